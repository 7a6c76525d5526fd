"""Parts of steps that are cut elsewhere, for states between them: see `cuts`."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import unbound
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.cuts import note_closed
from kickdrift.engine.flows.error_control import saved
from kickdrift.engine.flows.resting import FREE_V, FREE_X
from kickdrift.engine.flows.surfaces import BEFORE, HIT, NOW, RESTING, RESTS, SWITCH, TOUCHES, row_of, size_of

Floats = NDArray[np.float64]

keep_state: Callable[..., None] = unbound
find_gaps: Callable[..., float] = unbound
find_sides: Callable[..., None] = unbound
hold_on: Callable[..., None] = unbound
settle: Callable[..., None] = unbound


def begin_between(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Prepare a part of a step from a state: the sides of switches, and which gaps are at rest."""
    keep_state(t, h, x, v, params, work)
    find_sides(t, h, x, v, params, work)
    settle(t, h, x, v, work)
    assign(row_of(BEFORE, work), row_of(NOW, work))


def end_between(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """End a part of a step as steps between impacts end: gaps that touched at its start and closed are at rest."""
    n, hit = x.size, row_of(HIT, work)
    assign(saved(n, FREE_X, n, work), x)
    assign(saved(n, FREE_V, v.size, work), v)
    for _ in range(hit.size + 1):
        hold_on(t, h, x, v, work)
        find_gaps(t, x, v, work)
        touches, more = TOUCHES * size_of(x, work), False
        note_closed(-touches, work)
        for row in range(hit.size):
            if hit[row] != 0.0 and row_of(SWITCH, work)[row] == 0.0 and row_of(BEFORE, work)[row] <= touches:
                row_of(RESTING, work)[row], more = RESTS, True
        if not more:
            break
        assign(x, saved(n, FREE_X, n, work))
        assign(v, saved(n, FREE_V, v.size, work))
