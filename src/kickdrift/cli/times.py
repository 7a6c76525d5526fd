"""Spans of time on the command line: a number, with a unit if it is not the system's own."""

import math
import re

from kickdrift.core.constants import JULIAN_YEAR
from kickdrift.core.errors import ArgumentError

_DAY = 86_400.0
_SECONDS = {
    unit: seconds
    for units, seconds in (
        (("s", "sec", "second", "seconds"), 1.0),
        (("min", "minute", "minutes"), 60.0),
        (("h", "hour", "hours"), 3_600.0),
        (("d", "day", "days"), _DAY),
        (("yr", "year", "years", "a"), JULIAN_YEAR.value * _DAY),
    )
    for unit in units
}
TIMES = tuple(_SECONDS)
_NUMBER_AND_UNIT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([A-Za-z]*)\s*")


def parse_time(argument: str, text: str, own_unit: str, bare: str = "") -> float:
    """Read a time such as ``0.5 day``.

    Parameters
    ----------
    argument : str
        What to call it in errors, such as ``--step``.
    text : str
        What was given.
    own_unit : str
        Unit of time of the system, empty if it has none.
    bare : str
        Unit of a number without one, the system's own if empty.

    Returns
    -------
    float
        In the system's own unit; finite and not zero.

    Raises
    ------
    ArgumentError
        For a text that is not such a time, or a unit that the system's own cannot be converted to.
    """
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if match is None:
        raise ArgumentError(f"{argument}={text!r} is not a time; give a number, or one with a unit such as '0.5 day'.")
    value, unit = float(match[1]), match[2] or bare
    if unit:
        value *= _own_units_in(argument, text, unit, own_unit)
    if not (math.isfinite(value) and value != 0):
        raise ArgumentError(f"{argument}={text!r} must be finite and not zero.")
    return value


def _own_units_in(argument: str, text: str, unit: str, own_unit: str) -> float:
    if unit == own_unit:
        return 1.0
    if unit.lower() not in _SECONDS:
        raise ArgumentError(
            f"{argument}={text!r}: the unit {unit!r} is unknown; use second, minute, hour, day or year."
        )
    if own_unit.lower() not in _SECONDS:
        own = f"has its time in {own_unit!r}" if own_unit else "has no unit of time"
        raise ArgumentError(
            f"{argument}={text!r} has a unit, but the system {own}; give --duration and --step as plain numbers."
        )
    return _SECONDS[unit.lower()] / _SECONDS[own_unit.lower()]
