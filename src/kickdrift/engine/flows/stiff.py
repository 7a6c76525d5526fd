"""Implicit Runge-Kutta methods for stiff problems: those whose last stage is the end of the step.

Templates, see `kickdrift.engine.flows.runge_kutta`, whose stages these are. Three things differ where decay is much faster
than the step:

- Each component starts from the polynomial of the previous step only if that has the direction of its own slope. After a
  transient it has not: the slopes of the first stages are unrelated to the motion that follows, and Newton's iteration finds
  another root from there. On Robertson's problem that was one with a negative concentration, and the run was lost.
- A step whose equations cannot be solved is halved until they can, as where a relaxation oscillator jumps; under a control of
  errors the step fails instead, since nothing would compare its halves with others.
- The step is compared with an embedded one (Hairer, Wanner, Solving Ordinary Differential Equations II, 2nd ed.,
  section IV.8), and the largest difference of each number is kept. The difference is multiplied by the inverse matrix of the
  iteration, if there is one: otherwise the stiff components would dominate it.

Layout of memory: that of `runge_kutta.implicit_runge_kutta`, then the rates at the start of the step, of x and of v. The
head of the solver has at 6 whether the last stage of the step before is the start of this one.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.core.linear_algebra import lu_solve
from kickdrift.core.views import part
from kickdrift.engine.flows import runge_kutta
from kickdrift.engine.flows.implicit import clear, increments, padded, solver_memory
from kickdrift.engine.flows.layout import (
    EVALUATIONS,
    KEPT_BY,
    KEPT_FOR,
    RETRIED,
    TROUBLE,
    coefficients_at,
    estimated_errors,
    memory,
)
from kickdrift.engine.flows.runge_kutta import number_of_unknowns, shift, stages, tableau

Floats = NDArray[np.float64]
_STIFF = 4
_LEAST_SHARE = 2.0**-20  # of a step, below which the step fails
_STARTS_THERE = 6

STAGES, GENERAL = 0, False  # bound, see `runge_kutta`
SIZE, SIZE_OF_V = 0, 0

acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
scratch: Callable[..., Floats] = unbound
solve: Callable[..., bool] = unbound
advance: Callable[..., None] = unbound
take_step: Callable[..., bool] = unbound
estimate: Callable[..., None] = unbound


def memory_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers."""
    return padded(runge_kutta.implicit_memory(n, coefficients, params)) + 2 * padded(n)


def stiff_runge_kutta(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and v by h, in one step or, unless a step that fails is tried again, by repeated halving."""
    trouble, done, share = work[TROUBLE], 0.0, 1.0
    while done < 1.0:
        work[TROUBLE] = trouble
        if take_step(t + done * h, share * h, x, v, params, work):
            done += share
            if done % (2.0 * share) == 0.0 and done + 2.0 * share <= 1.0:
                share *= 2.0
        else:
            share *= 0.5
            if share < _LEAST_SHARE or work[RETRIED] != 0.0:
                return
        if share < 1.0:
            forget(x.size, v.size, STAGES, GENERAL, work)


def take_attempt(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Advance x and v by h in one step; return False, with the state unchanged, if its equations cannot be solved."""
    n, n_v, head = SIZE or x.size, SIZE_OF_V if SIZE else v.size, memory(work)
    x, v = part(x, 0, n), part(v, 0, n_v)
    c, _, b, _, b_of_v, onward = tableau(n, STAGES, work)
    xs, vs, x_rates, v_rates = stages(n, n_v, STAGES, GENERAL, work)
    m = number_of_unknowns(n, n_v, STAGES, GENERAL)
    x_rate, v_rate = first_rates(n, n_v, STAGES, GENERAL, work)
    if head[_STARTS_THERE] == 0.0:
        if GENERAL:
            velocity_at(t, x, v, params, work, x_rate)
        else:
            assign(x_rate, v)
        if n_v > 0:
            acceleration_at(t, x, v, params, work, v_rate)
        work[EVALUATIONS] += 1.0
    else:
        assign(x_rate, part(x_rates, (STAGES - 1) * n, n))
        assign(v_rate, part(v_rates, (STAGES - 1) * n_v, n_v))
    trouble = work[TROUBLE]
    for _ in range(2):
        work[TROUBLE] = trouble
        for i in range(STAGES):
            weights = part(onward, i * STAGES, STAGES)
            if GENERAL:
                shift(x, h, weights, x_rates, part(xs, i * n, n))
                hold_back(x, c[i] * h, x_rate, part(xs, i * n, n))
            shift(v, h, weights, v_rates, part(vs, i * n_v, n_v))
            hold_back(v, c[i] * h, v_rate, part(vs, i * n_v, n_v))
        if solve(_STIFF, m, STAGES * n, t, h, x, v, params, work):
            advance(h, x, v, work, b, b_of_v, x_rates, v_rates)
            estimate(h, x, v, work)
            head[_STARTS_THERE] = 1.0
            return True
        # The extrapolated start was poor: without rates, the stages start from x and v.
        clear(x_rates)
        clear(v_rates)
    return False


def estimate_errors(h: float, x: Floats, v: Floats, work: Floats) -> None:
    """Note the differences from the embedded step, if they are the largest so far."""
    n, n_v = SIZE or x.size, SIZE_OF_V if SIZE else v.size
    m = number_of_unknowns(n, n_v, STAGES, GENERAL)
    _, _, x_rates, v_rates = stages(n, n_v, STAGES, GENERAL, work)
    x_rate, v_rate = first_rates(n, n_v, STAGES, GENERAL, work)
    weights = part(work, coefficients_at(n) + 1 + 3 * STAGES * (1 + STAGES), STAGES + 1)
    difference, last = increments(m, work), (STAGES - 1) * n
    differ(h, weights, x_rate, x_rates, part(difference, last, n))
    if GENERAL and work[KEPT_BY] == _STIFF and work[KEPT_FOR] == h:
        differ(h, weights, v_rate, v_rates, part(difference, m - n_v, n_v))
        # Twice in a transient, as Hairer and Wanner do: in a first step, and after one that was halved.
        for _ in range(2 if memory(work)[_STARTS_THERE] == 0.0 else 1):
            for i in range(STAGES - 1):
                assign(part(difference, i * n, n), part(difference, last, n))
                assign(part(difference, STAGES * n + i * n_v, n_v), part(difference, m - n_v, n_v))
            lu_solve(scratch(0, m * m, work), scratch(m * m, m, work), difference)
    largest = estimated_errors(n, work)
    for k in range(n):
        largest[k] = max(largest[k], abs(difference[last + k]))


@compiled(inline=True)
def first_rates(n: int, n_v: int, s: int, general: bool, work: Floats) -> tuple[Floats, Floats]:
    """Return the rates at the start of the step, of x and of v."""
    start = solver_memory(number_of_unknowns(n, n_v, s, general)) + 2 * padded(s * n)
    own = memory(work)
    return part(own, start, n), part(own, start + padded(n), n_v)


@compiled
def forget(n: int, n_v: int, s: int, general: bool, work: Floats) -> None:
    """Clear the rates of the last step, from which the next one, of another size, cannot extrapolate."""
    _, _, x_rates, v_rates = stages(n, n_v, s, general, work)
    clear(x_rates)
    clear(v_rates)
    memory(work)[_STARTS_THERE] = 0.0


@compiled(inline=True)
def hold_back(y: Floats, h: float, rate: Floats, stage: Floats) -> None:
    """Start a stage from y in the components that would move against their slope there, or more than twice as far.

    Each is judged separately: no norm gives the scale of its changes.
    """
    for k in range(y.size):
        along = h * rate[k]
        if not abs(stage[k] - y[k] - along) <= abs(along):
            stage[k] = y[k]


@compiled(inline=True)
def differ(h: float, weights: Floats, rate: Floats, rates: Floats, difference: Floats) -> None:
    """Write h times the weighted sum of the rates at the start, and of those of the stages."""
    n = rate.size
    for k in range(n):
        total = weights[0] * rate[k]
        for j in range(1, weights.size):
            total += weights[j] * rates[(j - 1) * n + k]
        difference[k] = h * total
