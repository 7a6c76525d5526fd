"""Sliding modes: motion along a switch to which the forces on both sides lead back, such as dry friction at rest.

Templates. By Filippov's rule, the force there is the mean of those of both sides with which the switch stays zero. For forces
that are linear in the side it is that of a side between -1 and 1, the equivalent control (V. I. Utkin, Sliding Modes in Control
and Optimization (1992), chapter 2). It is constant during a step, at first from the rates of the switch at its start, then by
iteration such that the step ends at the switch: of second order, for any method. Where the motion returns to a switch at once
and the rates do not say so, as they vanish where it only touches the switch, two trial steps tell what the side does.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.error_control import saved
from kickdrift.engine.flows.impact import REST
from kickdrift.engine.flows.layout import (
    CHANGES,
    CHATTERING,
    END,
    EVALUATIONS,
    FIRST_STEP,
    MISSED_SWITCH,
    TROUBLE,
    VELOCITY,
    has_part,
    own_params,
)
from kickdrift.engine.flows.resting import FREE_V, FREE_X
from kickdrift.engine.flows.surfaces import (
    CROSSED,
    FLIES,
    KEPT,
    LOW_GAP,
    PLACE_OF_SIDES,
    RESTING,
    ROUNDS,
    SIDE,
    SLIDES_ON,
    STEEPNESS,
    SWITCH,
    TOUCHES,
    WITHOUT,
    change_of_sides,
    params_of_gaps,
    place,
    room_of_accelerations,
    room_of_gaps,
    row_of,
    size_of,
)

Floats = NDArray[np.float64]

acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
gaps_at: Callable[..., None] = unbound
rate_of_switch: Callable[..., float] = unbound
take_equivalent_side: Callable[..., bool] = unbound

_MOMENT = 1e-4  # of a step, by which the rate of a switch is a difference
_LINEAR = 1e-2  # of the difference of the rates on both sides
MOST_ROUNDS, _SETTLED = 20, 1e-12  # of the iteration for the sides
_MISSED = 1e-6  # of the side: tolerance of the iteration, unless rounding errors are as large


@compiled
def may_slide(work: Floats) -> bool:
    """Whether the force gets the sides."""
    return bool(own_params(work)[PLACE_OF_SIDES] >= 0.0)


@compiled
def note_crossing(row: int, t: float, work: Floats) -> bool:
    """Let the next step slide along a switch that is crossed again at once, and return whether it is."""
    crossed = row_of(CROSSED, work)
    again = abs(t - crossed[row]) < REST * abs(work[FIRST_STEP])
    crossed[row] = t
    if again and may_slide(work):
        row_of(RESTING, work)[row] = SLIDES_ON
    return bool(again)


@compiled
def place_of_side(row: int, work: Floats) -> int:
    """Return the index of the side of a switch in the params of the force."""
    index, switch = int(own_params(work)[PLACE_OF_SIDES]), row_of(SWITCH, work)
    for i in range(row):
        index += 1 if switch[i] != 0.0 else 0
    return index


def find_rate(row: int, side: float, t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> float:
    """Return the rate at which a switch grows along the run under the force of a side, which is left in `params`."""
    n, room = x.size, room_of_gaps(x.size, work)
    rate, a = place(n, work), room_of_accelerations(n, work)
    there, v_there = saved(n, FREE_X, n, work), saved(n, FREE_V, v.size, work)
    params[place_of_side(row, work)] = side
    if has_part(VELOCITY, work):
        velocity_at(t, x, v, params, work, rate)
    else:
        assign(rate, v)
    if v.size > 0:
        acceleration_at(t, x, v, params, work, a)
    work[EVALUATIONS] += 1.0
    moment = _MOMENT * work[FIRST_STEP]
    if (work[END] - t - moment) * moment < 0.0:
        moment = -moment
    for i in range(n):
        there[i] = x[i] + moment * rate[i]
    for i in range(v.size):
        v_there[i] = v[i] + moment * a[i]
    gaps_at(t, x, v, params_of_gaps(n, work), work, room)
    now = room[row]
    gaps_at(t + moment, there, v_there, params_of_gaps(n, work), work, room)
    return float((room[row] - now) / moment if work[FIRST_STEP] > 0.0 else (now - room[row]) / moment)


def find_equivalent_side(row: int, t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Take the side with which a switch stays zero, and return whether there is one that both sides lead back to.

    It fails for forces that are not linear in the side.
    """
    below = rate_of_switch(row, -1.0, t, x, v, params, work)
    above = rate_of_switch(row, 1.0, t, x, v, params, work)
    unresolved = (below - above) * _MOMENT * abs(work[FIRST_STEP]) <= TOUCHES * size_of(x, work)
    if unresolved or not (below > 0.0 and above < 0.0):
        return False
    equivalent = (below + above) / (below - above)
    if abs(rate_of_switch(row, equivalent, t, x, v, params, work)) > _LINEAR * (below - above):
        work[TROUBLE] = CHATTERING
    row_of(SIDE, work)[row], row_of(STEEPNESS, work)[row] = equivalent, 0.5 * (above - below)
    return True


def slide(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Begin a step with the equivalent sides of the switches along which the motion slides, or those of a first trial."""
    resting = row_of(RESTING, work)
    for row in range(resting.size):
        if resting[row] == SLIDES_ON:
            work[CHANGES] += 1.0
            if not take_equivalent_side(row, t, x, v, params, work):
                row_of(SIDE, work)[row] = row_of(STEEPNESS, work)[row] = 0.0


@compiled
def try_sides(h: float, n: int, work: Floats) -> bool:
    """Find what sides do to switches in steps with the sides 0 and 1, and return whether the step has to be repeated for that.

    Leave switches from which the sides lead away.
    """
    room, resting, side, steepness = (
        room_of_gaps(n, work),
        row_of(RESTING, work),
        row_of(SIDE, work),
        row_of(STEEPNESS, work),
    )
    without, again = row_of(WITHOUT, work), False
    for row in range(side.size):
        if resting[row] != SLIDES_ON or steepness[row] != 0.0:
            continue
        if side[row] == 0.0:
            without[row], side[row], again = room[row], 1.0, True
            continue
        steepness[row] = (room[row] - without[row]) / h
        if not steepness[row] < 0.0:
            resting[row], side[row], again = FLIES, 1.0 if without[row] >= 0.0 else -1.0, True
            own_params(work)[LOW_GAP] = 0.0
    return again


def miss_switches(t: float, h: float, x: Floats, v: Floats, work: Floats) -> bool:
    """Return whether a step has to be repeated to end at the switches along which the motion slides, with corrected sides."""
    own, resting, side = own_params(work), row_of(RESTING, work), row_of(SIDE, work)
    gaps_at(t, x, v, params_of_gaps(x.size, work), work, room_of_gaps(x.size, work))
    if try_sides(abs(h), x.size, work):
        work[CHANGES] += 1.0
        return True
    largest = correct_sides(abs(h), x.size, work)
    own[ROUNDS] += 1.0
    if largest > _SETTLED and own[ROUNDS] < MOST_ROUNDS:
        work[CHANGES] += 1.0
        return True
    room, rounding = room_of_gaps(x.size, work), TOUCHES * max(size_of(x, work), size_of(v, work))
    for row in range(resting.size):
        if resting[row] == SLIDES_ON and largest > _MISSED and abs(room[row]) > rounding:
            work[TROUBLE] = MISSED_SWITCH
        if resting[row] == SLIDES_ON and abs(side[row]) == 1.0:
            resting[row] = FLIES
    own[ROUNDS] = own[KEPT] = 0.0
    return False


@compiled
def _product(a: Floats, b: Floats) -> float:
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@compiled
def correct_sides(h: float, n: int, work: Floats) -> float:
    """Correct the sides by Broyden's method from the slopes of each alone, and return the largest correction by these.

    It starts again where a side reaches a bound, and leaves out the sides that stay there. The effect of each side on other
    switches follows from the previous corrections, without a matrix: C. T. Kelley, Iterative Methods for Linear and Nonlinear
    Equations (1995), algorithm brsol in section 7.3.
    """
    own, room, resting, side = own_params(work), room_of_gaps(n, work), row_of(RESTING, work), row_of(SIDE, work)
    steepness, kept, largest = row_of(STEEPNESS, work), int(own[KEPT]), 0.0
    change = change_of_sides(kept, n, work)
    for row in range(side.size):
        change[row] = 0.0
        if resting[row] == SLIDES_ON:
            alone = -room[row] / (h * steepness[row])
            change[row] = min(max(side[row] + alone, -1.0), 1.0) - side[row] if abs(side[row]) == 1.0 else alone
            largest = max(largest, abs(min(max(side[row] + alone, -1.0), 1.0) - side[row]))
    for k in range(kept):
        before = change_of_sides(k, n, work)
        share = _product(before, change) / _product(before, before)
        if k + 1 < kept:
            after = change_of_sides(k + 1, n, work)
            for row in range(side.size):
                change[row] += share * after[row]
        elif abs(1.0 - share) > _SETTLED:
            for row in range(side.size):
                change[row] /= 1.0 - share
    own[KEPT] += 1.0
    for row in range(side.size):
        if abs(side[row] + change[row]) >= 1.0 and change[row] != 0.0:
            own[KEPT] = 0.0
        if resting[row] == SLIDES_ON:
            side[row] = min(max(side[row] + change[row], -1.0), 1.0)
    return largest


@compiled
def something_slides(work: Floats) -> bool:
    """Whether the motion slides along a switch."""
    resting, some = row_of(RESTING, work), False
    for row in range(resting.size):
        some = some or resting[row] == SLIDES_ON
    return some
