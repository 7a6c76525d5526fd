"""Solutions of ensembles on disk."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core import archive
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.invariants import Invariants
from kickdrift.io.solution_file import INVARIANT, description
from kickdrift.scale.ensemble_solution import EVENTS, EnsembleSolution
from kickdrift.scale.zeros import Zeros, flattened, separated

_PARAMETER = "parameter: "
_OF_MEMBERS = ("step", "step_range", "n_steps", "n_rejected", "n_force_evaluations")


def save(solution: EnsembleSolution, path: str | Path) -> Path:
    """Write the solution of an ensemble to a file, whole or not at all.

    Returns
    -------
    Path
        The file written; ``.npz`` is appended if it is missing.

    Raises
    ------
    FileFormatError
        If the file cannot be written there.
    """
    header, arrays = contents(solution)
    arrays |= {"x": solution.x, "v": solution.v}
    return archive.write(path, header, arrays | {INVARIANT + name: a for name, a in solution.invariants.items()})


def contents(solution: EnsembleSolution) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return the header and the arrays of a file, but for the rows."""
    outcomes = list(dict.fromkeys(zip(solution.status, solution.messages, strict=True)))
    places = {outcome: k for k, outcome in enumerate(outcomes)}
    header = {
        "format": archive.ENSEMBLE,
        "outcomes": [(status.name, message) for status, message in outcomes],
        "wall_time": solution.wall_time,
        "about": asdict(solution.about),
    }
    arrays: dict[str, NDArray[Any]] = {"t": solution.t}
    arrays["outcome"] = np.array([places[outcome] for outcome in zip(solution.status, solution.messages, strict=True)])
    arrays |= {name: getattr(solution, name) for name in _OF_MEMBERS}
    arrays |= flattened([Zeros(*zeros) for zeros in zip(*(getattr(solution, name) for name in EVENTS), strict=True)])
    return header, arrays | {_PARAMETER + name: values for name, values in solution.parameters.items()}


def assemble(head: dict[str, Any], arrays: dict[str, Any]) -> EnsembleSolution:
    """Create the solution of an ensemble from the contents of a file.

    Raises
    ------
    LookupError, TypeError, ValueError
        If it holds something else.
    """
    t, x, v = arrays["t"], arrays["x"], arrays["v"]
    kept = {name.removeprefix(INVARIANT): a for name, a in arrays.items() if name.startswith(INVARIANT)}
    labels = {name.removeprefix(_PARAMETER): a for name, a in arrays.items() if name.startswith(_PARAMETER)}
    if any(array.dtype != np.float64 for array in (t, x, v, *kept.values())):
        raise ValueError("its arrays are not float64")
    rows = x.shape[:2]
    if not (t.ndim == 1 and t.size and x.ndim >= 2 and rows[1] == t.size and v.shape in (x.shape, (*rows, 0))):
        raise ValueError(f"t, x and v have shapes {t.shape}, {x.shape} and {v.shape}")
    if any(values.shape[:2] != rows for values in kept.values()):
        raise ValueError("an invariant has another number of times or members")
    of_members = [arrays[name] for name in ("outcome", *_OF_MEMBERS)]
    if any(array.shape[:1] != rows[:1] for array in of_members) or any(
        a.shape[:1] != rows[:1] for a in labels.values()
    ):
        raise ValueError("the number of members is inconsistent")
    outcomes = [(Outcome[name], str(message)) for name, message in head["outcomes"]]
    chosen = [outcomes[k] for k in arrays["outcome"]]
    return EnsembleSolution(
        t=t,
        x=x,
        v=v,
        invariants=Invariants(tuple(kept), kept.__getitem__),
        status=tuple(status for status, _ in chosen),
        messages=tuple(message for _, message in chosen),
        **{name: arrays[name] for name in _OF_MEMBERS},
        wall_time=float(head["wall_time"]),
        about=description(head["about"]),
        **_events(arrays, rows[0], x.shape[2:], v.shape[2:]),
        parameters=labels,
    )


def _events(
    arrays: dict[str, Any], members: int, shape: tuple[int, ...], shape_of_v: tuple[int, ...]
) -> dict[str, Any]:
    """Return the zeros of events in a file; earlier files have none."""
    if "n_events" not in arrays:
        return {}
    zeros = separated(arrays, members)
    for own in zeros:
        if any(x.shape[1:] != shape or v.shape[1:] != shape_of_v for x, v in zip(own.x, own.v, strict=True)):
            raise ValueError("the zeros of events have other shapes than the states")
    return {name: tuple(own[k] for own in zeros) for k, name in enumerate(EVENTS)}
