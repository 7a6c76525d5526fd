"""The order of a method, measured on a problem."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods
from kickdrift.analysis.reference import end_of_reference
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.engine.solution import Solution
from kickdrift.engine.solve import solve
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ObservedOrder:
    """The decrease of the error with the step.

    Attributes
    ----------
    method : str
        Name of the method.
    steps : (S,) array
        Sizes of the steps used, largest first.
    errors : (S,) array
        Largest error in x and v at the end of the span.
    order : float
        Slope of the least-squares line through log(errors) over log(steps).
    """

    method: str
    steps: Floats
    errors: Floats
    order: float

    @property
    def between(self) -> Floats:
        """Orders between successive steps, shape (S - 1,): if they agree, the steps are small enough."""
        slopes: Floats = np.diff(np.log(self.errors)) / np.diff(np.log(self.steps))
        return slopes


def observed_order(
    problem: System | Problem | Callable[..., Any],
    method: str | methods.Method,
    t_span: Sequence[float],
    steps: Sequence[float],
    x0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    reference: tuple[ArrayLike, ArrayLike] | None = None,
    args: Sequence[float] | None = None,
    compile: bool = True,  # noqa: A002 - as in `solve`
) -> ObservedOrder:
    """Measure the order of a method on a problem: the slope of log(error) against log(step).

    Parameters
    ----------
    problem, method, t_span, x0, v0, args, compile
        As for `kickdrift.solve`. For a Python function and up to some 10,000 steps in all, ``compile=False`` is faster: the
        runs take less time than compilation.
    steps : sequence of float
        At least two, each the largest allowed, as for `kickdrift.solve`.
    reference : (x, v), optional
        State at the end of the span, v empty for first-order equations. By default the exact solution of the system
        where it has one that starts with `t_span` at 0, or else a run of DOP853 at a relative tolerance of 1e-13:
        errors should lie above 1e-11.

    Returns
    -------
    ObservedOrder

    Raises
    ------
    ArgumentError
        For fewer than two different steps.
    KickdriftError
        If a run does not reach the end, or hits the reference exactly.

    Notes
    -----
    DOP853: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), section II.5.

    Examples
    --------
    >>> import kickdrift as kd
    >>> found = kd.analysis.observed_order(
    ...     kd.systems.pendulum(), "leapfrog", (0.0, 5.0), steps=(0.1, 0.05, 0.025)
    ... )
    >>> round(found.order, 1)
    2.0
    """
    if not np.iterable(steps):
        raise ArgumentError(f"steps={steps!r} must be a list of at least two steps.")
    runs = [
        solve(
            problem,
            t_span,
            x0,
            v0,
            step=step,
            method=method,
            save_every=2**60,
            args=args,
            compile=compile,
            progress=False,
        )
        for step in steps
    ]
    for run in runs:
        if not run.success:
            raise KickdriftError(f"steps={run.step!r}: the order cannot be measured: {run.message}")
    sizes = np.array([abs(run.step) for run in runs])
    if np.unique(sizes).size < 2:
        raise ArgumentError(
            f"steps={list(steps)!r} yield only {np.unique(sizes).size} different step size; a slope needs at least two."
        )
    x, v = reference if reference is not None else end_of_reference(problem, runs[0], x0 is None and v0 is None, args)
    errors = np.array([_error(run, x, v) for run in runs])
    largest_first = np.argsort(-sizes)
    sizes, errors = sizes[largest_first], errors[largest_first]
    slope, _ = np.polyfit(np.log(sizes), np.log(errors), 1)
    return ObservedOrder(runs[0].about.method, sizes, errors, float(slope))


def _error(run: Solution, x: ArrayLike, v: ArrayLike) -> float:
    error = float(max(np.abs(run.x[-1] - x).max(), np.abs(run.v[-1] - v).max(initial=0.0)))
    if error == 0:
        raise KickdriftError(f"steps={run.step!r} has no error beyond that of the reference; give larger steps.")
    return error
