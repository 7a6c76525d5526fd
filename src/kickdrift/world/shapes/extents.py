"""Axis-aligned bounds of shapes relative to their origins: functions shared by the kinds."""

from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, matrix, turned

Extent = tuple[float, float, float, float, float, float]  # lower corner, upper corner


@compiled(inline=True)
def turned_extents(q: Quaternion, sides: Vector) -> Vector:
    """Return the half sides of the axis-aligned bounds of a rotated box with the given half sides: |R| sides."""
    a, b, c = sides
    u, v, w = matrix(q)
    return (
        abs(u[0]) * a + abs(u[1]) * b + abs(u[2]) * c,
        abs(v[0]) * a + abs(v[1]) * b + abs(v[2]) * c,
        abs(w[0]) * a + abs(w[1]) * b + abs(w[2]) * c,
    )


@compiled(inline=True)
def symmetric(half: Vector) -> Extent:
    """Return the bounds centred at the origin with the given half sides."""
    return (-half[0], -half[1], -half[2], half[0], half[1], half[2])


@compiled
def around(numbers: Any, begin: int, width: int, count: int, points: int, q: Quaternion) -> Extent:
    """Return the bounds of the first `points` points of each of `count` rows of numbers, rotated by q."""
    x, y, z = np.inf, np.inf, np.inf
    u, v, w = -np.inf, -np.inf, -np.inf
    for row in range(count):
        for k in range(points):
            at = begin + width * row + 3 * k
            point = (numbers[at], numbers[at + 1], numbers[at + 2])
            p = turned(q, point)
            x, y, z = min(x, p[0]), min(y, p[1]), min(z, p[2])
            u, v, w = max(u, p[0]), max(v, p[1]), max(w, p[2])
    return (x, y, z, u, v, w)
