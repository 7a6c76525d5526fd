"""Sweeps over the components of first-order equations y' = f(t, y), each with the components before it already new.

The sweep of Gauss and Seidel is the drift of such equations. The sweep against the order, implicit in each component of
its own, is its adjoint, and both over half a step make the composition diagonal method (Butusov, Tutueva, Fedoseev,
Terentev, Karimov, Mathematics 8, 943 (2020)). Time is the last of the components: the sweep sees the time at its start,
the adjoint sweep the time at its end.

Templates, see `kickdrift.engine.flows.kick_drift`. A component comes alone where the system gives it so, or else with
all others. Evaluations are counted in whole f: as many calls for a component as there are components are one.

Memory: the index of a component, which its function gets in the place of v, and the calls not counted yet.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.views import part
from kickdrift.engine.flows.implicit import MOST_ITERATIONS, ROUNDING
from kickdrift.engine.flows.layout import COMPONENT, EVALUATIONS, TROUBLE, has_part, memory

Floats = NDArray[np.float64]
_SHORTEST = 1e-8  # of a secant against the component: rounding leaves half of the digits of its slope

SIZE = 0  # bound for a few numbers

component_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound


def constants(coefficients: Floats, n: int, params: Floats, general: bool) -> dict[str, int]:
    """Return no compile-time constants besides the size."""
    return {}


def memory_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers."""
    return 2


def sweep(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance the components by h one after the other, each at its rate with the new values of those before it."""
    n = SIZE or x.size
    rates = part(work, 3 * n, n)
    for i in range(n):
        evaluate_component(i, t, x, v, params, work)
        add_to_x(part(x, i, 1), h, part(rates, i, 1), alone(i, n, work))


def adjoint_sweep(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance the components by h, the last one first, each implicitly, at its rate at the new value."""
    n = SIZE or x.size
    rates = part(work, 3 * n, n)
    for i in range(n - 1, -1, -1):
        start = x[i]
        solved = solve_component(i, t + h, h, x, v, params, work)
        x[i] = start
        if not solved:
            break
        add_to_x(part(x, i, 1), h, part(rates, i, 1), alone(i, n, work))


def solve_component(i: int, t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Solve x_i = start + h f_i(t, x) by the secant method and write the rate, or the residual to TROUBLE.

    The first iteration is a fixed-point one, whose slope is -1. It ends where the increments stop shrinking.
    """
    rate = part(work, 3 * (SIZE or x.size) + i, 1)
    start = x[i]
    slope, earlier, earlier_residual, previous = -1.0, np.nan, np.nan, np.inf
    residual = size = np.nan
    for _ in range(MOST_ITERATIONS):
        evaluate_component(i, t, x, v, params, work)
        residual = (start - x[i]) + h * rate[0]
        size = max(abs(start), abs(x[i]), abs(h * rate[0]))
        if not np.isfinite(residual):
            x[i] = 0.5 * (x[i] + earlier)  # half of the last increment may suffice
            continue
        if abs(x[i] - earlier) > _SHORTEST * size:
            slope = (residual - earlier_residual) / (x[i] - earlier)
        increment = -residual / slope
        if residual == 0.0 or (abs(increment) <= ROUNDING * size and not abs(increment) < previous):
            return True
        earlier, earlier_residual, previous = x[i], residual, abs(increment)
        x[i] += increment
    work[TROUBLE] = abs(residual) / size if abs(residual) > 0.0 else np.inf
    return False


def evaluate_component(i: int, t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Write the rate of a component among the rates of x."""
    n = SIZE or x.size
    rates = part(work, 3 * n, n)
    if has_part(COMPONENT, work):
        own = memory(work)
        own[0] = i
        component_at(t, x, part(own, 0, 1), params, work, rates)
        own[1] = own[1] + 1.0 if own[1] + 1.0 < n else 0.0
        work[EVALUATIONS] += own[1] == 0.0
    else:
        velocity_at(t, x, v, params, work, rates)
        work[EVALUATIONS] += 1.0


@compiled(inline=True)
def alone(i: int, n: int, work: Floats) -> Floats:
    """Return work in the layout of a state of component i alone: its rounding error is at index 1."""
    return part(work, n + i - 1, work.size - n - i + 1)
