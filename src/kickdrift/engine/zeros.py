"""Zeros of functions of the state between two states: parts of steps in which they are, and the search for them."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled

Floats = NDArray[np.float64]

_ROUNDS = 100  # of a search, each of which takes half of the interval at least every third time


class Brackets(NamedTuple):
    """Parts of steps in which an event may have zeros: states before them, shares of the step, and values at both ends."""

    t: Floats
    size: Floats
    x: Floats
    v: Floats
    begin: Floats
    end: Floats
    first: Floats
    last: Floats

    def part(self, which: Any) -> "Brackets":
        """Return some of them."""
        return Brackets(*(array[which] for array in self))

    def joined(self, *others: "Brackets") -> "Brackets":
        """Return these and others."""
        return Brackets(*(np.concatenate(arrays) for arrays in zip(self, *others, strict=True)))


class Zero(NamedTuple):
    """A zero of an event, by its number, and the state there."""

    t: float
    event: int
    x: Floats
    v: Floats


class Seen(NamedTuple):
    """What was found of events up to a step: zeros, the steps in which further ones are, and the evaluations that it took.

    No zero up to the time `beyond` ends a run: it continued from there.
    """

    zeros: tuple[Zero, ...]
    waiting: tuple[tuple[int, Brackets], ...]
    evaluations: int
    beyond: float | None = None


class Found(NamedTuple):
    """What a look at a chunk has found: after how many of its steps it ends, the zero at which it does, and what went wrong.

    And whether the function has no zero there, but jumps over it in an impact.
    """

    steps: int
    stop: Zero | None = None
    failure: str = ""
    jumps: bool = False


@compiled
def find_changes(values: Floats, found: NDArray[np.int64]) -> int:
    """Note after which of its values a function passes through zero, or comes to it; return how often it does.

    One pass over memory; masks of NumPy take six, 5 ns a step.
    """
    count = 0
    for row in range(values.size - 1):
        first, last = values[row], values[row + 1]
        if (first < 0.0 <= last) or (first > 0.0 >= last):
            found[count] = row
            count += 1
    return count


def changes(parts: Brackets) -> NDArray[np.bool_]:
    """Return the steps in which a function passes through zero, or comes to it."""
    first, last = parts.first, parts.last
    return np.asarray(((first < 0.0) & (last >= 0.0)) | ((first > 0.0) & (last <= 0.0)))


def tolerance_of(brackets: Brackets) -> Floats:
    """Return how well the zeros in parts of steps can be known, in steps."""
    return np.asarray(4.0 * np.spacing(np.abs(brackets.t) + np.abs(brackets.size)) / np.abs(brackets.size))


def search(
    begin: Floats,
    end: Floats,
    first: Floats,
    last: Floats,
    value_at: Callable[[NDArray[np.intp], Floats], Floats],
    tolerance: Floats,
) -> Floats:
    """Find the zero between each pair of ends by the Illinois rule and halves.

    M. Dowell, P. Jarratt, BIT 11, 168 (1971).

    Parameters
    ----------
    begin, end : (B,) array
        The ends.
    first, last : (B,) array
        Values of the function there, of different signs.
    value_at : callable
        ``value_at(which, points)`` returns the values of these functions, by their indices, at points.
    tolerance : (B,) array
        Of the zeros.
    """
    begin, end, first, last = (array.copy() for array in (begin, end, first, last))
    sign, kept = np.sign(first), np.zeros(begin.size)
    for round_ in range(_ROUNDS):
        at = np.flatnonzero((end - begin > tolerance) & (last != 0.0))
        if not at.size:
            break
        a, b, fa, fb = begin[at], end[at], first[at], last[at]
        point = _guess(a, b, fa, fb, tolerance[at], halves=round_ % 3 == 2)
        value = value_at(at, point)
        later = value * sign[at] > 0.0  # the zero lies after this
        first[at] = np.where(later, value, np.where(kept[at] < 0.0, 0.5 * fa, fa))
        last[at] = np.where(later, np.where(kept[at] > 0.0, 0.5 * fb, fb), value)
        begin[at], end[at], kept[at] = np.where(later, point, a), np.where(later, b, point), np.where(later, 1.0, -1.0)
    return end


def _guess(a: Floats, b: Floats, fa: Floats, fb: Floats, tolerance: Floats, *, halves: bool) -> Floats:
    """Return where straight lines between the ends pass through zero, or the middle; never too near to an end."""
    middle, near = 0.5 * (a + b), 0.5 * tolerance
    if halves:
        return middle
    with np.errstate(all="ignore"):
        share = b - fb * (b - a) / (fb - fa)
    return np.where(np.isfinite(share), np.clip(share, a + near, b - near), middle)
