"""The surface of a rope, for drawing: a tube around its vertices."""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.rotations import cross

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_SIDES = 8


def tube(points: Floats, radius: float) -> tuple[Floats, Integers]:
    """Return the vertices and triangles of a tube of eight sides around points, (N, 3), with flat ends.

    The ring around a point is in the plane that halves the angle there; along the tube rings do not twist.
    """
    ways = np.diff(points, axis=0)
    ways = ways / np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-300)
    along = np.concatenate((ways[:1], ways[1:] + ways[:-1], ways[-1:]))
    u = np.empty_like(points)
    side = np.eye(3)[int(np.argmin(np.abs(along[0])))]
    for k, axis in enumerate(along):
        square = float(axis @ axis)
        across = side - (side @ axis) / square * axis if square > 0.0 else side
        size = float(np.linalg.norm(across))
        u[k] = side = across / size if size > 0.0 else side
    v = cross(along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300), u)
    turns = 2.0 * math.pi / _SIDES * np.arange(_SIDES)
    rings = points[:, None] + radius * (np.cos(turns)[:, None] * u[:, None] + np.sin(turns)[:, None] * v[:, None])
    return np.concatenate((rings.reshape(-1, 3), points[:1], points[-1:])), _triangles(len(points))


def _triangles(count: int) -> Integers:
    """Return the triangles between the rings around `count` points, and those of the two ends."""
    near = np.arange(_SIDES)
    far = np.roll(near, -1)
    start = _SIDES * np.arange(count - 1)[:, None]
    a, b, c, d = start + near, start + far, start + _SIDES + far, start + _SIDES + near
    sides = np.concatenate((np.stack((a, b, c), axis=2).reshape(-1, 3), np.stack((a, c, d), axis=2).reshape(-1, 3)))
    first, last = np.full(_SIDES, _SIDES * count), np.full(_SIDES, _SIDES * count + 1)
    end = _SIDES * (count - 1)
    caps = np.concatenate((np.stack((first, far, near), axis=1), np.stack((last, end + near, end + far), axis=1)))
    return np.concatenate((sides, caps))
