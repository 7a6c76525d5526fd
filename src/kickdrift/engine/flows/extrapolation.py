"""Extrapolation of the composition diagonal method, a symmetric one, to step zero: each row gains two orders.

Row j has j + 1 substeps, each a kick and a drift over half of it and their adjoints, or for first-order equations the
two sweeps. Their error is a series in the square of the substep, and the polynomial through the rows is followed to
zero (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), section II.9).

Templates, see `kickdrift.engine.flows.implicit`. The coefficient is the number of rows.

Memory, after that of the solver: whether it solves for v (1), the state at the start and the rounding errors of its sums
(4 n), and the changes of x and v by each row (2 n each).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.adjoint import adjoint_drift, adjoint_kick, drift_residual, kick_residual
from kickdrift.engine.flows.implicit import solver_memory
from kickdrift.engine.flows.layout import EVALUATIONS, VELOCITY, coefficients_at, has_part, memory
from kickdrift.engine.flows.sweep import adjoint_sweep, sweep

Floats = NDArray[np.float64]

acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound
take_symmetric_step: Callable[..., None] = unbound


def memory_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers."""
    return solver_memory(n) + 1 + 4 * n + 2 * n * int(coefficients[0])


def extrapolate(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and v by h."""
    n, n_v = x.size, v.size
    n_rows = int(work[coefficients_at(n)])
    own = memory(work)[solver_memory(n) + 1 :]
    start, rows = own[: 4 * n], own[4 * n : 4 * n + 2 * n * n_rows]
    assign(start[:n], x)
    assign(start[n : n + n_v], v)
    assign(start[2 * n : 4 * n], work[n : 3 * n])
    for j in range(n_rows):
        part = h / (j + 1)
        for step in range(j + 1):
            take_symmetric_step(t + step * part, part, x, v, params, work)
        row = rows[2 * n * j : 2 * n * (j + 1)]
        added(x, start[:n], work[n : 2 * n], start[2 * n : 3 * n], row[:n])
        added(v, start[n : n + n_v], work[2 * n : 2 * n + n_v], start[3 * n : 3 * n + n_v], row[n : n + n_v])
        assign(x, start[:n])
        assign(v, start[n : n + n_v])
        assign(work[n : 3 * n], start[2 * n : 4 * n])
    follow_to_zero(rows, n_rows)
    last = rows[2 * n * (n_rows - 1) :]
    add_to_x(x, 1.0, last[:n], work)
    if n_v > 0:
        add_to_v(v, 1.0, last[n : n + n_v], work)


def take_sweeps(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Take a step of order 2: a sweep and its adjoint."""
    sweep(t, 0.5 * h, x, v, params, work)
    adjoint_sweep(t + 0.5 * h, 0.5 * h, x, v, params, work)


def take_kicks_and_drifts(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Take a step of order 2: K*/2 D/2 D*/2 K/2."""
    n = x.size
    memory(work)[solver_memory(n)] = 1.0
    adjoint_kick(t, 0.5 * h, x, v, params, work)
    if has_part(VELOCITY, work):
        rate = work[3 * n : 4 * n]
        velocity_at(t + 0.5 * h, x, v, params, work, rate)
        add_to_x(x, 0.5 * h, rate, work)
        memory(work)[solver_memory(n)] = 0.0
        adjoint_drift(t + 0.5 * h, 0.5 * h, x, v, params, work)
    else:
        add_to_x(x, h, v, work)
    acceleration_at(t + h, x, v, params, work, work[:n])
    work[EVALUATIONS] += 1.0
    add_to_v(v, 0.5 * h, work[:n], work)


def half_residual(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Write the residual of the adjoint kick or drift, whichever is being solved for."""
    if memory(work)[solver_memory(x.size)] == 1.0:
        kick_residual(t, h, x, v, params, work)
    else:
        drift_residual(t, h, x, v, params, work)


@compiled
def added(y: Floats, start: Floats, residual: Floats, residual_before: Floats, into: Floats) -> None:
    """Write the change of y, including the residuals of the sums."""
    for i in range(y.size):
        into[i] = (y[i] - start[i]) - (residual[i] - residual_before[i])


@compiled
def follow_to_zero(rows: Floats, n_rows: int) -> None:
    """Extrapolate by the scheme of Aitken and Neville; the last row becomes the result."""
    size = rows.size // n_rows
    for column in range(1, n_rows):
        for j in range(n_rows - 1, column - 1, -1):
            ratio = (j + 1) / (j + 1 - column)
            for i in range(size):
                change = rows[j * size + i] - rows[(j - 1) * size + i]
                rows[j * size + i] += change / (ratio * ratio - 1.0)
