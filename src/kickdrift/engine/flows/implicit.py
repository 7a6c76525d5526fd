"""The solver inside the implicit flows: for m unknowns z with z = Phi(z), a fixed-point iteration, then Newton's.

The fixed-point iteration needs no Jacobian, and is used where it contracts so fast that a matrix would cost more. Otherwise
`newton` forms I - dPhi/dz by differences and keeps it for many steps, until its iteration contracts slowly, too. Iterations
continue until the increments stop shrinking: a looser criterion would make the energy drift. (Hairer, Wanner, Solving
Ordinary Differential Equations II, 2nd ed., section IV.8; Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd
ed., section VIII.6.)

A flow that solves so is a template with a part ``residual``, which leaves Phi(z) - z as the increment, and the scales.
`solve`, `newton` and `form_matrix` are bound to it by `kickdrift.engine.letters`.

Layout of memory::

    0     number of unknowns m
    1     number of those, from the first, that are measured by the first scale; the others are by the second
    2, 3  scales: sizes of the unknowns, relative to which 1e-12 is rounding
    4, 5  the scales at the start of the iteration, in which increments are compared
    8     unknowns (m), increments (m), the last move (m), and the memory of the flow itself, each from a cache line on

The scratch has the matrix (m * m) and its pivots (m).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.views import float_of, part, words
from kickdrift.engine.flows.layout import KEPT_BY, KEPT_FOR, KEPT_TIMES, TROUBLE, memory

Floats = NDArray[np.float64]
ROUNDING = 1e-12  # of an increment against the unknowns
MOST_ITERATIONS = 50
MOST_WITH_MATRIX = 16_384  # unknowns: 2 GiB
_HEAD = 8
_MANY, _RETRIED_AFTER = 32, 20  # for more unknowns, one solution of this number is tried without a matrix
_NOT_THE_SIGN = 0x7FFF_FFFF_FFFF_FFFF

residual_inside: Callable[..., None] = unbound
newton: Callable[..., bool] = unbound


@compiled(inline=True)
def padded(m: int) -> int:
    """Round a length up to whole cache lines: vectors that cross lines are slow to read when just written."""
    return (m + 7) // 8 * 8


@compiled(inline=True)
def solver_memory(m: int) -> int:
    """Numbers of memory for m unknowns; those of the flow itself follow."""
    return _HEAD + 3 * padded(m)


def solver_scratch(m: int) -> int:
    """Numbers of scratch for m unknowns, of which there may be too many for a matrix."""
    return m * m + m if m <= MOST_WITH_MATRIX else 0


@compiled(inline=True)
def unknowns(m: int, work: Floats) -> Floats:
    """Return z."""
    return part(memory(work), _HEAD, m)


@compiled(inline=True)
def increments(m: int, work: Floats) -> Floats:
    """Return Phi(z) - z."""
    return part(memory(work), _HEAD + padded(m), m)


@compiled(inline=True)
def moves(m: int, work: Floats) -> Floats:
    """Return the last move of z."""
    return part(memory(work), _HEAD + 2 * padded(m), m)


@compiled(inline=True)
def patience(m: int) -> float:
    """Return the number of fixed-point iterations allowed, in units of that for a few unknowns.

    A matrix costs m residuals and m^3 / 1.5 operations, and each iteration with it m^2: the number of iterations without it
    that costs as much grows with m.
    """
    return 1.0 + m / 100 + m * m / 200_000


def solve(
    keeper: int, m: int, first: int, t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats
) -> bool:
    """Solve for the m unknowns, starting from those in memory; writes the solution there, or the residual to TROUBLE.

    The keeper is the number of the flow, which identifies the owner of the kept matrix; the first `first` unknowns have the
    first scale.
    """
    head = memory(work)
    head[0], head[1], head[4] = m, first, 0.0
    kept = work[KEPT_BY] == keeper and work[KEPT_FOR] == h
    if kept:
        work[KEPT_TIMES] += 1.0
        if m < _MANY or work[KEPT_TIMES] % _RETRIED_AFTER != 0.0:
            return newton(keeper, False, t, h, x, v, params, work)
    z, increment, last = unknowns(m, work), increments(m, work), moves(m, work)
    # The allowed contraction. Single increments may even grow: with complex eigenvalues every second one does.
    slow = (1.0 - 0.7 / patience(m)) * (0.8 if kept else 1.0)  # 0.3 for a few unknowns
    missing = previous = most = least = np.inf
    stalled, patient = 0, 0
    for _ in range(int(MOST_ITERATIONS * patience(m))):
        residual_inside(t, h, x, v, params, work)
        if head[4] == 0.0:
            head[4], head[5] = head[2], head[3]
        one = largest(part(increment, 0, first))
        missing, size = one / head[2], one / head[4]
        if first < m:
            other = largest(part(increment, first, m - first))
            missing, size = larger(missing, other / head[3]), larger(size, other / head[5])
        shrinking, rounding = size < previous, missing <= ROUNDING
        stalled = stalled + 1 if rounding and not size < least else 0
        if missing == 0.0 or stalled > patient:
            if kept:
                work[KEPT_BY] = 0.0
            return True
        if not (shrinking or size <= most or stalled > 0):
            if previous < np.inf:
                retreat(z, 1.0, last)
                return newton(keeper, not kept, t, h, x, v, params, work)
            break
        proceed(z, increment, last)
        if size > most and not rounding:
            return newton(keeper, not kept, t, h, x, v, params, work)
        if not shrinking and not rounding:
            patient = 3
        least = min(least, size)
        most = size if previous == np.inf else most * slow
        previous = size
    return missing <= ROUNDING or failed(missing, work)


@compiled
def failed(missing: float, work: Floats) -> bool:
    """Note the residual of a solve that failed, and that no matrix is kept."""
    work[KEPT_BY] = 0.0
    work[TROUBLE] = missing if np.isfinite(missing) else np.inf
    return False


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
    """Undo a fraction of the last move."""
    for i in range(z.size):
        z[i] -= share * last[i]
        last[i] -= share * last[i]


@compiled
def relative_size(increment: Floats, head: Floats, scales: int) -> float:
    """Maximum norm of increments in terms of the scales at an index of the head; NaN where there is one."""
    first = int(head[1])
    size: float = largest(part(increment, 0, first)) / head[scales]
    if first == increment.size:
        return size
    return larger(size, largest(part(increment, first, increment.size - first)) / head[scales + 1])


@compiled
def largest(values: Floats) -> float:
    """Maximum norm; NaN where there is one, whose bits are a larger integer than those of any number."""
    bits = words(values)
    greatest = 0
    for i in range(bits.size):
        greatest = max(greatest, bits[i] & _NOT_THE_SIGN)
    return float_of(greatest)


@compiled
def larger(size: float, other: float) -> float:
    """Return the larger of two sizes, NaN where one is."""
    return other if size <= other or np.isnan(other) else size


@compiled
def scale(size: float, other: float) -> float:
    """Return the larger of two sizes, 1 where both are zero."""
    greatest = size if not size <= other else other
    return greatest if greatest != 0.0 else 1.0
