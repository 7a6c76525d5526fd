"""Detection of gaps without a sign, such as abs(x) or x**2, through which bodies would pass unnoticed.

Templates. A gap that is positive at both ends of a step, and that grew at its end as if it had come from below zero, is
looked at along the step. Where it comes to zero there, and is negative nowhere around, it has no side that is beyond it.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.error_control import saved
from kickdrift.engine.flows.layout import TROUBLE, UNSIGNED_GAP
from kickdrift.engine.flows.surfaces import (
    BEFORE,
    DIFFERENCE,
    FLIES,
    LEFT,
    NOW,
    RESTING,
    SWITCH,
    TOUCHES,
    params_of_gaps,
    place,
    room_of_accelerations,
    room_of_gaps,
    row_of,
    size_of,
)

Floats = NDArray[np.float64]

gaps_at: Callable[..., None] = unbound
is_unsigned: Callable[..., bool] = unbound
gap_on_way: Callable[..., float] = unbound
has_no_other_side: Callable[..., bool] = unbound

_MOMENT = 1e-6  # of a step, by which the rate of a gap at its end is a difference
_ZERO = 1e-6  # of a gap at the ends of a step
_THIRDS = 100  # iterations of ternary search, until no floats are left between


@compiled
def may_pass(row: int, touches: float, work: Floats) -> bool:
    """Whether a gap of impacts was open at the start of a step, and is open at its end."""
    before, now = row_of(BEFORE, work)[row], row_of(NOW, work)[row]
    flies = row_of(RESTING, work)[row] == FLIES and row_of(SWITCH, work)[row] == 0.0
    return bool(flies and before > touches and now > touches)


def look_for_unsigned(t: float, h: float, x: Floats, v: Floats, work: Floats) -> None:
    """Fail if a body has passed a gap without a sign within a step."""
    n, now, room, there = x.size, row_of(NOW, work), room_of_gaps(x.size, work), place(x.size, work)
    touches, some = TOUCHES * size_of(x, work), False
    for row in range(now.size):
        some = some or may_pass(row, touches, work)
    if not some:
        return
    for i in range(n):
        there[i] = x[i] - _MOMENT * h * v[i]
    gaps_at(t - _MOMENT * h, there, v, params_of_gaps(n, work), work, room)
    earlier = row_of(LEFT, work)
    assign(earlier, room)
    for row in range(now.size):
        grew = (now[row] - earlier[row]) / _MOMENT > now[row]
        if grew and may_pass(row, touches, work) and is_unsigned(row, t, h, x, v, work):
            work[TROUBLE] = UNSIGNED_GAP


def find_gap_on_way(row: int, share: float, t: float, h: float, x: Floats, v: Floats, work: Floats) -> float:
    """Return a gap at a fraction of the straight path of a step."""
    n, begin, room, there = x.size, saved(x.size, 0, x.size, work), room_of_gaps(x.size, work), place(x.size, work)
    for i in range(n):
        there[i] = begin[i] + share * (x[i] - begin[i])
    gaps_at(t - h + share * h, there, v, params_of_gaps(n, work), work, room)
    return float(room[row])


def touches_without_sign(row: int, t: float, h: float, x: Floats, v: Floats, work: Floats) -> bool:
    """Whether a gap reaches zero on the straight path of a step without becoming negative nearby."""
    low, high = 0.0, 1.0
    for _ in range(_THIRDS):
        third = (high - low) / 3.0
        if gap_on_way(row, low + third, t, h, x, v, work) < gap_on_way(row, high - third, t, h, x, v, work):
            high -= third
        else:
            low += third
    least = gap_on_way(row, low, t, h, x, v, work)
    if not 0.0 <= least <= _ZERO * min(row_of(BEFORE, work)[row], row_of(NOW, work)[row]):
        return False
    nearest = room_of_accelerations(x.size, work)
    assign(nearest, place(x.size, work))
    return has_no_other_side(row, t - h + low * h, nearest, v, work)


def look_around(row: int, t: float, x: Floats, v: Floats, work: Floats) -> bool:
    """Whether a gap is positive somewhere around a state, and negative nowhere."""
    room, there, d = room_of_gaps(x.size, work), place(x.size, work), DIFFERENCE * size_of(x, work)
    assign(there, x)
    most = 0.0
    for i in range(x.size):
        for sign in (-1.0, 1.0):
            there[i] = x[i] + sign * d
            gaps_at(t, there, v, params_of_gaps(x.size, work), work, room)
            if room[row] < 0.0:
                return False
            most = max(most, room[row])
        there[i] = x[i]
    return most > 0.0
