"""Cylinders with round ends."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from kickdrift.world.shapes.kinds import CAPSULE
from kickdrift.world.shapes.mass import Array, MassProperties, extent

_QUARTER = np.linspace(0.0, 0.5 * math.pi, 9)
_CIRCLE = np.linspace(0.0, 2.0 * math.pi, 33)


@dataclass(frozen=True)
class Capsule:
    """All points within a radius of a segment along the z axis, whose middle is the origin.

    Attributes
    ----------
    radius : float
        m.
    length : float
        Of the segment, and so of the cylinder between the two round ends, m.

    Raises
    ------
    ArgumentError
        If one of the two is not positive and finite.
    """

    radius: float
    length: float
    kind: ClassVar[int] = CAPSULE

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", extent("radius", self.radius))
        object.__setattr__(self, "length", extent("length", self.length))

    @property
    def numbers(self) -> Array:
        """What compiled code knows of it: the radius and half of the length."""
        return np.array([self.radius, 0.5 * self.length])

    def mass_properties(self) -> MassProperties:
        """Weigh it for density 1.

        Notes
        -----
        A half ball has its centre of mass 3/8 of its radius away from its flat side, and 83/320 m r^2 about the axes
        through that centre and parallel to the flat side.
        """
        r, half = self.radius, 0.5 * self.length
        cylinder = math.pi * r**2 * self.length
        ball = 4.0 / 3.0 * math.pi * r**3
        along = 0.5 * cylinder * r**2 + 0.4 * ball * r**2
        arm = half + 0.375 * r
        across = cylinder * (r**2 / 4.0 + self.length**2 / 12.0) + ball * (83.0 / 320.0 * r**2 + arm**2)
        return MassProperties(cylinder + ball, np.zeros(3), np.diag([across, across, along]))

    def wireframe(self) -> list[Array]:
        """Return the outlines in the xz and the yz plane and both rims of the cylinder, in the shape's frame."""
        half = 0.5 * self.length
        x, z = self.radius * np.cos(_QUARTER), self.radius * np.sin(_QUARTER) + half
        x, z = np.concatenate((x, -x[::-1])), np.concatenate((z, z[::-1]))
        x, z = np.concatenate((x, -x, x[:1])), np.concatenate((z, -z, z[:1]))
        rim = self.radius * np.column_stack((np.cos(_CIRCLE), np.sin(_CIRCLE), np.zeros(_CIRCLE.size)))
        up = np.array([0.0, 0.0, half])
        nothing = np.zeros(x.size)
        outlines = [np.column_stack((x, nothing, z)), np.column_stack((nothing, x, z))]
        return [*outlines, rim - up, rim + up]
