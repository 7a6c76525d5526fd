"""Impacts: what the velocity gets where a gap closes, and how what rests on a surface stays there.

Templates. Newton's law of restitution and Coulomb's of friction,

    v += M^-1 J^T p,   p = -(1 + e) J v / (J M^-1 J^T),   of what is tangential at most mu p,

where J is the gradient of the gap. A rebound whose flight would be shorter than a thousandth of a step is none: the body rests.
After each step, what rests is put back onto its surface, and what moves it in is taken from the velocity, with the friction
that goes with it; it leaves where the forces lift it.

Layout of the params of control: HEAD numbers, named below; then for each of m gaps, in ROWS rows, its restitution, its
friction, whether it is a switch, the side on which it counts, whether it rests, the gap before the step and now,
whether it has closed; then VECTORS of n numbers, the inverse masses first; room for m gaps; and the params of the function.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.core.views import part
from kickdrift.engine.flows.layout import (
    EVALUATIONS,
    FAILED_CONTROL,
    FIRST_STEP,
    TROUBLE,
    VELOCITY,
    has_part,
    own_params,
)

Floats = NDArray[np.float64]

acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
gaps_at: Callable[..., None] = unbound
find_gaps: Callable[..., float] = unbound
find_gradient: Callable[..., float] = unbound
put_back: Callable[..., None] = unbound
strike: Callable[..., bool] = unbound

HEAD = 17
COUNT, LOCATED, BODY_SIZE = 0, 1, 2  # 3 and 4 are those of a trial, see `error_control`
LOW, HIGH, LOW_GAP, HIGH_GAP, MODE, WHOLE, MOVED_LAST, LENGTH, ROUNDS, RATE, PLACE_OF_SIDES, SHORT = range(5, 17)
ROWS = 8
RESTITUTION, FRICTION, SWITCH, SIDE, RESTING, BEFORE, NOW, HIT = range(ROWS)
VECTORS = 4
_INVERSE_MASSES, _GRADIENT, _PLACE, _ACCELERATION = range(VECTORS)

_DIFFERENCE = 1e-4  # of the size of x: differences of fourth order leave 1e-12 of the gradient
TOUCHES = 1e-12  # of the size of x: two that are so near take part in one impact
CLOSED = 1e-14  # of the size of x: what touches at the start of a step closes where it is so far beyond
REST = 1e-3  # of a step: a shorter flight is none
_MOMENT, _DOUBLINGS = 1e-16, 24  # of a step, how short a moment may be, and how often it is doubled
_ROUNDS = 200  # of impacts that follow from each other


@compiled(inline=True)
def row_of(index: int, work: Floats) -> Floats:
    """Return one number of each row."""
    own = own_params(work)
    m = int(own[COUNT])
    return part(own, HEAD + index * m, m)


@compiled(inline=True)
def vector(index: int, n: int, work: Floats) -> Floats:
    """Return one of the vectors."""
    own = own_params(work)
    return part(own, HEAD + ROWS * int(own[COUNT]) + index * n, n)


@compiled(inline=True)
def params_of_gaps(n: int, work: Floats) -> Floats:
    """Return the params of the function."""
    own = own_params(work)
    start = HEAD + (ROWS + 1) * int(own[COUNT]) + VECTORS * n
    return part(own, start, own.size - start)


@compiled(inline=True)
def room_of_gaps(n: int, work: Floats) -> Floats:
    """Return room for the gaps."""
    own = own_params(work)
    return part(own, HEAD + ROWS * int(own[COUNT]) + VECTORS * n, int(own[COUNT]))


def evaluate_gaps(t: float, x: Floats, v: Floats, work: Floats) -> float:
    """Leave the gaps, and return the smallest of those that may close."""
    now, side, resting, before = row_of(NOW, work), row_of(SIDE, work), row_of(RESTING, work), row_of(BEFORE, work)
    gaps_at(t, x, v, params_of_gaps(x.size, work), work, now)
    least, closed = math.inf, CLOSED * own_params(work)[LENGTH]
    for i in range(now.size):
        now[i] *= side[i]
        if now[i] != now[i]:
            work[TROUBLE] = FAILED_CONTROL
        if resting[i] == 0.0:
            least = min(least, now[i] + closed if before[i] <= closed else now[i])
    return least


def difference_gradient(row: int, t: float, x: Floats, v: Floats, work: Floats) -> float:
    """Leave the gradient of a gap and its rate at rest, and return the square of the gradient over the masses."""
    n, room = x.size, room_of_gaps(x.size, work)
    place, gradient, inverse = vector(_PLACE, n, work), vector(_GRADIENT, n, work), vector(_INVERSE_MASSES, n, work)
    d = own_params(work)[LENGTH]
    for i in range(n):
        place[i] = x[i]
        d = max(d, abs(x[i]))
    d *= _DIFFERENCE
    square = 0.0
    for i in range(n):
        slope = 0.0
        for k in range(4):
            at, weight = (-2.0, 1.0) if k == 0 else (-1.0, -8.0) if k == 1 else (1.0, 8.0) if k == 2 else (2.0, -1.0)
            place[i] = x[i] + at * d
            gaps_at(t, place, v, params_of_gaps(n, work), work, room)
            slope += weight * room[row]
        place[i] = x[i]
        gradient[i] = slope / (12.0 * d)
        square += gradient[i] * gradient[i] * inverse[i]
    span, slope = _DIFFERENCE * abs(work[FIRST_STEP]), 0.0
    for k in range(4):
        at, weight = (-2.0, 1.0) if k == 0 else (-1.0, -8.0) if k == 1 else (1.0, 8.0) if k == 2 else (2.0, -1.0)
        gaps_at(t + at * span, x, v, params_of_gaps(n, work), work, room)
        slope += weight * room[row]
    own_params(work)[RATE] = slope / (12.0 * span)
    return square


def move_to_surface(row: int, t: float, x: Floats, v: Floats, work: Floats) -> None:
    """Put what is beyond a surface back onto it, by the shortest way."""
    n, gradient, inverse = x.size, vector(_GRADIENT, x.size, work), vector(_INVERSE_MASSES, x.size, work)
    for _ in range(3):
        square = find_gradient(row, t, x, v, work)
        gaps_at(t, x, v, params_of_gaps(n, work), work, room_of_gaps(n, work))
        gap = room_of_gaps(n, work)[row]
        if gap == 0.0 or square == 0.0:
            return
        for i in range(n):
            x[i] -= gap * gradient[i] * inverse[i] / square


def give_impulse(row: int, t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Let a row rebound, if it is closing, or rest; return whether it was."""
    n, own = x.size, own_params(work)
    square = find_gradient(row, t, x, v, work)
    gradient, inverse = vector(_GRADIENT, n, work), vector(_INVERSE_MASSES, n, work)
    speed, size = own[RATE], abs(own[RATE])
    for i in range(n):
        speed += gradient[i] * v[i]
        size += abs(gradient[i] * v[i])
    if not speed < -1e-14 * size:
        return False
    a, pull = vector(_ACCELERATION, n, work), 0.0
    acceleration_at(t, x, v, params, work, a)
    work[EVALUATIONS] += 1.0
    for i in range(n):
        pull += gradient[i] * a[i]
    restitution = row_of(RESTITUTION, work)[row]
    share = REST if own[LOCATED] != 0.0 else 2.0
    flight = -2.0 * restitution * speed if own[LOCATED] != 0.0 else -2.0 * speed
    if pull < 0.0 and flight <= -pull * share * abs(work[FIRST_STEP]):
        restitution = 0.0
        row_of(RESTING, work)[row] = 1.0
    rub(row, square, speed, (1.0 + restitution) * -speed, v, work)
    for i in range(n):
        v[i] -= (1.0 + restitution) * speed * gradient[i] * inverse[i] / square
    return True


@compiled
def rub(row: int, square: float, speed: float, change: float, v: Floats, work: Floats) -> None:
    """Take from what is tangential at most friction times the `change` of the closing speed."""
    n, friction, size = v.size, row_of(FRICTION, work)[row], int(own_params(work)[BODY_SIZE])
    if friction == 0.0:
        return
    gradient, inverse = vector(_GRADIENT, n, work), vector(_INVERSE_MASSES, n, work)
    for first in range(0, n, size):
        length, closing, slip = 0.0, 0.0, 0.0
        for i in range(first, first + size):
            length += gradient[i] * gradient[i]
            closing += gradient[i] * v[i]
        if length == 0.0:
            continue
        for i in range(first, first + size):
            slip += (v[i] - closing * gradient[i] / length) ** 2
        slip = math.sqrt(slip)
        if slip > 0.0:
            taken = min(1.0, friction * change * inverse[first] * math.sqrt(length) / square / slip)
            for i in range(first, first + size):
                v[i] -= taken * (v[i] - closing * gradient[i] / length)


def settle_or_lift(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Keep what rests on its surface, unless it was lifted; one after the other, until nothing closes."""
    n, resting, now = x.size, row_of(RESTING, work), row_of(NOW, work)
    gradient, inverse = vector(_GRADIENT, n, work), vector(_INVERSE_MASSES, n, work)
    for row in range(resting.size):
        if now[row] > 0.0:
            resting[row] = 0.0
    for _ in range(_ROUNDS):
        closing = False
        for row in range(resting.size):
            if resting[row] == 0.0:
                continue
            put_back(row, t, x, v, work)
            square = find_gradient(row, t, x, v, work)
            speed, size = own_params(work)[RATE], abs(own_params(work)[RATE])
            for i in range(n):
                speed += gradient[i] * v[i]
                size += abs(gradient[i] * v[i])
            if speed < -1e-14 * size:
                closing = True
                rub(row, square, speed, -speed, v, work)
                for i in range(n):
                    v[i] -= speed * gradient[i] * inverse[i] / square
        if not closing:
            break


def cross_switch(row: int, t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Bring a state that has come to a switch to its other side, by the shortest moment that floats know.

    The step before has seen one law to its end, and the next one sees the other from its start.
    """
    n, side, now = x.size, row_of(SIDE, work), row_of(NOW, work)
    rate, a = vector(_PLACE, n, work), vector(_ACCELERATION, n, work)
    if has_part(VELOCITY, work):
        velocity_at(t, x, v, params, work, rate)
    else:
        assign(rate, v)
    if v.size > 0:
        acceleration_at(t, x, v, params, work, a)
    work[EVALUATIONS] += 1.0
    moment = _MOMENT * abs(work[FIRST_STEP])
    for _ in range(_DOUBLINGS):
        if now[row] < 0.0:
            break
        for i in range(n):
            x[i] += moment * rate[i]
        for i in range(v.size):
            v[i] += moment * a[i]
        moment *= 2.0
        find_gaps(t, x, v, work)
    side[row], now[row] = -side[row], -now[row]


def strike_rows(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Let everything rebound that closes where it touches, one after the other, until nothing does."""
    own, now, hit, switch = own_params(work), row_of(NOW, work), row_of(HIT, work), row_of(SWITCH, work)
    touches = TOUCHES * own[LENGTH]
    for row in range(now.size):
        if own[LOCATED] == 0.0:
            hit[row] = 1.0 if now[row] < 0.0 else 0.0
            if hit[row] != 0.0 and switch[row] == 0.0:
                put_back(row, t, x, v, work)
        elif now[row] <= touches:
            hit[row] = 1.0
    for _ in range(_ROUNDS):
        struck = False
        for row in range(now.size):
            if hit[row] != 0.0 and switch[row] == 0.0 and strike(row, t, x, v, params, work):
                struck = True
        if not struck:
            break
    for row in range(now.size):
        hit[row] = 0.0
