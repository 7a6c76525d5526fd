"""`solve`: from a function or a system to a solution."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods, systems
from kickdrift.core.errors import ArgumentError, MethodMismatchError
from kickdrift.core.outcomes import Outcome
from kickdrift.engine import quantities
from kickdrift.engine.grid import lay_grid
from kickdrift.engine.program import compose
from kickdrift.engine.run import Run
from kickdrift.engine.solution import Description, Invariants, Solution
from kickdrift.engine.user_functions import adopt
from kickdrift.systems.system import SecondOrder, System, start

Floats = NDArray[np.float64]


def solve(
    problem: System | SecondOrder | Callable[..., Any],
    t_span: Sequence[float],
    x0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    step: float,
    method: str | methods.Method = "semi-implicit-euler",
    t_eval: ArrayLike | None = None,
    save_every: int | None = None,
    args: Sequence[float] | None = None,
    compensated: bool = True,
    compile: bool = True,  # noqa: A002 - a promised name
    progress: bool | None = None,
) -> Solution:
    """Integrate x'' = a(t, x, v) with a fixed step.

    Parameters
    ----------
    problem : System, SecondOrder or callable
        A system of `kickdrift.systems`, or a function for the acceleration. The names of its arguments declare its
        structure: ``x``, ``t``, ``v``, ``params`` (the float array of `args`), ``out`` (written in place).
    t_span : (float, float)
        Start and end; the end may lie before the start.
    x0, v0 : array_like
        Start, of any one shape; a scalar makes the function get and return floats. A system brings its own.
    step : float
        Largest step allowed. A whole number of equal steps covers `t_span`; the step used is ``solution.step``.
    method : str or Method
        Name of a method, see ``kickdrift.methods.catalogue()``.
    t_eval : array_like, optional
        Times to keep, on the grid of steps.
    save_every : int, optional
        Keep every so manieth step, and the last; every step if neither this nor `t_eval` is given.
    args : sequence of float, optional
        Numbers that the function gets as ``params``.
    compensated : bool
        Whether the sums for x and v carry what they round off (Kahan), so that rounding does not grow with the number
        of steps.
    compile : bool
        Whether to compile Python functions with Numba; False runs them interpreted.
    progress : bool, optional
        Whether to show a progress bar. By default one shows on a terminal, for runs longer than two seconds.

    Returns
    -------
    Solution

    Raises
    ------
    ArgumentError
        For an argument that cannot be used, before any work is done.
    MethodMismatchError
        For a method that would lose its order on a velocity-dependent acceleration.

    Warns
    -----
    InterpretedWarning
        If Numba cannot compile the function.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> def gravity(x):
    ...     return -x / np.linalg.norm(x) ** 3
    >>> sol = kd.solve(gravity, t_span=(0.0, 100.0), x0=[1, 0], v0=[0, 1.1], step=0.01)
    >>> sol.x.shape
    (10001, 2)
    """
    chosen = methods.get(method)
    x, v = _start(problem, x0, v0)
    params, compensated = _parameters(args), bool(compensated)
    try:
        grid = lay_grid(t_span, step, t_eval, save_every, x.size)
        system = _system(problem, grid.t0, x, v, params, compile)
        _check_fit(chosen, system)
        run = Run(system, compose(chosen, system), grid, compensated, progress)
    except MemoryError as error:
        raise ArgumentError(
            f"step={step!r} and save_every={save_every!r} need more memory than there is ({error}); keep fewer steps."
        ) from None
    ending = run.go()
    t = np.append(grid.times, grid.times[-1])[: ending.saved]
    if ending.outcome is not Outcome.COMPLETED and ending.saved:
        t[-1] = grid.t0 + ending.n_steps * grid.step
    shape = (ending.saved, *x.shape)
    xs, vs = run.xs[: ending.saved].reshape(shape), run.vs[: ending.saved].reshape(shape)
    for kept in (t, xs, vs):
        kept.flags.writeable = False  # invariants are evaluated later, from the same numbers
    return Solution(
        t=t,
        x=xs,
        v=vs,
        invariants=Invariants(tuple(system.quantities), partial(quantities.evaluate, system, t=t, x=xs, v=vs)),
        status=ending.outcome,
        message=ending.message,
        step=grid.step,
        n_steps=ending.n_steps,
        n_force_evaluations=ending.evaluations,
        wall_time=ending.wall_time,
        about=_describe(system, chosen, compensated),
    )


def _start(problem: Any, x0: ArrayLike | None, v0: ArrayLike | None) -> tuple[Floats, Floats]:
    if not isinstance(problem, System | SecondOrder) and not callable(problem):
        raise ArgumentError(
            f"problem={problem!r} is not a function or a system; give one, such as kd.systems.get('kepler')."
        )
    if problem in systems.catalogue().values():
        raise ArgumentError(f"problem={problem.__name__} is the function that makes a system; call it.")
    given = {"x0": x0, "v0": v0}
    if isinstance(problem, System):
        given = {"x0": problem.x0 if x0 is None else x0, "v0": problem.v0 if v0 is None else v0}
    arrays = {name: _floats(name, value) for name, value in given.items()}
    x, v = arrays["x0"], arrays["v0"]
    if x.shape != v.shape:
        raise ArgumentError(f"v0 has shape {v.shape} but x0 has shape {x.shape}; give one velocity to each position.")
    if x.size == 0:
        raise ArgumentError(f"x0 of shape {x.shape} is empty; give at least one number.")
    if isinstance(problem, System) and x.shape != problem.x0.shape:
        raise ArgumentError(f"x0 has shape {x.shape} but {problem.name!r} has states of shape {problem.x0.shape}.")
    return x, v


def _floats(name: str, value: ArrayLike | None) -> Floats:
    if value is None:
        raise ArgumentError(f"{name} is missing; a function needs x0 and v0 to start from.")
    try:
        if np.iscomplexobj(value):
            raise TypeError("it is complex")
        array = start(value)
    except (TypeError, ValueError) as error:
        raise ArgumentError(
            f"{name}={value!r} is not an array of numbers: {error}; give a number, list or array."
        ) from None
    if not np.isfinite(array).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ArgumentError(f"{name} is {array[where]} at index {where}; a start must be finite.")
    return array


def _parameters(args: Sequence[float] | None) -> Floats:
    try:
        params = np.atleast_1d(np.array(() if args is None else args, dtype=np.float64))
    except (TypeError, ValueError):
        raise ArgumentError(
            f"args={args!r} must be numbers; the function gets them as the float array params."
        ) from None
    if params.ndim != 1:
        raise ArgumentError(f"args has shape {params.shape}; give a flat list of numbers.")
    if not np.isfinite(params).all():
        raise ArgumentError(f"args={args!r} must be finite.")
    return params


def _system(problem: Any, t0: float, x: Floats, v: Floats, params: Floats, compile_: bool) -> System:
    if isinstance(problem, System):
        if params.size:
            raise ArgumentError(
                f"args={params.tolist()!r} given, but {problem.name!r} has its own parameters; leave it out."
            )
        # Another start has another exact solution.
        same = np.array_equal(x, problem.x0) and np.array_equal(v, problem.v0)
        return problem if same else replace(problem, x0=x, v0=v, exact=None)
    return adopt(problem, t0, x, v, params, compile_)


def _check_fit(method: methods.Method, system: System) -> None:
    if system.velocity_dependent and method.kind is not methods.Kind.GENERAL:
        fitting = [m for m in methods.catalogue().values() if m.kind is methods.Kind.GENERAL]
        best = max(fitting, key=lambda m: (min(m.order, method.order), m.explicit))
        raise MethodMismatchError(
            f"method={method.name!r} has order {method.order} for {method.kind.value}, but the acceleration of"
            f" {system.name!r} depends on v, and the order would fall to 1; use {best.name!r} (order {best.order})."
        )


def _describe(system: System, method: methods.Method, compensated: bool) -> Description:
    units = dict(system.units) | {name: quantity.unit for name, quantity in system.quantities.items() if quantity.unit}
    return Description(
        system=system.name,
        method=method.name,
        order=method.order,
        word=method.spelling,
        compensated=compensated,
        dimensions=system.dimensions or tuple(f"axis_{i}" for i in range(system.x0.ndim)),
        coordinates=dict(system.coordinates),
        units=units,
        source=system.source,
    )
