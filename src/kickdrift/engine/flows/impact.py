"""Impacts: the change of velocity where a gap closes; and the crossing of switches.

Templates. Newton's law of restitution and Coulomb's of friction,

    v += M^-1 J^T p,   p = -(1 + e) J v / (J M^-1 J^T),   with a tangential impulse of at most mu p,

where J is the gradient of the gap. A rebound whose flight would be shorter than a thousandth of a step does not happen: the
body rests, see `resting`.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.error_control import saved
from kickdrift.engine.flows.layout import END, EVALUATIONS, FIRST_STEP, VELOCITY, has_part, own_params
from kickdrift.engine.flows.resting import FREE_V, FREE_X, speed_of
from kickdrift.engine.flows.surfaces import (
    BODY_SIZE,
    FLIES,
    FRICTION,
    HIT,
    LOCATED,
    NOW,
    RESTING,
    RESTITUTION,
    RESTS,
    SIDE,
    SQUARE,
    SWITCH,
    TOUCHES,
    gradient,
    inverse_masses,
    list_one,
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
find_gaps: Callable[..., float] = unbound
find_gradients: Callable[..., None] = unbound
pull_to: Callable[..., float] = unbound
put_back: Callable[..., None] = unbound
strike: Callable[..., bool] = unbound

REST = 1e-3  # of a step: after shorter flights a body is at rest
_MOMENT, _DOUBLINGS = 1e-16, 24  # the shortest time to cross a switch, in steps, and how often it is doubled
_ROUNDS = 200  # of successive impacts at one time
_AHEAD = 0.125  # of a step: interval of the second difference that gives the acceleration of a gap


def move_to_surface(row: int, t: float, x: Floats, v: Floats, work: Floats) -> None:
    """Move positions beyond a surface back onto it, by the shortest way."""
    n, slopes, inverse = x.size, gradient(0, x.size, work), inverse_masses(x.size, work)
    list_one(row, work)
    for _ in range(3):
        find_gradients(t, x, v, work)
        square = row_of(SQUARE, work)[0]
        gaps_at(t, x, v, params_of_gaps(n, work), work, room_of_gaps(n, work))
        gap = room_of_gaps(n, work)[row]
        if gap == 0.0 or square == 0.0:
            return
        for i in range(n):
            x[i] -= gap * slopes[i] * inverse[i] / square


def accelerate_gap(
    row: int, speed: float, square: float, t: float, x: Floats, v: Floats, params: Floats, work: Floats
) -> float:
    """Return the second derivative of a gap for motion along its surface, due to forces, curvature and the surface's motion."""
    n, slopes, inverse = x.size, gradient(0, x.size, work), inverse_masses(x.size, work)
    a, there, room = room_of_accelerations(n, work), place(n, work), room_of_gaps(n, work)
    acceleration_at(t, x, v, params, work, a)
    work[EVALUATIONS] += 1.0
    span, total = _AHEAD * abs(work[FIRST_STEP]), 0.0
    if t + 2.0 * span > work[END]:
        span = -span
    for point in range(3):
        s = point * span
        for i in range(n):
            there[i] = x[i] + s * (v[i] - speed * slopes[i] * inverse[i] / square + 0.5 * s * a[i])
        gaps_at(t + s, there, v, params_of_gaps(n, work), work, room)
        total += -2.0 * room[row] if point == 1 else room[row]
    return float(total / (span * span))


def give_impulse(row: int, t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Apply the rebound of a row that is closing, or bring it to rest; return whether it was closing."""
    n, located = x.size, is_located(work)
    list_one(row, work)
    find_gradients(t, x, v, work)
    square, slopes, inverse = row_of(SQUARE, work)[0], gradient(0, n, work), inverse_masses(n, work)
    speed, size = speed_of(0, v, work)
    if square == 0.0:
        return False
    now = row_of(NOW, work)
    if located and abs(now[row]) <= TOUCHES * size_of(x, work):
        for i in range(n):  # otherwise a contact slightly beyond its surface closes again by rounding
            x[i] -= now[row] * slopes[i] * inverse[i] / square
        now[row] = 0.0
    if not speed < -1e-14 * size:
        return False
    pull = pull_to(row, speed, square, t, x, v, params, work)
    restitution, rests = row_of(RESTITUTION, work)[row], row_of(RESTING, work)
    flight, share = (-2.0 * restitution * speed, REST) if located else (-2.0 * speed, 2.0)
    rests[row] = FLIES
    if pull < 0.0 and flight <= -pull * share * abs(work[FIRST_STEP]):
        restitution = 0.0
        rests[row] = RESTS
    rub(row, square, speed, (1.0 + restitution) * -speed, v, work)
    for i in range(n):
        v[i] -= (1.0 + restitution) * speed * slopes[i] * inverse[i] / square
    return True


@compiled
def is_located(work: Floats) -> bool:
    """Whether impacts are located in time."""
    return bool(own_params(work)[LOCATED] != 0.0)


@compiled
def rub(row: int, square: float, speed: float, change: float, v: Floats, work: Floats) -> None:
    """Reduce the tangential velocity by at most friction times the `change` of the closing speed."""
    n, friction, size = v.size, row_of(FRICTION, work)[row], int(own_params(work)[BODY_SIZE])
    if friction == 0.0:
        return
    slopes, inverse = gradient(0, n, work), inverse_masses(n, work)
    for first in range(0, n, size):
        length, closing, slip = 0.0, 0.0, 0.0
        for i in range(first, first + size):
            length += slopes[i] * slopes[i]
            closing += slopes[i] * v[i]
        if length == 0.0:
            continue
        for i in range(first, first + size):
            slip += (v[i] - closing * slopes[i] / length) ** 2
        slip = math.sqrt(slip)
        if slip > 0.0:
            taken = min(1.0, friction * change * inverse[first] * math.sqrt(length) / square / slip)
            for i in range(first, first + size):
                v[i] -= taken * (v[i] - closing * slopes[i] / length)


def cross_switch(row: int, t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Move a state at a switch to its other side, by the shortest time that floats resolve.

    The step before has seen one law to its end, and the next one sees the other from its start. A state that the motion does
    not bring there is not changed: the switch itself moves on, as one that depends on time alone does.
    """
    n, side, now = x.size, row_of(SIDE, work), row_of(NOW, work)
    rate, a = place(n, work), room_of_accelerations(n, work)
    if has_part(VELOCITY, work):
        velocity_at(t, x, v, params, work, rate)
    else:
        assign(rate, v)
    if v.size > 0:
        acceleration_at(t, x, v, params, work, a)
    work[EVALUATIONS] += 1.0
    first_x, first_v = saved(n, FREE_X, n, work), saved(n, FREE_V, v.size, work)
    assign(first_x, x)
    assign(first_v, v)
    moment = _MOMENT * work[FIRST_STEP]
    for _ in range(_DOUBLINGS):
        if now[row] < 0.0:
            break
        for i in range(n):
            x[i] += moment * rate[i]
        for i in range(v.size):
            v[i] += moment * a[i]
        moment *= 2.0
        find_gaps(t, x, v, work)
    if not now[row] < 0.0:
        assign(x, first_x)
        assign(v, first_v)
        find_gaps(t, x, v, work)
    side[row], now[row] = -side[row], -now[row]


def strike_rows(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Apply rebounds one after the other where bodies touch and approach, until none does."""
    own, now, hit, switch = own_params(work), row_of(NOW, work), row_of(HIT, work), row_of(SWITCH, work)
    touches = TOUCHES * size_of(x, work)
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
