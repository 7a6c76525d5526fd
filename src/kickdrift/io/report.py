"""The report of a run: a fact a line."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.solution import Solution


def report(solution: Solution) -> str:
    """Say what was run, what it cost, and how well the conserved quantities were conserved.

    Errors are the largest at the times kept: relative to the start, absolute where the start is zero. The drift is the
    slope of a straight line through the energy errors.
    """
    about, unit = solution.about, solution.about.units.get("t", "")
    per_step = solution.wall_time / max(solution.n_steps, 1) * 1e9
    rows = [
        ("system", about.system),
        ("method", f"{about.method}, order {about.order}: {about.word}"),
        ("span", f"{solution.t[0]:.10g} to {solution.t[-1]:.10g} {unit}".rstrip()),
        ("step", f"{solution.step:.10g} {unit}".rstrip()),
        ("steps", f"{solution.n_steps}"),
        ("force evaluations", f"{solution.n_force_evaluations}"),
        ("wall time", f"{solution.wall_time:.3g} s, {per_step:.4g} ns a step"),
        ("sums", "compensated" if about.compensated else "plain"),
    ]
    for name, values in solution.invariants.items():
        error, relative = largest_error(values)
        rows.append((f"{name} error", f"{error:.3e}{' (relative)' if relative else ' (absolute)'}"))
        if name == "energy" and solution.t.size > 1:
            per = f" per {unit}" if unit else " per unit of time"
            rows.append(("energy drift", f"{drift(solution.t, values):+.3e}{per}"))
    rows.append(("outcome", solution.message))
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:<{width}}  {value}" for name, value in rows)


def largest_error(values: NDArray[np.float64]) -> tuple[float, bool]:
    """Return the largest deviation from the start, and whether it is relative to it."""
    deviation = (
        float(np.abs(values - values[0]).max())
        if values.ndim == 1
        else float(np.linalg.norm(values - values[0], axis=1).max())
    )
    start = float(np.linalg.norm(values[0]))
    return (deviation / start, True) if start > 0 else (deviation, False)


def drift(t: NDArray[np.float64], energy: NDArray[np.float64]) -> float:
    """Return the slope of the relative energy error over time."""
    scale = abs(energy[0]) if energy[0] != 0 else 1.0
    error, centred = (energy - energy[0]) / scale, t - t.mean()
    return float(centred @ (error - error.mean()) / (centred @ centred))
