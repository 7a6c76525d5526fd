"""Bodies that rest on surfaces or slide along them: projection of the steps of any method onto surfaces, and release.

Templates. RATTLE (H. C. Andersen, J. Comput. Phys. 52, 24 (1983)) with one-sided constraints, around the letters of a step.
Impulses p along the gradients J at the start of the step would change its final positions by ``h M^-1 J^T p`` and velocities by
``M^-1 J^T p``; p is chosen such that the positions are on the surfaces. Further impulses along the gradients at the end remove
the normal velocities. The sum of both must not pull: if it would be negative, it is zero, and the body leaves the surface.
This is of order 2, for any method; with a symmetric one, energy is conserved as by RATTLE.
Friction acts with both, see `sliding`.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.error_control import saved
from kickdrift.engine.flows.layout import CROWDED, NOT_HELD, TROUBLE, UNSIGNED_GAP, own_params
from kickdrift.engine.flows.sliding import find_sliding, rub_listed
from kickdrift.engine.flows.surfaces import (
    FLIES,
    IMPULSE,
    LEAVES,
    LEFT,
    LIST,
    LISTED,
    MOST_LISTED,
    NOW,
    OPENS,
    RATE,
    RESTING,
    RESTS,
    SQUARE,
    SWITCH,
    TOUCHES,
    USED,
    gradient,
    inverse_masses,
    list_one,
    params_of_gaps,
    place,
    room_of_gaps,
    row_of,
    size_of,
)

Floats = NDArray[np.float64]

gaps_at: Callable[..., None] = unbound
find_gradients: Callable[..., None] = unbound
find_gaps: Callable[..., float] = unbound
has_no_other_side: Callable[..., bool] = unbound
reach: Callable[..., None] = unbound
hold_listed: Callable[..., None] = unbound

_ROUNDS = 20  # iterations of Newton's method, and of normal impulses and friction alternately
_SWEEPS = 1000  # of Gauss and Seidel over the gaps
_FLAT = 1e-3  # a gradient that is as small where a gap closes is looked at: that of abs(x) is 0 at 0, by differences
_STILL = 1e-9  # of the terms in the speed of a gap
_ROUNDING = 2.220446049250313e-16
FREE_X, FREE_V = 4, 5  # vectors of control: the end of the step without projection


def find_resting(t: float, h: float, x: Floats, v: Floats, work: Floats) -> None:
    """Bring contacts to rest whose normal motion in a step is within the tolerance; note the opening speeds of the others."""
    resting, switch, now, opens = row_of(RESTING, work), row_of(SWITCH, work), row_of(NOW, work), row_of(OPENS, work)
    touches = TOUCHES * size_of(x, work)
    for row in range(now.size):
        opens[row] = 0.0
        if resting[row] == FLIES and switch[row] == 0.0 and abs(now[row]) <= touches:
            list_one(row, work)
            find_gradients(t, x, v, work)
            speed, still = speed_of(0, v, work)[0], still_speed(0, h, x, v, work)
            if steepest(0, x.size, work) < _FLAT and has_no_other_side(row, t, x, v, work):
                work[TROUBLE] = UNSIGNED_GAP
            if abs(speed) <= still:
                resting[row] = RESTS
            else:
                opens[row] = speed


@compiled
def steepest(k: int, n: int, work: Floats) -> float:
    """Return the largest component of the gradient of a listed gap."""
    slopes, most = gradient(k, n, work), 0.0
    for i in range(n):
        most = max(most, abs(slopes[i]))
    return most


@compiled
def speed_of(k: int, v: Floats, work: Floats) -> tuple[float, float]:
    """Return the opening speed of a listed gap, and the sum of its terms' sizes."""
    rate, slopes = row_of(RATE, work)[k], gradient(k, v.size, work)
    speed, size = rate, abs(rate)
    for i in range(v.size):
        speed += slopes[i] * v[i]
        size += abs(slopes[i] * v[i])
    return speed, size


@compiled
def still_speed(k: int, h: float, x: Floats, v: Floats, work: Floats) -> float:
    """Return the tolerance for the speed of a listed gap at rest: rounding, or the tolerance of contact over a step."""
    return max(_STILL * speed_of(k, v, work)[1], TOUCHES * size_of(x, work) / abs(h))


@compiled
def list_resting(leaving: float, work: Floats) -> int:
    """List the gaps at rest, with or without those that are about to open, and return their number."""
    own, row, resting = own_params(work), row_of(LIST, work), row_of(RESTING, work)
    listed = 0
    for i in range(resting.size):
        if resting[i] == RESTS or resting[i] == leaving:
            if listed == int(own[MOST_LISTED]):  # more than twice the degrees of freedom
                work[TROUBLE] = CROWDED
                break
            row[listed] = i
            listed += 1
    own[LISTED] = listed
    return listed


def hold(t: float, h: float, x: Floats, v: Floats, work: Floats) -> None:
    """Project the end of a step back onto the surfaces of gaps at rest, except those that open, which are marked."""
    n, resting, now = x.size, row_of(RESTING, work), row_of(NOW, work)
    if list_resting(LEAVES, work) == 0:
        return
    assign(saved(n, FREE_X, n, work), x)
    assign(saved(n, FREE_V, n, work), v)
    hold_listed(t, h, x, v, work)
    leaves, closes = False, False
    for row in range(resting.size):
        leaves = leaves or resting[row] == LEAVES
    if leaves:
        assign(x, saved(n, FREE_X, n, work))
        assign(v, saved(n, FREE_V, n, work))
        if list_resting(RESTS, work) > 0:
            hold_listed(t, h, x, v, work)
        find_gaps(t, x, v, work)
        for row in range(resting.size):
            closes = closes or (resting[row] == LEAVES and now[row] < 0.0)
    if closes:  # it leaves the surface in the next step
        assign(x, saved(n, FREE_X, n, work))
        assign(v, saved(n, FREE_V, n, work))
        list_resting(LEAVES, work)
        hold_listed(t, h, x, v, work)


def hold_to_surfaces(t: float, h: float, x: Floats, v: Floats, work: Floats) -> None:
    """Project a step onto the listed surfaces."""
    n, listed = x.size, int(own_params(work)[LISTED])
    impulse, used, square = row_of(IMPULSE, work), row_of(USED, work), row_of(SQUARE, work)
    find_gradients(t - h, saved(n, 0, n, work), v, work)
    find_sliding(x, work)
    for k in range(listed):
        impulse[k] = used[k] = 0.0
    reach(t, h, x, v, work)
    for k in range(listed):
        impulse[k] *= math.sqrt(square[k])
        used[k] /= h
    find_gradients(t, x, v, work)
    for k in range(listed):
        impulse[k] /= math.sqrt(square[k]) if square[k] > 0.0 else 1.0
    keep_along(v, work)
    resting, row = row_of(RESTING, work), row_of(LIST, work)
    for k in range(listed):
        opens = speed_of(k, v, work)[0] > still_speed(k, h, x, v, work)
        resting[int(row[k])] = LEAVES if impulse[k] <= 0.0 and opens else RESTS
    forget_roundings(x, v, work)


def reach_surfaces(t: float, h: float, x: Floats, v: Floats, work: Floats) -> None:
    """Find the impulses at the start for which a step ends on the surfaces, with the corresponding friction."""
    n, room, left, row = x.size, room_of_gaps(x.size, work), row_of(LEFT, work), row_of(LIST, work)
    listed, way, begin = int(own_params(work)[LISTED]), place(n, work), saved(n, 0, n, work)
    size, moved = size_of(x, work), 0.0
    for _ in range(_ROUNDS):
        gaps_at(t, x, v, params_of_gaps(n, work), work, room)
        for k in range(listed):
            left[k] = -room[int(row[k])] / h
        balance(0.25 * _ROUNDING * size / h, way, work)
        moved = 0.0
        for i in range(n):
            x[i] += h * way[i]
            v[i] += way[i]
            moved = max(moved, abs(h * way[i]))
        for i in range(n):
            way[i] = x[i] - begin[i]
        rubbed = rub_listed(h, way, saved(n, 1, n, work), work)
        if rubbed > 0.0:
            for i in range(n):
                v[i] += (way[i] - (x[i] - begin[i])) / h
                x[i] = begin[i] + way[i]
        if max(moved, rubbed) <= 4.0 * _ROUNDING * size:
            return
    if not moved <= TOUCHES * size:
        work[TROUBLE] = NOT_HELD


@compiled
def balance(least: float, change: Floats, work: Floats) -> None:
    """Find the impulses that remove the remaining speeds of the listed gaps, and write the change of the velocities."""
    n, left, square, impulse = change.size, row_of(LEFT, work), row_of(SQUARE, work), row_of(IMPULSE, work)
    listed, inverse = int(own_params(work)[LISTED]), inverse_masses(n, work)
    for i in range(n):
        change[i] = 0.0
    for _ in range(_SWEEPS):
        largest = 0.0
        for k in range(listed):
            if square[k] == 0.0:
                continue
            slopes, lacking = gradient(k, n, work), left[k]
            for i in range(n):
                lacking -= slopes[i] * change[i]
            lacking /= square[k]
            impulse[k] += lacking
            for i in range(n):
                change[i] += lacking * slopes[i] * inverse[i]
                largest = max(largest, abs(lacking * slopes[i] * inverse[i]))
        if listed == 1 or largest <= least:
            break


@compiled
def keep_along(v: Floats, work: Floats) -> None:
    """Remove the normal velocities at the surfaces by impulses whose sum pushes, and apply friction."""
    n, square, impulse = v.size, row_of(SQUARE, work), row_of(IMPULSE, work)
    listed, inverse = int(own_params(work)[LISTED]), inverse_masses(n, work)
    for _ in range(_ROUNDS):
        for _ in range(_SWEEPS):
            still = True
            for k in range(listed):
                if square[k] == 0.0:
                    continue
                speed, size = speed_of(k, v, work)
                given = max(impulse[k] - speed / square[k], 0.0) - impulse[k]
                impulse[k] += given
                slopes = gradient(k, n, work)
                for i in range(n):
                    v[i] += given * slopes[i] * inverse[i]
                still = still and abs(given) * square[k] <= 8.0 * _ROUNDING * (size + impulse[k] * square[k])
            if still or listed == 1:
                break
        largest = 0.0
        for i in range(n):
            largest = max(largest, abs(v[i]))
        if rub_listed(1.0, v, v, work) <= 4.0 * _ROUNDING * largest:
            break


@compiled
def forget_roundings(x: Floats, v: Floats, work: Floats) -> None:
    """Make positions that do not change, and velocities that vanish, exact: rounding errors would let them wander."""
    n = x.size
    begin, free_x, free_v = saved(n, 0, n, work), saved(n, FREE_X, n, work), saved(n, FREE_V, n, work)
    moved, kicked = 0.0, 0.0
    for i in range(n):
        moved, kicked = max(moved, abs(x[i] - free_x[i])), max(kicked, abs(v[i] - free_v[i]))
    for i in range(n):
        if x[i] != free_x[i] and abs(x[i] - begin[i]) <= min(8.0 * _ROUNDING * abs(x[i]), 1e-6 * moved):
            x[i] = begin[i]
            work[n + i] = saved(n, 2, 2 * n, work)[i]
        if v[i] != free_v[i] and abs(v[i]) <= 8.0 * _ROUNDING * kicked:
            v[i] = work[2 * n + i] = 0.0


@compiled
def let_go(work: Floats) -> None:
    """Release the bodies that leave their surfaces."""
    resting = row_of(RESTING, work)
    for row in range(resting.size):
        if resting[row] == LEAVES:
            resting[row] = FLIES
