"""Where bodies leave surfaces because forces no longer press them on: steps are cut there, see `cuts`.

Templates. The push is minus the second derivative of a gap that the forces at the end of a step would cause. Where it has
become negative in a step, the step is cut at its zero, and the next one lets go of the surface from its start, see `resting`.
Of bodies that hold each other the push of each gap leaves out the impulses of the others: such cuts change no motion.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.layout import END, EVALUATIONS, FIRST_STEP, own_params
from kickdrift.engine.flows.surfaces import (
    FLIES,
    LOCATED,
    PUSH,
    PUSH_BEFORE,
    RESTING,
    RESTS,
    ROUNDS,
    START,
    TOUCHES,
    params_of_gaps,
    place,
    room_of_accelerations,
    room_of_gaps,
    row_of,
    size_of,
    something_rests,
)

Floats = NDArray[np.float64]

acceleration_at: Callable[..., None] = unbound
gaps_at: Callable[..., None] = unbound

_AHEAD = 0.0625  # of a step: interval of the differences


def find_pushes(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Write the push on each gap at rest, as a length over a step, by a force evaluation; 0 for the others.

    Differences of fourth order, at times within the run, since tables may end with it: of third order at its ends.
    """
    n, own, push, resting = x.size, own_params(work), row_of(PUSH, work), row_of(RESTING, work)
    a, there, room = room_of_accelerations(n, work), place(n, work), room_of_gaps(n, work)
    assign(push, 0.0)
    if own[LOCATED] == 0.0 or not something_rests(work):
        return
    acceleration_at(t, x, v, params, work, a)
    work[EVALUATIONS] += 1.0
    span = _AHEAD * abs(work[FIRST_STEP])
    ahead = 1.0 if t - 2.0 * span < own[START] else -1.0 if t + 2.0 * span > work[END] else 0.0
    for point in range(5):
        if ahead == 0.0:
            at = point - 2.0
            weight = -30.0 if point == 2 else 16.0 if abs(at) == 1.0 else -1.0
        else:
            at = ahead * point
            weight = 35.0 if point == 0 else -104.0 if point == 1 else 114.0 if point == 2 else -56.0
            weight = 11.0 if point == 4 else weight
        s = at * span
        for i in range(n):
            there[i] = x[i] + s * (v[i] + 0.5 * s * a[i])
        gaps_at(t + s, there, v, params_of_gaps(n, work), work, room)
        for row in range(push.size):
            if resting[row] != FLIES:
                push[row] -= weight * room[row] / (12.0 * _AHEAD * _AHEAD)


@compiled
def least_push(at: int, x: Floats, work: Floats) -> float:
    """Return the least push, at the end of a step or before it, on the gaps that were pressed together before it."""
    before, push, least = row_of(PUSH_BEFORE, work), row_of(at, work), math.inf
    pressed = TOUCHES * size_of(x, work)
    for row in range(push.size):
        if before[row] > pressed:
            least = min(least, push[row])
    return least if least < -pressed or own_params(work)[ROUNDS] > 0.0 else abs(least)


@compiled
def note_pushes(work: Floats) -> None:
    """Keep the pushes on what rests at the end of a step, for the next one."""
    before, push, resting = row_of(PUSH_BEFORE, work), row_of(PUSH, work), row_of(RESTING, work)
    for row in range(push.size):
        before[row] = push[row] if resting[row] == RESTS else 0.0


@compiled
def rests_newly(work: Floats) -> bool:
    """Whether something rests of which the push is not known."""
    before, resting, some = row_of(PUSH_BEFORE, work), row_of(RESTING, work), False
    for row in range(before.size):
        some = some or (resting[row] == RESTS and before[row] == 0.0)
    return some
