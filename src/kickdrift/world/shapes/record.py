"""The record of a kind of shapes: everything that worlds, files and drawings need of it."""

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from numba import types
from numpy.typing import NDArray

from kickdrift.core.compilation import Function
from kickdrift.core.errors import ArgumentError
from kickdrift.world.shapes.mass_properties import MassProperties

Floats = NDArray[np.float64]

# Sorts of kinds
SOLID = 0  # has an interior, so that its bodies may move
SURFACE = 1  # of triangles, each of which forms its own contacts
HALF_SPACE = 2  # below the plane z = 0; without finite bounds
TRIANGLE_OF_SURFACE = 3  # the part of a surface, not a shape of users

# Cores, to which the contact points of round shapes are attached while they roll; see `kickdrift.world.contacts.round_cores`
NO_CORE = 0  # points are fixed in the body
CENTRE = 1  # a point or a segment, at a distance that is the first of the shape's numbers
AXIS = 2  # the z axis of a solid of revolution

# Appearance besides colour: bits
PLAIN = 0
GLOSSY = 1  # has highlights
CREASED = 2  # edges between its faces are drawn
BALL = 4  # has marks that show its rotation, and the same outline from all sides
GROUND = 8  # has a grid, and fades with distance

_ARRAY, _VECTOR = types.Array(types.float64, 1, "C"), types.UniTuple(types.float64, 3)
EXTENT = types.UniTuple(types.float64, 6)(_ARRAY, types.UniTuple(types.float64, 4))
RAY = types.UniTuple(types.float64, 4)(_ARRAY, _VECTOR, _VECTOR, types.float64)


class Shape(Protocol):
    """The interface of a shape."""

    kind: ClassVar[int]

    @property
    def numbers(self) -> Floats:
        """The data for compiled code, (N,)."""
        ...

    @property
    def reach(self) -> float:
        """Radius of its bounding sphere about the origin of its frame, m; 0.0 for shapes that never move."""
        ...

    def mass_properties(self) -> MassProperties:
        """Return the mass properties at unit density."""
        ...


_OF_SHAPES = ("kind", "numbers", "reach", "mass_properties")


@dataclass(frozen=True, eq=False, kw_only=True)
class Kind:
    """The record of a kind of shapes.

    Attributes
    ----------
    number : int
        From `kickdrift.world.shapes.kind_numbers`.
    name : str
        In files and messages.
    sort : int
        `SOLID`, `SURFACE`, `HALF_SPACE` or `TRIANGLE_OF_SURFACE`.
    shape : type, optional
        The dataclass for users, a `Shape`; files store its fields.
    extent : callable, optional
        ``extent(numbers, orientation)``, compiled: axis-aligned bounds of a rotated shape, relative to its origin.
    ray : callable, optional
        ``ray(numbers, origin, direction, limit)``, compiled; see `kickdrift.world.shapes.rays`.
    core : int
        `CENTRE` or `AXIS` if it can roll: its contact points do not turn with it, and are found again after the smallest
        rotation.
    look : int
        Bits, such as `GLOSSY`.

    Raises
    ------
    ArgumentError
        If the record lacks something that a kind of this sort must have, or has something that it cannot have.
    """

    number: int
    name: str
    sort: int
    shape: type[Any] | None = None
    extent: Function | None = None
    ray: Function | None = None
    core: int = NO_CORE
    look: int = CREASED

    def __post_init__(self) -> None:
        needed = {
            "shape": self.sort != TRIANGLE_OF_SURFACE,
            "extent": self.sort in (SOLID, SURFACE),
            "ray": self.sort != SURFACE,
        }
        for name, needs in needed.items():
            if needs != (getattr(self, name) is not None):
                raise ArgumentError(f"The kind {self.name!r} {'must have' if needs else 'cannot have'} {name}=.")
        missing = [name for name in _OF_SHAPES if self.shape is not None and not hasattr(self.shape, name)]
        if missing:
            raise ArgumentError(f"The shape of the kind {self.name!r} has no {', '.join(missing)}; define it.")
        if self.shape is not None and self.shape.kind != self.number:
            raise ArgumentError(f"The kind {self.name!r} is number {self.number}, but its shape has {self.shape.kind}.")
