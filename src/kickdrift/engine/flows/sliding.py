"""Friction of bodies on surfaces: sticking, sliding, and reversals of the slip.

Templates. By Coulomb's law friction reduces the displacement along a surface as far as the impulses at the start of a step
allow, and the speed at the end as far as their sum allows, see `resting`. So sticking bodies do not move. On bodies that
slide at the start, friction acts against their velocities at both ends, which is of second order on curved paths, and as if
they kept sliding even where that reverses the slip: there the step is cut, see `cuts`. Where impacts are not located no step
is cut, and friction stops bodies where it can.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.engine.flows.error_control import saved
from kickdrift.engine.flows.layout import FIRST_STEP, own_params
from kickdrift.engine.flows.surfaces import (
    BODY_SIZE,
    FRICTION,
    IMPULSE,
    LIST,
    LISTED,
    LOCATED,
    RESTING,
    RESTS,
    SLIDES,
    SLIP,
    TOUCHES,
    USED,
    gradient,
    inverse_masses,
    list_one,
    row_of,
    size_of,
)

Floats = NDArray[np.float64]

find_gradients: Callable[..., None] = unbound


@compiled
def along(k: int, a: Floats, b: Floats, work: Floats) -> float:
    """Return the scalar product of the tangential parts of two velocities at a listed gap."""
    slopes, total, size = gradient(k, a.size, work), 0.0, int(own_params(work)[BODY_SIZE])
    for first in range(0, a.size, size):
        length, across_a, across_b = 0.0, 0.0, 0.0
        for i in range(first, first + size):
            length += slopes[i] * slopes[i]
            across_a += slopes[i] * a[i]
            across_b += slopes[i] * b[i]
        # The difference of the products would round to a slip of 1e-8 of the speed of a surface that moves.
        if length > 0.0:
            for i in range(first, first + size):
                total += (a[i] - across_a * slopes[i] / length) * (b[i] - across_b * slopes[i] / length)
    return total


@compiled
def find_sliding(x: Floats, work: Floats) -> None:
    """Note the slip speeds of the listed gaps at the start of a step that can be cut: zero for those that stick.

    Which do must not depend on the size that is tried, or the slip that it was chosen by is not found at its end.
    """
    own, slides, row, start = own_params(work), row_of(SLIDES, work), row_of(LIST, work), saved(x.size, 1, x.size, work)
    for k in range(int(own[LISTED])):
        slides[k] = 0.0
        if own[LOCATED] != 0.0 and row_of(FRICTION, work)[int(row[k])] > 0.0:
            speed = math.sqrt(max(along(k, start, start, work), 0.0))
            slides[k] = speed if speed * abs(work[FIRST_STEP]) > TOUCHES * size_of(x, work) else 0.0


@compiled
def least_slip(v: Floats, work: Floats) -> float:
    """Write the slip of each at the end of a step, negative if it has reversed, and return the smallest."""
    slides, row, slip = row_of(SLIDES, work), row_of(LIST, work), row_of(SLIP, work)
    start, least = saved(v.size, 1, v.size, work), math.inf
    for i in range(slip.size):
        slip[i] = math.inf
    for k in range(int(own_params(work)[LISTED])):
        i = int(row[k])
        if slides[k] > 0.0 and row_of(RESTING, work)[i] == RESTS:
            slip[i] = along(k, v, start, work) / slides[k] * abs(work[FIRST_STEP])
            least = min(least, slip[i])
    return least


@compiled
def least_slip_at_start(work: Floats) -> float:
    """Return the smallest slip at the start of the step."""
    slides, least = row_of(SLIDES, work), math.inf
    for k in range(int(own_params(work)[LISTED])):
        if slides[k] > 0.0:
            least = min(least, slides[k] * abs(work[FIRST_STEP]))
    return least


def stop_slip(row: int, t: float, x: Floats, v: Floats, work: Floats) -> None:
    """Remove the rounding errors of a slip that has reached zero."""
    n, size = x.size, int(own_params(work)[BODY_SIZE])
    start, slopes = saved(n, 1, n, work), gradient(0, n, work)
    list_one(row, work)
    find_gradients(t, x, v, work)
    square = along(0, start, start, work)
    share = along(0, v, start, work) / square if square > 0.0 else 0.0
    for first in range(0, n, size):
        length, across = 0.0, 0.0
        for i in range(first, first + size):
            length += slopes[i] * slopes[i]
            across += slopes[i] * start[i]
        if length > 0.0:
            for i in range(first, first + size):
                v[i] -= share * (start[i] - across * slopes[i] / length)


@compiled
def rub_listed(h: float, way: Floats, velocity: Floats, work: Floats) -> float:
    """Reduce the tangential velocities by friction, as far as the impulses allow, and return the largest change.

    Sliding bodies lose it against their given velocity; sticking bodies lose no more than they have.
    """
    n, friction, impulse, used = way.size, row_of(FRICTION, work), row_of(IMPULSE, work), row_of(USED, work)
    row, inverse, largest, slides = row_of(LIST, work), inverse_masses(n, work), 0.0, row_of(SLIDES, work)
    start = saved(n, 1, n, work)
    size = int(own_params(work)[BODY_SIZE])
    for k in range(int(own_params(work)[LISTED])):
        rough = friction[int(row[k])]
        if rough == 0.0:
            continue
        slopes = gradient(k, n, work)
        for first in range(0, n, size):
            against = velocity if slides[k] > 0.0 else way
            length, across, far, onward = 0.0, 0.0, 0.0, 0.0
            for i in range(first, first + size):
                length += slopes[i] * slopes[i]
                across += slopes[i] * against[i]
            if length == 0.0:
                continue
            for i in range(first, first + size):
                far += (against[i] - across * slopes[i] / length) ** 2
                onward += (against[i] - across * slopes[i] / length) * start[i]
            far = math.sqrt(far)
            allowed = rough * impulse[k] * math.sqrt(length) * inverse[first] * h - used[k]
            if far > 0.0 and allowed > 0.0:
                share = allowed / far
                if slides[k] == 0.0:
                    share = min(1.0, share)
                used[k] += share * far
                largest = max(largest, share * far)
                if slides[k] > 0.0 and onward < 0.0:
                    share = -share
                for i in range(first, first + size):
                    way[i] -= share * (against[i] - across * slopes[i] / length)
    return largest
