"""The record of a kind of shapes: all that a world, a file and a picture know of it."""

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from numba import types
from numpy.typing import NDArray

from kickdrift.core.compilation import Function
from kickdrift.core.errors import ArgumentError
from kickdrift.world.shapes.mass import MassProperties

Floats = NDArray[np.float64]

# What a kind is
SOLID = 0  # has an inside, so that its bodies may move
SURFACE = 1  # of triangles, which are met one by one
HALF_SPACE = 2  # what is under the plane z = 0; no box holds it
TRIANGLE_OF_SURFACE = 3  # no shape of its own

# How it looks, besides its colour: bits
PLAIN = 0
GLOSSY = 1  # mirrors the lamp
CREASED = 2  # lines are drawn where its faces meet
BALL = 4  # marks show how it turns, and from all sides it is as large
GROUND = 8  # has a grid, and fades with the distance

_ARRAY, _VECTOR = types.Array(types.float64, 1, "C"), types.UniTuple(types.float64, 3)
EXTENT = types.UniTuple(types.float64, 6)(_ARRAY, types.UniTuple(types.float64, 4))
RAY = types.UniTuple(types.float64, 4)(_ARRAY, _VECTOR, _VECTOR, types.float64)


class Shape(Protocol):
    """The interface of a shape."""

    kind: ClassVar[int]

    @property
    def numbers(self) -> Floats:
        """What compiled code knows of it."""
        ...

    @property
    def reach(self) -> float:
        """Farthest that any point of it is from the origin of its frame, m; 0.0 for those that never move."""
        ...

    def mass_properties(self) -> MassProperties:
        """Return the mass properties at unit density."""
        ...


_OF_SHAPES = ("kind", "numbers", "reach", "mass_properties")


@dataclass(frozen=True, eq=False, kw_only=True)
class Kind:
    """What there is to know of a kind of shapes.

    Attributes
    ----------
    number : int
        Of `kickdrift.world.shapes.kinds`.
    name : str
        In files and sentences.
    sort : int
        `SOLID`, `SURFACE`, `HALF_SPACE` or `TRIANGLE_OF_SURFACE`.
    shape : type, optional
        The dataclass that users make one with: `Shape`; its fields are what files keep.
    extent : callable, optional
        ``extent(numbers, orientation)``, compiled: the box along the world's axes that one fills, relative to its origin.
    ray : callable, optional
        ``ray(numbers, origin, direction, limit)``, compiled; see `kickdrift.world.shapes.rays`.
    is_round : bool
        Whether it rolls: its contacts go with it and are found again after the smallest turn.
    look : int
        Bits, such as `GLOSSY`.

    Raises
    ------
    ArgumentError
        If something is missing that a kind of this sort has to have.
    """

    number: int
    name: str
    sort: int
    shape: type[Any] | None = None
    extent: Function | None = None
    ray: Function | None = None
    is_round: bool = False
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
