"""Solutions of ensembles on disk."""

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core import archive
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.invariants import Invariants
from kickdrift.io.solution_file import INVARIANT, description
from kickdrift.scale.ensemble_solution import EVENTS, LAST, EnsembleSolution
from kickdrift.scale.moments import Moments, flattened, separated

_PARAMETER, _LAST = "parameter: ", "last invariant: "
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
    arrays |= flattened([Moments(*own) for own in _by_member(solution, EVENTS)], "events")
    arrays |= flattened([Moments(*((one,) for one in own)) for own in _by_member(solution, LAST)], "last")
    arrays |= {_LAST + name: np.concatenate(values) for name, values in solution.last_invariants.items()}
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
        **_last(arrays, rows[0], x.shape[2:], v.shape[2:]),
        parameters=labels,
    )


def _events(
    arrays: dict[str, Any], members: int, shape: tuple[int, ...], shape_of_v: tuple[int, ...]
) -> dict[str, Any]:
    """Return the zeros of events in a file."""
    zeros = _separated(arrays, members, "events", shape, shape_of_v)
    return {name: tuple(own[k] for own in zeros) for k, name in enumerate(EVENTS)}


def _last(arrays: dict[str, Any], members: int, shape: tuple[int, ...], shape_of_v: tuple[int, ...]) -> dict[str, Any]:
    """Return the early ends in a file."""
    ends = _separated(arrays, members, "last", shape, shape_of_v)
    if any(len(arrays_of_one) != 1 for own in ends for arrays_of_one in own):
        raise ValueError("the early ends of members are missing")
    sizes = [own.t[0].size for own in ends]
    flat = {name.removeprefix(_LAST): a for name, a in arrays.items() if name.startswith(_LAST)}
    if any(len(values) != sum(sizes) or values.dtype != np.float64 for values in flat.values()):
        raise ValueError("an invariant has another number of early ends")
    invariants = {name: tuple(np.split(values, np.cumsum(sizes)[:-1])) for name, values in flat.items()}
    return {name: tuple(own[k][0] for own in ends) for k, name in enumerate(LAST)} | {"last_invariants": invariants}


def _by_member(solution: EnsembleSolution, names: tuple[str, ...]) -> Iterator[tuple[Any, ...]]:
    return zip(*(getattr(solution, name) for name in names), strict=True)


def _separated(
    arrays: dict[str, Any], members: int, name: str, shape: tuple[int, ...], shape_of_v: tuple[int, ...]
) -> list[Moments]:
    """Return the moments of this name in a file, whose states have these shapes."""
    moments = separated(arrays, members, name)
    for own in moments:
        if any(x.shape[1:] != shape or v.shape[1:] != shape_of_v for x, v in zip(own.x, own.v, strict=True)):
            raise ValueError(f"the states of {name} have other shapes than those of rows")
    return moments
