"""The adjoint kick and drift: the rate is evaluated at the end of the flow, which is an implicit equation.

They are the implicit halves of a method whose other half is explicit (Hairer, Lubich, Wanner,
Geometric Numerical Integration, 2nd ed., section VI.3). Templates, see `kickdrift.engine.flows.implicit`.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.implicit import increments, largest, scale, solver_memory, solver_scratch, unknowns
from kickdrift.engine.flows.layout import EVALUATIONS, memory

Floats = NDArray[np.float64]
_ADJOINT_KICK, _ADJOINT_DRIFT = 1, 2

acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound
solve: Callable[..., bool] = unbound


def memory_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers."""
    return solver_memory(n)


def scratch_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of scratch for a state of n numbers."""
    return solver_scratch(n)


def adjoint_kick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h under the acceleration at (t, x, v after it)."""
    n = x.size
    assign(unknowns(n, work), v)
    if solve(_ADJOINT_KICK, n, n, t, h, x, v, params, work):
        add_to_v(v, h, work[:n], work)


def kick_residual(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Leave v + h a(t, x, u) - u."""
    n = x.size
    a, u = work[:n], unknowns(n, work)
    acceleration_at(t, x, u, params, work, a)
    work[EVALUATIONS] += 1.0
    leave_residual(v, u, h, a, increments(n, work), memory(work))


def adjoint_drift(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x by h at its rate at (t, x after it, v)."""
    n = x.size
    assign(unknowns(n, work), x)
    if solve(_ADJOINT_DRIFT, n, n, t, h, x, v, params, work):
        add_to_x(x, h, work[3 * n : 4 * n], work)


def drift_residual(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Leave x + h f(t, y, v) - y."""
    n = x.size
    rate, y = work[3 * n : 4 * n], unknowns(n, work)
    velocity_at(t, y, v, params, work, rate)
    leave_residual(x, y, h, rate, increments(n, work), memory(work))


@compiled
def leave_residual(start: Floats, end: Floats, h: float, rate: Floats, increment: Floats, head: Floats) -> None:
    """Leave start + h rate - end as the increment, and its scale."""
    for i in range(start.size):
        increment[i] = (start[i] - end[i]) + h * rate[i]
    head[2] = scale(largest(end), abs(h) * largest(rate))
