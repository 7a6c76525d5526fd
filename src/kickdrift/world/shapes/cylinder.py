"""Cylinders with flat ends."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from kickdrift.world.shapes.frustum import frustum_extent, ray_frustum
from kickdrift.world.shapes.kind_numbers import CYLINDER
from kickdrift.world.shapes.mass_properties import Array, MassProperties, extent
from kickdrift.world.shapes.record import AXIS, CREASED, GLOSSY, SOLID, Kind


@dataclass(frozen=True)
class Cylinder:
    """A cylinder about the z axis, centred at the origin.

    Attributes
    ----------
    radius : float
        m.
    length : float
        From end to end, m.

    Raises
    ------
    ArgumentError
        If one of the two is not positive and finite.

    Notes
    -----
    It is round, not a prism: it rolls, and ray casts, bounding boxes and contacts with planes, spheres and capsules are
    exact. So are contacts with boxes, hulls and triangles, at faces as well as at edges, except for the extent of contact
    points where an end lies partly over a face: there the rim is a polygon of 24 corners. In contacts of two cylinders one
    of them is such a polygon, with a corner at the point of contact.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> can = world.add_body(kd.Cylinder(0.1, 1.0), density=1000.0)
    >>> round(can.mass, 3)
    31.416
    """

    radius: float
    length: float
    kind: ClassVar[int] = CYLINDER

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", extent("radius", self.radius))
        object.__setattr__(self, "length", extent("length", self.length))

    @property
    def numbers(self) -> Array:
        """The data for compiled code: the radii of both ends and half of the length."""
        return np.array([self.radius, self.radius, 0.5 * self.length])

    @property
    def reach(self) -> float:
        """Radius of its bounding sphere about the origin of its frame, m."""
        return math.hypot(self.radius, 0.5 * self.length)

    def mass_properties(self) -> MassProperties:
        """Return the mass properties at unit density.

        Returns
        -------
        MassProperties
            Volume, centre of mass and inertia.

        Examples
        --------
        >>> import kickdrift as kd
        >>> round(float(kd.Cylinder(0.1, 1.0).mass_properties().volume), 6)
        0.031416
        """
        square = self.radius**2
        volume = math.pi * square * self.length
        across = volume * (3.0 * square + self.length**2) / 12.0
        return MassProperties(volume, np.zeros(3), np.diag([across, across, 0.5 * volume * square]))


RECORD = Kind(
    number=CYLINDER,
    name="cylinder",
    sort=SOLID,
    shape=Cylinder,
    extent=frustum_extent,
    ray=ray_frustum,
    core=AXIS,
    look=GLOSSY | CREASED,
)
