"""Solutions on disk."""

from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from kickdrift.core import archive
from kickdrift.core.kinds import Kind
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.description import Description
from kickdrift.engine.invariants import Invariants
from kickdrift.engine.solution import Solution

_EVENTS = ("t_events", "x_events", "v_events")
INVARIANT, _DERIVED = "invariant: ", "derived: "


def save(solution: Solution, path: str | Path) -> Path:
    """Write a solution to a file, whole or not at all.

    Parameters
    ----------
    solution : Solution
    path : path
        ``.npz`` is appended if it is missing. The folder must exist.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    FileFormatError
        If the file cannot be written there.
    """
    solution = solution.plain
    return archive.write(path, {"format": archive.SOLUTION, **header_of(solution)}, arrays_of(solution))


def header_of(solution: Solution) -> dict[str, Any]:
    """Return the JSON header of a solution."""
    return {
        "status": solution.status.name,
        "message": solution.message,
        "step": solution.step,
        "n_steps": solution.n_steps,
        "n_force_evaluations": solution.n_force_evaluations,
        "wall_time": solution.wall_time,
        "about": asdict(solution.about),
        "step_range": list(solution.step_range),
        "n_rejected": solution.n_rejected,
        "error_estimate": None if solution.error_estimate is None else solution.error_estimate.tolist(),
    }


def arrays_of(solution: Solution) -> dict[str, Any]:
    """Return the arrays of a solution."""
    arrays = {"t": solution.t, "x": solution.x, "v": solution.v}
    arrays |= {INVARIANT + name: values for name, values in solution.invariants.items()}
    for name in _EVENTS:
        arrays |= {f"{name}{k}": values for k, values in enumerate(getattr(solution, name))}
    return arrays | {_DERIVED + name: values for name, values in solution.derived.items()}


def _range(given: Any) -> tuple[float, float]:
    smallest, largest = given
    return float(smallest), float(largest)


def _estimate(given: Any, x: Any) -> Any:
    """Return the error estimate in a file; earlier files have none."""
    if given is None:
        return None
    estimate = np.array(given, dtype=float)
    if estimate.shape != x.shape[1:]:
        raise ValueError(f"error_estimate has shape {estimate.shape}")
    return estimate


def _events(arrays: dict[str, Any], x: Any, v: Any) -> dict[str, Any]:
    """Return the zeros of events that a file holds."""
    count = sum(name.startswith("t_events") for name in arrays)
    found = {name: tuple(arrays[f"{name}{k}"] for k in range(count)) for name in _EVENTS}
    for k, t in enumerate(found["t_events"]):
        shapes = (t.size,), (t.size, *x.shape[1:]), (t.size, *v.shape[1:])
        given = [found[name][k] for name in _EVENTS]
        if any(array.dtype != np.float64 or array.shape != shape for array, shape in zip(given, shapes, strict=True)):
            raise ValueError(f"the zeros of events[{k}] have other shapes than the states")
    return found


def assemble(head: dict[str, Any], arrays: dict[str, Any]) -> Solution:
    """Create a solution from the contents of a file.

    Raises
    ------
    LookupError, TypeError, ValueError
        If it holds something else.
    """
    if head["format"] != archive.SOLUTION:
        raise KeyError("format")
    return Solution(**members(head, arrays))


def description(given: dict[str, Any]) -> Description:
    """Return the description of a run from a file."""
    about = {f.name: given[f.name] for f in fields(Description)}
    about["choice"], about["step_control"] = str(about["choice"]), str(about["step_control"])
    about["scales"] = {str(name): float(scale) for name, scale in about["scales"].items()}
    about["gm"] = tuple(float(each) for each in about["gm"])
    about["dimensions"] = tuple(about["dimensions"])
    about["kind"] = Kind[about["kind"]].name
    return Description(**about)


def members(head: dict[str, Any], arrays: dict[str, Any]) -> dict[str, Any]:
    """Return the members of a solution by name, of what a file holds."""
    kept = {name.removeprefix(INVARIANT): a for name, a in arrays.items() if name.startswith(INVARIANT)}
    derived = {name.removeprefix(_DERIVED): a for name, a in arrays.items() if name.startswith(_DERIVED)}
    t, x, v = arrays["t"], arrays["x"], arrays["v"]
    if any(array.dtype != np.float64 for array in (t, x, v, *kept.values(), *derived.values())):
        raise ValueError("its arrays are not float64")
    if any(values.shape[:1] != t.shape for values in (*kept.values(), *derived.values())):
        raise ValueError("an invariant has another number of times")
    if not (t.ndim == 1 and t.size and v.shape in (x.shape, (t.size, 0)) and x.shape[:1] == t.shape):
        raise ValueError(f"t, x and v have shapes {t.shape}, {x.shape} and {v.shape}")
    return {
        "t": t,
        "x": x,
        "v": v,
        "invariants": Invariants(tuple(kept), kept.__getitem__),
        "status": Outcome[head["status"]],
        "message": str(head["message"]),
        "step": float(head["step"]),
        "n_steps": int(head["n_steps"]),
        "n_force_evaluations": int(head["n_force_evaluations"]),
        "wall_time": float(head["wall_time"]),
        "about": description(head["about"]),
        "derived": derived,
        "step_range": _range(head["step_range"]),
        "n_rejected": int(head["n_rejected"]),
        "error_estimate": _estimate(head.get("error_estimate"), x),
        **_events(arrays, x, v),
    }
