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
        value = number(name, getattr(material, name), unit, zero=name not in positive)
        if value > _LARGEST or 0.0 < value < _SMALLEST:
            zero = "" if name in positive else "zero or "
            of_unit = f" {unit}" if unit != "1" else ""
            raise ArgumentError(f"{name}={value!r} must be {zero}from {_SMALLEST:g} to {_LARGEST:g}{of_unit}.")
        object.__setattr__(material, name, value)


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
