"""The modified Hamiltonian that a word of kicks and drifts conserves, as a series in the step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods
from kickdrift.analysis.bch import brackets
from kickdrift.analysis.flow_derivatives import FlowDerivatives
from kickdrift.analysis.order import ObservedOrder
from kickdrift.analysis.spans import step_of
from kickdrift.core.errors import ArgumentError, KickdriftError, MethodMismatchError
from kickdrift.core.kinds import Kind
from kickdrift.engine.problem_adapter import describe
from kickdrift.engine.solve import solve
from kickdrift.engine.start import Start
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System, start

Floats = NDArray[np.float64]

_ROWS = 200


def modified_hamiltonian(
    problem: System | Problem | Callable[..., Any],
    method: str | methods.Method,
    step: float,
    x: ArrayLike,
    v: ArrayLike,
    *,
    order: int = 4,
    args: Sequence[float] | None = None,
    compile: bool = True,  # noqa: A002 - as in `solve`
) -> Floats | np.float64:
    """Evaluate the modified Hamiltonian of a method at states: H + h H_2 + h^2 H_3 + ..., truncated at a power of the step.

    Its terms are Poisson brackets of the kinetic and the potential part (Baker-Campbell-Hausdorff), computed as derivatives
    of the energy along drifts and kicks, by finite differences of order 6 and 8. A method conserves it to h^(order + 1), or
    to h^(order + 2) if it is symmetric and `order` even, for small steps: the series is asymptotic and diverges.

    Parameters
    ----------
    problem : System, Problem or callable
        A separable one with an energy, and without time dependence.
    method : str or Method
        A word of kicks and drifts.
    step : float
        With its sign.
    x, v : array_like
        States, (T, *shape); of a system also one, of the shape of its x0. For Hamiltonians they are q and p.
    order : int
        The last power of the step, from 0, which gives the energy, to 4.
    args, compile
        As for `kickdrift.solve`.

    Returns
    -------
    (T,) array, or a number

    Raises
    ------
    ArgumentError
        For a method that has other flows, an order that is not from 0 to 4, or states that do not fit.
    MethodMismatchError
        For a problem that is not separable.
    KickdriftError
        For a problem without energy.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> pendulum = kd.systems.pendulum()
    >>> sol = kd.solve(pendulum, (0.0, 100.0), step=0.1, method="leapfrog")
    >>> modified = kd.analysis.modified_hamiltonian(
    ...     pendulum, "leapfrog", sol.step, sol.x, sol.v
    ... )
    >>> bool(np.ptp(sol.energy) > 1e-4), bool(np.ptp(modified) < 1e-7)
    (True, True)
    """
    chosen, step = methods.get(method), step_of(step)
    series = brackets(chosen, order)
    try:
        xs, vs = start(x), start(v)
    except TypeError as error:
        raise ArgumentError(f"x and v must be arrays of numbers: {error}.") from None
    if xs.shape != vs.shape:
        raise ArgumentError(f"x and v have shapes {xs.shape} and {vs.shape}; give x and v of the same shape.")
    system = _separable(problem, xs, vs, args, compile)
    single = xs.shape == system.x0.shape
    if not single and xs.shape[1:] != system.x0.shape:
        raise ArgumentError(f"x has shape {xs.shape}, but states of {system.name!r} have {system.x0.shape}.")
    rows = xs.reshape(1 if single else xs.shape[0], -1), vs.reshape(1 if single else xs.shape[0], -1)
    flows = FlowDerivatives(system)
    total = flows.energy(*rows)
    for word, coefficient in series.items():
        total = total + float(coefficient) * flows.derivative(word, float(step), *rows)
    return np.float64(total[0]) if single else total


def modified_order(
    problem: System | Problem | Callable[..., Any],
    method: str | methods.Method,
    t_span: Sequence[float],
    steps: Sequence[float],
    x0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    order: int | None = None,
    args: Sequence[float] | None = None,
    compile: bool = True,  # noqa: A002 - as in `solve`
) -> ObservedOrder:
    """Measure the power of the step to which a method conserves its modified Hamiltonian.

    Parameters
    ----------
    problem, method, t_span, x0, v0, args, compile
        As for `kickdrift.solve` and `modified_hamiltonian`.
    steps : sequence of float
        At least two.
    order : int, optional
        The last power of the step in the series. By default the order p of the method, or 4 if that is less: the first term
        beyond H. Then the power measured is p + 1, or p + 2 for a symmetric method; that of the energy itself is p.

    Returns
    -------
    ObservedOrder
        Its errors are the variation of the modified Hamiltonian along a run.

    Raises
    ------
    ArgumentError
        For fewer than two different steps.
    KickdriftError
        If a run does not reach the end, or the deviation is zero.

    Examples
    --------
    >>> import kickdrift as kd
    >>> found = kd.analysis.modified_order(
    ...     kd.systems.pendulum(), "leapfrog", (0.0, 10.0), [0.2, 0.1, 0.05]
    ... )
    >>> round(found.order)
    4
    """
    chosen = methods.get(method)
    last = min(chosen.order, 4) if order is None else order
    found = []
    for step in steps:
        run = solve(problem, t_span, x0, v0, step=step, method=chosen, args=args, compile=compile, progress=False)
        if not run.success:
            raise KickdriftError(f"steps={step!r}: the order cannot be measured: {run.message}")
        rows = slice(None, None, -(-run.t.size // _ROWS))
        states = run.x[rows], run.v[rows]
        values = modified_hamiltonian(problem, chosen, run.step, *states, order=last, args=args, compile=compile)
        found.append((abs(run.step), float(np.ptp(values))))
    sizes, errors = np.array(sorted(found, reverse=True)).T
    if np.unique(sizes).size < 2 or not errors.all():
        raise ArgumentError(
            f"steps={list(steps)!r} yield no slope: give at least two different steps, with errors above rounding."
        )
    slope, _ = np.polyfit(np.log(sizes), np.log(errors), 1)
    return ObservedOrder(chosen.name, sizes, errors, float(slope))


def _separable(problem: Any, x: Floats, v: Floats, args: Sequence[float] | None, compile_: bool) -> System:
    if isinstance(problem, System):
        system = problem
    else:
        first = Start(x, v) if x.ndim == 0 else Start(x[0], v[0])
        system = describe(problem, 0.0, first, start(() if args is None else args).reshape(-1), compile_)
    if not Kind.SEPARABLE.includes(system.kind):
        raise MethodMismatchError(
            f"problem={system.name!r} has no modified Hamiltonian here: its kind is {system.kind.value}, but kicks and"
            f" drifts are the flows of {Kind.SEPARABLE.value}."
        )
    if "energy" not in system.quantities:
        raise KickdriftError(f"{system.name!r} has no energy; pass energy=... to its description.")
    return system
