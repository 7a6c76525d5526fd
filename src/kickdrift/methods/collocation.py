"""The tableau that follows from its nodes by collocation."""

from collections.abc import Sequence
from fractions import Fraction

Matrix = tuple[tuple[Fraction, ...], ...]


def collocation(nodes: Sequence[Fraction]) -> tuple[Matrix, tuple[Fraction, ...]]:
    """Return the weights of stages and step, exact for the nodes as they are given.

    a_ij and b_j are the integrals, from 0 to c_i and from 0 to 1, of the polynomial that is 1 at c_j and 0 at the other
    nodes (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed., theorem II.1.4).
    """
    polynomials = [_lagrange(nodes, j) for j in range(len(nodes))]
    a = tuple(tuple(_integral(polynomial, node) for polynomial in polynomials) for node in nodes)
    return a, tuple(_integral(polynomial, Fraction(1)) for polynomial in polynomials)


def _lagrange(nodes: Sequence[Fraction], j: int) -> list[Fraction]:
    """Coefficients, constant first, of the polynomial that is 1 at node j and 0 at the others."""
    coefficients = [Fraction(1)]
    for k, node in enumerate(nodes):
        if k != j:
            times_x, times_node = [Fraction(0), *coefficients], [*(node * c for c in coefficients), Fraction(0)]
            coefficients = [(p - q) / (nodes[j] - node) for p, q in zip(times_x, times_node, strict=True)]
    return coefficients


def _integral(coefficients: Sequence[Fraction], end: Fraction) -> Fraction:
    return sum((c * end ** (k + 1) / (k + 1) for k, c in enumerate(coefficients)), Fraction(0))
