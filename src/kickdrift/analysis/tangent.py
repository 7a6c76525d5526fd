"""The tangent map: the effect of steps of a method on small differences between states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods
from kickdrift.analysis.spans import step_of
from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.engine.solve import solve
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System

Floats = NDArray[np.float64]
Map = Callable[[Floats], Floats]

# Central differences of order six: f'(0) ~ sum w_k (f(k e) - f(-k e)) / e (Fornberg, Math. Comp. 51, 699 (1988)).
_STENCIL = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))


def scales_of(x: Floats, v: Floats, step: float) -> Floats:
    """Return increments that move x as far in a step as they change it: both halves have the same rounding in a Jacobian."""
    length = max(float(np.abs(x).max()), abs(step) * float(np.abs(v).max(initial=0.0))) or 1.0
    return np.concatenate([np.full(x.size, length), np.full(v.size, length / abs(step))])


def jacobian(image: Map, y: Floats, increments: Floats) -> Floats:
    """Return the Jacobian of a map of rows of states, by central differences of order six."""
    offsets = np.array([sign * k for k, _ in _STENCIL for sign in (1, -1)])
    rows = y + np.einsum("k,ij->ikj", offsets, np.diag(increments)).reshape(-1, y.size)
    images = image(rows).reshape(y.size, len(_STENCIL), 2, y.size)
    weights = np.array([weight for _, weight in _STENCIL])
    columns = np.einsum("k,ikj->ij", weights, images[:, :, 0] - images[:, :, 1]) / increments[:, None]
    return np.ascontiguousarray(columns.T)


def tangent_map(
    problem: System | Problem | Callable[..., Any],
    method: str | methods.Method,
    step: float,
    at: tuple[ArrayLike, ArrayLike] | None = None,
    *,
    n_steps: int = 1,
    t: float = 0.0,
    increment: float = 2e-3,
    args: Sequence[float] | None = None,
    compile: bool = True,  # noqa: A002 - as in `solve`
) -> Floats:
    """Return the derivative of steps of a method with respect to the initial state.

    It is the derivative of the method, not of the equations: the product of the derivatives of the single steps, each by
    central differences of order six. Applied to a small difference of states, it gives the difference after the steps; for
    symplectic methods and unit masses it is symplectic.

    Parameters
    ----------
    problem, method, args, compile
        As for `kickdrift.solve`.
    step : float
        Size of a step, with its sign.
    at : (x, v), optional
        The initial state; by default that of the system, if it has one.
    n_steps : int
        Number of steps.
    t : float
        The initial time, for forces that depend on it.
    increment : float
        Of the differences: in x relative to the largest component of x, or of v times the step if that is larger; in v that
        over the step.

    Returns
    -------
    (2 n, 2 n) array
        For n numbers in x, in the order of x and then v; (n, n) for first-order equations.

    Raises
    ------
    ArgumentError
        For a step of 0, fewer steps than one, an increment that is not between 0 and 1, and whatever `kickdrift.solve`
        refuses.
    KickdriftError
        If a step fails.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> matrix = kd.analysis.tangent_map(kd.systems.harmonic_oscillator(), "kick-drift", 0.1)
    >>> np.round(matrix, 6)
    array([[ 0.99,  0.1 ],
           [-0.1 ,  1.  ]])
    """
    if not 0 < increment < 1:
        raise ArgumentError(f"increment={increment!r} must lie between 0 and 1; 2e-3 suits most problems.")
    if not is_whole(n_steps, 1):
        raise ArgumentError(f"n_steps={n_steps!r} must be a whole number of at least 1.")
    steps = Steps(problem, method, step, *(at if at is not None else (None, None)), t=t, args=args, compile_=compile)
    matrix, state, size = np.eye(steps.start.size), steps.start, steps.x0.size
    for k in range(n_steps):
        image = partial(steps.advance, t + k * step, count=1)
        matrix = jacobian(image, state, increment * scales_of(state[:size], state[size:], step)) @ matrix
        state = image(state[None])[0]
    return matrix


class Steps:
    """Steps of a method from many states at once, as rows of x and then v."""

    def __init__(
        self,
        problem: Any,
        method: str | methods.Method,
        step: float,
        x0: ArrayLike | None,
        v0: ArrayLike | None,
        *,
        t: float,
        args: Sequence[float] | None,
        compile_: bool,
    ) -> None:
        step = step_of(step)
        run = solve(
            problem, (t, t + step), x0, v0, step=abs(step), method=method, args=args, compile=compile_, progress=False
        )
        if run.dense is None:
            raise ArgumentError(
                "the problem is stochastic, and its tangent map is not defined here; use a problem without noise."
            )
        self.x0, self.v0, self._step = run.x[0], run.v[0], step
        self.start = np.concatenate([run.x[0].reshape(-1), run.v[0].reshape(-1)])
        self._processing = run.dense.compile()

    def advance(self, t: float, rows: Floats, count: int) -> Floats:
        """Do so many steps from each row.

        Raises
        ------
        KickdriftError
            If one of them fails.
        """
        size, many = self.x0.size, rows.shape[0]
        xs, vs = rows[:, :size].reshape(many, *self.x0.shape), rows[:, size:].reshape(many, *self.v0.shape)
        sizes, counts = np.full(many, self._step), np.full(many, count, dtype=np.int64)
        x, v, _ = self._processing.go_on(np.full(many, float(t)), sizes, counts, xs, vs)
        if not (np.isfinite(x).all() and np.isfinite(v).all()):
            raise KickdriftError(
                f"step={self._step!r} leads to a state that is not finite from t={t!r}; use a smaller one."
            )
        return np.concatenate([x.reshape(many, -1), v.reshape(many, -1)], axis=1)
