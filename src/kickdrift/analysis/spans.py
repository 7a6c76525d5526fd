"""Time spans from users' arguments."""

import math
from typing import Any

from kickdrift.core.arguments import real
from kickdrift.core.errors import ArgumentError


def ends_of(t_span: Any) -> tuple[float, float]:
    """Return start and end.

    Raises
    ------
    ArgumentError
        For anything but two different finite times.
    """
    try:
        begin, end = (real(time) for time in t_span)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"t_span={t_span!r} must be two times, (start, end): {error}.") from None
    if not (math.isfinite(begin) and math.isfinite(end) and begin != end):
        raise ArgumentError(f"t_span={t_span!r} must be two finite times that differ, (start, end).")
    return begin, end


def step_of(step: Any) -> float:
    """Return a step, with its sign.

    Raises
    ------
    ArgumentError
        For anything but a finite number that is not 0.
    """
    try:
        value = real(step)
    except TypeError:
        value = math.nan
    if not math.isfinite(value) or value == 0:
        raise ArgumentError(f"step={step!r} must be a finite number, and not 0.")
    return value
