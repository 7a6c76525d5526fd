"""The report of a run: one fact per line."""

from collections.abc import Sequence

from kickdrift.analysis.energy import drift, largest_error
from kickdrift.analysis.phase import largest_phase_error, phase_drift
from kickdrift.engine.solution import Solution, sizes_of_steps


def report(solution: Solution) -> str:
    """Return a report: what was run, what it cost, and how well the conserved quantities were conserved.

    Errors are the largest at the times kept, relative to the initial value; those of momenta, which may be zero, relative to
    the sum of the magnitudes for the bodies. The drift is the slope of the least-squares line through the energy errors. If
    the exact motion is known, the phase error is the time by which the run is ahead of it.
    """
    solution = solution.plain
    about, unit = solution.about, solution.about.units.get("t", "")
    per_step = solution.wall_time / max(solution.n_steps, 1) * 1e9
    rows = [
        ("system", about.system),
        ("method", f"{about.method}, order {about.order}: {about.word}"),
        ("span", f"{solution.t[0]:.10g} to {solution.t[-1]:.10g} {unit}".rstrip()),
        ("step", f"{sizes_of_steps(solution, digits=10)} {unit}".rstrip()),
        ("steps", f"{solution.n_steps}" + f", {solution.n_rejected} more rejected" * (solution.n_rejected > 0)),
        ("force evaluations", f"{solution.n_force_evaluations}"),
        ("wall time", f"{solution.wall_time:.3g} s, {per_step:.4g} ns per step"),
        ("sums", "compensated" if about.compensated else "plain"),
    ]
    if solution.error_estimate is not None:
        rows.append(("estimated error", f"{solution.error_estimate.max():.3e} at most per step"))
    if about.step_control:
        rows.insert(2, ("step control", about.step_control))
    if about.choice:
        rows.insert(2, ("chosen because", about.choice))
    for name, values in solution.invariants.items():
        absolute, relative = largest_error(values, about.scales.get(name))
        size = f"{absolute:.3e} {about.units.get(name, '')}".rstrip()
        rows.append((f"{name} error", f"{relative:.3e} relative, {size} absolute" if relative is not None else size))
        if name == "energy" and solution.t.size > 1:
            per = f" per {unit}" if unit else " per unit of time"
            rows.append(("energy drift", f"{drift(solution.t, values):+.3e}{per}"))
    if "phase error" in solution.derived:
        rows.append(("phase error", _phase(solution, unit)))
    if solution.t_events:
        rows.append(("events", ", ".join(f"{own.size}" for own in solution.t_events) + " zeros"))
    if solution.saved_to:
        rows.append(("kept", f"all rows are in {solution.saved_to!r}, the first and the last here"))
    rows.append(("outcome", solution.message))
    return lines(rows)


def _phase(solution: Solution, unit: str) -> str:
    """Return the phase error in words: how far the run is ahead of the exact motion, and how fast that grows."""
    largest = f"{largest_phase_error(solution):.3e} {unit}".rstrip() + " in time at most"
    return largest + (f", {phase_drift(solution):+.3e} per unit of time" if solution.t.size > 1 else "")


def lines(facts: Sequence[tuple[str, str]]) -> str:
    """Write facts below each other, their names in one column."""
    width = max(len(name) for name, _ in facts)
    return "\n".join(f"{name:<{width}}  {value}" for name, value in facts)
