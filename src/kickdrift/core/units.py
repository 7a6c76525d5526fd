"""Quantities of astropy and pint, recognised by the package of their type, so that neither is imported."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError

Floats = NDArray[np.float64]

_LIBRARIES = ("astropy", "pint")
_PLAIN = frozenset((float, int, type(None)))  # what most arguments are, at a fifth of the time


def has_unit(value: Any) -> bool:
    """Whether a value is a quantity, or a list, a tuple or an array of objects that holds one."""
    if type(value) in _PLAIN:
        return False
    if isinstance(value, np.ndarray) and value.dtype == object:
        return has_unit(value.ravel().tolist())
    if isinstance(value, list | tuple):
        return not _PLAIN.issuperset(map(type, value)) and any(map(has_unit, value))
    known = type(value).__module__.partition(".")[0] in _LIBRARIES
    return known and hasattr(value, "to") and (hasattr(value, "unit") or hasattr(value, "units"))


def unit_of(value: Any) -> Any:
    """Return the unit of a quantity, or of the first one in a list."""
    if isinstance(value, list | tuple):
        return next(unit_of(member) for member in value if has_unit(member))
    return value.unit if hasattr(value, "unit") else value.units


def is_time(unit: Any) -> bool:
    """Whether a unit is one of time."""
    return bool(unit.is_equivalent("s") if hasattr(unit, "is_equivalent") else unit.is_compatible_with("s"))


def numbers(name: str, value: Any, unit: Any) -> Any:
    """Return a quantity, or a list of quantities, as plain numbers in a unit.

    Raises
    ------
    ArgumentError
        For what has another dimension, or no unit.
    """
    if isinstance(value, list | tuple):
        return [numbers(name, member, unit) for member in value]
    if not has_unit(value):
        raise ArgumentError(
            f"{name}={value!r} has no unit, but other arguments have; give it in {spelt(unit)} or the like."
        )
    try:
        converted = value.to(unit)
    except Exception:
        raise ArgumentError(
            f"{name}={value} has the unit {spelt(unit_of(value))}, which cannot be converted to {spelt(unit)}."
        ) from None
    return converted.value if hasattr(converted, "unit") else converted.magnitude


def with_unit(values: Any, unit: Any) -> Any:
    """Return numbers as a quantity of the library that a unit is from."""
    return type(1 * unit)(values, unit)


def factor(one: Any, other: Any) -> float:
    """Return the factor that converts one unit to another."""
    return float(numbers("unit", 1 * one, other))


def spelt(unit: Any) -> str:
    """Return a unit as one word that other libraries can parse, such as ``au/d``."""
    text = f"{unit:~C}" if hasattr(unit, "is_compatible_with") else str(unit)
    return text.replace(" / ", "/").replace(" ", "*") or "1"
