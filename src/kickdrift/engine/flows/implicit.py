"""The solver inside the implicit flows: for m unknowns z with z = Phi(z), Newton's iteration with a kept matrix.

It starts with the identity for a matrix, a fixed-point iteration that needs no Jacobian at small steps. Where that
contracts slowly, I - dPhi/dz is formed by differences and kept, step after step, until it contracts slowly in its turn.
A Newton step after which the next increment is larger is halved until it is not. The iteration goes on until the
increments stop shrinking: a looser end would make the energy drift. (Hairer, Wanner, Solving Ordinary Differential
Equations II, 2nd ed., section IV.8; Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed., section VIII.6.)

A flow that solves so is a template with a part ``residual``, which leaves Phi(z) - z as the increment, and the scales.
`solve` and `form_matrix` are bound to it by `kickdrift.engine.letters`.

Layout of memory::

    0     number of unknowns m
    1     how many of them, from the first, are measured by the first scale; the others by the second
    2, 3  scales: sizes of the unknowns beside which 1e-12 is rounding
    4, 5  the scales at the start of the iteration, in which increments are compared
    6     unknowns (m), increments (m), the last move (m), pivots (m), matrix (m * m), and what the flow itself needs
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.linear_algebra import lu_factor, lu_solve
from kickdrift.engine.flows.layout import KEPT_BY, KEPT_FOR, TROUBLE, memory

Floats = NDArray[np.float64]
ROUNDING = 1e-12  # of an increment against the unknowns
MOST_ITERATIONS = 50
_HEAD = 6
_SLOW = 0.3  # a contraction slower than this is worth m residuals for a new matrix

residual: Callable[..., None] = unbound
form_matrix: Callable[..., bool] = unbound


@compiled(inline=True)
def solver_memory(m: int) -> int:
    """Numbers of memory for m unknowns; those of the flow itself come after."""
    return _HEAD + 4 * m + m * m


@compiled(inline=True)
def unknowns(m: int, work: Floats) -> Floats:
    """Return z."""
    return memory(work)[_HEAD : _HEAD + m]


@compiled(inline=True)
def increments(m: int, work: Floats) -> Floats:
    """Return Phi(z) - z."""
    return memory(work)[_HEAD + m : _HEAD + 2 * m]


def solve(keeper: int, t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Solve from the unknowns in memory on; leaves them there, or the residual at TROUBLE.

    The keeper is the number of the flow, which tells whose matrix is in memory.
    """
    head = memory(work)
    m = int(head[0])
    z, increment, last = unknowns(m, work), increments(m, work), head[_HEAD + 2 * m : _HEAD + 3 * m]
    pivots, matrix = head[_HEAD + 3 * m : _HEAD + 4 * m], head[_HEAD + 4 * m : solver_memory(m)]
    kept = work[KEPT_BY] == keeper and work[KEPT_FOR] == h
    missing = previous = np.inf
    head[4] = 0.0
    rounding = forming = moved = newton = False
    for _ in range(MOST_ITERATIONS):
        residual(t, h, x, v, params, work)
        if head[4] == 0.0:
            head[4], head[5] = head[2], head[3]
        missing = relative_size(increment, head, 2)
        if missing == 0.0:
            return True
        formed = forming
        if forming:
            kept = form_matrix(t, h, x, v, params, work)
            if not kept:
                break
            work[KEPT_BY], work[KEPT_FOR] = keeper, h
            previous = np.inf
        if kept:
            lu_solve(matrix, pivots, increment)
        size = relative_size(increment, head, 4)
        shrinking, rounding = size < previous, relative_size(increment, head, 2) <= ROUNDING
        if rounding and not shrinking:
            return True
        if shrinking:
            forming = size > _SLOW * previous and not rounding
            proceed(z, increment, last)
            moved, newton, previous = True, formed, size
        elif not moved:
            break
        else:
            # A step of Newton's was too long, and half of it may do. Any other wants a matrix from where it began.
            retreat(z, 0.5 if newton else 1.0, last)
            forming = not newton
    if rounding:
        return True
    work[KEPT_BY] = 0.0
    work[TROUBLE] = missing if np.isfinite(missing) else np.inf
    return False


def form_matrix_by_differences(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Form and factor I - dPhi/dz at z by forward differences, one residual a column; leaves the increments."""
    head = memory(work)
    m, first = int(head[0]), int(head[1])
    z, increment, base = unknowns(m, work), increments(m, work), head[_HEAD + 2 * m : _HEAD + 3 * m]
    pivots, matrix = head[_HEAD + 3 * m : _HEAD + 4 * m], head[_HEAD + 4 * m : solver_memory(m)]
    copy(increment, base)
    for j in range(m):
        unchanged = z[j]
        z[j] += 1.5e-8 * max(abs(z[j]), head[4] if j < first else head[5])
        residual(t, h, x, v, params, work)
        for i in range(m):
            matrix[i * m + j] = -(increment[i] - base[i]) / (z[j] - unchanged)
        z[j] = unchanged
    copy(base, increment)
    return lu_factor(matrix, pivots)


@compiled
def copy(values: Floats, into: Floats) -> None:
    """Copy numbers. An assignment to a slice takes 0.6 s more to compile, for the sentence of its error."""
    for i in range(values.size):
        into[i] = values[i]


@compiled
def clear(values: Floats) -> None:
    """Set numbers to zero."""
    for i in range(values.size):
        values[i] = 0.0


@compiled
def proceed(z: Floats, increment: Floats, last: Floats) -> None:
    """Move the unknowns by the increments, and note them as the last move."""
    for i in range(z.size):
        z[i] += increment[i]
        last[i] = increment[i]


@compiled
def retreat(z: Floats, share: float, last: Floats) -> None:
    """Take back a share of the last move."""
    for i in range(z.size):
        z[i] -= share * last[i]
        last[i] -= share * last[i]


@compiled
def relative_size(increment: Floats, head: Floats, scales: int) -> float:
    """Maximum norm of increments in terms of the scales at an index of the head; NaN where there is one."""
    first = int(head[1])
    norm = 0.0
    for j in range(increment.size):
        size = abs(increment[j]) / (head[scales] if j < first else head[scales + 1])
        if not size <= norm:
            norm = size
        if np.isnan(norm):
            break
    return norm


@compiled
def largest(values: Floats) -> float:
    """Maximum norm; NaN where there is one."""
    norm = 0.0
    for value in values:
        if not abs(value) <= norm:
            norm = abs(value)
        if np.isnan(norm):
            break
    return norm


@compiled
def scale(size: float, other: float) -> float:
    """Return the larger of two sizes, 1 where both are zero."""
    greatest = size if not size <= other else other
    return greatest if greatest != 0.0 else 1.0
