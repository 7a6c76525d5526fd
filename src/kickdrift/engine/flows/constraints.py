"""Projections onto holonomic constraints g(x) = 0, in the metric of the masses M.

Positions x after a drift go back to g(x) = 0 along M^-1 G^T, with the Jacobian G = dg/dx at the positions that the drift
left: a constraint force there, so that the step stays symplectic and, with its mirror image, symmetric. Velocities go to
G v = 0 with G where they are. (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed., section VII.1.)

Both solve for multipliers mu by increments -S^-1 r of what is left over, r = g(x + M^-1 G^T mu) or G (v + M^-1 G^T mu),
until the increments stop shrinking: a looser end would make the energy drift. S is G M^-1 G^T for rows of G scaled to
unit length. Where positions contract slowly, it is formed anew with the Jacobian of the positions reached on its left:
Newton's iteration. Rows within 1e-6 of the span of others get no multiplier: redundant constraints are fulfilled with
the others, and if they are not, the step fails. (Damping S by 1e-12 instead lets what redundant constraints disagree
about on the way leak into the tangent space, up to 1e-5 in a second of a pendulum.)

Layout of params: those of the system's functions, the number m of constraints, a length that differences are measured
by, the inverse masses (n).

Layout of memory::

    0     number of rows with a multiplier
    1     Jacobian where the next drift starts (m n)
          lengths of its rows (m), sums of their sizes (m), their order, those with a multiplier first (m)
          S, factored (m m), pivots (m)
          left over (m), multipliers (m), increment (n), its total (n), state reached (n)
          another Jacobian (m n), S of all rows (m m), room for differences (2 m)
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.linear_algebra import independent, lu_factor, lu_solve
from kickdrift.engine.flows.implicit import largest, scale
from kickdrift.engine.flows.layout import CONSTRAINT_JACOBIAN, TROUBLE, has_part, memory

Floats = NDArray[np.float64]
_INDEPENDENT = 1e-12  # squared distance of a row from the span of others
_ROUNDING = 1e-12  # of an increment, or of how far a constraint is from zero, against the state
_SLOW = 0.3  # a contraction slower than this is worth a new matrix
_MOST_ITERATIONS = 50
_DIFFERENCE = 1e-4  # of fourth order: truncation and rounding leave some 1e-12 of the Jacobian

constraints_at: Callable[..., None] = unbound
constraint_jacobian_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound
jacobian: Callable[..., None] = unbound
linearise: Callable[..., None] = unbound
leave_over: Callable[..., float] = unbound
renew: Callable[..., bool] = unbound
project: Callable[..., bool] = unbound


def memory_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers."""
    m = count(n, params)
    return 1 + 2 * m * n + 2 * m * m + 8 * m + 3 * n


@compiled(inline=True)
def count(n: int, params: Floats) -> int:
    """Return the number of constraints."""
    return int(params[params.size - n - 2])


@compiled(inline=True)
def rows_of(n: int, m: int, own: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the Jacobian, lengths of its rows, sums of their sizes, and their order."""
    lengths = 1 + m * n
    sums, order = lengths + m, lengths + 2 * m
    return own[1:lengths], own[lengths:sums], own[sums:order], own[order : order + m]


@compiled(inline=True)
def factored(n: int, m: int, own: Floats) -> tuple[Floats, Floats]:
    """Return S and its pivots, for the rows with a multiplier."""
    rank, start = int(own[0]), 1 + m * n + 3 * m
    pivots = start + m * m
    return own[start : start + rank * rank], own[pivots : pivots + rank]


@compiled(inline=True)
def iterated(n: int, m: int, own: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Return what is left over, the multipliers, the increment, its total, and the state reached."""
    left = 1 + m * n + m * m + 4 * m
    multipliers, increment = left + m, left + 2 * m
    total, reached = increment + n, increment + 2 * n
    return (
        own[left:multipliers],
        own[multipliers:increment],
        own[increment:total],
        own[total:reached],
        own[reached : reached + n],
    )


@compiled(inline=True)
def spare(n: int, m: int, own: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return room for another Jacobian, for S of all rows, and for differences."""
    rows = 1 + m * n + m * m + 6 * m + 3 * n
    products, above, below = rows + m * n, rows + m * n + m * m, rows + m * n + m * m + m
    return own[rows:products], own[products:above], own[above:below], own[below : below + m]


def linearise_constraints(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Leave the Jacobian at x and its S in memory; moves nothing."""
    n, m, own = x.size, count(x.size, params), memory(work)
    rows, lengths, sums, order = rows_of(n, m, own)
    _, products, _, _ = spare(n, m, own)
    jacobian(t, x, v, params, work, rows)
    measure(rows, params, lengths, sums)
    multiply(rows, rows, lengths, params, products)
    own[0] = m
    matrix, _ = factored(n, m, own)
    matrix[:] = products
    own[0] = independent(matrix, order, _INDEPENDENT)
    if not factor(n, m, own):
        work[TROUBLE] = np.inf


def constrain_positions(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Bring x, which drifted by h, back to the constraints, and v with it."""
    n = x.size
    _, _, _, total, _ = iterated(n, count(n, params), memory(work))
    if project(scale(largest(x), abs(h) * largest(v)), t, h, x, v, params, work):
        add_to_x(x, 1.0, total, work)
        add_to_v(v, 1.0 / h, total, work)
        linearise(t, h, x, v, params, work)


def constrain_velocities(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Bring v into the tangent space of the constraints at x, where the Jacobian in memory is from."""
    n = x.size
    _, _, _, total, _ = iterated(n, count(n, params), memory(work))
    if project(scale(largest(v), 0.0), t, h, x, v, params, work):
        add_to_v(v, 1.0, total, work)


def project_state(size: float, t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Find the total of the increments for a state of this size, or leave at TROUBLE what is left over."""
    n, m, own = x.size, count(x.size, params), memory(work)
    rows, lengths, _, order = rows_of(n, m, own)
    left, multipliers, increment, total, _ = iterated(n, m, own)
    matrix, pivots = factored(n, m, own)
    total[:] = 0.0
    previous, renewed, excess, moved = np.inf, False, np.inf, np.inf
    for iteration in range(_MOST_ITERATIONS):
        excess = leave_over(size, t, x, v, params, work)
        for k in range(pivots.size):
            i = int(order[k])
            multipliers[k] = -left[i] / lengths[i]
        lu_solve(matrix, pivots, multipliers[: pivots.size])
        push(rows, lengths, order, multipliers[: pivots.size], params, increment)
        moved = largest(increment) / size
        if not np.isfinite(moved):
            break
        shrinking = moved < previous
        if shrinking or moved > _ROUNDING:
            total += increment
        if moved == 0.0 or (not shrinking and moved <= _ROUNDING):
            break
        if iteration > 0 and moved > _SLOW * previous and moved > _ROUNDING:
            if renewed and not shrinking:
                break
            renewed = renew(t, x, v, params, work)
            previous = np.inf if renewed else moved
        else:
            previous = moved
    if moved <= _ROUNDING and excess <= _ROUNDING:
        return True
    trouble = max(excess, moved)
    work[TROUBLE] = trouble if np.isfinite(trouble) else np.inf
    return False


def positions_left_over(size: float, t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> float:
    """Leave g at the positions reached, and return how far from zero it is: the change of x that it asks for."""
    n, m, own = x.size, count(x.size, params), memory(work)
    _, _, sums, _ = rows_of(n, m, own)
    left, _, _, total, reached = iterated(n, m, own)
    for j in range(n):
        reached[j] = x[j] + total[j]
    constraints_at(t, reached, v, params, work, left)
    return farthest(left, sums) / size


def velocities_left_over(size: float, t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> float:
    """Leave G times the velocities reached; it is linear, so that small increments say enough."""
    n, m, own = x.size, count(x.size, params), memory(work)
    rows, _, _, _ = rows_of(n, m, own)
    left, _, _, total, reached = iterated(n, m, own)
    for j in range(n):
        reached[j] = v[j] + total[j]
    for i in range(m):
        left[i] = 0.0
        for j in range(n):
            left[i] += rows[i * n + j] * reached[j]
    return 0.0


def renew_at_positions(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Form and factor S with the Jacobian at the positions reached on its left."""
    n, m, own = x.size, count(x.size, params), memory(work)
    rows, lengths, _, _ = rows_of(n, m, own)
    _, _, _, total, reached = iterated(n, m, own)
    there, products, _, _ = spare(n, m, own)
    for j in range(n):
        reached[j] = x[j] + total[j]
    jacobian(t, reached, v, params, work, there)
    multiply(there, rows, lengths, params, products)
    return factor(n, m, own)


def renew_nothing(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Say that S is what it should be: in the velocities, the constraints are linear."""
    return False


def jacobian_here(t: float, x: Floats, v: Floats, params: Floats, work: Floats, out: Floats) -> None:
    """Write the Jacobian at x, by differences where the system has none; x is moved and put back."""
    if has_part(CONSTRAINT_JACOBIAN, work):
        constraint_jacobian_at(t, x, v, params, work, out)
        return
    n, m = x.size, count(x.size, params)
    _, _, above, below = spare(n, m, memory(work))
    d = _DIFFERENCE * scale(params[params.size - n - 1], largest(x))
    for j in range(n):
        kept = x[j]
        for k in range(1, 3):
            x[j] = kept + k * d
            constraints_at(t, x, v, params, work, above)
            x[j] = kept - k * d
            constraints_at(t, x, v, params, work, below)
            for i in range(m):
                slope = (above[i] - below[i]) / (2 * k * d)
                out[i * n + j] = slope if k == 1 else (4 * out[i * n + j] - slope) / 3
        x[j] = kept


@compiled
def measure(rows: Floats, params: Floats, lengths: Floats, sums: Floats) -> None:
    """Write lengths in the metric of the inverse masses, and sums of sizes; 1 for a row of zeros."""
    m = lengths.size
    n = rows.size // m
    for i in range(m):
        square = total = 0.0
        for j in range(n):
            square += rows[i * n + j] ** 2 * params[params.size - n + j]
            total += abs(rows[i * n + j])
        lengths[i] = scale(np.sqrt(square), 0.0)
        sums[i] = scale(total, 0.0)


@compiled
def multiply(left: Floats, right: Floats, lengths: Floats, params: Floats, products: Floats) -> None:
    """Write left M^-1 right^T, both by the lengths of rows."""
    m = lengths.size
    n = left.size // m
    for i in range(m):
        for k in range(m):
            product = 0.0
            for j in range(n):
                product += left[i * n + j] * right[k * n + j] * params[params.size - n + j]
            products[i * m + k] = product / (lengths[i] * lengths[k])


@compiled
def factor(n: int, m: int, own: Floats) -> bool:
    """Factor S of the rows with a multiplier, out of that of all rows."""
    _, _, _, order = rows_of(n, m, own)
    _, products, _, _ = spare(n, m, own)
    matrix, pivots = factored(n, m, own)
    for k in range(pivots.size):
        for q in range(pivots.size):
            matrix[k * pivots.size + q] = products[int(order[k]) * m + int(order[q])]
    return lu_factor(matrix, pivots)


@compiled
def push(
    rows: Floats, lengths: Floats, order: Floats, multipliers: Floats, params: Floats, out: Floats
) -> None:
    """Write M^-1 G^T times multipliers of the scaled rows that have one."""
    n = out.size
    out[:] = 0.0
    for k in range(multipliers.size):
        i = int(order[k])
        for j in range(n):
            out[j] += rows[i * n + j] * (multipliers[k] / lengths[i])
    for j in range(n):
        out[j] *= params[params.size - n + j]


@compiled
def farthest(left: Floats, sums: Floats) -> float:
    """Largest change of a number of the state that what is left over asks for; NaN where there is one."""
    greatest = 0.0
    for i in range(left.size):
        size = abs(left[i]) / sums[i]
        if not size <= greatest:
            greatest = size
    return greatest
