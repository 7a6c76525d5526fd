"""The coefficients of a Runge-Kutta method, partitioned if those of x and v differ."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.arguments import reals
from kickdrift.core.errors import ArgumentError

_ROUNDING = 1e-13


@dataclass(frozen=True)
class Tableau:
    """The Butcher tableau of a Runge-Kutta method with s stages, for `Method`; validated on creation.

    Attributes
    ----------
    a : s sequences of s numbers
        In row i, the weights of the slopes in stage i. The nodes c are the sums of the rows.
    b : sequence of s numbers
        Weights of the slopes in the step.
    a_of_v, b_of_v : the same for v, optional
        If v has different weights from x (Hairer, Lubich, Wanner, Geometric Numerical Integration, section II.2).
    error_weights : two sequences of s numbers, optional
        For `kickdrift.LocalError`: weights of the slopes in two estimates of the error of a step, the first of the higher
        order, which are combined as in Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, eq. (II.10.17).
    error_order : int
        The order of the estimated error: the error of a step scales as its size to this power plus one.

    Raises
    ------
    ArgumentError
        For an a that is not square or does not fit b, and for weights b that do not add up to 1.

    Examples
    --------
    The explicit midpoint rule:

    >>> from kickdrift.methods import Tableau
    >>> midpoint = Tableau(a=[[0, 0], [0.5, 0]], b=[0, 1])
    >>> midpoint.stages, midpoint.explicit, midpoint.symmetric
    (2, True, False)
    """

    a: Sequence[Sequence[Fraction | float]]
    b: Sequence[Fraction | float]
    a_of_v: Sequence[Sequence[Fraction | float]] | None = None
    b_of_v: Sequence[Fraction | float] | None = None
    error_weights: Sequence[Sequence[float]] | None = None
    error_order: int = 0

    def __post_init__(self) -> None:
        for name in ("a", "b", "a_of_v", "b_of_v"):
            _check_numbers(name, getattr(self, name), 1 if name[0] == "b" else 2)
        for a, b in ((self._a, self._b), (self._a_of_v, self._b_of_v)):
            if a.shape != (b.size, b.size) or b.shape != self._b.shape:
                raise ArgumentError(
                    f"a has shape {a.shape} but b has {b.size} weights; a must be square, with one row per weight."
                )
            if abs(b.sum() - 1) > _ROUNDING:
                raise ArgumentError(f"b={b.tolist()!r} adds up to {b.sum()!r}, not to 1.")

    @property
    def _a(self) -> NDArray[np.float64]:
        return np.array([[float(w) for w in row] for row in self.a])

    @property
    def _b(self) -> NDArray[np.float64]:
        return np.array([float(w) for w in self.b])

    @property
    def _a_of_v(self) -> NDArray[np.float64]:
        return self._a if self.a_of_v is None else np.array([[float(w) for w in row] for row in self.a_of_v])

    @property
    def _b_of_v(self) -> NDArray[np.float64]:
        return self._b if self.b_of_v is None else np.array([float(w) for w in self.b_of_v])

    @property
    def stages(self) -> int:
        """Number of stages."""
        return len(self.b)

    @property
    def explicit(self) -> bool:
        """Whether each stage depends only on earlier ones."""
        return not (np.triu(self._a).any() or np.triu(self._a_of_v).any())

    @property
    def symmetric(self) -> bool:
        """Whether a step of -h inverts a step of h (Hairer, Lubich, Wanner, theorem V.2.3)."""
        return all(
            np.allclose(a + a[::-1, ::-1], np.broadcast_to(b, a.shape), rtol=0, atol=_ROUNDING)
            and np.allclose(b, b[::-1], rtol=0, atol=_ROUNDING)
            for a, b in ((self._a, self._b), (self._a_of_v, self._b_of_v))
        )

    @property
    def symplectic(self) -> bool:
        """Whether b_i A_ij + B_j a_ji = b_i B_j, with b and a for x, B and A for v (theorem VI.4.6 there)."""
        b, b_of_v = self._b, self._b_of_v
        defect = b[:, None] * self._a_of_v + (b_of_v[:, None] * self._a).T - np.outer(b, b_of_v)
        return bool(np.abs(defect).max() < _ROUNDING and np.abs(b - b_of_v).max() < _ROUNDING)

    @property
    def onward(self) -> NDArray[np.float64]:
        """Weights of the slopes of a step in the stages of the next one, extrapolated by the polynomial through the slopes.

        Row i has the integrals from 1 to 1 + c_i of the polynomials that are 1 at one node and 0 at the others. Zeros
        where nodes coincide, and for explicit tableaux.
        """
        nodes, powers = self._a.sum(axis=1), np.arange(1, self.stages + 1)
        if self.explicit or np.unique(nodes).size < nodes.size:
            return np.zeros_like(self._a)
        integrals = ((1 + nodes[:, None]) ** powers - 1) / powers
        solved: NDArray[np.float64] = np.linalg.solve((nodes[:, None] ** (powers - 1)).T, integrals.T).T
        return solved

    @property
    def stiffly_accurate(self) -> bool:
        """Whether the last stage is the end of the step, and each stage an equation to solve.

        Fast decay is then complete after one step (Hairer, Wanner, Solving Ordinary Differential Equations II, section
        IV.3), if the method is A-stable.
        """
        same = self.a_of_v is None and self.b_of_v is None
        return same and not self.explicit and np.array_equal(self._a[-1], self._b) and bool(np.linalg.det(self._a))

    @property
    def embedded(self) -> NDArray[np.float64]:
        """Weights of the error estimate of a stiffly accurate tableau: of the slope at the start, then of those of the stages.

        The estimate is the difference from a quadrature of order s that also has the slope at the start. The weight of
        that slope is the real eigenvalue of a (Hairer, Wanner, section IV.8), or, if there is none, the modulus of the
        eigenvalue nearest to the real axis.
        """
        nodes, powers = self._a.sum(axis=1), np.arange(self.stages)
        eigenvalues = np.linalg.eigvals(self._a)
        first = abs(eigenvalues[np.argmin(abs(eigenvalues.imag))])
        missing = np.where(powers == 0, -first, 0.0)
        return np.append(first, np.linalg.solve(nodes[None, :] ** powers[:, None], missing))

    @property
    def numbers(self) -> NDArray[np.float64]:
        """The data for the engine: s, the nodes, a and b for x, a and b for v, and `onward`, matrices row by row.

        After them, of a stiffly accurate tableau, `embedded`; and at the end `error_weights`, if there are any.

        Time is one of the positions: its nodes are those of x.
        """
        a, a_of_v = self._a, self._a_of_v
        matrices = (a.sum(axis=1), a.ravel(), self._b, a_of_v.ravel(), self._b_of_v, self.onward.ravel())
        embedded = self.embedded if self.stiffly_accurate else ()
        errors = () if self.error_weights is None else np.ravel(self.error_weights)
        return np.concatenate([[float(self.stages)], *matrices, embedded, errors])


def _check_numbers(name: str, given: Any, dimensions: int) -> None:
    """Refuse anything but a list of numbers, or of rows of numbers; None stands for another one."""
    if given is None and name.endswith("_of_v"):
        return
    try:
        array = reals([list(row) for row in given] if dimensions == 2 else list(given))
    except Exception as error:  # of objects of all sorts
        raise ArgumentError(
            f"{name}={given!r} must be numbers: {error}; give Fraction(1, 2) or 0.5, not strings."
        ) from None
    if array.ndim != dimensions or not np.isfinite(array).all():
        raise ArgumentError(f"{name}={given!r} must be {'rows of ' * (dimensions - 1)}finite numbers.")
