"""Terrain: heights over a grid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.arguments import reals
from kickdrift.core.errors import ArgumentError
from kickdrift.world.shapes.kind_numbers import HEIGHT_FIELD
from kickdrift.world.shapes.mass_properties import LARGEST, Array, MassProperties, extent
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.record import SURFACE, Kind
from kickdrift.world.shapes.triangle import surface_extent


@dataclass(frozen=True, eq=False)
class HeightField:
    """A surface over a grid that collides from above: two triangles per cell.

    It has no mass and is for static bodies.

    Attributes
    ----------
    heights : (M, N) array
        z at x = i dx, y = j dy in the shape's frame, m.
    spacing : (2,) tuple
        dx and dy, m; one number sets both.

    Raises
    ------
    ArgumentError
        If there are fewer than two by two heights, one is not finite, or a spacing is not positive and finite.
    """

    heights: Array
    spacing: tuple[float, float]
    kind: ClassVar[int] = HEIGHT_FIELD

    def __init__(self, heights: ArrayLike, spacing: ArrayLike) -> None:
        try:
            array = reals(heights)
        except TypeError as error:
            raise ArgumentError(f"heights={heights!r} must be numbers: {error}; give z along x and y, in m.") from None
        if array.ndim != 2 or min(array.shape) < 2:
            raise ArgumentError(f"heights has the shape {array.shape}; give (M, N), at least two by two.")
        near = np.abs(array) <= LARGEST
        if not near.all():
            i, j = np.argwhere(~near)[0].tolist()
            raise ArgumentError(
                f"heights[{i}, {j}]={array[i, j]} is not finite, or beyond {LARGEST:g} m; give every height, in m."
            )
        try:
            steps = reals(spacing)
        except TypeError as error:
            raise ArgumentError(
                f"spacing={spacing!r} must be numbers: {error}; give one length or two, in m."
            ) from None
        if steps.shape not in ((), (2,)):
            raise ArgumentError(f"spacing={spacing!r} has the shape {steps.shape}; give one length or two, in m.")
        dx, dy = np.broadcast_to(steps, 2)
        object.__setattr__(self, "heights", array)
        object.__setattr__(self, "spacing", (extent("spacing", dx), extent("spacing", dy)))

    @property
    def points(self) -> Array:
        """Grid points, (M, N, 3), m."""
        i, j = np.indices(self.heights.shape)
        return np.stack((self.spacing[0] * i, self.spacing[1] * j, self.heights), axis=2)

    @property
    def mesh(self) -> Mesh:
        """The same surface as a mesh."""
        number = np.arange(self.heights.size).reshape(self.heights.shape)
        a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
        lower, upper = np.stack((a, b, c), axis=2), np.stack((a, c, d), axis=2)
        return Mesh(self.points.reshape(-1, 3), np.stack((lower, upper), axis=2).reshape(-1, 3))

    @cached_property
    def numbers(self) -> Array:
        """The data for compiled code: the triangles."""
        return self.mesh.numbers

    @property
    def reach(self) -> float:
        """0.0, as for all shapes that never move."""
        return 0.0

    def mass_properties(self) -> MassProperties:
        """Refuse, since it has no mass.

        Raises
        ------
        ArgumentError
            Always: a surface has no volume.
        """
        raise ArgumentError("A height field is a surface and has no mass; add it to a static body.")


RECORD = Kind(number=HEIGHT_FIELD, name="height field", sort=SURFACE, shape=HeightField, extent=surface_extent)
