"""Spheres."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, times
from kickdrift.world.shapes.closest_points import along
from kickdrift.world.shapes.extents import Extent
from kickdrift.world.shapes.kind_numbers import SPHERE
from kickdrift.world.shapes.mass_properties import Array, MassProperties, extent
from kickdrift.world.shapes.rays import MISS, Hit, ahead, through_ball
from kickdrift.world.shapes.record import BALL, CENTRE, GLOSSY, SOLID, Kind


@compiled
def _extent(numbers: Any, q: Quaternion) -> Extent:
    """Return the bounds of a ball; see `kickdrift.world.shapes.record`."""
    r = numbers[0]
    return (-r, -r, -r, r, r, r)


@compiled
def _ray(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Cast a ray at a ball; see `kickdrift.world.shapes.rays`."""
    distance = ahead(through_ball(origin, direction, numbers[0]), limit)
    if distance == math.inf:
        return MISS
    normal = times(1.0 / numbers[0], along(origin, distance, direction))
    return (distance, normal[0], normal[1], normal[2])


@dataclass(frozen=True)
class Sphere:
    """A ball about the origin of its frame.

    Attributes
    ----------
    radius : float
        m.

    Raises
    ------
    ArgumentError
        If the radius is not positive and finite.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> ball = world.add_body(kd.Sphere(0.5), density=1000.0)
    >>> round(ball.mass, 3)
    523.599
    """

    radius: float
    kind: ClassVar[int] = SPHERE

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", extent("radius", self.radius))

    @property
    def numbers(self) -> Array:
        """The data for compiled code: the radius."""
        return np.array([self.radius])

    @property
    def reach(self) -> float:
        """Radius of its bounding sphere about the origin of its frame, m."""
        return self.radius

    def mass_properties(self) -> MassProperties:
        """Return the mass properties at unit density.

        Returns
        -------
        MassProperties
            Volume, centre of mass and inertia.

        Examples
        --------
        >>> import kickdrift as kd
        >>> round(float(kd.Sphere(0.5).mass_properties().volume), 6)
        0.523599
        """
        volume = 4.0 / 3.0 * math.pi * self.radius**3
        return MassProperties(volume, np.zeros(3), 0.4 * volume * self.radius**2 * np.eye(3))


RECORD = Kind(
    number=SPHERE, name="sphere", sort=SOLID, shape=Sphere, extent=_extent, ray=_ray, core=CENTRE, look=GLOSSY | BALL
)
