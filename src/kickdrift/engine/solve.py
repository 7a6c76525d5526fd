"""`solve`: from a function or a system to a solution."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods, systems
from kickdrift.core.arguments import choice, reals
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.core.outcomes import Outcome
from kickdrift.core.threads import present
from kickdrift.engine import multipliers, quantities
from kickdrift.engine.fit import AUTO, Choice, check_direction, choose
from kickdrift.engine.grid import Grid, lay_grid
from kickdrift.engine.inside import Inside
from kickdrift.engine.problem_adapter import adopt
from kickdrift.engine.progress import compiling_announced
from kickdrift.engine.run import Run
from kickdrift.engine.solution import Description, Invariants, Solution
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System, start

Floats = NDArray[np.float64]


def solve(
    problem: System | Problem | Callable[..., Any],
    t_span: Sequence[float],
    x0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    step: float,
    method: str | methods.Method | None = None,
    order: int | None = None,
    t_eval: ArrayLike | None = None,
    save_every: int | None = None,
    args: Sequence[float] | None = None,
    compensated: bool = True,
    compile: bool = True,  # noqa: A002 - a promised name
    check_bounds: bool = True,
    progress: bool | None = None,
) -> Solution:
    """Integrate a mechanical system, or other equations of motion, with a fixed step.

    Parameters
    ----------
    problem : System, Problem or callable
        A system of `kickdrift.systems`; a description by functions, such as `kickdrift.SecondOrder`,
        `kickdrift.Hamiltonian` or `kickdrift.FirstOrder`; or a function for the acceleration. The names of its
        arguments declare its structure: ``x``, ``t``, ``v``, ``params`` (the float array of `args`), ``out`` (written
        in place).
    t_span : (float, float)
        Start and end; the end may lie before the start.
    x0, v0 : array_like
        Start, of any one shape; a scalar makes the function get and return floats. A system brings its own. For
        Hamiltonians they are q and p; first-order equations have no v0.
    step : float
        Largest step allowed. A whole number of equal steps covers `t_span`; the step used is ``solution.step``.
    method : str or Method, optional
        Name of a method, see ``kickdrift.methods.catalogue()``; ``"auto"`` takes the one that is best for the kind of
        problem, or of the wanted `order`, and an L-stable one where the problem is stiff at its start; the report says
        why. By default the semi-implicit Euler method, or ``"auto"`` where that does not
        apply or an order is given.
    order : int, optional
        For ``method="auto"``: the least order wanted, of methods that keep the structure of the problem. By default what
        takes the least time to errors between 1e-3 and 1e-9 at the end, or close to it; for Hamiltonians that are not
        separable that is `dop853`, whose energy drifts.
    t_eval : array_like, optional
        Times to keep, on the grid of steps.
    save_every : int, optional
        Keep every n-th step, for n = `save_every`, and the last; every step if neither this nor `t_eval` is given.
    args : sequence of float, optional
        Numbers that the function gets as ``params``.
    compensated : bool
        Whether the sums for x and v carry what they round off (Kahan), so that rounding does not grow with the number
        of steps.
    compile : bool
        Whether to compile Python functions with Numba; False runs them interpreted.
    check_bounds : bool
        Whether an index out of bounds in a compiled function is an error, as it is in Python: at the start an
        ArgumentError, later the end of the run, with what was done. False saves a few per cent of the time in loops over
        large arrays, where a wrong index then reads or overwrites other memory.
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
        For a method that would lose its order on the problem.

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
    _check_method(method, order)
    x, v = _start(problem, x0, v0)
    params, compensated, compiles = _parameters(args), choice("compensated", compensated), choice("compile", compile)
    check_bounds = choice("check_bounds", check_bounds)
    progress = None if progress is None else choice("progress", progress)
    try:
        grid = lay_grid(t_span, step, t_eval, save_every, x.size)
        with compiling_announced(progress):
            system = _system(problem, grid.t0, x, v, params, compiles, check_bounds)
            taken = choose(method, order, system, grid.t0, grid.step, grid.n_steps * grid.step)
            chosen = taken.method
            check_direction(chosen, grid.step)
            inside = Inside(system, chosen, grid, compensated)
            run = Run(inside.system, inside.program, grid, compensated, progress)
    except MemoryError as error:
        raise ArgumentError(
            f"step={step!r}, save_every={save_every!r} and method={method!r} need more memory than there is ({error});"
            " keep fewer steps, or take an explicit method: implicit ones keep a matrix of the state's size squared."
        ) from None
    return _solution(system, taken, grid, inside, run, compensated)


def _solution(system: System, taken: Choice, grid: Grid, inside: Inside, run: Run, compensated: bool) -> Solution:
    """Run, and return what was kept."""
    ending = run.go()
    t = np.append(grid.times, grid.times[-1])[: ending.saved]
    if ending.outcome is not Outcome.COMPLETED and ending.saved:
        t[-1] = grid.t0 + ending.n_steps * grid.step
    xs, vs = inside.leave(run, ending)
    for kept in (t, xs, vs):
        kept.flags.writeable = False  # invariants are evaluated later, from the same numbers
    return Solution(
        t=t,
        x=xs,
        v=vs,
        invariants=Invariants(tuple(system.quantities), partial(quantities.evaluate, system, t=t, x=xs, v=vs)),
        status=ending.outcome,
        message=ending.message + quantities.energy_lost(system, t, xs, vs),
        step=grid.step,
        n_steps=ending.n_steps,
        n_force_evaluations=ending.evaluations + inside.evaluations,
        wall_time=ending.wall_time,
        about=_describe(system, taken, compensated),
        derived=_derived(system, t, xs, vs),
        error_estimate=None if ending.estimated is None else ending.estimated.reshape(system.x0.shape),
    )


def _derived(system: System, t: Floats, xs: Floats, vs: Floats) -> Invariants:
    constrained = system.kind is Kind.CONSTRAINED
    return Invariants(("multipliers",) * constrained, lambda name: multipliers.evaluate(system, t, xs, vs))


def _check_method(method: Any, order: Any) -> None:
    if not (method is None or (isinstance(method, str) and method == AUTO)):
        methods.get(method)
        if order is not None:
            raise ArgumentError(f"order={order!r} is for method='auto'; {method!r} has its own. Leave one of them out.")
    elif order is not None and (isinstance(order, bool) or not isinstance(order, int | np.integer) or order < 1):
        raise ArgumentError(f"order={order!r} must be a positive whole number.")


def _start(problem: Any, x0: ArrayLike | None, v0: ArrayLike | None) -> tuple[Floats, Floats]:
    if not isinstance(problem, System | Problem) and not callable(problem):
        raise ArgumentError(
            f"problem={problem!r} is not a function or a system; give one, such as kd.systems.get('kepler')."
        )
    if problem in systems.catalogue().values():
        raise ArgumentError(f"problem={problem.__name__} is the function that makes a system; call it.")
    if isinstance(problem, System):
        x0, v0 = problem.x0 if x0 is None else x0, problem.v0 if v0 is None else v0
        has_velocity = problem.kind is not Kind.FIRST_ORDER
    else:
        has_velocity = getattr(problem, "has_velocity", True)
        if not has_velocity and v0 is not None:
            raise ArgumentError(f"v0={v0!r} given, but first-order equations have only x0, the start of y.")
    x = _floats("x0", x0)
    if x.size == 0:
        raise ArgumentError(f"x0 of shape {x.shape} is empty; give at least one number.")
    if isinstance(problem, System) and x.shape != problem.x0.shape:
        raise ArgumentError(f"x0 has shape {x.shape} but {problem.name!r} has states of shape {problem.x0.shape}.")
    if not has_velocity:
        return x, np.zeros(0)
    v = _floats("v0", v0)
    if x.shape != v.shape:
        raise ArgumentError(f"v0 has shape {v.shape} but x0 has shape {x.shape}; give one velocity to each position.")
    return x, v


def _floats(name: str, value: ArrayLike | None) -> Floats:
    if value is None:
        raise ArgumentError(f"{name} is missing; a function needs x0 and v0 to start from.")
    try:
        array = start(value)
    except TypeError as error:
        raise ArgumentError(
            f"{name}={value!r} is not an array of numbers: {error}; give a number, list or array."
        ) from None
    if not np.isfinite(array).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ArgumentError(f"{name} is {array[where]} at index {where}; a start must be finite.")
    return array


def _parameters(args: Sequence[float] | None) -> Floats:
    try:
        params = np.atleast_1d(reals(() if args is None else args))
    except TypeError:
        raise ArgumentError(
            f"args={args!r} must be numbers; the function gets them as the float array params."
        ) from None
    if params.ndim != 1:
        raise ArgumentError(f"args has shape {params.shape}; give a flat list of numbers.")
    if not np.isfinite(params).all():
        raise ArgumentError(f"args={args!r} must be finite.")
    return params


def _system(problem: Any, t0: float, x: Floats, v: Floats, params: Floats, compile_: bool, checked: bool) -> System:
    if isinstance(problem, System):
        if params.size:
            raise ArgumentError(
                f"args={params.tolist()!r} given, but {problem.name!r} has its own parameters; leave it out."
            )
        if problem.unthreaded is not None and not present():
            problem = replace(problem, acceleration=problem.unthreaded)
        # Another start has another exact solution.
        same = np.array_equal(x, problem.x0) and np.array_equal(v, problem.v0)
        started: System = problem if same else replace(problem, x0=x, v0=v, exact=None)
        return started
    return adopt(problem, t0, x, v, params, compile_, checked)


def _describe(system: System, taken: Choice, compensated: bool) -> Description:
    method = taken.method
    units = dict(system.units) | {name: quantity.unit for name, quantity in system.quantities.items() if quantity.unit}
    return Description(
        system=system.name,
        method=method.name,
        kind=system.kind.name,
        order=method.order,
        word=method.spelling,
        compensated=compensated,
        dimensions=system.dimensions or tuple(f"axis_{i}" for i in range(system.x0.ndim)),
        coordinates=dict(system.coordinates),
        units=units,
        source=system.source,
        choice=taken.reason,
    )
