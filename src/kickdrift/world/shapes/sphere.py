"""Balls."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from kickdrift.world.shapes.kinds import SPHERE
from kickdrift.world.shapes.mass import Array, MassProperties, extent

_CIRCLE = np.linspace(0.0, 2.0 * math.pi, 33)


@dataclass(frozen=True)
class Sphere:
    """Ball about the origin of its frame.

    Attributes
    ----------
    radius : float
        m.

    Raises
    ------
    ArgumentError
        If the radius is not positive and finite.
    """

    radius: float
    kind: ClassVar[int] = SPHERE

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", extent("radius", self.radius))

    @property
    def numbers(self) -> Array:
        """What compiled code knows of it: the radius."""
        return np.array([self.radius])

    def mass_properties(self) -> MassProperties:
        """Weigh it for density 1."""
        volume = 4.0 / 3.0 * math.pi * self.radius**3
        return MassProperties(volume, np.zeros(3), 0.4 * volume * self.radius**2 * np.eye(3))

    def wireframe(self) -> list[Array]:
        """Return great circles about the three axes, (33, 3) each, in the shape's frame."""
        circle = self.radius * np.column_stack((np.cos(_CIRCLE), np.sin(_CIRCLE), np.zeros(_CIRCLE.size)))
        return [np.roll(circle, shift, axis=1) for shift in range(3)]
