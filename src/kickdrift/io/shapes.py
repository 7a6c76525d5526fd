"""Shapes in files: the name of each kind, and the numbers that it is made of."""

from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.shapes.record import Shape
from kickdrift.world.shapes.shape_kinds import SHAPES, kind_of


class Catalogue:
    """Different shapes, each once: words for JSON, and one row of numbers."""

    def __init__(self) -> None:
        self.words: list[dict[str, Any]] = []
        self._numbers: list[NDArray[np.float64]] = []
        self._places: dict[Any, int] = {}

    def place(self, shape: Any) -> int:
        """Return the index of a shape in the catalogue, to which it is added if it is new."""
        arguments = {f.name: np.asarray(getattr(shape, f.name)) for f in fields(shape) if f.init}
        key = (type(shape), *((name, value.shape, value.tobytes()) for name, value in arguments.items()))
        if key not in self._places:
            self._places[key] = len(self.words)
            sizes = {name: list(value.shape) for name, value in arguments.items()}
            whole = [name for name, value in arguments.items() if value.dtype.kind == "i"]
            self.words.append({"kind": kind_of(shape).name, "sizes": sizes, "whole": whole})
            self._numbers += [value.ravel().astype(np.float64) for value in arguments.values()]
        return self._places[key]

    @property
    def numbers(self) -> NDArray[np.float64]:
        """The numbers of all shapes, one after the other; integers are exact as floats."""
        return np.concatenate([np.zeros(0), *self._numbers])


def shapes_of(words: Iterable[Mapping[str, Any]], numbers: NDArray[np.float64]) -> list[Shape]:
    """Make the shapes of a catalogue again.

    Raises
    ------
    LookupError, TypeError, ValueError
        If it is invalid.
    """
    made: list[Shape] = []
    begin = 0
    for word in words:
        kind, arguments = SHAPES[word["kind"]], {}
        for name, shape in word["sizes"].items():
            end = begin + int(np.prod(shape, dtype=np.int64))
            value = numbers[begin:end].reshape([int(n) for n in shape])
            arguments[name] = value.astype(np.int64) if name in word["whole"] else value
            begin = end
        made.append(kind(**{n: float(v) if v.ndim == 0 else v for n, v in arguments.items()}))
    if begin != numbers.size:
        raise ValueError("it has data of more shapes than are named")
    return made
