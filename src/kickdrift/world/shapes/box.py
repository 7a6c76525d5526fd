"""Boxes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.arguments import reals
from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.core.vectors import Quaternion, Vector
from kickdrift.world.shapes.extents import Extent, symmetric, turned_extents
from kickdrift.world.shapes.kind_numbers import BOX
from kickdrift.world.shapes.mass_properties import Array, MassProperties, extent
from kickdrift.world.shapes.rays import MISS, Hit, ahead
from kickdrift.world.shapes.record import SOLID, Kind


@compiled
def _extent(numbers: Any, q: Quaternion) -> Extent:
    """Return the bounds of a box; see `kickdrift.world.shapes.record`."""
    return symmetric(turned_extents(q, (numbers[0], numbers[1], numbers[2])))


@compiled
def _ray(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Cast a ray at a box; see `kickdrift.world.shapes.rays`."""
    enters, leaves, face_in, face_out = -math.inf, math.inf, 0, 0
    for i in range(3):
        if direction[i] != 0.0:
            low, high = (-numbers[i] - origin[i]) / direction[i], (numbers[i] - origin[i]) / direction[i]
            if min(low, high) > enters:
                enters, face_in = min(low, high), i
            if max(low, high) < leaves:
                leaves, face_out = max(low, high), i
        elif abs(origin[i]) > numbers[i]:
            return MISS
    distance = ahead((enters, leaves), limit)
    if distance == math.inf:
        return MISS
    face = face_in if distance == enters else face_out
    side = math.copysign(1.0, direction[face])
    if distance == enters:
        side = -side
    return (distance, side if face == 0 else 0.0, side if face == 1 else 0.0, side if face == 2 else 0.0)


@dataclass(frozen=True)
class Box:
    """A box centred at the origin, with edges along the axes.

    Attributes
    ----------
    size : (3,) tuple
        Lengths of the edges, m.

    Raises
    ------
    ArgumentError
        If there are not three lengths, or one is not positive and finite.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> box = world.add_body(kd.Box((1.0, 2.0, 0.5)), density=1000.0)
    >>> round(box.mass, 3)
    1000.0
    """

    size: tuple[float, float, float]
    kind: ClassVar[int] = BOX

    def __init__(self, size: ArrayLike) -> None:
        try:
            lengths = reals(size)
        except TypeError as error:
            raise ArgumentError(
                f"size={size!r} must be numbers: {error}; give the lengths of three edges, in m."
            ) from None
        if lengths.shape != (3,):
            raise ArgumentError(f"size={size!r} has the shape {lengths.shape}; give the lengths of three edges, in m.")
        object.__setattr__(self, "size", tuple(extent(f"size[{k}]", lengths[k]) for k in range(3)))

    @property
    def numbers(self) -> Array:
        """The data for compiled code: half of each length."""
        return 0.5 * np.array(self.size)

    @property
    def reach(self) -> float:
        """Radius of its bounding sphere about the origin of its frame, m."""
        return float(np.linalg.norm(self.numbers))

    def mass_properties(self) -> MassProperties:
        """Return the mass properties at unit density.

        Returns
        -------
        MassProperties
            Volume, centre of mass and inertia.

        Examples
        --------
        >>> import kickdrift as kd
        >>> round(float(kd.Box((1.0, 2.0, 0.5)).mass_properties().volume), 6)
        1.0
        """
        squares = np.square(self.size)
        volume = float(np.prod(self.size))
        return MassProperties(volume, np.zeros(3), np.diag(volume / 12.0 * (squares.sum() - squares)))


RECORD = Kind(number=BOX, name="box", sort=SOLID, shape=Box, extent=_extent, ray=_ray)
