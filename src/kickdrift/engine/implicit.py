"""The implicit flows: a step whose slopes are taken where it ends, or in its middle.

Both solve the same stage equation for the velocity u at the time t + s,

    u = v + s a(t + s, x + s u, u),

with s = h for the implicit Euler method and s = h/2 for the midpoint rule. The iteration is Newton's with a kept
matrix: it starts with the identity, a fixed-point iteration that needs no Jacobian at small steps; where that contracts
slowly, the matrix I - s da/du is formed by differences and kept until it contracts slowly in its turn. It goes on
until the increments stop shrinking: a looser end would make the energy drift.
(Hairer, Wanner, Solving Ordinary Differential Equations II, 2nd ed., section IV.8.)

The functions are templates: see `kickdrift.engine.flows`; `solve_stage` and what it calls are bound like the rest.

Layout of ``work`` from 3 n on: u, trial position, increment, pivots, matrix (n*n), and at -3 whether there is a matrix.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.linear_algebra import lu_factor, lu_solve
from kickdrift.engine.flows import EVALUATIONS, TROUBLE

Floats = NDArray[np.float64]
HAS_MATRIX = -3
_ROUNDING = 1e-12  # of an increment against the velocity
_SLOW = 0.3  # a contraction slower than this is worth n evaluations for a new matrix
_MOST_ITERATIONS = 50

acceleration: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound


def work_size(n: int) -> int:
    """Numbers of work that a state of n numbers needs, the three at the end included."""
    return 7 * n + n * n + 3


def implicit_euler(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and v by h with the slopes at the end of the step."""
    n = x.size
    if solve_stage(t + h, h, x, v, params, work):
        add_to_x(x, h, work[3 * n : 4 * n], work)
        add_to_v(v, h, work[:n], work)


def implicit_midpoint(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and v by h with the slopes in the middle of the step."""
    n = x.size
    if solve_stage(t + 0.5 * h, 0.5 * h, x, v, params, work):
        add_to_x(x, h, work[3 * n : 4 * n], work)
        add_to_v(v, h, work[:n], work)


def solve_stage(t: float, s: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Solve the stage equation; leaves u and its acceleration in work, or the residual at TROUBLE."""
    n = x.size
    u, increment = work[3 * n : 4 * n], work[5 * n : 6 * n]
    pivots, matrix = work[6 * n : 7 * n], work[7 * n : 7 * n + n * n]
    u[:] = v
    previous = np.inf
    fresh = False
    for iteration in range(_MOST_ITERATIONS):
        stage_residual(t, s, x, v, params, work)
        if work[HAS_MATRIX] != 0.0:
            lu_solve(matrix, pivots, increment)
        size = largest(increment)
        scale = max(largest(u), abs(s) * largest(work[:n]))
        # Below this, increments are rounding: of the velocity, or of the position that its change is lost in.
        floor = max(_ROUNDING * scale, 4e-16 * largest(x) / abs(s))
        if not np.isfinite(size):
            break
        shrinking = size < previous
        if shrinking or size > floor:
            u += increment
        if size == 0.0 or (not shrinking and size <= floor):
            return True
        if iteration > 0 and size > _SLOW * previous and size > floor:
            if fresh and not shrinking:
                break
            if not form_matrix(t, s, x, params, work):
                break
            fresh = True
            previous = np.inf
        else:
            previous = size
        if iteration == _MOST_ITERATIONS - 1 and size <= floor:
            return True
    stage_residual(t, s, x, v, params, work)
    residual = largest(increment)
    work[TROUBLE] = residual if residual > 0.0 else np.inf
    return False


def stage_residual(t: float, s: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Leave v + s a(t, x + s u, u) - u as the increment of a fixed-point iteration."""
    n = x.size
    a, u, trial, increment = work[:n], work[3 * n : 4 * n], work[4 * n : 5 * n], work[5 * n : 6 * n]
    for i in range(n):
        trial[i] = x[i] + s * u[i]
    acceleration(t, trial, u, params, a)
    work[EVALUATIONS] += 1.0
    for i in range(n):
        increment[i] = (v[i] - u[i]) + s * a[i]


def form_matrix(t: float, s: float, x: Floats, params: Floats, work: Floats) -> bool:
    """Form and factor I - s da/du at u by forward differences, one evaluation a column."""
    n = x.size
    a, u, trial, column = work[:n], work[3 * n : 4 * n], work[4 * n : 5 * n], work[5 * n : 6 * n]
    matrix = work[7 * n : 7 * n + n * n]
    for i in range(n):
        trial[i] = x[i] + s * u[i]
    acceleration(t, trial, u, params, a)
    scale = max(largest(u), largest(x) / abs(s), abs(s) * largest(a))
    for j in range(n):
        kept_u, kept_trial = u[j], trial[j]
        difference = 1.5e-8 * (scale if scale > 0.0 else 1.0)
        u[j] += difference
        trial[j] = x[j] + s * u[j]
        acceleration(t, trial, u, params, column)
        for i in range(n):
            matrix[i * n + j] = (1.0 if i == j else 0.0) - s * (column[i] - a[i]) / difference
        u[j], trial[j] = kept_u, kept_trial
    work[EVALUATIONS] += n + 1.0
    work[HAS_MATRIX] = 1.0
    return lu_factor(matrix, work[6 * n : 7 * n])


@compiled
def largest(values: Floats) -> float:
    """Maximum norm; NaN where there is one."""
    norm = 0.0
    for value in values:
        if not abs(value) <= norm:
            norm = abs(value)
    return norm
