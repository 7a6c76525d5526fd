"""A kick that is implicit in the velocity, exactly so for linear forces: one step of Newton's method, a linear equation.

Where damping is stiff, it is stable at any step (MuJoCo's implicit integrator; the linearly implicit Euler method of
Hairer, Wanner, Solving Ordinary Differential Equations II, 2nd ed. (1996), section IV.9). A template, see
`kickdrift.engine.flows.kick_drift`.

Memory: a displaced velocity (n). Scratch: a matrix (n * n) and pivots (n).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import unbound
from kickdrift.core.elementwise import assign
from kickdrift.core.errors import ArgumentError
from kickdrift.core.linear_algebra import lu_factor, lu_solve
from kickdrift.core.views import part
from kickdrift.engine.flows.implicit import MOST_WITH_MATRIX, largest, scale
from kickdrift.engine.flows.layout import (
    EVALUATIONS,
    KEPT_BY,
    TROUBLE,
    VELOCITY_JACOBIAN,
    change_of_v,
    has_part,
    memory,
)

Floats = NDArray[np.float64]

acceleration_at: Callable[..., None] = unbound
velocity_jacobian_at: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound
scratch: Callable[..., Floats] = unbound


def memory_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers."""
    return n


def scratch_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of scratch for a state of n numbers; ArgumentError if the matrix would be too large."""
    if n > MOST_WITH_MATRIX:
        raise ArgumentError(
            f"x0 has {n} numbers, and kicks that are implicit in the velocity need a matrix of that size squared,"
            f" which is limited to {MOST_WITH_MATRIX} rows; use a method without a matrix, such as 'velocity-verlet',"
            " or 'implicit-midpoint', which needs none if the step is small enough."
        )
    return n * n + n


def linearly_implicit_kick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h u, with (1 - h da/dv) u = a at (t, x, v)."""
    n = x.size
    matrix, pivots, u = scratch(0, n * n, work), scratch(n * n, n, work), change_of_v(n, work)
    acceleration_at(t, x, v, params, work, work[:n])
    work[EVALUATIONS] += 1.0
    work[KEPT_BY] = 0.0  # the matrix kept by another flow is overwritten
    if has_part(VELOCITY_JACOBIAN, work):
        velocity_jacobian_at(t, x, v, params, work, matrix)
    else:
        form_velocity_jacobian(t, h, x, v, params, work)
    for i in range(n):
        for j in range(n):
            matrix[i * n + j] = (1.0 if i == j else 0.0) - h * matrix[i * n + j]
    if not lu_factor(matrix, pivots):
        work[TROUBLE] = np.inf
        return
    assign(u, work[:n])
    lu_solve(matrix, pivots, u)
    add_to_v(v, h, u, work)


def form_velocity_jacobian(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Form da/dv by forward differences from the acceleration in work, with one evaluation a column."""
    n, matrix = x.size, scratch(0, x.size * x.size, work)
    a, displaced_a, displaced = part(work, 0, n), change_of_v(n, work), part(memory(work), 0, n)
    size = scale(largest(v), abs(h) * largest(a))
    assign(displaced, v)
    for j in range(n):
        displaced[j] = v[j] + 1.5e-8 * size
        acceleration_at(t, x, displaced, params, work, displaced_a)
        work[EVALUATIONS] += 1.0
        for i in range(n):
            matrix[i * n + j] = (displaced_a[i] - a[i]) / (displaced[j] - v[j])
        displaced[j] = v[j]
