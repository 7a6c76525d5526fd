"""Newton's iteration with a kept matrix, for `kickdrift.engine.flows.implicit`, whose layout of memory it shares.

A step of Newton's after which the next increment is larger is halved until it is not.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import unbound
from kickdrift.core.elementwise import assign
from kickdrift.core.linear_algebra import lu_factor, lu_solve
from kickdrift.engine.flows.implicit import (
    MOST_ITERATIONS,
    MOST_WITH_MATRIX,
    ROUNDING,
    failed,
    increments,
    moves,
    proceed,
    relative_size,
    retreat,
    unknowns,
)
from kickdrift.engine.flows.layout import FORMED, KEPT_BY, KEPT_FOR, memory

Floats = NDArray[np.float64]
_SLOW = 0.3  # a contraction slower than this is worth m residuals for a new matrix

residual: Callable[..., None] = unbound
form_matrix: Callable[..., bool] = unbound
scratch: Callable[..., Floats] = unbound


def newton(keeper: int, forming: bool, t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Solve from the unknowns in memory on, with the kept matrix or, if `forming`, first a new one.

    Leaves the solution, or the residual at TROUBLE.
    """
    head = memory(work)
    m = int(head[0])
    if m > MOST_WITH_MATRIX:
        return failed(relative_size(increments(m, work), head, 2), work)
    z, increment, last = unknowns(m, work), increments(m, work), moves(m, work)
    matrix, pivots = scratch(0, m * m, work), scratch(m * m, m, work)
    kept, moved = not forming, forming
    missing = previous = np.inf
    rounding = halving = False
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
            moved, halving, previous = True, formed, size
        elif not moved:
            break
        else:
            # If Newton's first step was too long, half of it may suffice. Otherwise form the matrix at the start again.
            retreat(z, 0.5 if halving else 1.0, last)
            forming = not halving
    return rounding or failed(missing, work)


def form_matrix_by_differences(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> bool:
    """Form and factor I - dPhi/dz at z by forward differences, with one residual a column; overwrites the increments."""
    head = memory(work)
    m, first = int(head[0]), int(head[1])
    z, increment, base = unknowns(m, work), increments(m, work), moves(m, work)
    matrix, pivots = scratch(0, m * m, work), scratch(m * m, m, work)
    work[FORMED] += 1.0
    assign(base, increment)
    for j in range(m):
        unchanged = z[j]
        z[j] += 1.5e-8 * max(abs(z[j]), head[4] if j < first else head[5])
        residual(t, h, x, v, params, work)
        for i in range(m):
            matrix[i * m + j] = -(increment[i] - base[i]) / (z[j] - unchanged)
        z[j] = unchanged
    assign(increment, base)
    return lu_factor(matrix, pivots)
