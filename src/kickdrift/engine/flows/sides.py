"""The sides of switches: in the params of the force, and for states between two steps.

Templates. Where steps are cut at a switch, the next one begins at the switch, up to rounding, with a known side: see `cuts`.
Of a part of that step only the state is known; its side is that to which the motion, or time alone, leads it a moment later.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.error_control import saved
from kickdrift.engine.flows.layout import CHANGES, END, EVALUATIONS, FIRST_STEP, TROUBLE, VELOCITY, has_part, own_params
from kickdrift.engine.flows.resting import FREE_V, FREE_X
from kickdrift.engine.flows.sliding_mode import may_slide
from kickdrift.engine.flows.surfaces import (
    BEFORE,
    NOW,
    PLACE_OF_SIDES,
    SIDE,
    SWITCH,
    TOUCHES,
    place,
    room_of_accelerations,
    row_of,
    size_of,
)

Floats = NDArray[np.float64]

acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
find_gaps: Callable[..., float] = unbound
take_ahead: Callable[..., None] = unbound
take_equivalent_side: Callable[..., bool] = unbound

_NEAR = 1e-6  # of the size of x: only switches that are as near are looked at a moment later
_ROUNDING = 2.220446049250313e-16
_LATEST = 1e-9  # of a step: how far ahead a state is followed that stays at a switch


@compiled
def show_sides(params: Floats, work: Floats) -> None:
    """Write the sides of the switches during the step into the params of the force; count the changes."""
    place = int(own_params(work)[PLACE_OF_SIDES])
    side, switch = row_of(SIDE, work), row_of(SWITCH, work)
    if place >= 0:
        for row in range(side.size):
            if switch[row] != 0.0:
                work[CHANGES] += 1.0 if params[place] != side[row] else 0.0
                params[place] = side[row]
                place += 1


def take_sides(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Determine the side of each switch on which a state is, or will be a moment later if it is at the switch."""
    side, now, switch, near = row_of(SIDE, work), row_of(NOW, work), row_of(SWITCH, work), False
    for row in range(side.size):
        side[row] = 1.0
    find_gaps(t, x, v, work)
    for row in range(side.size):
        near = near or (switch[row] != 0.0 and abs(now[row]) <= _NEAR * size_of(x, work))
        side[row] = -1.0 if now[row] < 0.0 and switch[row] != 0.0 else 1.0
    show_sides(params, work)
    if near:
        take_ahead(t, x, v, params, work)
        show_sides(params, work)
        for row in range(side.size):
            if switch[row] != 0.0 and may_slide(work) and abs(now[row]) <= TOUCHES * size_of(x, work):
                take_equivalent_side(row, t, x, v, params, work)
        show_sides(params, work)
        work[CHANGES] += 1.0
    work[TROUBLE] = 0.0


def take_sides_ahead(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Use the sides after a time within the rounding of t, or as soon as a switch is no longer zero."""
    n, side, now, before = x.size, row_of(SIDE, work), row_of(NOW, work), row_of(BEFORE, work)
    there, v_there, rate = saved(n, FREE_X, n, work), saved(n, FREE_V, v.size, work), place(n, work)
    a, switch = room_of_accelerations(n, work), row_of(SWITCH, work)
    if has_part(VELOCITY, work):
        velocity_at(t, x, v, params, work, rate)
    else:
        assign(rate, v)
    if v.size > 0:
        acceleration_at(t, x, v, params, work, a)
    work[EVALUATIONS] += 1.0
    moment, zero = 8.0 * _ROUNDING * (abs(t) + abs(work[FIRST_STEP])), 8.0 * _ROUNDING * size_of(x, work)
    moment = moment if work[FIRST_STEP] > 0.0 else -moment
    for row in range(now.size):
        side[row], before[row] = 1.0, now[row]
    first = True
    while (first or abs(moment) < _LATEST * abs(work[FIRST_STEP])) and (work[END] - t - moment) * moment >= 0.0:
        for i in range(n):
            there[i] = x[i] + moment * rate[i]
        for i in range(v.size):
            v_there[i] = v[i] + moment * a[i]
        find_gaps(t + moment, there, v_there, work)
        for row in range(now.size):
            if first or abs(before[row]) <= zero:
                before[row] = now[row]
        first, moment = False, 4.0 * moment
    for row in range(now.size):
        side[row] = -1.0 if before[row] < 0.0 and switch[row] != 0.0 else 1.0
    find_gaps(t, x, v, work)
