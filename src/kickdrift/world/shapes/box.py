"""Boxes."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.world.shapes.kinds import BOX
from kickdrift.world.shapes.mass import Array, MassProperties, extent

# One line along the four lower edges, a side, the four upper edges; then the other three sides.
_LINES = (
    ((-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, -1)),
    ((-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1), (-1, -1, 1)),
    ((-1, -1, -1), (-1, -1, 1)),
    ((1, -1, -1), (1, -1, 1)),
    ((1, 1, -1), (1, 1, 1)),
    ((-1, 1, -1), (-1, 1, 1)),
)


@dataclass(frozen=True)
class Box:
    """A box whose middle is the origin and whose edges lie along the axes.

    Attributes
    ----------
    size : (3,) tuple
        Lengths of the edges, m.

    Raises
    ------
    ArgumentError
        If there are not three lengths, or one is not positive and finite.
    """

    size: tuple[float, float, float]
    kind: ClassVar[int] = BOX

    def __init__(self, size: ArrayLike) -> None:
        lengths = np.asarray(size)
        if lengths.shape != (3,):
            raise ArgumentError(f"size={size!r} has the shape {lengths.shape}; give the lengths of three edges, in m.")
        object.__setattr__(self, "size", tuple(extent(f"size[{k}]", lengths[k]) for k in range(3)))

    @property
    def numbers(self) -> Array:
        """What compiled code knows of it: half of each length."""
        return 0.5 * np.array(self.size)

    def mass_properties(self) -> MassProperties:
        """Weigh it for density 1."""
        squares = np.square(self.size)
        volume = float(np.prod(self.size))
        return MassProperties(volume, np.zeros(3), np.diag(volume / 12.0 * (squares.sum() - squares)))

    def wireframe(self) -> list[Array]:
        """Return the edges as lines, in the shape's frame."""
        return [self.numbers * np.array(line, dtype=np.float64) for line in _LINES]
