"""The report of an ensemble: one fact per line."""

from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.io.report import lines
from kickdrift.scale.ensemble_solution import EnsembleSolution

_PART = 1024  # members whose rows are in memory at a time, if they are on disk
_MOST = 3  # members that failed which are named


def report(solution: EnsembleSolution) -> str:
    """Return a report: what was run, what it cost, how the members ended, and how well they conserved what is conserved.

    Errors are the largest at the times kept, of each member relative to its start: the median and the largest of members.
    """
    about, unit, steps = solution.about, solution.about.units.get("t", ""), int(solution.n_steps.sum())
    per_step = solution.wall_time / max(steps, 1) * 1e9
    rows = [
        ("system", about.system),
        ("members", f"{len(solution)}{_swept(solution)}"),
        ("method", f"{about.method}, order {about.order}: {about.word}"),
        ("span", f"{solution.t[0]:.10g} to {solution.t[-1]:.10g} {unit}".rstrip()),
        ("step", f"{_range(np.abs(solution.step))} {unit}".rstrip()),
        ("steps", f"{steps} in total"),
        ("force evaluations", f"{int(solution.n_force_evaluations.sum())}"),
        ("wall time", f"{solution.wall_time:.3g} s, {per_step:.4g} ns per member and step"),
        ("sums", "compensated" if about.compensated else "plain"),
    ]
    if about.choice:
        rows.insert(3, ("chosen because", about.choice))
    if solution.saved_to:
        rows.append(("rows", f"in {solution.saved_to!r}"))
    rows += [(f"{name} error", _errors(values)) for name, values in solution.invariants.items()]
    counts = Counter(status.name.lower().replace("_", " ") for status in solution.status)
    rows.append(("outcomes", ", ".join(f"{count} {name}" for name, count in counts.items())))
    failed = [i for i, status in enumerate(solution.status) if not status.success]
    rows += [(f"member {i}", solution.messages[i]) for i in failed[:_MOST]]
    return lines(rows)


def _swept(solution: EnsembleSolution) -> str:
    names = [f"{name} {_range(values)}" for name, values in solution.parameters.items() if values.dtype.kind in "fiu"]
    return f" over {', '.join(names)}" if names else ""


def _range(values: NDArray[Any]) -> str:
    low, high = values.min(), values.max()
    return f"{low:.10g}" if low == high else f"{low:.10g} to {high:.10g}"


def _errors(values: NDArray[Any]) -> str:
    parts = [_relative(np.asarray(values[first : first + _PART])) for first in range(0, values.shape[0], _PART)]
    relative = np.concatenate(parts)
    relative = relative[np.isfinite(relative)]
    if not relative.size:
        return "unknown"
    return f"{np.median(relative):.3e} relative in the median, {relative.max():.3e} at most"


def _relative(values: NDArray[Any]) -> NDArray[Any]:
    errors = np.abs(values - values[:, :1]).reshape(len(values), values.shape[1], -1)
    size = np.abs(values[:, 0]).reshape(len(values), -1).max(axis=1)
    with np.errstate(all="ignore"):
        relative: NDArray[Any] = np.where(np.isfinite(errors), errors, 0.0).max(axis=(1, 2)) / size
    return relative
