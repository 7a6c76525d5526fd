"""Validation of the arguments of queries, and their layout for compiled code."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import is_whole, real, reals
from kickdrift.core.errors import ArgumentError

Floats = NDArray[np.float64]

_ALL_LAYERS = (1 << 62) - 1


def rays_of(origins: ArrayLike, directions: ArrayLike, limit: Any) -> Floats:
    """Return rays as rows of an origin (3), a unit vector (3) and a limit, (N, 7)."""
    start, way = _vectors("origin", origins), _vectors("direction", directions)
    if len(start) not in (1, len(way)):
        raise ArgumentError(
            f"there are {len(start)} origins and {len(way)} directions; give one origin for all, or one per direction."
        )
    with np.errstate(over="ignore"):
        scale = np.abs(way).max(axis=1, initial=0.0)
    if not (scale > 0.0).all():
        raise ArgumentError(f"direction={way[np.argmin(scale)].tolist()} has zero length; (0, 0, -1) points down.")
    way = way / scale[:, None]
    rays = np.empty((len(way), 7))
    rays[:, :3], rays[:, 3:6], rays[:, 6] = start, way / np.sqrt((way * way).sum(axis=1))[:, None], _limit(limit)
    return rays


def _limit(limit: Any) -> float:
    try:
        length = real(limit)
    except TypeError:
        length = 0.0
    if not length > 0.0:
        raise ArgumentError(f"limit={limit!r} must be positive, in m; infinity is the default.")
    return length


def one_vector(argument: str, value: ArrayLike) -> Floats:
    """Return three finite numbers as an array (1, 3)."""
    array = _vectors(argument, value)
    if np.ndim(value) != 1:
        raise ArgumentError(f"{argument} has the shape {np.shape(value)}; give three numbers.")
    return array


def _vectors(argument: str, value: ArrayLike) -> Floats:
    try:
        array = np.atleast_2d(reals(value))
    except TypeError:
        raise ArgumentError(f"{argument}={value!r} is not an array of numbers; give three numbers per row.") from None
    if array.ndim != 2 or array.shape[1] != 3:
        raise ArgumentError(f"{argument} has the shape {np.shape(value)}; give three numbers, or three per row.")
    finite = np.isfinite(array).all(axis=1)
    if not finite.all():
        raise ArgumentError(f"{argument}={array[np.argmin(finite)].tolist()} is not finite; give finite numbers.")
    return array


def layer_bits(layers: Iterable[int] | None) -> int:
    """Return the bit set of some layers; None stands for all."""
    if layers is None:
        return _ALL_LAYERS
    if not isinstance(layers, Iterable) or (isinstance(layers, np.ndarray) and layers.ndim == 0):
        raise ArgumentError(f"layers={layers!r} must be a sequence of layers, whole numbers from 0 to 61.")
    wanted = 0
    for layer in layers:
        if not is_whole(layer, 0, 61):
            raise ArgumentError(f"layers contains {layer!r}; a layer is a whole number from 0 to 61.")
        wanted |= 1 << int(layer)
    return wanted
