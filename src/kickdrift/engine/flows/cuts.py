"""Steps that are cut where a gap closes: they are rejected, and repeated up to that time.

Templates, around the letters of a step: `begin_cut` keeps the state, and `end_cut` examines the result. If a gap is no longer
positive, the time at which it closes is found by steps of other sizes from the same start, by the Illinois algorithm and
bisection (M. Dowell, P. Jarratt, BIT 11, 168 (1971)). There the impact happens, or the force law changes, and the next step is
the rest of the first. Steps are also cut where the slip of sliding with friction reverses, since the force jumps there, and
where forces cease to press a body on its surface. Impacts that are not located happen after the step. A step without a result
is halved until it has one.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.engine.flows.error_control import BEGIN, take_back
from kickdrift.engine.flows.impact import REST
from kickdrift.engine.flows.layout import (
    CHANGES,
    CHATTERING,
    CLOCK,
    DENSITY,
    END,
    FAILED_CONTROL,
    FIRST_STEP,
    JAMMED,
    REJECTED,
    TROUBLE,
    at_end,
    own_params,
)
from kickdrift.engine.flows.lifting import least_push, note_pushes, rests_newly
from kickdrift.engine.flows.resting import let_go
from kickdrift.engine.flows.sides import show_sides
from kickdrift.engine.flows.sliding import least_slip, least_slip_at_start
from kickdrift.engine.flows.sliding_mode import note_crossing, something_slides
from kickdrift.engine.flows.surfaces import (
    BEFORE,
    FLIES,
    HIGH,
    HIGH_GAP,
    HIT,
    LOCATED,
    LOW,
    LOW_GAP,
    MODE,
    MOVED_LAST,
    NOW,
    OPENS,
    PUSH,
    PUSH_BEFORE,
    RESTING,
    RESTS,
    ROUNDS,
    SHORT,
    SIDE,
    SLIP,
    SWITCH,
    TOUCHES,
    TURNED,
    WHOLE,
    row_of,
    size_of,
    something_is_hit,
    something_rests,
)

Floats = NDArray[np.float64]

keep_state: Callable[..., None] = unbound
find_gaps: Callable[..., float] = unbound
strike_all: Callable[..., None] = unbound
settle: Callable[..., None] = unbound
hold_on: Callable[..., None] = unbound
cross: Callable[..., None] = unbound
stop: Callable[..., None] = unbound
look_for_passes: Callable[..., None] = unbound
find_pushes: Callable[..., None] = unbound
slide: Callable[..., None] = unbound
misses: Callable[..., bool] = unbound

FREE, SEARCHING, LAST, SHORTENED, SLIDING = 0.0, 1.0, 2.0, 3.0, 4.0  # modes
_MOST_ROUNDS, _ROUNDING = 200, 2.220446049250313e-16
_MOST_SHORT = 100.0  # consecutive cuts without time between
_SLIVER = 1e-9  # of a step: shorter remainders are left out


@compiled
def narrow(size: float, gap: float, work: Floats) -> None:
    """Narrow the bracket of step sizes between which a gap closes, and note which gaps have closed at its end."""
    own = own_params(work)
    own[MODE] = SEARCHING
    own[ROUNDS] += 1.0
    if gap >= 0.0:
        own[LOW], own[LOW_GAP] = size, gap
        if own[MOVED_LAST] > 0.0:
            own[HIGH_GAP] *= 0.5
        own[MOVED_LAST] = 1.0
        return
    own[HIGH], own[HIGH_GAP] = size, gap
    if own[MOVED_LAST] < 0.0:
        own[LOW_GAP] *= 0.5
    own[MOVED_LAST] = -1.0
    note_closed(0.0, work)


@compiled
def note_closed(least: float, work: Floats) -> None:
    """Note which gaps have closed or which slips have reversed after a trial."""
    now, hit, resting = row_of(NOW, work), row_of(HIT, work), row_of(RESTING, work)
    slip, turned = row_of(SLIP, work), row_of(TURNED, work)
    for row in range(hit.size):
        hit[row] = 1.0 if now[row] < least and resting[row] == FLIES else 0.0
        turned[row] = 1.0 if slip[row] < least else 0.0


@compiled
def choose_size(last: float, x: Floats, work: Floats) -> bool:
    """Choose the size of the step; return whether it must be repeated with that."""
    own, size_of_x = own_params(work), size_of(x, work)
    low, high = own[LOW], own[HIGH]
    tolerance = 4.0 * _ROUNDING * (abs(own[BEGIN]) + high)
    found = 0.0 < low == last and own[LOW_GAP] <= 4.0 * _ROUNDING * size_of_x
    if found:
        note_closed(4.0 * _ROUNDING * size_of_x, work)
    if low == 0.0 and own[LOW_GAP] <= TOUCHES * size_of_x and high > tolerance and something_is_hit(work):
        size = 0.5 * high
        if closes_at_once(work):
            own[MODE], size = LAST, tolerance
        elif high < REST * abs(work[FIRST_STEP]) and opens_no_more(TOUCHES * size_of_x, work):
            own[MODE], size = FREE, own[WHOLE]
    elif high - low > tolerance and own[ROUNDS] < _MOST_ROUNDS and not found:
        size = 0.5 * (low + high)
        if own[ROUNDS] % 3.0 != 0.0:
            size = (low * own[HIGH_GAP] - high * own[LOW_GAP]) / (own[HIGH_GAP] - own[LOW_GAP])
            size = min(max(size, low + 0.25 * tolerance), high - 0.25 * tolerance)
    else:
        size = low if low > 0.0 else high
        own[MODE] = LAST
    work[DENSITY] = abs(work[FIRST_STEP]) / size
    return bool(size != last or own[MODE] != LAST)


@compiled
def closes_at_once(work: Floats) -> bool:
    """Whether a gap that was touching at the start has closed: then only such gaps count as hit."""
    hit, opens, at_once = row_of(HIT, work), row_of(OPENS, work), False
    for row in range(hit.size):
        at_once = at_once or (hit[row] != 0.0 and opens[row] < 0.0)
    for row in range(hit.size):
        if at_once and opens[row] >= 0.0:
            hit[row] = 0.0
    return at_once


@compiled
def count_short(crosses: bool, work: Floats) -> None:
    """Count a cut without time before it, or at a switch that was just crossed; fail where there are too many in a row."""
    own = own_params(work)
    own[SHORT] += 1.0
    if own[SHORT] > _MOST_SHORT:
        work[TROUBLE] = CHATTERING if crosses else JAMMED


@compiled
def opens_no_more(touches: float, work: Floats) -> bool:
    """Let gaps come to rest, or cross their switches, that touched at the start and closed again at once, if all have."""
    hit, switch, before, side = row_of(HIT, work), row_of(SWITCH, work), row_of(BEFORE, work), row_of(SIDE, work)
    for row in range(hit.size):
        if hit[row] != 0.0 and before[row] > (0.0 if switch[row] != 0.0 else touches):
            return False
    passes = False
    for row in range(hit.size):
        if hit[row] != 0.0 and switch[row] != 0.0:
            side[row] *= -1.0
            passes = True
            note_crossing(row, own_params(work)[BEGIN], work)
        elif hit[row] != 0.0:
            row_of(RESTING, work)[row] = RESTS
        hit[row] = 0.0
    if passes:
        count_short(True, work)
    return True


@compiled
def shorten(size: float, work: Floats) -> bool:
    """Halve a step without a result, as between points that meet head-on, unless it becomes too short."""
    own = own_params(work)
    if own[MODE] not in (FREE, SHORTENED) or 0.5 * size < _SLIVER * abs(work[FIRST_STEP]):
        return False
    own[MODE] = SHORTENED
    work[DENSITY] = abs(work[FIRST_STEP]) / (0.5 * size)
    work[TROUBLE], work[REJECTED] = 0.0, 1.0
    return True


@compiled
def accept_cut(size: float, work: Floats) -> None:
    """Accept the step; the next is the rest of it, or a new one, at most up to the end."""
    own, first = own_params(work), abs(work[FIRST_STEP])
    work[REJECTED], own[MODE], own[MOVED_LAST] = 0.0, FREE, 0.0
    rest, left = own[WHOLE] - size, abs(work[END] - work[CLOCK])
    following = rest if rest > _SLIVER * first else first
    if not at_end(work):
        work[DENSITY] = first / (left if left - following < _SLIVER * first else following)


def begin_cut(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Keep the state, and the gaps if the step is new."""
    keep_state(t, h, x, v, params, work)
    own = own_params(work)
    if own[MODE] == FREE and something_slides(work):
        slide(t, x, v, params, work)
    show_sides(params, work)
    if own[MODE] == FREE:
        before, now = row_of(BEFORE, work), row_of(NOW, work)
        find_gaps(t, x, v, work)
        settle(t, h, x, v, work)
        for row in range(now.size):
            before[row] = now[row]
        own[LOW_GAP] = max(0.0, find_gaps(t, x, v, work))
        own[LOW], own[ROUNDS] = 0.0, 0.0
        if rests_newly(work):
            find_pushes(t, x, v, params, work)
            note_pushes(work)
        own[WHOLE] = abs(work[FIRST_STEP] / work[DENSITY])


def end_cut(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Accept the step, or choose its size for a repetition."""
    own, size, turned, gap = own_params(work), abs(work[FIRST_STEP] / work[DENSITY]), row_of(TURNED, work), 0.0
    if work[TROUBLE] != FAILED_CONTROL:
        hold_on(t, h, x, v, work)
        gap = find_gaps(t, x, v, work)
    if work[TROUBLE] == FAILED_CONTROL and shorten(size, work):
        take_back(x, v, work)
        return
    if own[MODE] in (FREE, SHORTENED, SLIDING) and something_slides(work):
        own[MODE] = SLIDING
        if misses(t, h, x, v, work):
            take_back(x, v, work)
            work[REJECTED] = 1.0
            return
        own[MODE] = FREE
    find_pushes(t, x, v, params, work)
    if own[MODE] != LAST:
        gap = min(gap, least_slip(v, work), least_push(PUSH, x, work))
    cut, crosses, again = own[MODE] in (SEARCHING, LAST) or gap < 0.0, False, False
    if cut and own[LOCATED] != 0.0 and own[MODE] != LAST:
        if own[ROUNDS] == 0.0:
            own[LOW_GAP] = min(own[LOW_GAP], least_slip_at_start(work), least_push(PUSH_BEFORE, x, work))
        narrow(size, gap, work)
        if choose_size(size, x, work):
            take_back(x, v, work)
            work[REJECTED] = 1.0
            return
    look_for_passes(t, h, x, v, work)
    if cut:
        hit, switch = row_of(HIT, work), row_of(SWITCH, work)
        for row in range(hit.size):
            if hit[row] != 0.0 and switch[row] != 0.0:
                crosses = True
                cross(row, t, x, v, params, work)
                again = note_crossing(row, t, work) or again
            if turned[row] != 0.0:
                stop(row, t, x, v, work)
                turned[row] = 0.0
        strike_all(t, x, v, params, work)
    if again or (cut and size < _SLIVER * abs(work[FIRST_STEP])):
        count_short(crosses, work)
    else:
        own[SHORT] = 0.0
    if cut or something_rests(work):
        work[CHANGES] += 1.0
    let_go(work)
    note_pushes(work)
    accept_cut(size, work)
