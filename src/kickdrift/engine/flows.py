"""The flows: each advances the state under one part of the dynamics, in place, and allocates nothing.

The functions here are templates: their global names ``acceleration``, ``add_to_x`` and ``add_to_v`` are bound by
`kickdrift.engine.letters` to a system's acceleration and to plain or compensated sums.

Layout of ``work``, n numbers to a state::

    0        accelerations of the last kick
    n        what the sums for x have rounded off
    2 n      what the sums for v have rounded off
    3 n ...  for the implicit flows, see `kickdrift.engine.implicit`
    -2       force evaluations counted by the implicit flows
    -1       residual of an implicit solve that failed, zero if none
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import carray
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.memory import floats_on_stack

Floats = NDArray[np.float64]
EVALUATIONS, TROUBLE = -2, -1

acceleration: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound
SIZE = 0


def work_size(n: int) -> int:
    """Numbers of work that a state of n numbers needs."""
    return 3 * n + 2


def kick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h under the acceleration at (t, x, v)."""
    a = work[: x.size]
    acceleration(t, x, v, params, a)
    add_to_v(v, h, a, work)


def kick_small(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Do the same for a state of SIZE numbers, a constant of the compilation.

    The accelerations pass in registers: through memory, where v could overlap them as far as the compiler knows, a step
    of the Kepler problem takes 24 ns instead of 21.
    """
    a = carray(floats_on_stack(SIZE), (SIZE,))
    acceleration(t, x, v, params, a)
    add_to_v(v, h, a, work)
    for i in range(SIZE):
        work[i] = a[i]


def rekick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h under the acceleration that the last kick left in work: x and t have not moved since."""
    add_to_v(v, h, work[: x.size], work)


def accelerate(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Leave the acceleration at (t, x, v) in work for `rekick`; moves nothing."""
    acceleration(t, x, v, params, work[: x.size])


def drift(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x by h at constant v."""
    add_to_x(x, h, v, work)


def explicit_euler(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and v by h with the slopes at the start of the step."""
    a = work[: x.size]
    acceleration(t, x, v, params, a)
    add_to_x(x, h, v, work)
    add_to_v(v, h, a, work)


@compiled(inline=True)
def add(y: Floats, h: float, rate: Floats, work: Floats) -> None:
    """Y += h rate."""
    for i in range(y.size):
        y[i] += h * rate[i]


@compiled(inline=True)
def _add_compensated(y: Floats, h: float, rate: Floats, residual: Floats) -> None:
    # Kahan, Comm. ACM 8, 40 (1965): what a sum rounds off is given to the next one.
    for i in range(y.size):
        increment = h * rate[i] - residual[i]
        total = y[i] + increment
        residual[i] = (total - y[i]) - increment
        y[i] = total


@compiled(inline=True)
def add_to_x_compensated(x: Floats, h: float, rate: Floats, work: Floats) -> None:
    """X += h rate, with the rounding kept in work."""
    _add_compensated(x, h, rate, work[x.size : 2 * x.size])


@compiled(inline=True)
def add_to_v_compensated(v: Floats, h: float, rate: Floats, work: Floats) -> None:
    """V += h rate, with the rounding kept in work."""
    _add_compensated(v, h, rate, work[2 * v.size : 3 * v.size])


def add_interpreted(y: Any, h: float, rate: Any, work: Any) -> None:
    """`add` for the interpreter: the same operations on whole arrays, and so the same bits."""
    y += h * rate


def _add_compensated_interpreted(y: Any, h: float, rate: Any, residual: Any) -> None:
    increment = h * rate - residual
    total = y + increment
    residual[:] = (total - y) - increment
    y[:] = total


def add_to_x_compensated_interpreted(x: Any, h: float, rate: Any, work: Any) -> None:
    """`add_to_x_compensated` for the interpreter."""
    _add_compensated_interpreted(x, h, rate, work[x.size : 2 * x.size])


def add_to_v_compensated_interpreted(v: Any, h: float, rate: Any, work: Any) -> None:
    """`add_to_v_compensated` for the interpreter."""
    _add_compensated_interpreted(v, h, rate, work[2 * v.size : 3 * v.size])
