"""Axis-aligned bounds of shapes relative to their origins: functions shared by the kinds."""

from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, turned

Extent = tuple[float, float, float, float, float, float]  # lower corner, upper corner


@compiled(inline=True)
def turned_extents(q: Quaternion, sides: Vector) -> Vector:
    """Return the half sides of the axis-aligned bounds of a rotated box with the given half sides: |R| sides."""
    w, x, y, z = q
    a, b, c = sides
    return (
        abs(1.0 - 2.0 * (y * y + z * z)) * a + abs(2.0 * (x * y - w * z)) * b + abs(2.0 * (x * z + w * y)) * c,
        abs(2.0 * (x * y + w * z)) * a + abs(1.0 - 2.0 * (x * x + z * z)) * b + abs(2.0 * (y * z - w * x)) * c,
        abs(2.0 * (x * z - w * y)) * a + abs(2.0 * (y * z + w * x)) * b + abs(1.0 - 2.0 * (x * x + y * y)) * c,
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
