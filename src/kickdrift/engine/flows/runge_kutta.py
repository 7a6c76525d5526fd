"""The Runge-Kutta methods, explicit and implicit, with coefficients of their own for x and v where a tableau has them.

Templates, see `kickdrift.engine.flows.implicit`. The coefficients are the numbers of a `kickdrift.methods.Tableau`.
The unknowns are the stages: their positions, then their velocities. Where x' = v, only the velocities are unknown:
X_i = x + h sum_j a_ij V_j.

The stages of a step start from the polynomial through the rates of the step before: for three stages that saves a fifth
to a third of the evaluations (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed., section VIII.6.1).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.engine.flows.implicit import clear, copy, increments, largest, scale, solver_memory, unknowns
from kickdrift.engine.flows.layout import EVALUATIONS, TROUBLE, VELOCITY, coefficients_at, has_part, memory

Floats = NDArray[np.float64]
_RUNGE_KUTTA = 3

acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound
solve: Callable[..., bool] = unbound


def explicit_memory(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers: a stage, a sum, and the rates of the stages."""
    return (2 * int(coefficients[0]) + 3) * n


def implicit_memory(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers: for the solver, the rates of the stages, and a sum."""
    s = int(coefficients[0])
    return solver_memory(2 * s * n) + (2 * s + 1) * n


def runge_kutta(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and v by h with an explicit tableau."""
    n, n_v, own = x.size, v.size, memory(work)
    s, c, a, b, a_of_v, b_of_v, _ = tableau(n, work)
    stage, stage_v, total = own[:n], own[n : n + n_v], own[2 * n : 3 * n]
    x_rates, v_rates = own[3 * n : (3 + s) * n], own[(3 + s) * n : (3 + s) * n + s * n_v]
    for i in range(s):
        shift(x, h, a[i * s : i * s + i], x_rates, stage)
        shift(v, h, a_of_v[i * s : i * s + i], v_rates, stage_v)
        evaluate(i, t + c[i] * h, stage, stage_v, params, work, x_rates, v_rates)
    advance(h, x, v, work, b, b_of_v, x_rates, v_rates, total)


def implicit_runge_kutta(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and v by h with any tableau."""
    n, n_v, head = x.size, v.size, memory(work)
    s, _, _, b, _, b_of_v, onward = tableau(n, work)
    general = has_part(VELOCITY, work)
    head[0], head[1] = s * (n + n_v) if general else s * n, s * n
    xs, vs, x_rates, v_rates, total = stages(s, n, n_v, general, work)
    trouble = work[TROUBLE]
    for _ in range(2):
        work[TROUBLE] = trouble
        for i in range(s):
            if general:
                shift(x, h, onward[i * s : (i + 1) * s], x_rates, xs[i * n : (i + 1) * n])
            shift(v, h, onward[i * s : (i + 1) * s], v_rates, vs[i * n_v : (i + 1) * n_v])
        if solve(_RUNGE_KUTTA, t, h, x, v, params, work):
            advance(h, x, v, work, b, b_of_v, x_rates, v_rates, total)
            break
        # Where the polynomial led astray: without rates, the stages start from x and v.
        clear(x_rates)
        clear(v_rates)


def stage_residual(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Leave how far each stage is from x + h sum_j a_ij x'_j and v + h sum_j a_ij v'_j."""
    n, n_v, head = x.size, v.size, memory(work)
    s, c, a, _, a_of_v, _, _ = tableau(n, work)
    general = has_part(VELOCITY, work)
    xs, vs, x_rates, v_rates, _ = stages(s, n, n_v, general, work)
    increment = increments(int(head[0]), work)
    of_x, of_v = increment[: s * n], increment[increment.size - s * n_v :]
    for i in range(s):
        if not general:
            shift(x, h, a[i * s : (i + 1) * s], x_rates, xs[i * n : (i + 1) * n])
    for i in range(s):
        evaluate(i, t + c[i] * h, xs[i * n : (i + 1) * n], vs[i * n_v : (i + 1) * n_v], params, work, x_rates, v_rates)
    for i in range(s):
        if general:
            shortfall(x, h, a[i * s : (i + 1) * s], x_rates, xs[i * n : (i + 1) * n], of_x[i * n : (i + 1) * n])
        shortfall(
            v, h, a_of_v[i * s : (i + 1) * s], v_rates, vs[i * n_v : (i + 1) * n_v], of_v[i * n_v : (i + 1) * n_v]
        )
    size_of_v = scale(largest(vs), abs(h) * largest(v_rates))
    if general:
        head[2], head[3] = scale(largest(xs), abs(h) * largest(x_rates)), size_of_v
    else:
        # A velocity is as exact as the position that its share of the step is added to: 4e-16 of x in 1e-12 of this.
        head[2] = scale(size_of_v, 4e-4 * largest(x) / abs(h))


def evaluate(
    i: int, t: float, stage: Floats, stage_v: Floats, params: Floats, work: Floats, x_rates: Floats, v_rates: Floats
) -> None:
    """Leave the rates of stage i."""
    n, n_v = stage.size, stage_v.size
    if has_part(VELOCITY, work):
        velocity_at(t, stage, stage_v, params, work, x_rates[i * n : (i + 1) * n])
    else:
        copy(stage_v, x_rates[i * n : (i + 1) * n])
    if n_v > 0:
        acceleration_at(t, stage, stage_v, params, work, v_rates[i * n_v : (i + 1) * n_v])
    work[EVALUATIONS] += 1.0


def advance(
    h: float,
    x: Floats,
    v: Floats,
    work: Floats,
    b: Floats,
    b_of_v: Floats,
    x_rates: Floats,
    v_rates: Floats,
    total: Floats,
) -> None:
    """Add the weighted rates of the stages."""
    combine(b, x_rates, total)
    add_to_x(x, h, total, work)
    if v.size > 0:
        combine(b_of_v, v_rates, total)
        add_to_v(v, h, total, work)


@compiled(inline=True)
def tableau(n: int, work: Floats) -> tuple[int, Floats, Floats, Floats, Floats, Floats, Floats]:
    """Return stages, nodes, a and b for x, a and b for v, and the weights of these rates in the next start."""
    numbers = work[coefficients_at(n) :]
    s = int(numbers[0])
    a, of_v, onward = 1 + s, 1 + 2 * s + s * s, 1 + 3 * s + 2 * s * s
    return (
        s,
        numbers[1:a],
        numbers[a : a + s * s],
        numbers[a + s * s : of_v],
        numbers[of_v : of_v + s * s],
        numbers[of_v + s * s : onward],
        numbers[onward : onward + s * s],
    )


@compiled(inline=True)
def stages(s: int, n: int, n_v: int, general: bool, work: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Return stage positions and velocities, their rates, and room for a sum."""
    m = int(memory(work)[0])
    z, own = unknowns(m, work), memory(work)[solver_memory(m) :]
    first, v_rates = own[: s * n], own[s * n : s * (n + n_v)]
    total = own[2 * s * n : (2 * s + 1) * n]
    # Where x' = v, the velocities of the stages are the rates of their positions, too.
    return (z[: s * n], z[s * n :], first, v_rates, total) if general else (first, z, z, v_rates, total)


@compiled(inline=True)
def combine(weights: Floats, rates: Floats, total: Floats) -> None:
    """Write the sum of weights times rates, of as many numbers each as the total has."""
    n = total.size
    for k in range(n):
        total[k] = 0.0
    for j in range(weights.size):
        for k in range(n):
            total[k] += weights[j] * rates[j * n + k]


@compiled
def shift(y: Floats, h: float, weights: Floats, rates: Floats, into: Floats) -> None:
    """Write y + h times the sum of weights times rates."""
    combine(weights, rates, into)
    for k in range(y.size):
        into[k] = y[k] + h * into[k]


@compiled
def shortfall(y: Floats, h: float, weights: Floats, rates: Floats, stage: Floats, into: Floats) -> None:
    """Write (y - stage) + h times the sum of weights times rates."""
    combine(weights, rates, into)
    for k in range(y.size):
        into[k] = (y[k] - stage[k]) + h * into[k]
