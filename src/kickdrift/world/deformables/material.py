"""Checks of the parameters of materials: fabrics, ropes and soft bodies."""

from collections.abc import Collection, Mapping
from dataclasses import fields
from typing import Any, TypeVar

from kickdrift.core.errors import ArgumentError
from kickdrift.world.argument_checks import number

Material = TypeVar("Material")

_SMALLEST, _LARGEST = 1e-15, 1e15  # range of all parameters, in which squares of derived quantities are finite


def check_numbers(material: Any, units: Mapping[str, str], positive: Collection[str]) -> None:
    """Check parameters by their names, and set them as floats: positive ones, or zero unless they are in `positive`.

    Raises
    ------
    ArgumentError
        For invalid numbers, and for numbers outside the supported range.
    """
    for name, unit in units.items():
        object.__setattr__(material, name, parameter(name, getattr(material, name), unit, zero=name not in positive))


def parameter(name: str, value: Any, unit: str, *, zero: bool = True) -> float:
    """Return a parameter as a float: a positive number, or zero if `zero` allows it.

    Raises
    ------
    ArgumentError
        For invalid numbers, and for numbers outside the supported range.
    """
    size = number(name, value, unit, zero=zero)
    if size > _LARGEST or 0.0 < size < _SMALLEST:
        or_zero, of_unit = "zero or " if zero else "", f" {unit}" if unit != "1" else ""
        raise ArgumentError(f"{name}={value!r} must be {or_zero}from {_SMALLEST:g} to {_LARGEST:g}{of_unit}.")
    return size


def material_of(kind: type[Material], what: str, options: Mapping[str, Any]) -> Material:
    """Return a material of a kind with these options, for messages about `what`.

    Raises
    ------
    ArgumentError
        For unknown options, and for invalid values.
    """
    known = [field.name for field in fields(kind)]  # type: ignore[arg-type]
    unknown = [name for name in options if name not in known]
    if unknown:
        raise ArgumentError(f"{unknown[0]}= is not an option of {what}; the options are {', '.join(known)}.")
    return kind(**options)
