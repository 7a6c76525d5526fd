"""Zeros of events of the members of an ensemble, any number for each, stored in flat arrays."""

import json
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Zeros(NamedTuple):
    """The zeros of a member: of each event the times, (K,), and the states there, (K, *shape)."""

    t: tuple[Floats, ...] = ()
    x: tuple[Floats, ...] = ()
    v: tuple[Floats, ...] = ()


def none_of(events: int, shape: tuple[int, ...], shape_of_v: tuple[int, ...]) -> Zeros:
    """Return the zeros of a member without any."""
    return Zeros((np.zeros(0),) * events, (np.zeros((0, *shape)),) * events, (np.zeros((0, *shape_of_v)),) * events)


def flattened(members: Sequence[Zeros]) -> dict[str, NDArray[Any]]:
    """Lay zeros out in arrays: how many each member has of each event, (M, E), and all of them; nothing without events."""
    if not members or not members[0].t:
        return {}
    arrays: dict[str, NDArray[Any]] = {
        "n_events": np.array([[t.size for t in own.t] for own in members], dtype=np.int64)
    }
    return arrays | {
        f"{name}_events": np.concatenate([a for own in members for a in getattr(own, name)]) for name in "txv"
    }


def separated(arrays: Mapping[str, Any], members: int) -> list[Zeros]:
    """Return the zeros of each member from arrays.

    Raises
    ------
    LookupError, ValueError
        If these are not such arrays.
    """
    counts = arrays.get("n_events", np.zeros((members, 0), dtype=np.int64))
    if counts.shape[:1] != (members,) or counts.ndim != 2 or (counts < 0).any():
        raise ValueError(f"n_events has shape {counts.shape}")
    if not counts.size:
        return [Zeros()] * members
    ends = np.cumsum(counts.reshape(-1))
    parts = []
    for name in "txv":
        values = arrays[f"{name}_events"]
        if len(values) != ends[-1] or values.dtype != np.float64:
            raise ValueError(f"{name}_events has shape {values.shape}")
        parts.append(np.split(values, ends[:-1]))
    events = counts.shape[1]
    return [Zeros(*(tuple(own[i * events : (i + 1) * events]) for own in parts)) for i in range(members)]


def spelled(own: Zeros) -> str:
    """Spell the zeros of a member as JSON, whose numbers keep all their bits."""
    return json.dumps({name: [values.tolist() for values in arrays] for name, arrays in own._asdict().items()})


def read(text: str, shape: tuple[int, ...], shape_of_v: tuple[int, ...]) -> Zeros:
    """Read the arrays that `spelled` wrote."""
    given, parts = json.loads(text), []
    for name, own in (("t", ()), ("x", shape), ("v", shape_of_v)):
        parts.append(tuple(np.array(values, dtype=float).reshape(len(values), *own) for values in given[name]))
    return Zeros(*parts)
