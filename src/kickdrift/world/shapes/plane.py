"""The half-space under a plane."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from kickdrift.core.errors import ArgumentError
from kickdrift.world.shapes.kinds import PLANE
from kickdrift.world.shapes.mass import Array, MassProperties

_HALF_WIDTH = 10.0  # m, of the part that pictures show
_LINES = 11


@dataclass(frozen=True)
class Plane:
    """All points with z <= 0 in its own frame. It has no mass and belongs to bodies that do not move."""

    kind: ClassVar[int] = PLANE

    @property
    def numbers(self) -> Array:
        """What compiled code knows of it: nothing but where it is."""
        return np.zeros(0)

    def mass_properties(self) -> MassProperties:
        """Refuse to weigh it.

        Raises
        ------
        ArgumentError
            Always: a half-space has no finite mass.
        """
        raise ArgumentError("A plane is half of space and has no finite mass; add it to a static body.")

    def wireframe(self) -> list[Array]:
        """Return a grid of 20 m by 20 m about the origin of its frame."""
        ends = np.array([-_HALF_WIDTH, _HALF_WIDTH])
        across = [
            np.column_stack((np.full(2, x), ends, np.zeros(2))) for x in np.linspace(-_HALF_WIDTH, _HALF_WIDTH, _LINES)
        ]
        return across + [line[:, [1, 0, 2]] for line in across]
