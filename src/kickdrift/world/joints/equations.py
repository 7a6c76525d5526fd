"""Equations of joints that close loops: all but symmetric, small, and some of them say the same twice.

m equations lie in a row of numbers: the matrix (m m), right side (m), what a diagonal element was before anything else
held (m), order of elimination (m), which axis of which joint each equation is of (m).
"""

from typing import Any

from kickdrift.core.compilation import compiled

# An equation whose diagonal element falls below this part of what it was is one that the others imply: a four-bar linkage
# closed by a hinge has three of them. Rounding leaves some 1e-14 there, a ratio of masses of 1e6 still 1e-6.
_IMPLIED = 1e-10


def room_for(m: int) -> int:
    """Return how many numbers m equations take."""
    return m * (m + 4)


@compiled(cached=False)
def factor_equations(numbers: Any, at: int, m: int) -> int:
    """Factor the matrix in place with diagonal pivots, and return how many equations are independent."""
    scale, order = at + m * m + m, at + m * m + 2 * m
    for k in range(m):
        numbers[order + k] = k
    for k in range(m):
        p, best = k, 0.0
        for i in range(k, m):
            before = numbers[scale + int(numbers[order + i])]
            share = numbers[at + i * m + i] / before if before > 0.0 else 0.0
            if share > best:
                p, best = i, share
        if not best > _IMPLIED:
            return k
        numbers[order + k], numbers[order + p] = numbers[order + p], numbers[order + k]
        for j in range(m):
            numbers[at + k * m + j], numbers[at + p * m + j] = numbers[at + p * m + j], numbers[at + k * m + j]
        for i in range(m):
            numbers[at + i * m + k], numbers[at + i * m + p] = numbers[at + i * m + p], numbers[at + i * m + k]
        pivot = numbers[at + k * m + k]
        for i in range(k + 1, m):
            share = numbers[at + i * m + k] / pivot
            numbers[at + i * m + k] = share
            for j in range(k + 1, m):
                numbers[at + i * m + j] -= share * numbers[at + k * m + j]
    return m


@compiled(cached=False)
def solve_equations(numbers: Any, at: int, m: int, rank: int) -> None:
    """Replace the right side by the solution in which implied equations have none."""
    right, order = at + m * m, at + m * m + 2 * m
    for i in range(rank):
        row = int(numbers[order + i])
        for k in range(i):
            numbers[right + row] -= numbers[at + i * m + k] * numbers[right + int(numbers[order + k])]
    for i in range(rank - 1, -1, -1):
        row = int(numbers[order + i])
        for k in range(i + 1, rank):
            numbers[right + row] -= numbers[at + i * m + k] * numbers[right + int(numbers[order + k])]
        numbers[right + row] /= numbers[at + i * m + i]
    for i in range(rank, m):
        numbers[right + int(numbers[order + i])] = 0.0
