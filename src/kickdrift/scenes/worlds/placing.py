"""Where things of a scene begin."""

import math
from collections.abc import Sequence
from typing import NamedTuple

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


class Placed(NamedTuple):
    """A capsule between two points: its centre, its orientation (w, x, y, z), and how far apart they are."""

    position: Vector
    orientation: Quaternion
    length: float


def between(start: Sequence[float], end: Sequence[float]) -> Placed:
    """Lay a capsule's own z axis from one point to another, by the shortest turn."""
    along = [b - a for a, b in zip(start, end, strict=True)]
    length = math.hypot(*along)
    x, y, z = (component / length for component in along)
    centre = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2, (start[2] + end[2]) / 2)
    if z < -1.0 + 1e-12:
        return Placed(centre, (0.0, 1.0, 0.0, 0.0), length)
    w = math.sqrt((1.0 + z) / 2)
    return Placed(centre, (w, -y / (2 * w), x / (2 * w), 0.0), length)


def about(axis: Sequence[float], angle: float) -> Quaternion:
    """Quaternion (w, x, y, z) of a turn about a unit vector."""
    sine = math.sin(angle / 2)
    return (math.cos(angle / 2), sine * axis[0], sine * axis[1], sine * axis[2])


def scatter(number: int) -> float:
    """Give a number in [-1/2, 1/2) that looks random, the same everywhere: multiples of the golden section."""
    return (number * _GOLDEN) % 1.0 - 0.5


def turned(q: Quaternion, a: Vector) -> Vector:
    """Turn a vector by a unit quaternion."""
    w, x, y, z = q
    tx, ty, tz = 2 * (y * a[2] - z * a[1]), 2 * (z * a[0] - x * a[2]), 2 * (x * a[1] - y * a[0])
    return (a[0] + w * tx + y * tz - z * ty, a[1] + w * ty + z * tx - x * tz, a[2] + w * tz + x * ty - y * tx)
