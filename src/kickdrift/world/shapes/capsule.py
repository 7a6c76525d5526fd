"""Capsules: cylinders with hemispherical caps."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, length, minus, times, turned
from kickdrift.world.shapes.closest_points import along, clamped
from kickdrift.world.shapes.extents import Extent, symmetric
from kickdrift.world.shapes.kind_numbers import CAPSULE
from kickdrift.world.shapes.mass_properties import Array, MassProperties, extent
from kickdrift.world.shapes.rays import MISS, Hit, ahead, through_ball, through_cylinder
from kickdrift.world.shapes.record import CENTRE, GLOSSY, SOLID, Kind


@compiled
def _extent(numbers: Any, q: Quaternion) -> Extent:
    """Return the bounds of a capsule; see `kickdrift.world.shapes.record`."""
    r, axis = numbers[0], turned(q, (0.0, 0.0, numbers[1]))
    return symmetric((abs(axis[0]) + r, abs(axis[1]) + r, abs(axis[2]) + r))


@compiled
def _ray(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Cast a ray at a capsule; see `kickdrift.world.shapes.rays`.

    Notes
    -----
    It is convex, and the union of a cylinder and two balls: a line enters it where it first enters one of these.
    """
    radius, half = numbers[0], numbers[1]
    enters, leaves = through_cylinder(origin, direction, radius, half)
    for side in range(2):
        z = origin[2] - half if side == 1 else origin[2] + half
        first, last = through_ball((origin[0], origin[1], z), direction, radius)
        enters, leaves = min(enters, first), max(leaves, last)
    distance = ahead((enters, leaves), limit)
    if distance == math.inf:
        return MISS
    x = along(origin, distance, direction)
    out = minus(x, (0.0, 0.0, clamped(x[2], -half, half)))
    normal = times(1.0 / length(out), out)
    return (distance, normal[0], normal[1], normal[2])


@dataclass(frozen=True)
class Capsule:
    """All points within a radius of a segment along the z axis, centred at the origin.

    Attributes
    ----------
    radius : float
        m.
    length : float
        Length of the segment, which is that of the cylinder between the caps, m.

    Raises
    ------
    ArgumentError
        If one of the two is not positive and finite.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> rod = world.add_body(kd.Capsule(0.1, 1.0), density=1000.0)
    >>> round(rod.mass, 3)
    35.605
    """

    radius: float
    length: float
    kind: ClassVar[int] = CAPSULE

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", extent("radius", self.radius))
        object.__setattr__(self, "length", extent("length", self.length))

    @property
    def numbers(self) -> Array:
        """The data for compiled code: the radius and half of the length."""
        return np.array([self.radius, 0.5 * self.length])

    @property
    def reach(self) -> float:
        """Radius of its bounding sphere about the origin of its frame, m."""
        return self.radius + 0.5 * self.length

    def mass_properties(self) -> MassProperties:
        """Return the mass properties at unit density.

        Returns
        -------
        MassProperties
            Volume, centre of mass and inertia.

        Notes
        -----
        A hemisphere has its centre of mass at 3/8 of its radius from its flat side, and a moment of inertia of 83/320 m r^2
        about axes through that centre and parallel to the flat side.

        Examples
        --------
        >>> import kickdrift as kd
        >>> round(float(kd.Capsule(0.1, 1.0).mass_properties().volume), 6)
        0.035605
        """
        r, half = self.radius, 0.5 * self.length
        cylinder = math.pi * r**2 * self.length
        ball = 4.0 / 3.0 * math.pi * r**3
        along = 0.5 * cylinder * r**2 + 0.4 * ball * r**2
        arm = half + 0.375 * r
        across = cylinder * (r**2 / 4.0 + self.length**2 / 12.0) + ball * (83.0 / 320.0 * r**2 + arm**2)
        return MassProperties(cylinder + ball, np.zeros(3), np.diag([across, across, along]))


RECORD = Kind(
    number=CAPSULE, name="capsule", sort=SOLID, shape=Capsule, extent=_extent, ray=_ray, core=CENTRE, look=GLOSSY
)
