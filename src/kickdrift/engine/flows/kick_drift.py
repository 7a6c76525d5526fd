"""Kicks and drifts.

The functions here are templates: their global names ``acceleration_at``, ``velocity_at``, ``add_to_x`` and ``add_to_v``
are bound by `kickdrift.engine.letters` to a system's functions and to plain or compensated sums.
"""

from collections.abc import Callable

import numpy as np
from numba import carray
from numpy.typing import NDArray

from kickdrift.core.compilation import unbound
from kickdrift.core.memory import floats_on_stack

Floats = NDArray[np.float64]

acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound
SIZE = 0


def kick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h under the acceleration at (t, x, v)."""
    a = work[: x.size]
    acceleration_at(t, x, v, params, work, a)
    add_to_v(v, h, a, work)


def kick_small(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Do the same as `kick` for a state of SIZE numbers, known at compile time.

    The accelerations pass in registers: through memory, where v could overlap them as far as the compiler knows, a step
    of the Kepler problem takes 24 ns instead of 21.
    """
    a = carray(floats_on_stack(SIZE), (SIZE,))
    acceleration_at(t, x, v, params, work, a)
    add_to_v(v, h, a, work)
    for i in range(SIZE):
        work[i] = a[i]


def rekick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h under the acceleration that the last kick wrote to work: x and t have not changed since."""
    add_to_v(v, h, work[: x.size], work)


def accelerate(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Write the acceleration at (t, x, v) to work for `rekick`, without moving the state."""
    acceleration_at(t, x, v, params, work, work[: x.size])


def drift(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x by h at constant v."""
    add_to_x(x, h, v, work)


def drift_along(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x by h at the system's rate at (t, x, v)."""
    rate = work[3 * x.size : 4 * x.size]
    velocity_at(t, x, v, params, work, rate)
    add_to_x(x, h, rate, work)
