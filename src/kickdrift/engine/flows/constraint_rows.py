"""The Jacobian of constraints in memory, and the quantities that flows compute from it.

Layout of params: those of the system's functions, the number m of constraints, a length that differences are measured
by, the inverse masses (n).

Layout of memory::

    0     number of rows with a multiplier
    1     Jacobian where the next drift starts (m n)
          inverse lengths of its rows (m), sums of their sizes (m), their order, those with a multiplier first (m)
          S, with rows of the identity for those without, factored (m m), pivots (m)
          residual (m), multipliers (m), increment (n), its total (n), state reached (n)
          another Jacobian (m n), S of all rows (m m), room for differences (m)
          for a few numbers, the response: the increment for each residual (n m)
"""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.linear_algebra import independent, lu_factor, lu_solve
from kickdrift.core.views import part
from kickdrift.engine.flows.implicit import clear, scale
from kickdrift.engine.flows.layout import FEW

Floats = NDArray[np.float64]
_INDEPENDENT = 1e-12  # squared distance of a row from the span of others


def memory_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers."""
    m = count(n, params)
    return 1 + 3 * m * n + 2 * m * m + 7 * m + 3 * n


def constants(coefficients: Floats, n: int, params: Floats, general: bool) -> dict[str, int]:
    """Return the constants with which a flow for a small state is compiled."""
    return {"COUNT": count(n, params)} if n <= FEW else {}


@compiled(inline=True)
def count(n: int, params: Floats) -> int:
    """Return the number of constraints."""
    return int(params[params.size - n - 2])


@compiled(inline=True)
def rows_of(n: int, m: int, own: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the Jacobian, inverse lengths of its rows, sums of their sizes, and their order."""
    lengths = 1 + m * n
    sums, order = lengths + m, lengths + 2 * m
    return part(own, 1, m * n), part(own, lengths, m), part(own, sums, m), part(own, order, m)


@compiled(inline=True)
def factored(n: int, m: int, own: Floats) -> tuple[Floats, Floats]:
    """Return S and its pivots."""
    start = 1 + m * n + 3 * m
    return part(own, start, m * m), part(own, start + m * m, m)


@compiled(inline=True)
def iterated(n: int, m: int, own: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Return the residual, the multipliers, the increment, its total, and the state reached."""
    left = 1 + m * n + m * m + 4 * m
    multipliers, increment = left + m, left + 2 * m
    total, reached = increment + n, increment + 2 * n
    return (
        part(own, left, m),
        part(own, multipliers, m),
        part(own, increment, n),
        part(own, total, n),
        part(own, reached, n),
    )


@compiled(inline=True)
def spare(n: int, m: int, own: Floats) -> tuple[Floats, Floats, Floats]:
    """Return room for another Jacobian, for S of all rows, and for differences."""
    rows = 1 + m * n + m * m + 6 * m + 3 * n
    products, room = rows + m * n, rows + m * n + m * m
    return part(own, rows, m * n), part(own, products, m * m), part(own, room, m)


@compiled(inline=True)
def response_of(n: int, m: int, own: Floats) -> Floats:
    """Return the increments for a unit of each residual."""
    return part(own, 1 + 2 * m * n + 2 * m * m + 7 * m + 3 * n, n * m)


@compiled(inline=True)
def respond(n: int, m: int, params: Floats, own: Floats) -> None:
    """Write the response to each residual, -M^-1 G^T S^-1, which is faster to apply than to solve for."""
    rows, inverse, _, order = rows_of(n, m, own)
    _, multipliers, increment, _, _ = iterated(n, m, own)
    matrix, pivots = factored(n, m, own)
    response = response_of(n, m, own)
    for k in range(m):
        i = int(order[k])
        clear(multipliers)
        multipliers[k] = -inverse[i] if k < own[0] else 0.0
        lu_solve(matrix, pivots, multipliers)
        push(rows, inverse, order, multipliers, params, increment)
        for j in range(n):
            response[j * m + i] = increment[j]


@compiled(inline=True)
def apply(response: Floats, left: Floats, increment: Floats) -> None:
    """Write the increment for the residual."""
    m = left.size
    for j in range(increment.size):
        increment[j] = 0.0
        for i in range(m):
            increment[j] += response[j * m + i] * left[i]


@compiled(inline=True)
def measure(rows: Floats, params: Floats, inverse: Floats, sums: Floats) -> None:
    """Write inverse lengths in the metric of the inverse masses, and sums of sizes; 1 for a row of zeros."""
    m = inverse.size
    n = rows.size // m
    for i in range(m):
        square = total = 0.0
        for j in range(n):
            square += rows[i * n + j] ** 2 * params[params.size - n + j]
            total += abs(rows[i * n + j])
        inverse[i] = 1.0 / scale(np.sqrt(square), 0.0)
        sums[i] = scale(total, 0.0)


@compiled(inline=True)
def multiply(left: Floats, right: Floats, inverse: Floats, params: Floats, products: Floats) -> None:
    """Write left M^-1 right^T, both by the lengths of rows."""
    m = inverse.size
    n = left.size // m
    for i in range(m):
        for k in range(m):
            product = 0.0
            for j in range(n):
                product += left[i * n + j] * right[k * n + j] * params[params.size - n + j]
            products[i * m + k] = product * (inverse[i] * inverse[k])


@compiled(inline=True)
def factor_rows(n: int, m: int, params: Floats, own: Floats) -> bool:
    """Measure the rows of the Jacobian, choose those that get a multiplier, and factor S."""
    rows, inverse, sums, order = rows_of(n, m, own)
    _, products, _ = spare(n, m, own)
    measure(rows, params, inverse, sums)
    multiply(rows, rows, inverse, params, products)
    matrix, _ = factored(n, m, own)
    for k in range(m * m):
        matrix[k] = products[k]
    own[0] = independent(matrix, order, _INDEPENDENT)
    return factor_products(n, m, own)


@compiled
def factor_with(left: Floats, n: int, m: int, params: Floats, own: Floats) -> bool:
    """Factor S with another Jacobian on its left."""
    rows, inverse, _, _ = rows_of(n, m, own)
    _, products, _ = spare(n, m, own)
    multiply(left, rows, inverse, params, products)
    return factor_products(n, m, own)


@compiled(inline=True)
def factor_products(n: int, m: int, own: Floats) -> bool:
    """Factor the part of S, given for all rows, of those with a multiplier; the others are decoupled."""
    _, _, _, order = rows_of(n, m, own)
    _, products, _ = spare(n, m, own)
    matrix, pivots = factored(n, m, own)
    rank = int(own[0])
    for k in range(m):
        for q in range(m):
            both = k < rank and q < rank
            matrix[k * m + q] = products[int(order[k]) * m + int(order[q])] if both else (1.0 if k == q else 0.0)
    return lu_factor(matrix, pivots)


@compiled(inline=True)
def push(rows: Floats, inverse: Floats, order: Floats, multipliers: Floats, params: Floats, out: Floats) -> None:
    """Write M^-1 G^T times multipliers of the scaled rows."""
    n = out.size
    clear(out)
    for k in range(multipliers.size):
        i = int(order[k])
        for j in range(n):
            out[j] += rows[i * n + j] * (multipliers[k] * inverse[i])
    for j in range(n):
        out[j] *= params[params.size - n + j]


def farthest(left: Floats, sums: Floats) -> float:
    """Return the largest change of the state that the residual requires; NaN if the residual contains one."""
    greatest = 0.0
    for i in range(left.size):
        size = abs(left[i]) / sums[i]
        if not size <= greatest:
            greatest = size
    return greatest
