"""Methods of kicks and drifts as solvers of SciPy: ``solve_ivp(fun, t_span, y0, method=StormerVerlet, step=0.01)``.

The classes are ``SemiImplicitEuler``, ``StormerVerlet``, ``Ruth3``, ``BlanesMoanS6``, ``BlanesMoanSrkn6b``,
``BlanesMoanSrkn11b``, ``Yoshida6`` and ``KahanLi8``; `solver` makes those of other methods. SciPy's events, dense output and
`t_eval` work with them. The state is y = [x, v], and ``fun(t, y)`` returns [x', v'], where v' may depend on t and x, and x' on
t and v: x'' = a(t, x), and Hamiltonians T(p, t) + V(q, t). Every step calls the function in Python; `kickdrift.solve` is about
a hundred times as fast, and supports other kinds of problem.
"""

import math
import warnings
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DenseOutput, OdeSolver

from kickdrift import methods
from kickdrift.core.arguments import real
from kickdrift.core.errors import ArgumentError
from kickdrift.methods import Kind, Letter, Method

Floats = NDArray[np.float64]

_TRIED = 1e-3  # of its size, by which v is changed to see whether v' depends on it, and x likewise; and of the span
_UNEVEN = 0.6180339887498949  # the golden ratio: the fractions of its multiples all differ


class SplittingSolver(OdeSolver):
    """The base class of the solvers, each for one method of kicks and drifts, with a fixed step.

    Parameters
    ----------
    fun, t0, y0, t_bound, vectorized
        As for SciPy's solvers; y0 is [x, v], and real.
    step : float
        Largest step allowed. A whole number of equal steps leads to t_bound.
    **extraneous
        Options of other solvers, such as rtol and atol, which a fixed step does not use; they cause a warning, as in SciPy's
        solvers.

    Raises
    ------
    ArgumentError
        For a step that is not positive and finite, an end that is not finite, and for states and functions without these two
        halves.
    """

    method: ClassVar[Method]
    t: float
    y: Floats

    def __init__(
        self,
        fun: Callable[[float, Floats], Any],
        t0: float,
        y0: Any,
        t_bound: float,
        step: float | None = None,
        vectorized: bool = False,
        **extraneous: Any,
    ) -> None:
        if extraneous:
            warnings.warn(
                f"{', '.join(sorted(extraneous))} given, which a fixed step does not use; give step=... alone.",
                stacklevel=3,
            )
        super().__init__(fun, t0, y0, t_bound, vectorized)
        if self.n % 2:
            raise ArgumentError(f"y0 has {self.n} numbers; give positions and as many velocities, [x, v].")
        self._half = self.n // 2
        self._steps = _count(step, t0, t_bound)
        self._check_halves()
        self._t0, self._h, self._done = t0, (t_bound - t0) / self._steps, 0
        self.h_abs = abs(self._h)

    def _check_halves(self) -> None:
        """Check that each half's rate depends on the other half alone, and that x' is linear in v where the method needs it.

        Shortly after the start, and at unequal distances from it: factors of a half may be zero there, such as a time or the
        difference of two numbers.
        """
        unequal = 1.0 + np.modf(_UNEVEN * np.arange(self.n))[0]
        n, y, wrong = self._half, self.y + _TRIED * unequal * (1.0 + np.abs(self.y)), ""
        rate = self._rates(y)
        for own, what in ((np.s_[:n], "x' depends on x"), (np.s_[n:], "v' depends on v")):
            changed = y.copy()
            changed[own] = self.y[own]
            same = np.array_equal(self._rates(changed)[own], rate[own], equal_nan=True)
            wrong = wrong if same else what
        if self.method.kind is Kind.NEWTONIAN:
            doubled = self._rates(np.append(y[:n], 2.0 * y[n:]))[:n]
            wrong = (
                wrong
                if np.allclose(doubled, 2.0 * rate[:n], rtol=1e-9, atol=0.0, equal_nan=True)
                else "x' is not linear in v"
            )
        if wrong and self.method.order > 1:
            raise ArgumentError(
                f"fun returns [x', v'], in which {wrong}: {self.method.name!r} would lose its order. Use"
                " kickdrift.solve, which has methods for this."
            )

    def _rates(self, y: Floats) -> Floats:
        """Return a copy of the rates shortly after the start; `fun` may return the same array again."""
        rates = np.array(self.fun(self.t + _TRIED * (self.t_bound - self.t), y), dtype=float)
        if rates.shape != y.shape:
            raise ArgumentError(
                f"fun returned an array of shape {rates.shape}, but y0 has {self.n} numbers; return [x', v']."
            )
        return rates

    def _moved(self, t: float, y: Floats, h: float) -> Floats:
        """Return the state after a step of any size; the clock moves with the positions."""
        y, n, x_clock, v_clock = y.copy(), self._half, 0.0, 0.0
        for letter, weight in self.method.word:
            share = float(weight)
            if letter is Letter.KICK:
                y[n:] += share * h * np.asarray(self.fun(t + x_clock * h, y))[n:]
                v_clock += share
            else:
                y[:n] += share * h * np.asarray(self.fun(t + v_clock * h, y))[:n]
                x_clock += share
        return y

    def _step_impl(self) -> tuple[bool, str | None]:
        y = self._moved(self.t, self.y, self._h)
        if not np.isfinite(y).all():
            return False, "the state is not finite after this step; use a smaller one"
        self._done += 1
        self._before = self.t, self.y
        self.t = self.t_bound if self._done == self._steps else self._t0 + self._done * self._h
        self.y = y
        return True, None

    def _dense_output_impl(self) -> DenseOutput:
        return _Between(*self._before, self.t, self.y, self._moved)


class _Between(DenseOutput):
    """States within a step, by shorter ones from its start."""

    def __init__(self, t_old: float, y_old: Floats, t: float, y: Floats, moved: Callable[..., Floats]) -> None:
        super().__init__(t_old, t)
        self._y_old, self._y, self._moved = y_old, y, moved

    def _call_impl(self, t: Any) -> Floats:
        if np.ndim(t):
            return np.stack([self._call_impl(one) for one in t], axis=-1)
        return self._y if t == self.t else self._moved(self.t_old, self._y_old, t - self.t_old)


def _count(step: Any, t0: float, t_bound: float) -> int:
    try:
        size = real(step)
    except TypeError:
        size = math.nan
    length = abs(t_bound - t0)
    if not math.isfinite(length):
        raise ArgumentError(
            f"t0={t0!r} and t_bound={t_bound!r} must be finite, since a whole number of equal steps lies between them."
        )
    if not 0.0 < size < math.inf:
        raise ArgumentError(f"step={step!r} must be positive and finite: solve_ivp(..., method=..., step=0.01).")
    return max(1, math.ceil(length / size * (1.0 - 1e-12)))


def solver(method: str | Method) -> type[SplittingSolver]:
    """Return a method as a class for `solve_ivp`.

    Parameters
    ----------
    method : str or Method
        A method of kicks and drifts, such as ``"blanes-moan-s6"``.

    Returns
    -------
    type
        A `SplittingSolver`, for ``solve_ivp(..., method=...)``.

    Raises
    ------
    ArgumentError
        For a method that has other letters.

    Examples
    --------
    >>> import scipy.integrate, kickdrift.scipy
    >>> Yoshida6 = kickdrift.scipy.solver("yoshida-6")
    >>> sol = scipy.integrate.solve_ivp(
    ...     lambda t, y: [y[1], -y[0]], (0, 1), [1, 0], method=Yoshida6, step=0.1
    ... )
    >>> round(float(sol.y[0, -1]), 6)
    0.540302
    """
    found = methods.get(method) if isinstance(method, str) else method
    if not set(found.letters) <= {Letter.KICK, Letter.DRIFT} or found.corrector:
        raise ArgumentError(
            f"method={found.name!r} needs more than kicks and drifts, which are all that fun defines; use"
            " kickdrift.solve."
        )
    name = "".join(part.capitalize() for part in (method if isinstance(method, str) else found.name).split("-"))
    return type(
        name, (SplittingSolver,), {"method": found, "__doc__": f"{found.name}, order {found.order}: {found.source}."}
    )


SemiImplicitEuler = solver("semi-implicit-euler")
StormerVerlet = solver("stormer-verlet")
Ruth3 = solver("ruth-3")
BlanesMoanS6 = solver("blanes-moan-s6")
BlanesMoanSrkn6b = solver("blanes-moan-srkn6b")
BlanesMoanSrkn11b = solver("blanes-moan-srkn11b")
Yoshida6 = solver("yoshida-6")
KahanLi8 = solver("kahan-li-8")
