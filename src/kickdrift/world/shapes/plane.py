"""The half-space below a plane."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.core.vectors import Vector
from kickdrift.world.shapes.kind_numbers import PLANE
from kickdrift.world.shapes.mass_properties import Array, MassProperties
from kickdrift.world.shapes.rays import MISS, Hit, ahead
from kickdrift.world.shapes.record import GROUND, HALF_SPACE, Kind


@compiled
def _ray(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Cast a ray at a half-space; see `kickdrift.world.shapes.rays`."""
    height, rise = origin[2], direction[2]
    if rise < 0.0:
        distance = ahead((-height / rise, math.inf), limit) if height >= 0.0 else math.inf
    elif rise > 0.0:
        distance = ahead((-math.inf, -height / rise), limit)
    else:
        distance = math.inf
    return (distance, 0.0, 0.0, 1.0) if distance < math.inf else MISS


@dataclass(frozen=True)
class Plane:
    """All points with z <= 0 in its own frame. It has no mass and is for static bodies."""

    kind: ClassVar[int] = PLANE

    @property
    def numbers(self) -> Array:
        """The data for compiled code: none besides its pose."""
        return np.zeros(0)

    @property
    def reach(self) -> float:
        """0.0, as for all shapes that never move."""
        return 0.0

    def mass_properties(self) -> MassProperties:
        """Refuse, since it has no finite mass.

        Raises
        ------
        ArgumentError
            Always: a half-space has no finite mass.
        """
        raise ArgumentError("A plane is half of space and has no finite mass; add it to a static body.")


RECORD = Kind(number=PLANE, name="plane", sort=HALF_SPACE, shape=Plane, ray=_ray, look=GROUND)
