"""States of members beside the rows that all have: zeros of events, and rows at their ends; stored in flat arrays."""

import json
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Moments(NamedTuple):
    """States of a member, at the zeros of each event, or at its end: of each kind the times, (K,), and states, (K, *shape)."""

    t: tuple[Floats, ...] = ()
    x: tuple[Floats, ...] = ()
    v: tuple[Floats, ...] = ()


def none_of(kinds: int, shape: tuple[int, ...], shape_of_v: tuple[int, ...]) -> Moments:
    """Return the moments of a member without any."""
    return Moments((np.zeros(0),) * kinds, (np.zeros((0, *shape)),) * kinds, (np.zeros((0, *shape_of_v)),) * kinds)


def flattened(members: Sequence[Moments], name: str) -> dict[str, NDArray[Any]]:
    """Lay moments out in arrays of that name: how many each member has of each kind, (M, E), and all of them."""
    if not members or not members[0].t:
        return {}
    counts = np.array([[t.size for t in own.t] for own in members], dtype=np.int64)
    arrays: dict[str, NDArray[Any]] = {f"n_{name}": counts}
    return arrays | {
        f"{letter}_{name}": np.concatenate([a for own in members for a in getattr(own, letter)]) for letter in "txv"
    }


def separated(arrays: Mapping[str, Any], members: int, name: str) -> list[Moments]:
    """Return the moments of each member from the arrays of that name.

    Raises
    ------
    LookupError, ValueError
        If these are not such arrays.
    """
    counts = arrays.get(f"n_{name}", np.zeros((members, 0), dtype=np.int64))
    if counts.shape[:1] != (members,) or counts.ndim != 2 or (counts < 0).any():
        raise ValueError(f"n_{name} has shape {counts.shape}")
    if not counts.size:
        return [Moments()] * members
    ends = np.cumsum(counts.reshape(-1))
    parts = []
    for letter in "txv":
        values = arrays[f"{letter}_{name}"]
        if len(values) != ends[-1] or values.dtype != np.float64:
            raise ValueError(f"{letter}_{name} has shape {values.shape}")
        parts.append(np.split(values, ends[:-1]))
    kinds = counts.shape[1]
    return [Moments(*(tuple(own[i * kinds : (i + 1) * kinds]) for own in parts)) for i in range(members)]


def spelled(own: Moments) -> str:
    """Spell the moments of a member as JSON, whose numbers keep all their bits."""
    return json.dumps({name: [values.tolist() for values in arrays] for name, arrays in own._asdict().items()})


def read(text: str, shape: tuple[int, ...], shape_of_v: tuple[int, ...]) -> Moments:
    """Read the arrays that `spelled` wrote."""
    given, parts = json.loads(text), []
    for name, own in (("t", ()), ("x", shape), ("v", shape_of_v)):
        parts.append(tuple(np.array(values, dtype=float).reshape(len(values), *own) for values in given[name]))
    return Moments(*parts)
