"""Cones."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from kickdrift.world.shapes.frustum import frustum_extent, ray_frustum
from kickdrift.world.shapes.kind_numbers import CONE
from kickdrift.world.shapes.mass_properties import Array, MassProperties, extent
from kickdrift.world.shapes.record import AXIS, CREASED, GLOSSY, SOLID, Kind


@dataclass(frozen=True)
class Cone:
    """A cone about the z axis, with its tip above; the origin is halfway between base and tip.

    Its centre of mass is at a quarter of its length above the base, z = -length / 4.

    Attributes
    ----------
    radius : float
        Of the base, at z = -length / 2, m.
    length : float
        From the base to the tip, m.

    Raises
    ------
    ArgumentError
        If one of the two is not positive and finite.

    Notes
    -----
    The notes on contacts of `Cylinder` apply to cones, too.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> cone = world.add_body(kd.Cone(0.1, 1.0), density=1000.0)
    >>> round(cone.mass, 3)
    10.472
    >>> cone.position.round(6)
    array([ 0.  ,  0.  , -0.25])
    """

    radius: float
    length: float
    kind: ClassVar[int] = CONE

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", extent("radius", self.radius))
        object.__setattr__(self, "length", extent("length", self.length))

    @property
    def numbers(self) -> Array:
        """The data for compiled code: the radii of both ends and half of the length."""
        return np.array([self.radius, 0.0, 0.5 * self.length])

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
        >>> round(float(kd.Cone(0.1, 1.0).mass_properties().volume), 6)
        0.010472
        """
        square = self.radius**2
        volume = math.pi * square * self.length / 3.0
        across = volume * 3.0 * (4.0 * square + self.length**2) / 80.0
        return MassProperties(
            volume, np.array([0.0, 0.0, -0.25 * self.length]), np.diag([across, across, 0.3 * volume * square])
        )


RECORD = Kind(
    number=CONE,
    name="cone",
    sort=SOLID,
    shape=Cone,
    extent=frustum_extent,
    ray=ray_frustum,
    core=AXIS,
    look=GLOSSY | CREASED,
)
