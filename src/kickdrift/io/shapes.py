"""Shapes in files: the name of each kind, and the numbers that it is made of."""

from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.shape_rows import Shape
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.plane import Plane
from kickdrift.world.shapes.sphere import Sphere

_KINDS: dict[str, Any] = {
    "plane": Plane,
    "sphere": Sphere,
    "capsule": Capsule,
    "box": Box,
    "hull": Hull,
    "mesh": Mesh,
    "height field": HeightField,
}
_NAMES = {kind: name for name, kind in _KINDS.items()}


class Catalogue:
    """Different shapes, each once: words for JSON, and one row of numbers."""

    def __init__(self) -> None:
        self.words: list[dict[str, Any]] = []
        self._numbers: list[NDArray[np.float64]] = []
        self._places: dict[Any, int] = {}

    def place(self, shape: Shape) -> int:
        """Say which one of the catalogue a shape is; it comes into it if there is none like it."""
        arguments = _arguments(shape)
        key = (type(shape), *((name, value.shape, value.tobytes()) for name, value in arguments.items()))
        if key not in self._places:
            self._places[key] = len(self.words)
            self.words.append({"kind": _NAMES[type(shape)], "sizes": {n: list(v.shape) for n, v in arguments.items()}})
            self._numbers += [value.ravel() for value in arguments.values()]
        return self._places[key]

    @property
    def numbers(self) -> NDArray[np.float64]:
        """What all shapes are made of, one after the other."""
        return np.concatenate([np.zeros(0), *self._numbers])


def _arguments(shape: Any) -> dict[str, NDArray[np.float64]]:
    """Return what a shape was made of: whole numbers are exact as floats."""
    return {f.name: np.asarray(getattr(shape, f.name), dtype=np.float64) for f in fields(shape) if f.init}


def shapes_of(words: Iterable[Mapping[str, Any]], numbers: NDArray[np.float64]) -> list[Shape]:
    """Make the shapes of a catalogue anew.

    Raises
    ------
    LookupError, TypeError, ValueError
        If it is none.
    """
    made: list[Shape] = []
    begin = 0
    for word in words:
        kind, arguments = _KINDS[word["kind"]], {}
        for name, shape in word["sizes"].items():
            end = begin + int(np.prod(shape, dtype=np.int64))
            value = numbers[begin:end].reshape([int(n) for n in shape])
            arguments[name] = value.astype(np.int64) if (kind, name) == (Mesh, "faces") else value
            begin = end
        made.append(kind(**{n: float(v) if v.ndim == 0 else v for n, v in arguments.items()}))
    if begin != numbers.size:
        raise ValueError("there are numbers of more shapes than are named")
    return made
