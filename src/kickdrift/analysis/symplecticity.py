"""Symplecticity of one step."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods
from kickdrift.analysis.one_step import take_step
from kickdrift.analysis.tangent import jacobian, scales_of
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.systems import ChargedParticle, Constrained, Langevin, Newtonian
from kickdrift.systems.problem import Problem
from kickdrift.systems.second_order import to_each_number
from kickdrift.systems.system import System, start

Floats = NDArray[np.float64]


def symplecticity_defect(
    problem: System | Problem | Callable[..., Any],
    method: str | methods.Method,
    step: float,
    at: tuple[ArrayLike, ArrayLike] | None = None,
    *,
    t: float = 0.0,
    masses: ArrayLike | None = None,
    increment: float = 2e-3,
) -> float:
    """Return max |J' Omega J - Omega|, with J the Jacobian of one step by central differences of order six.

    Parameters
    ----------
    problem : System, SecondOrder or callable
        As for `kickdrift.solve`.
    method : str or Method
        Name of a method.
    step : float
        Size of the step, with its sign.
    at : (x, v), optional
        The state; by default the initial state of the system, if it has one. For a state of d numbers the step is run 12 d
        times.
    t : float
        The time, for a force that depends on it.
    masses : array_like, optional
        Of a shape that broadcasts to the state: the two-form is sum_i m_i dx_i ^ dv_i, so it depends on the masses of
        bodies. By default those of a `kickdrift.Newtonian`, or 1.
    increment : float
        Of the differences: in x relative to the largest component of x, or of step * v if that is larger; in v that over the
        step. A much shorter length scale, such as a close pair's, needs a smaller increment.

    Returns
    -------
    float
        Zero for a symplectic step, up to rounding, about 1e-16 / `increment`, and truncation: at most 1e-13 for the
        pendulum and 5e-13 for the Kepler problem with an eccentricity of 0.6 at steps up to 0.1.

    Raises
    ------
    ArgumentError
        For masses or a state of the wrong shape, a step of 0, an increment that is not positive, or a kind of problem
        without such a two-form.

    Notes
    -----
    Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), section VI.2.

    Examples
    --------
    >>> import kickdrift as kd
    >>> pendulum = kd.systems.pendulum()
    >>> defects = [
    ...     kd.analysis.symplecticity_defect(pendulum, name, 0.1)
    ...     for name in ("leapfrog", "runge-kutta-4")
    ... ]
    >>> defects[0] < 1e-12 < defects[1]
    True
    """
    if not getattr(problem, "has_velocity", True) or getattr(problem, "kind", None) is Kind.FIRST_ORDER:
        raise ArgumentError(
            f"problem={problem!r} has no velocities or momenta, and so no two-form to conserve; describe it as"
            " kd.Hamiltonian or kd.SecondOrder if it has."
        )
    if isinstance(problem, ChargedParticle | Constrained | Langevin):
        raise ArgumentError(
            f"problem={type(problem).__name__} has no symplecticity defect here: in a magnetic field v is not the"
            " canonical momentum, constraints exclude finite differences, and noise is not symplectic."
        )
    if masses is None:
        masses = problem.mass if isinstance(problem, Newtonian) else 1.0
    if not 0 < increment < 1:
        raise ArgumentError(f"increment={increment!r} must lie between 0 and 1; 2e-3 suits most problems.")
    x, v = _place(problem, at)
    try:
        m = to_each_number(masses, x.shape)
    except ValueError:
        raise ArgumentError(
            f"masses of shape {np.shape(masses)} do not fit states of shape {x.shape}; for (N, 3) give N."
        ) from None
    size = x.size
    if step == 0:
        raise ArgumentError(f"step={step!r} must not be 0; give the size of one step, with its sign.")
    if x.shape != v.shape:
        raise ArgumentError(f"at has x of shape {x.shape} and v of shape {v.shape}; give one velocity per position.")

    def image(rows: Floats) -> Floats:
        halves = rows.reshape(-1, 2, *x.shape)
        ends = [take_step(problem, method, step, start(x), start(v), t) for x, v in halves]
        return np.array([np.ravel(end) for end in ends])

    y = np.concatenate([x.reshape(-1), v.reshape(-1)])
    matrix = jacobian(image, y, increment * scales_of(x, v, step))
    omega = np.zeros((2 * size, 2 * size))
    omega[:size, size:], omega[size:, :size] = np.diag(m), -np.diag(m)
    return float(np.abs(matrix.T @ omega @ matrix - omega).max())


def _place(problem: Any, at: tuple[ArrayLike, ArrayLike] | None) -> tuple[Floats, Floats]:
    if at is not None:
        x, v = at
        return start(x), start(v)
    if not isinstance(problem, System):
        raise ArgumentError("at is missing; a function has no start of its own: give at=(x, v).")
    return problem.x0, problem.v0
