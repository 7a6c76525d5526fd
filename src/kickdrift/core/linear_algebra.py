"""Small dense linear algebra for compiled flows, in place and without allocation."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled

Floats = NDArray[np.float64]


@compiled(inline=True)
def lu_factor(matrix: Floats, pivots: Floats) -> bool:
    """Factor a square matrix, given as n*n numbers row by row, in place with partial pivoting.

    Parameters
    ----------
    matrix : (n*n,) array
        Overwritten by the factors.
    pivots : (n,) array
        Filled with the row exchanged at each column.

    Returns
    -------
    bool
        False for a matrix that is singular to working precision.

    Notes
    -----
    Golub, Van Loan, Matrix Computations, 4th ed. (2013), section 3.4.
    """
    n = pivots.size
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if abs(matrix[i * n + k]) > abs(matrix[p * n + k]):
                p = i
        pivots[k] = p
        if not abs(matrix[p * n + k]) > 0.0:
            return False
        for j in range(n):
            matrix[k * n + j], matrix[p * n + j] = matrix[p * n + j], matrix[k * n + j]
        for i in range(k + 1, n):
            matrix[i * n + k] /= matrix[k * n + k]
            for j in range(k + 1, n):
                matrix[i * n + j] -= matrix[i * n + k] * matrix[k * n + j]
    return True


@compiled(inline=True)
def lu_solve(matrix: Floats, pivots: Floats, b: Floats) -> None:
    """Overwrite b, of n numbers, with the solution of the system that `lu_factor` factored."""
    n = pivots.size
    for k in range(n):
        p = int(pivots[k])
        b[k], b[p] = b[p], b[k]
    for i in range(n):
        for j in range(i):
            b[i] -= matrix[i * n + j] * b[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            b[i] -= matrix[i * n + j] * b[j]
        b[i] /= matrix[i * n + i]


@compiled(inline=True)
def independent(products: Floats, order: Floats, least: float) -> int:
    """Choose independent ones of m vectors by their scalar products, and return how many.

    Parameters
    ----------
    products : (m*m,) array
        Scalar products of each vector with each; overwritten.
    order : (m,) array
        Filled with the numbers of the vectors, those chosen first: at each turn the one farthest from the span of those
        before it.
    least : float
        Squared distance from that span above which a vector is independent.

    Notes
    -----
    Cholesky's method with diagonal pivoting: Golub, Van Loan, Matrix Computations, 4th ed. (2013), section 4.2.8.
    """
    m = order.size
    for k in range(m):
        order[k] = k
    for k in range(m):
        p = k
        for i in range(k + 1, m):
            if products[i * m + i] > products[p * m + p]:
                p = i
        order[k], order[p] = order[p], order[k]
        for j in range(m):
            products[k * m + j], products[p * m + j] = products[p * m + j], products[k * m + j]
        for i in range(m):
            products[i * m + k], products[i * m + p] = products[i * m + p], products[i * m + k]
        if not products[k * m + k] > least:
            return k
        for i in range(k + 1, m):
            share = products[i * m + k] / products[k * m + k]
            for j in range(k + 1, m):
                products[i * m + j] -= share * products[k * m + j]
    return m
