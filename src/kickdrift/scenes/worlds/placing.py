"""Initial poses of the bodies of scenes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.rotations import Floats, turn_to

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


class Placed(NamedTuple):
    """A capsule between two points: its centre, its orientation (w, x, y, z), and how far apart they are."""

    position: Floats
    orientation: Floats
    length: float


def between(start: ArrayLike, end: ArrayLike) -> Placed:
    """Lay a capsule's own z axis from one point to another, by the shortest turn."""
    a, b = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    length = float(np.linalg.norm(b - a))
    return Placed((a + b) / 2, turn_to((b - a) / length), length)


def scatter(number: int) -> float:
    """Give a number in [-1/2, 1/2) that looks random, the same everywhere: multiples of the golden section."""
    return (number * _GOLDEN) % 1.0 - 0.5
