"""Validation of the numbers, vectors and orientations that users pass to worlds."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import all_finite, choice, real, reals
from kickdrift.core.errors import ArgumentError

__all__ = ["choice", "direction", "number", "unit_quaternion", "vector"]

Floats = NDArray[np.float64]


def vector(argument: str, value: ArrayLike, size: int) -> Floats:
    """Return `size` finite numbers as an array, (size,); ArgumentError for anything else."""
    try:
        array = reals(value)
    except TypeError:
        raise ArgumentError(f"{argument}={value!r} must be {size} numbers.") from None
    if array.shape != (size,) or not all_finite(array):
        raise ArgumentError(f"{argument}={value!r} must be {size} finite numbers.")
    return array


def unit_quaternion(argument: str, value: ArrayLike) -> Floats:
    """Return a quaternion divided by its norm, (4,); ArgumentError for a norm of zero."""
    q = vector(argument, value, 4)
    size = float(np.linalg.norm(q))
    if size < 1e-9:
        raise ArgumentError(
            f"{argument}={value!r} has zero norm; give a quaternion (w, x, y, z), such as (1, 0, 0, 0)."
        )
    return q / size


def direction(argument: str, value: ArrayLike) -> Floats:
    """Return a vector divided by its length, (3,); ArgumentError for a length of zero."""
    v = vector(argument, value, 3)
    size = np.abs(v).max()
    if size == 0.0:
        raise ArgumentError(
            f"{argument}={value!r} has no direction; give a vector that is not zero: (0, 0, 1) points up."
        )
    v = v / size  # whose square is neither infinite nor zero
    return np.asarray(v / np.linalg.norm(v))


def number(argument: str, value: Any, unit: str, *, zero: bool = True) -> float:
    """Return a finite number that is positive, or zero if `zero` allows it; ArgumentError for others."""
    if type(value) is float and 0.0 < value < np.inf:
        return value
    what = ("zero or " if zero else "") + "positive and finite" + (f", in {unit}" if unit != "1" else "")
    try:
        size = real(value)
    except TypeError:
        raise ArgumentError(f"{argument}={value!r} must be a number, {what}.") from None
    if not (0.0 <= size < np.inf) or (size == 0.0 and not zero):
        raise ArgumentError(f"{argument}={value!r} must be {what}.")
    return size
