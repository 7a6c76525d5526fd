"""Zeros of event functions: brackets within steps, and root finding in them."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled

Floats = NDArray[np.float64]

# Of a step in which a function may turn near zero: down to a millionth, which tells two zeros apart that are so close. At a
# turn, some 1 / sqrt(part) parts stay near zero; a function that stays there for a whole step is evaluated at 256 parts of it.
_HALVINGS = 20
_WHOLE, _MOST_PARTS = 8, 4096
_QUIET = 1e-30  # of the most that a function may change in a step: smaller values are rounding, as of the gap of a body at rest
_ROUNDS = 100  # iterations of root finding, of which at least one in three halves the interval


class Brackets(NamedTuple):
    """Parts of steps in which an event may have zeros: states before the steps, both ends as fractions, values there."""

    t: Floats
    size: Floats
    x: Floats
    v: Floats
    begin: Floats
    end: Floats
    first: Floats
    last: Floats

    def part(self, which: Any) -> "Brackets":
        """Return some of the brackets."""
        return Brackets(*(array[which] for array in self))

    def joined(self, *others: "Brackets") -> "Brackets":
        """Return these brackets and others."""
        return Brackets(*(np.concatenate(arrays) for arrays in zip(self, *others, strict=True)))


class Zero(NamedTuple):
    """A zero: its time and the middle of its step, the number of the event, the state, and the evaluations of its search."""

    t: float
    middle: float
    event: int
    x: Floats
    v: Floats
    evaluations: int = 0


class Seen(NamedTuple):
    """Results of the search for zeros up to a step: zeros, brackets of further ones, and force evaluations.

    No zero up to the time `beyond` ends the run, because it was continued from there.
    """

    zeros: tuple[Zero, ...]
    waiting: tuple[tuple[int, Brackets], ...]
    evaluations: int
    beyond: float | None = None


class Found(NamedTuple):
    """Result of the search in a chunk of steps: the number of steps before its end, the zero that ends it, and a failure.

    And whether the function jumps over zero in an impact.
    """

    steps: int
    stop: Zero | None = None
    failure: str = ""
    jumps: bool = False


@compiled
def find_changes(values: Floats, found: NDArray[np.int64]) -> int:
    """List the indices after which a function crosses or reaches zero; return their number.

    It passes over memory once; masks of NumPy do six times, 5 ns a step.
    """
    count = 0
    for row in range(values.size - 1):
        first, last = values[row], values[row + 1]
        if (first < 0.0 <= last) or (first > 0.0 >= last):
            found[count] = row
            count += 1
    return count


def changes(parts: Brackets) -> NDArray[np.bool_]:
    """Return the steps in which a function crosses or reaches zero."""
    first, last = parts.first, parts.last
    return np.asarray(((first < 0.0) & (last >= 0.0)) | ((first > 0.0) & (last <= 0.0)))


def too_fast(t: Floats, values: Floats, bound: float) -> NDArray[np.bool_]:
    """Whether a function changes faster in steps than the bound of its rate, along the last axis, but for rounding."""
    way = bound * np.abs(np.diff(t))
    with np.errstate(invalid="ignore"):
        return np.asarray(np.abs(np.diff(values)) > (1.0 + 1e-6) * way + 1e-12 * np.abs(values[..., 1:]))


def with_zeros(
    steps: Brackets, bound: float, value_at: Callable[[NDArray[np.intp], Brackets, Floats], Floats]
) -> tuple[Brackets, NDArray[np.intp]]:
    """Find the parts of steps in which a function changes its sign, by halves, each with one zero.

    Parameters
    ----------
    steps : Brackets
    bound : float
        Bound of the rate of the function: where it is farther from zero, it is not evaluated.
    value_at : callable
        ``value_at(which, parts, shares)`` returns values in parts of these of the `steps`, at fractions of the steps.

    Returns
    -------
    parts : Brackets
    which : array of int
        The steps of which they are parts.
    """
    which, parts, quiet = np.arange(steps.t.size), steps, _are_quiet(steps, bound)
    done = []
    for halving in range(_HALVINGS):
        way = bound * np.abs(parts.size) * (parts.end - parts.begin)
        # It may be zero, but for rounding, at both ends of a step, but hardly in its middle, too.
        rests = quiet[which] & _are_quiet(parts, bound) & (halving > 0)
        near = (np.abs(parts.first) + np.abs(parts.last) <= way) & ~rests  # it may turn there
        near &= ~_hopeless(which[near], halving, int(steps.t.size))[which]
        done.append((parts.part(~(near | rests)), which[~(near | rests)]))
        which, parts = which[near], parts.part(near)
        if not which.size:
            break
        middle = 0.5 * (parts.begin + parts.end)
        value = value_at(which, parts, middle)
        parts = parts._replace(end=middle, last=value).joined(parts._replace(begin=middle, first=value))
        which = np.concatenate((which, which))
    parts, which = parts.joined(*(own for own, _ in done)), np.concatenate((which, *(of for _, of in done)))
    changed = changes(parts)
    return parts.part(changed), which[changed]


def _are_quiet(parts: Brackets, bound: float) -> NDArray[np.bool_]:
    """Whether a function is zero, but for rounding, at both ends of each part."""
    most = _QUIET * bound * np.abs(parts.size)
    return np.asarray((np.abs(parts.first) <= most) & (np.abs(parts.last) <= most))


def _hopeless(which: NDArray[np.intp], halving: int, steps: int) -> NDArray[np.bool_]:
    """Whether too many parts of each of the steps are near zero, by the steps that these are parts of."""
    parts = np.bincount(which, minlength=steps)
    return np.asarray(parts > _MOST_PARTS if halving != _WHOLE else parts == 2**_WHOLE)


def joined_by_event(brackets: list[tuple[int, Brackets]]) -> list[tuple[int, Brackets]]:
    """Return the brackets of zeros that are not yet located, joined for each event."""
    events = sorted({event for event, _ in brackets})
    return [(k, Brackets.joined(*(own for event, own in brackets if event == k))) for k in events]


def spent_from(spent: list[tuple[Floats, NDArray[np.int64]]], t: float, sign: float, at_it: bool) -> int:
    """Return the evaluations spent in steps that begin after a time, or at it."""
    return sum(int(own[(sign * begin > sign * t) | (at_it & (begin == t))].sum()) for begin, own in spent)


def tolerance_of(brackets: Brackets) -> Floats:
    """Return the accuracy with which zeros can be located, in steps."""
    return np.asarray(4.0 * np.spacing(np.abs(brackets.t) + np.abs(brackets.size)) / np.abs(brackets.size))


def search(
    begin: Floats,
    end: Floats,
    first: Floats,
    last: Floats,
    value_at: Callable[[NDArray[np.intp], Floats], Floats],
    tolerance: Floats,
) -> Floats:
    """Find the zero between each pair of ends by the Illinois algorithm and bisection.

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
        The zeros.
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
        later = value * sign[at] > 0.0  # the zero is later
        first[at] = np.where(later, value, np.where(kept[at] < 0.0, 0.5 * fa, fa))
        last[at] = np.where(later, np.where(kept[at] > 0.0, 0.5 * fb, fb), value)
        begin[at], end[at], kept[at] = np.where(later, point, a), np.where(later, b, point), np.where(later, 1.0, -1.0)
    return end


def _guess(a: Floats, b: Floats, fa: Floats, fb: Floats, tolerance: Floats, *, halves: bool) -> Floats:
    """Return the zeros of the secants, or the midpoints; never too close to an end."""
    middle, near = 0.5 * (a + b), 0.5 * tolerance
    if halves:
        return middle
    with np.errstate(all="ignore"):
        share = b - fb * (b - a) / (fb - fa)
    return np.where(np.isfinite(share), np.clip(share, a + near, b - near), middle)
