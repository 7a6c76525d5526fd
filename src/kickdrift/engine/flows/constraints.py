"""Projections onto holonomic constraints g(x) = 0, in the metric of the masses M.

Positions x after a drift go back to g(x) = 0 along M^-1 G^T, with the Jacobian G = dg/dx where the drift started: a
constraint force there, so that the step stays symplectic and, with its mirror image, symmetric. Velocities go to
G v = 0 with G where they are. (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed., section VII.1.)

Both solve for multipliers mu by increments -S^-1 r with the residual r = g(x + M^-1 G^T mu) or G (v + M^-1 G^T mu), until the
increments stop shrinking, or are no larger than the rounding of the unknowns: a looser criterion would make the energy drift.
S is G M^-1 G^T for rows of G scaled to unit length. Where positions contract slowly, it is formed again with the Jacobian of
the positions reached on its left: Newton's iteration. Rows within 1e-6 of the span of others get no multiplier: redundant
constraints are satisfied with the others, and if they are not, the step fails. (Damping S by 1e-12 instead lets the
disagreement of redundant constraints during the iteration leak into the tangent space, up to 1e-5 in a second of a pendulum.)
For a few numbers the product of all these matrices is formed once, and an iteration is its product with the residual.

Templates, see `kickdrift.engine.flows.kick_drift`; the layout of their memory is in `constraint_rows`.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import unbound
from kickdrift.core.linear_algebra import lu_solve
from kickdrift.engine.flows.constraint_rows import (
    apply,
    count,
    factor_rows,
    factor_with,
    factored,
    iterated,
    push,
    respond,
    response_of,
    rows_of,
    spare,
)
from kickdrift.engine.flows.implicit import MOST_ITERATIONS, ROUNDING, clear, largest, scale
from kickdrift.engine.flows.layout import CONSTRAINT_JACOBIAN, TROUBLE, has_part, memory

Floats = NDArray[np.float64]
_SLOW = 0.3  # a contraction slower than this is worth a new matrix
_ROUNDED = 2.0**-53  # of the unknowns: rounding of the residual itself

SIZE, COUNT = 0, 0  # bound for a few numbers: of the state, and of constraints

constraints_at: Callable[..., None] = unbound
constraint_jacobian_at: Callable[..., None] = unbound
constraint_differences_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound
jacobian: Callable[..., None] = unbound
linearise: Callable[..., None] = unbound
leave_over: Callable[..., None] = unbound
excess_of: Callable[..., float] = unbound
renew: Callable[..., bool] = unbound
project: Callable[..., bool] = unbound


def linearise_constraints(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Write the Jacobian at x and its S into memory, without moving the state."""
    n, m, own = SIZE or x.size, COUNT or count(x.size, params), memory(work)
    rows, _, _, _ = rows_of(n, m, own)
    jacobian(t, x, v, params, work, rows)
    if not factor_rows(n, m, params, own):
        work[TROUBLE] = np.inf
    elif COUNT:
        respond(n, m, params, own)


def constrain_positions(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Project x, which drifted by h, back onto the constraints, and correct v accordingly."""
    n = SIZE or x.size
    _, _, _, total, _ = iterated(n, COUNT or count(n, params), memory(work))
    if project(scale(largest(x), abs(h) * largest(v)), t, h, x, v, params, work):
        add_to_x(x, 1.0, total, work)
        add_to_v(v, 1.0 / h, total, work)
        linearise(t, h, x, v, params, work)


def constrain_velocities(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Project v onto the tangent space of the constraints at x, where the Jacobian in memory was evaluated."""
    n = SIZE or x.size
    _, _, _, total, _ = iterated(n, COUNT or count(n, params), memory(work))
    if project(scale(largest(v), 0.0), t, h, x, v, params, work):
        add_to_v(v, 1.0, total, work)


def project_state(size: float, t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Find the total of the increments for a state of this size, or write the residual to TROUBLE."""
    n, m, own = SIZE or x.size, COUNT or count(x.size, params), memory(work)
    rows, inverse, sums, order = rows_of(n, m, own)
    left, multipliers, increment, total, _ = iterated(n, m, own)
    matrix, pivots = factored(n, m, own)
    rank, rounding = int(own[0]), ROUNDING * size
    clear(total)
    previous, renewed, moved = np.inf, False, np.inf
    for iteration in range(MOST_ITERATIONS):
        leave_over(t, x, v, params, work)
        if COUNT:
            apply(response_of(n, m, own), left, increment)
        else:
            for k in range(m):
                i = int(order[k])
                multipliers[k] = -left[i] * inverse[i] if k < rank else 0.0
            lu_solve(matrix, pivots, multipliers)
            push(rows, inverse, order, multipliers, params, increment)
        moved = largest(increment)
        if not np.isfinite(moved):
            break
        shrinking = moved < previous
        if shrinking or moved > rounding:
            for j in range(n):
                total[j] += increment[j]
        if moved <= _ROUNDED * size or (not shrinking and moved <= rounding):
            break
        if iteration > 0 and moved > _SLOW * previous and moved > rounding:
            if renewed and not shrinking:
                break
            renewed = renew(t, x, v, params, work)
            previous = np.inf if renewed else moved
        else:
            previous = moved
    excess = excess_of(left, sums)
    if moved <= rounding and excess <= rounding:
        return True
    trouble = max(excess, moved) / size
    work[TROUBLE] = trouble if np.isfinite(trouble) else np.inf
    return False


def positions_left_over(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Write g at the positions reached."""
    n, m, own = SIZE or x.size, COUNT or count(x.size, params), memory(work)
    left, _, _, total, reached = iterated(n, m, own)
    for j in range(n):
        reached[j] = x[j] + total[j]
    constraints_at(t, reached, v, params, work, left)


def nothing_in_excess(left: Floats, sums: Floats) -> float:
    """Return zero: the residual of velocities is linear, so that small increments suffice."""
    return 0.0


def velocities_left_over(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Write G times the velocities reached."""
    n, m, own = SIZE or x.size, COUNT or count(x.size, params), memory(work)
    rows, _, _, _ = rows_of(n, m, own)
    left, _, _, total, reached = iterated(n, m, own)
    for j in range(n):
        reached[j] = v[j] + total[j]
    for i in range(m):
        left[i] = 0.0
        for j in range(n):
            left[i] += rows[i * n + j] * reached[j]


def renew_at_positions(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Form and factor S with the Jacobian at the positions reached on its left."""
    n, m, own = SIZE or x.size, COUNT or count(x.size, params), memory(work)
    _, _, _, total, reached = iterated(n, m, own)
    there, _, _ = spare(n, m, own)
    for j in range(n):
        reached[j] = x[j] + total[j]
    jacobian(t, reached, v, params, work, there)
    factored_anew = factor_with(there, n, m, params, own)
    if COUNT and factored_anew:
        respond(n, m, params, own)
    return factored_anew


def renew_nothing(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Return False, since nothing is renewed: the constraints are linear in the velocities."""
    return False


def jacobian_here(t: float, x: Floats, v: Floats, params: Floats, work: Floats, out: Floats) -> None:
    """Write the Jacobian at x, by finite differences if the system has none."""
    if has_part(CONSTRAINT_JACOBIAN, work):
        constraint_jacobian_at(t, x, v, params, work, out)
    else:
        _, _, room = spare(SIZE or x.size, COUNT or count(x.size, params), memory(work))
        constraint_differences_at(t, x, room, params, work, out)
