"""Surfaces at which steps are cut: layout of their numbers, gaps and gradients.

Templates. Layout of the params of control: HEAD numbers, named below; then ROWS rows of a number to each of m gaps, named
below, of which the last ones belong to the gaps that are listed; VECTORS of n numbers, the inverse masses first; room for m
gaps; the gradients of the gaps that are listed, n numbers each; changes of the sides, m numbers each; and the params of the
function.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.views import part
from kickdrift.engine.flows.layout import END, FAILED_CONTROL, FIRST_STEP, TROUBLE, own_params

Floats = NDArray[np.float64]

gaps_at: Callable[..., None] = unbound
time_slopes: Callable[..., None] = unbound

HEAD = 21
COUNT, LOCATED, BODY_SIZE = 0, 1, 2  # 3 and 4 are those of a trial, see `error_control`
LOW, HIGH, LOW_GAP, HIGH_GAP, MODE, WHOLE, MOVED_LAST, LENGTH, ROUNDS, PLACE_OF_SIDES, SHORT = range(5, 16)
START, MOST_LISTED, LISTED = 16, 17, 18  # of the run; how many gaps can be listed, and are
MOST_KEPT, KEPT = 19, 20  # how many changes of the sides can be kept, and are
ROWS = 23
RESTITUTION, FRICTION, SWITCH, SIDE, RESTING, BEFORE, NOW, HIT, OPENS, SLIP, TURNED = range(11)
STEEPNESS, WITHOUT, CROSSED = 11, 12, 13  # of switches, see `sliding_mode`
PUSH, PUSH_BEFORE = 14, 15  # at rest, see `lifting`
LIST, SQUARE, RATE, IMPULSE, USED, LEFT, SLIDES = range(16, ROWS)  # of those listed: the gap, and the data on it
FLIES, RESTS, LEAVES, SLIDES_ON = 0.0, 1.0, 2.0, 3.0  # states of a gap, in RESTING: LEAVES until its step is taken
VECTORS = 3
_INVERSE_MASSES, _PLACE, _ACCELERATION = range(VECTORS)

TOUCHES = 1e-12  # of the size of x: two that are so near take part in one impact
CLOSED = 1e-14  # of the size of x: a gap closed at the start of a step closes again where it is that far beyond
DIFFERENCE = 1e-4  # of the size of x: differences of fourth order leave 1e-12 of the gradient
_SPAN = 1e-2  # of a step, in the same way


@compiled(inline=True)
def row_of(index: int, work: Floats) -> Floats:
    """Return one number of each row."""
    own = own_params(work)
    m = int(own[COUNT])
    return part(own, HEAD + index * m, m)


@compiled(inline=True)
def _vector(index: int, n: int, work: Floats) -> Floats:
    own = own_params(work)
    return part(own, HEAD + ROWS * int(own[COUNT]) + index * n, n)


@compiled(inline=True)
def inverse_masses(n: int, work: Floats) -> Floats:
    """Return the inverse mass of each component of the state."""
    return _vector(_INVERSE_MASSES, n, work)


@compiled(inline=True)
def place(n: int, work: Floats) -> Floats:
    """Return scratch for n numbers, which every gradient overwrites."""
    return _vector(_PLACE, n, work)


@compiled(inline=True)
def room_of_accelerations(n: int, work: Floats) -> Floats:
    """Return scratch for n numbers."""
    return _vector(_ACCELERATION, n, work)


@compiled(inline=True)
def room_of_gaps(n: int, work: Floats) -> Floats:
    """Return scratch for the gaps."""
    own = own_params(work)
    return part(own, HEAD + ROWS * int(own[COUNT]) + VECTORS * n, int(own[COUNT]))


@compiled(inline=True)
def gradient(k: int, n: int, work: Floats) -> Floats:
    """Return the gradient of a listed gap."""
    own = own_params(work)
    return part(own, HEAD + (ROWS + 1) * int(own[COUNT]) + (VECTORS + k) * n, n)


@compiled(inline=True)
def _start_of_changes(n: int, work: Floats) -> int:
    own = own_params(work)
    return HEAD + (ROWS + 1) * int(own[COUNT]) + (VECTORS + int(own[MOST_LISTED])) * n


@compiled(inline=True)
def params_of_gaps(n: int, work: Floats) -> Floats:
    """Return the params of the function."""
    own = own_params(work)
    start = _start_of_changes(n, work) + int(own[MOST_KEPT]) * int(own[COUNT])
    return part(own, start, own.size - start)


@compiled(inline=True)
def change_of_sides(k: int, n: int, work: Floats) -> Floats:
    """Return one of the changes of the sides in a step."""
    m = int(own_params(work)[COUNT])
    return part(own_params(work), _start_of_changes(n, work) + k * m, m)


@compiled
def size_of(x: Floats, work: Floats) -> float:
    """Return the size of positions, to which rounding errors are relative."""
    size = float(own_params(work)[LENGTH])
    for i in range(x.size):
        size = max(size, abs(x[i]))
    return size


@compiled
def list_one(row: int, work: Floats) -> None:
    """List a single gap."""
    own_params(work)[LISTED] = 1.0
    row_of(LIST, work)[0] = row


@compiled
def something_is_hit(work: Floats) -> bool:
    """Whether a gap has closed, rather than only a slip reversed."""
    hit, some = row_of(HIT, work), False
    for row in range(hit.size):
        some = some or hit[row] != 0.0
    return some


@compiled
def something_rests(work: Floats) -> bool:
    """Whether the step was projected back onto a surface."""
    resting, some = row_of(RESTING, work), False
    for row in range(resting.size):
        some = some or resting[row] != FLIES
    return some


def evaluate_gaps(t: float, x: Floats, v: Floats, work: Floats) -> float:
    """Write the gaps, and return the smallest of those that may close."""
    now, side, resting, before = row_of(NOW, work), row_of(SIDE, work), row_of(RESTING, work), row_of(BEFORE, work)
    gaps_at(t, x, v, params_of_gaps(x.size, work), work, now)
    least, closed = math.inf, CLOSED * size_of(x, work)
    for i in range(now.size):
        now[i] *= side[i]
        if now[i] != now[i]:
            work[TROUBLE] = FAILED_CONTROL
        if resting[i] == 0.0:
            least = min(least, now[i] + closed if before[i] <= closed else now[i])
    return least


def difference_gradients(t: float, x: Floats, v: Floats, work: Floats) -> None:
    """Write the gradients of the listed gaps, their squares over the masses, and the rates of gaps that move by themselves."""
    n, room, there, inverse = x.size, room_of_gaps(x.size, work), place(x.size, work), inverse_masses(x.size, work)
    listed, row, square = int(own_params(work)[LISTED]), row_of(LIST, work), row_of(SQUARE, work)
    d = DIFFERENCE * size_of(x, work)
    for i in range(n):
        there[i] = x[i]
    for k in range(listed):
        square[k] = 0.0
    for i in range(n):
        for k in range(listed):
            gradient(k, n, work)[i] = 0.0
        for point in range(4):
            sign = 1.0 if point % 2 == 0 else -1.0
            there[i] = x[i] + (sign * d if point < 2 else 2.0 * sign * d)
            gaps_at(t, there, v, params_of_gaps(n, work), work, room)
            for k in range(listed):
                gradient(k, n, work)[i] += (8.0 * sign if point < 2 else -sign) * room[int(row[k])]
        there[i] = x[i]
        for k in range(listed):
            slopes = gradient(k, n, work)
            slopes[i] /= 12.0 * d
            square[k] += slopes[i] * slopes[i] * inverse[i]
    time_slopes(t, x, v, work)


def difference_in_time(t: float, x: Floats, v: Floats, work: Floats) -> None:
    """Write the rates of the listed gaps at constant positions, by times within the run, since tables may end with it.

    Differences of differences, so that constant gaps have the rate zero.
    """
    n, own, room, rate, base = (
        x.size,
        own_params(work),
        room_of_gaps(x.size, work),
        row_of(RATE, work),
        row_of(LEFT, work),
    )
    listed, row, span = int(own[LISTED]), row_of(LIST, work), _SPAN * abs(work[FIRST_STEP])
    ahead = 1.0 if t - 2.0 * span < own[START] else -1.0 if t + 2.0 * span > work[END] else 0.0
    gaps_at(t, x, v, params_of_gaps(n, work), work, room)
    for k in range(listed):
        rate[k], base[k] = 0.0, room[int(row[k])]
    for point in range(4):
        if ahead == 0.0:
            weight = 8.0 if point == 0 else -8.0 if point == 1 else -1.0 if point == 2 else 1.0
            at = 1.0 if point == 0 else -1.0 if point == 1 else 2.0 if point == 2 else -2.0
        else:
            weight = ahead * (48.0 if point == 0 else -36.0 if point == 1 else 16.0 if point == 2 else -3.0)
            at = ahead * (point + 1.0)
        gaps_at(t + at * span, x, v, params_of_gaps(n, work), work, room)
        for k in range(listed):
            rate[k] += weight * (room[int(row[k])] - base[k])
    for k in range(listed):
        rate[k] /= 12.0 * span
