"""Conversion of users' arguments to real numbers, without loss."""

import math
from contextlib import suppress
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.core.units import has_unit

Floats = NDArray[np.float64]
# Kinds of dtypes that are refused: complex numbers would lose their imaginary parts, texts and dates would become numbers.
_NO_NUMBERS = "cSUMmV"
MOST_STEPS = 2**62
"""No run has as many, and 64 bits count them."""
_PLAIN = frozenset((float, int, np.float64))  # what lists and tuples mostly hold, 10 us faster
_FEW = 32  # numbers that Python checks as fast as NumPy


def reals(value: Any) -> Floats:
    """Return a new array of the real numbers that a user gives.

    Raises
    ------
    TypeError
        If it holds anything else, is ragged, or cannot be converted to an array; the message tells why.
    """
    if type(value) is np.ndarray and value.dtype == np.float64:
        return value.copy()
    if type(value) is float:
        return np.array(value)
    if type(value) in (list, tuple) and _PLAIN.issuperset(map(type, value)):
        with suppress(OverflowError):  # reported below
            return np.array(value, dtype=np.float64)
    if has_unit(value):
        raise TypeError("it has a unit, which would be lost: give plain numbers")
    if np.ma.is_masked(value):
        raise TypeError("it has masked entries, whose mask would be lost: fill them, or leave them out")
    try:
        given = np.asarray(value)
        if given.dtype.kind == "O" and any(member is None for member in given.flat):
            raise TypeError("it holds None")  # which NumPy converts to NaN
        if given.dtype.kind == "b" or _holds_booleans(value):
            raise TypeError("it holds True or False, which are not numbers")  # NumPy converts them to 1 and 0
        if given.dtype.kind not in _NO_NUMBERS:
            return np.array(given, dtype=np.float64, order="C")
        why = "it is complex" if given.dtype.kind == "c" else f"it holds {given.dtype.name}"
    except Exception as error:  # conversion of arbitrary objects may raise anything
        why = str(error)
    raise TypeError(why)


def _holds_booleans(value: Any) -> bool:
    """Whether lists, however nested, or an array hold True or False."""
    if isinstance(value, np.ndarray):
        return value.dtype.kind == "b" or (value.dtype.kind == "O" and _holds_booleans(value.ravel().tolist()))
    if not isinstance(value, list | tuple):
        return isinstance(value, bool | np.bool_)
    kinds = set(map(type, value))
    if kinds & {bool, np.bool_}:
        return True
    nested = any(issubclass(kind, list | tuple | np.ndarray) for kind in kinds)
    return nested and any(map(_holds_booleans, value))


def real(value: Any) -> float:
    """Return the one real number that a user gives.

    Raises
    ------
    TypeError
        If it is not a number, or beyond the range of floats.
    """
    if type(value) is float:
        return value
    if isinstance(value, bool | np.bool_) or (array := reals(value)).ndim != 0:
        raise TypeError("it is not a number")
    return float(array)


def number(argument: str, value: Any) -> float:
    """Return the one real number that a user gives as an argument; ArgumentError for anything else."""
    try:
        return real(value)
    except TypeError as error:
        raise ArgumentError(f"{argument}={value!r} must be a number: {error}.") from None


def all_finite(array: Floats) -> bool:
    """Whether all numbers of an array are finite; a reduction by NumPy takes 2 us, whatever the size."""
    if array.size <= _FEW:
        return all(map(math.isfinite, array.ravel().tolist()))
    return bool(np.isfinite(array).all())


def choice(argument: str, value: Any) -> bool:
    """Return True or False; ArgumentError for anything else, such as "no", which Python takes for True."""
    if type(value) is not bool and not isinstance(value, np.bool_):
        raise ArgumentError(f"{argument}={value!r} must be True or False.")
    return bool(value)


def is_whole(value: Any, least: int, most: float = math.inf) -> TypeGuard[int]:
    """Whether a value is a whole number, of Python or NumPy, in a range; True and False are not."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool) and bool(least <= value <= most)


def number_of_steps(argument: str, value: int | None, default: int = MOST_STEPS) -> int:
    """Return the number of steps that a user gives, at most `MOST_STEPS`; ArgumentError for anything else."""
    if value is None:
        return default
    if not is_whole(value, 1):
        raise ArgumentError(f"{argument}={value!r} must be a positive whole number of steps.")
    return min(int(value), MOST_STEPS)


def check_checkpoint_every(checkpoint: Any, every: Any) -> None:
    """Raise an ArgumentError if the steps between checkpoints are given without a folder for them."""
    if checkpoint is None and every is not None:
        raise ArgumentError(f"checkpoint_every={every!r} is given without checkpoint, a folder for them; give it.")
