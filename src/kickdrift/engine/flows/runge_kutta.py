"""The Runge-Kutta methods, explicit and implicit, with separate coefficients for x and v if a tableau has them.

Templates, see `kickdrift.engine.flows.implicit`. The coefficients are the numbers of a `kickdrift.methods.Tableau`.
The unknowns are the stages: their positions, then their velocities. Where x' = v, only the velocities are unknown:
X_i = x + h sum_j a_ij V_j.

The stages of a step start from the polynomial through the rates of the step before: for three stages that saves a fifth
to a third of the evaluations (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed., section VIII.6.1).

How many stages there are, whether x' is v, and for a few numbers the size of the state, are constants of the
compilation: loops over them are unrolled, and a step of Gauss 6 on the pendulum takes half as long.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.views import part
from kickdrift.engine.flows.implicit import (
    clear,
    increments,
    largest,
    padded,
    scale,
    solver_memory,
    solver_scratch,
    unknowns,
)
from kickdrift.engine.flows.layout import EVALUATIONS, FEW, TROUBLE, coefficients_at, memory

Floats = NDArray[np.float64]
_RUNGE_KUTTA = 3
BLOCK = 512  # numbers that stay in the L1 cache while the rates of the stages are added up

STAGES, GENERAL = 0, False  # bound: how many stages, and whether x' is not v
SIZE, SIZE_OF_V = 0, 0  # bound for a few numbers

acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound
solve: Callable[..., bool] = unbound


def constants(coefficients: Floats, n: int, params: Floats, general: bool) -> dict[str, int]:
    """Return the compile-time constants."""
    return {"STAGES": int(coefficients[0]), "GENERAL": general}


def explicit_memory(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers: a stage, and the rates of the stages."""
    return 2 * padded(int(coefficients[0]) * n) + 2 * padded(n)


def implicit_memory(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers: for the solver, and the rates of the stages."""
    s = int(coefficients[0])
    return solver_memory(2 * s * n) + 2 * padded(s * n)


def implicit_scratch(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of scratch for a state of n numbers."""
    return solver_scratch(2 * int(coefficients[0]) * n)


def runge_kutta(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and v by h with an explicit tableau."""
    n, n_v, own = SIZE or x.size, SIZE_OF_V if SIZE else v.size, memory(work)
    x, v = part(x, 0, n), part(v, 0, n_v)
    c, a, b, a_of_v, b_of_v, _ = tableau(n, STAGES, work)
    rates = padded(STAGES * n)
    x_rates, v_rates, stage = part(own, 0, STAGES * n), part(own, rates, STAGES * n_v), part(own, 2 * rates, n)
    for i in range(STAGES):
        stage_v = part(own, 2 * rates + padded(n), n_v) if GENERAL else part(x_rates, i * n, n_v)
        shift(x, h, part(a, i * STAGES, i), x_rates, stage)
        shift(v, h, part(a_of_v, i * STAGES, i), v_rates, stage_v)
        evaluate(i, t + c[i] * h, stage, stage_v, params, work, x_rates, v_rates)
    advance(h, x, v, work, b, b_of_v, x_rates, v_rates)


def implicit_runge_kutta(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and v by h with any tableau."""
    n, n_v = SIZE or x.size, SIZE_OF_V if SIZE else v.size
    _, _, b, _, b_of_v, onward = tableau(n, STAGES, work)
    xs, vs, x_rates, v_rates = stages(n, n_v, STAGES, GENERAL, work)
    trouble = work[TROUBLE]
    m = number_of_unknowns(n, n_v, STAGES, GENERAL)
    for _ in range(2):
        work[TROUBLE] = trouble
        for i in range(STAGES):
            weights = part(onward, i * STAGES, STAGES)
            if GENERAL:
                shift(x, h, weights, x_rates, part(xs, i * n, n))
            shift(v, h, weights, v_rates, part(vs, i * n_v, n_v))
        if solve(_RUNGE_KUTTA, m, STAGES * n, t, h, x, v, params, work):
            advance(h, x, v, work, b, b_of_v, x_rates, v_rates)
            break
        # The extrapolated start was poor: without rates, the stages start from x and v.
        clear(x_rates)
        clear(v_rates)


def stage_residual(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Write the differences of the stages from x + h sum_j a_ij x'_j and v + h sum_j a_ij v'_j."""
    n, n_v, head = SIZE or x.size, SIZE_OF_V if SIZE else v.size, memory(work)
    x, v = part(x, 0, n), part(v, 0, n_v)
    m = number_of_unknowns(n, n_v, STAGES, GENERAL)
    c, a, _, a_of_v, _, _ = tableau(n, STAGES, work)
    xs, vs, x_rates, v_rates = stages(n, n_v, STAGES, GENERAL, work)
    increment = increments(m, work)
    of_v = part(increment, m - STAGES * n_v, STAGES * n_v)
    for i in range(STAGES):
        stage, stage_v = part(xs, i * n, n), part(vs, i * n_v, n_v)
        if not GENERAL:
            shift(x, h, part(a, i * STAGES, STAGES), x_rates, stage)
        evaluate(i, t + c[i] * h, stage, stage_v, params, work, x_rates, v_rates)
    for i in range(STAGES):
        if GENERAL:
            weights = part(a, i * STAGES, STAGES)
            shortfall(x, h, weights, x_rates, part(xs, i * n, n), part(increment, i * n, n))
        weights = part(a_of_v, i * STAGES, STAGES)
        shortfall(v, h, weights, v_rates, part(vs, i * n_v, n_v), part(of_v, i * n_v, n_v))
    size_of_v = scale(largest(vs), abs(h) * largest(v_rates))
    if GENERAL:
        head[2], head[3] = scale(largest(xs), abs(h) * largest(x_rates)), size_of_v
    else:
        # A velocity is as accurate as the position to which its part of the step is added: 4e-16 of x in 1e-12 of this.
        head[2] = scale(size_of_v, 4e-4 * largest(x) / abs(h))


def evaluate(
    i: int, t: float, stage: Floats, stage_v: Floats, params: Floats, work: Floats, x_rates: Floats, v_rates: Floats
) -> None:
    """Write the rates of stage i; those of x only where they differ from v."""
    n, n_v = stage.size, stage_v.size
    if GENERAL:
        velocity_at(t, stage, stage_v, params, work, part(x_rates, i * n, n))
    if n_v > 0:
        acceleration_at(t, stage, stage_v, params, work, part(v_rates, i * n_v, n_v))
    work[EVALUATIONS] += 1.0


def advance(
    h: float, x: Floats, v: Floats, work: Floats, b: Floats, b_of_v: Floats, x_rates: Floats, v_rates: Floats
) -> None:
    """Add the weighted rates of the stages; their sums are stored in place of the last kick's acceleration."""
    n, n_v = x.size, v.size
    total = part(work, 3 * n, n)
    combine(b, x_rates, total)
    add_to_x(x, h, total, work)
    if n_v > 0:
        total = part(work, 3 * n, n_v)
        combine(b_of_v, v_rates, total)
        add_to_v(v, h, total, work)


@compiled(inline=True)
def tableau(n: int, s: int, work: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats]:
    """Return nodes, a and b for x, a and b for v, and the weights of these rates in the next start, of s stages."""
    c = coefficients_at(n) + 1
    a, of_v = c + s, c + 2 * s + s * s
    b_of_v = of_v + s * s
    return (
        part(work, c, s),
        part(work, a, s * s),
        part(work, a + s * s, s),
        part(work, of_v, s * s),
        part(work, b_of_v, s),
        part(work, b_of_v + s, s * s),
    )


@compiled(inline=True)
def number_of_unknowns(n: int, n_v: int, s: int, general: bool) -> int:
    """Return m: positions and velocities of s stages, or where x' = v only these."""
    return s * (n + n_v) if general else s * n


@compiled(inline=True)
def stages(n: int, n_v: int, s: int, general: bool, work: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return stage positions and velocities, and their rates."""
    m = number_of_unknowns(n, n_v, s, general)
    z, own = unknowns(m, work), memory(work)
    start = solver_memory(m)
    first, v_rates = part(own, start, s * n), part(own, start + padded(s * n), s * n_v)
    if general:
        return part(z, 0, s * n), part(z, s * n, s * n_v), first, v_rates
    # Where x' = v, the velocities of the stages are the rates of their positions, too.
    return first, z, z, v_rates


@compiled(inline=True)
def combine(weights: Floats, rates: Floats, total: Floats) -> None:
    """Write the sum of weights times rates, of as many numbers each as the total has."""
    n = total.size
    for start in range(0, n, BLOCK):
        size = min(BLOCK, n - start)
        add_up(weights, rates, start, n, part(total, start, size))


@compiled(inline=True)
def add_up(weights: Floats, rates: Floats, start: int, n: int, block: Floats) -> None:
    """Write a block of the sum of weights times rates; where there are many, rate by rate, so that loops vectorise."""
    if n <= FEW:
        for k in range(n):
            total = 0.0
            for j in range(weights.size):
                total += weights[j] * rates[j * n + k]
            block[k] = total
        return
    for k in range(block.size):
        block[k] = 0.0
    for j in range(weights.size):
        rate = part(rates, j * n + start, block.size)
        for k in range(block.size):
            block[k] += weights[j] * rate[k]


@compiled(inline=True)
def shift(y: Floats, h: float, weights: Floats, rates: Floats, into: Floats) -> None:
    """Write y + h times the sum of weights times rates."""
    n = y.size
    for start in range(0, n, BLOCK):
        size = min(BLOCK, n - start)
        old, new = part(y, start, size), part(into, start, size)
        add_up(weights, rates, start, n, new)
        for k in range(size):
            new[k] = old[k] + h * new[k]


@compiled(inline=True)
def shortfall(y: Floats, h: float, weights: Floats, rates: Floats, stage: Floats, into: Floats) -> None:
    """Write (y - stage) + h times the sum of weights times rates."""
    n = y.size
    for start in range(0, n, BLOCK):
        size = min(BLOCK, n - start)
        old, there, short = part(y, start, size), part(stage, start, size), part(into, start, size)
        add_up(weights, rates, start, n, short)
        for k in range(size):
            short[k] = (old[k] - there[k]) + h * short[k]
