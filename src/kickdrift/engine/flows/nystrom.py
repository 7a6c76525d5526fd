"""Gravity integrated to a tolerance, by the Runge-Kutta-Nystroem method of order 12 with an estimate of order 10.

The step is a share of the time scale of the fastest pair, tau^-2 = max (Gm / d^3 + u^2 / d^2), and the estimated error moves
that share, which varies much less than the time scale does. Errors of pairs are measured by their distances.

Each acceleration is added at once to all sums that it is part of: to the stages after it, to both sums of the step and to both
of its error. They lie side by side, a row of whole cache lines for each number of the state.

Layout of the room, for n numbers::

    0         the sums (n rows)
    ...       position and velocity, to be advanced, and the same after a step; position and acceleration of a stage (n each)
"""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.views import part
from kickdrift.engine.flows.mergers import deepest, find_contact, gap
from kickdrift.methods.nystrom import DORMAND_12
from kickdrift.systems.gravity import add_gravity_pairwise

Floats = NDArray[np.float64]

STAGES = DORMAND_12.c.size
_LINE = 8  # numbers
_X, _V, _ERROR, _ERROR_OF_V = range(STAGES, STAGES + 4)  # of the sums, after those of the stages
_SUMS = -(-(STAGES + 4) // _LINE) * _LINE
ROOM = _SUMS + 6
"""Numbers of room for each component of the state."""

_NODES = DORMAND_12.c
_TABLE = np.zeros((STAGES, _SUMS))
_TABLE[:, :STAGES] = DORMAND_12.a.T
_TABLE[:, [_X, _V, _ERROR, _ERROR_OF_V]] = np.transpose(
    [DORMAND_12.b, DORMAND_12.b_of_v, DORMAND_12.error, DORMAND_12.error_of_v]
)
_WEIGHTS = _TABLE.ravel()
_EXPONENT = -1.0 / (DORMAND_12.error_order + 1)
_SAFETY, _LEAST, _MOST = 0.85, 0.2, 4.0
_FIRST = 0.5  # fraction of the time scale: errors of about 1e-10
_SHORTEST = 1e-13  # of the whole step: two bodies are at one place
_MOST_TRIES = 60


@compiled(cached=False, inline=True)
def vector(room: Floats, index: int, n: int) -> Floats:
    """Return position, velocity, both after a step, position or acceleration of a stage."""
    return part(room, (_SUMS + index) * n, n)


@compiled(cached=False)
def integrate(
    h: float, tolerance: float, masses: Floats, radii: Floats, touching: bool, room: Floats
) -> tuple[int, float, int, int]:
    """Advance position and velocity in the room by h, or until two bodies touch.

    Parameters
    ----------
    masses : array
        0, and Gm of each body.
    radii : array
        Of each, where they are `touching`.

    Returns
    -------
    steps : int
        Number of steps tried.
    left : float
        The rest of h: 0, or the time after a contact, or after a step that fails at any size.
    one, other : int
        The bodies that touch, -1 for none.
    """
    n = 3 * (masses.size - 1)
    x, v, new_x, new_v = vector(room, 0, n), vector(room, 1, n), vector(room, 2, n), vector(room, 3, n)
    whole, done, share, steps = abs(h), 0.0, _FIRST, 0
    scale = time_scale(x, v, masses)
    while done < whole:
        left = whole - done
        size = share * scale
        last = size >= left
        if last:
            size = left
        elif size > 0.5 * left:
            size = 0.5 * left
        if not size > _SHORTEST * whole:
            break
        take_step(math.copysign(size, h), masses, room)
        steps += 1
        error = largest_error(size, x, masses, room) / tolerance
        if error <= 1.0:
            one = other = -1
            if touching:
                cut, tries, one, other = step_to_contact(math.copysign(size, h), masses, radii, room)
                last, size, steps = last and cut == size, cut, steps + tries
            for k in range(n):
                x[k], v[k] = new_x[k], new_v[k]
            done = whole if last else done + size
            if one >= 0:
                return steps, math.copysign(whole - done, h), one, other
            share = max(size, _SHORTEST * whole) / scale * min(_SAFETY * max(error, 1e-10) ** _EXPONENT, _MOST)
            scale = time_scale(x, v, masses)
        elif error < math.inf:
            share = size / scale * max(_SAFETY * error**_EXPONENT, _LEAST)
        else:
            share = size / scale * _LEAST
    return steps, math.copysign(whole - done, h), -1, -1


@compiled(cached=False)
def step_to_contact(h: float, masses: Floats, radii: Floats, room: Floats) -> tuple[float, int, int, int]:
    """Repeat a step up to the contact of two bodies.

    Returns
    -------
    size : float
        The size of the step, unchanged if none come close.
    steps : int
        Number of steps tried.
    one, other : int
        The bodies that touch, -1 for none.
    """
    n = 3 * (masses.size - 1)
    x, v, new_x, new_v = vector(room, 0, n), vector(room, 1, n), vector(room, 2, n), vector(room, 3, n)
    share, one, other = find_contact(h, radii, x, v, new_x, new_v)
    if one < 0:
        return abs(h), 0, one, other
    steps, low, high = 0, 0.0, share
    if share < 1.0:
        take_step(share * h, masses, room)
        steps = 1
    if gap(radii, one, other, new_x) > 0.0:
        return abs(share * h), steps, -1, -1  # the shortest distance, without contact
    found, earlier = one, other
    while found >= 0:
        one, other, low = found, earlier, 0.0
        apart, through = max(gap(radii, one, other, x), 0.0), gap(radii, one, other, new_x)
        while steps < _MOST_TRIES and high - low > _SHORTEST and through < -_SHORTEST * radii[one]:
            middle = 0.5 * (low + high)
            if steps % 3 != 2:  # the Illinois algorithm
                middle = (low * through - high * apart) / (through - apart)
            take_step(middle * h, masses, room)
            steps += 1
            now = gap(radii, one, other, new_x)
            if now > 0.0:
                low, apart = middle, now
            else:
                high, through = middle, now
        take_step(high * h, masses, room)
        steps += 1
        found, earlier = deepest(radii, one, other, x, new_x) if steps < _MOST_TRIES else (-1, -1)
    return abs(high * h), steps, one, other


@compiled(cached=False, fast=True)
def time_scale(x: Floats, v: Floats, masses: Floats) -> float:
    """Return the time scale of the fastest pair."""
    fastest = 0.0
    for i in range(1, masses.size - 1):
        for j in range(i):
            d2 = u2 = 0.0
            for k in range(3):
                d2 += (x[3 * j + k] - x[3 * i + k]) ** 2
                u2 += (v[3 * j + k] - v[3 * i + k]) ** 2
            fastest = max(fastest, ((masses[1 + i] + masses[1 + j]) / math.sqrt(d2) + u2) / d2)
    return 1.0 / math.sqrt(fastest)


@compiled(cached=False, fast=True)
def take_step(h: float, masses: Floats, room: Floats) -> None:
    """Do a step, and write the result beside the initial state."""
    n, h2 = 3 * (masses.size - 1), h * h
    x, v, new_x, new_v = vector(room, 0, n), vector(room, 1, n), vector(room, 2, n), vector(room, 3, n)
    stage, rate = vector(room, 4, n), vector(room, 5, n)
    for k in range(_SUMS * n):
        room[k] = 0.0
    for i in range(STAGES):
        for k in range(n):
            stage[k] = x[k] + (_NODES[i] * h * v[k] + h2 * room[_SUMS * k + i])
            rate[k] = 0.0
        add_gravity_pairwise(1.0, stage, masses, rate)
        for k in range(n):
            for start in range((i + 1) // _LINE * _LINE, _SUMS, _LINE):
                sums = part(room, _SUMS * k + start, _LINE)
                for q in range(_LINE):
                    sums[q] += rate[k] * _WEIGHTS[_SUMS * i + start + q]
    for k in range(n):
        new_x[k] = x[k] + (h * v[k] + h2 * room[_SUMS * k + _X])
        new_v[k] = v[k] + h * room[_SUMS * k + _V]


@compiled(cached=False, fast=True)
def largest_error(h: float, x: Floats, masses: Floats, room: Floats) -> float:
    """Return the largest estimated error of a distance between two bodies, relative to it."""
    worst = 0.0
    for i in range(1, masses.size - 1):
        for j in range(i):
            d2 = e2 = 0.0
            for k in range(3):
                one, other = _SUMS * (3 * i + k), _SUMS * (3 * j + k)
                d2 += (x[3 * j + k] - x[3 * i + k]) ** 2
                e2 += (room[other + _ERROR] - room[one + _ERROR]) ** 2
                e2 += (room[other + _ERROR_OF_V] - room[one + _ERROR_OF_V]) ** 2
            if not e2 <= worst * d2:
                worst = e2 / d2  # or NaN
    return h * h * math.sqrt(worst)
