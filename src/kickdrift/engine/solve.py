"""`solve`: from a function or a system to a solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from kickdrift import methods
from kickdrift.core.arguments import check_checkpoint_every, choice
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.announcing import compiling_announced
from kickdrift.engine.checkpoints import Checkpoints
from kickdrift.engine.continuation import carry_out
from kickdrift.engine.dense import check_between
from kickdrift.engine.event_functions import events_of
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.identity import identity_of
from kickdrift.engine.impacts import Impacts
from kickdrift.engine.method_selection import check_direction, check_wanted, choose
from kickdrift.engine.problem_adapter import Adapter
from kickdrift.engine.solution import Solution
from kickdrift.engine.start import parameters, start_of
from kickdrift.engine.steering import steering_of
from kickdrift.engine.step_control import StepControl
from kickdrift.engine.streaming import store_of
from kickdrift.engine.table_ranges import tables_of
from kickdrift.engine.task import Journey, Task
from kickdrift.engine.unit_solution import enter
from kickdrift.engine.zarr_store import ZarrStore
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System


def solve(
    problem: System | Problem | Callable[..., Any],
    t_span: Sequence[float],
    x0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    step: float | None = None,
    method: str | methods.Method | None = None,
    order: int | None = None,
    t_eval: ArrayLike | None = None,
    save_every: int | None = None,
    events: Callable[..., Any] | Sequence[Callable[..., Any]] | None = None,
    impacts: Impacts | Callable[..., Any] | None = None,
    switches: Callable[..., Any] | None = None,
    step_control: StepControl | Callable[..., Any] | str | None = None,
    rtol: float | None = None,
    atol: ArrayLike | None = None,
    max_steps: int | None = None,
    args: Sequence[float] | None = None,
    compensated: bool = True,
    compile: bool = True,  # noqa: A002 - a promised name
    check_bounds: bool = True,
    progress: bool | None = None,
    save_to: str | Path | None = None,
    checkpoint: str | Path | None = None,
    checkpoint_every: int | None = None,
    checkpoint_keep: int | None = 2,
) -> Solution:
    """Integrate a mechanical system, or other equations of motion.

    Parameters
    ----------
    problem : System, Problem or callable
        A system of `kickdrift.systems`; a description by functions, such as `kickdrift.SecondOrder`, `kickdrift.Hamiltonian`
        or `kickdrift.FirstOrder`; or a function for the acceleration. The names of its arguments declare its structure:
        ``x``, ``t``, ``v``, ``params`` (the float array of `args`), ``out`` (written in place instead of returned).
    t_span : (float, float)
        Start and end; the end may lie before the start.
    x0, v0 : array_like
        Initial state, of any shape; with a scalar the functions take and return floats. A system has its own. For
        Hamiltonians they are q and p; first-order equations have no v0.
    step : float
        Largest step allowed. A whole number of equal steps covers `t_span`; the step used is ``solution.step``. With
        `step_control` it is the first one; with `rtol` or `atol` it may be left out.
    method : str or Method, optional
        Name of a method, see ``kickdrift.methods.catalogue()``; ``"auto"`` selects the best one for the kind of problem, or
        for the requested `order`, and an L-stable one where the problem is found to be stiff; the report gives the reason.
        By default the semi-implicit Euler method, or ``"auto"`` where that does not apply, where an order is given, and for
        `kickdrift.Oscillatory`; with a step density the symmetric method of order 2 for the kind of problem.
    order : int, optional
        For ``method="auto"``: the lowest order wanted, among methods that preserve the structure of the problem. By default
        the method that takes the least time, or nearly so, for errors between 1e-3 and 1e-9 at the end; for non-separable
        Hamiltonians that is `dop853`, whose energy drifts.
    t_eval : array_like, optional
        Times to keep, any in `t_span`, in any order; with `save_to` in the order of the run. States between two steps are
        computed as by ``solution(t)``.
    save_every : int, optional
        Keep every n-th step, for n = `save_every`, and the last; every step if neither this nor `t_eval` is given. Of variable
        steps the last whole one is kept, too, from which a partial step leads to the end.
    events : callable or list of callable, optional
        Functions of the state, with arguments named as those of forces. Their zeros are located to the accuracy of the
        method: ``solution.t_events``, and the states there. A function may have attributes. With a positive ``direction``
        only zeros at which it increases count, with a negative one those at which it decreases. With ``terminal``, True or a
        number n, the run ends at the first, or the n-th, zero. With ``rate_bound``, a bound on its rate of change, all zeros
        more than a millionth of a step apart are found, or 1/256 where the function stays near zero for a whole step, and
        the run ends if it changes faster; without, two zeros within a step are missed. A zero at the start does not count. A
        function that jumps over zero in an impact has a zero there, and so has a gap that closes in one; the states are those
        after the impact.
    impacts : Impacts or callable, optional
        Surfaces that bodies rebound from, see `kickdrift.Impacts`; a function alone is a gap with restitution 1.
    switches : callable, optional
        A function of the state, a number or an array, at whose zeros the force law changes: steps are cut there, so that the
        method keeps its order. The sides, 1 or -1, on which the step lies are appended to the ``params`` of the force;
        discontinuous forces must use these, since a step looks beyond its end before it is cut. Where the forces of both
        sides lead back to a switch, as in dry friction at rest, the motion slides along it, by Filippov's rule and to second
        order: the side is then a number between -1 and 1, in which the force has to be linear, as in ``-0.2 * params[-1]``.
    step_control : optional
        What determines the size of each step: a step density, which is a function of the state, ``"distance"``,
        ``"acceleration"`` or ``"own"``, for reversible steps by `kickdrift.HairerSoderlind`; or an instance of that class,
        `kickdrift.HuangLeimkuhler`, `kickdrift.LogarithmicHamiltonian`, `kickdrift.TimeTransformed`, or
        `kickdrift.LocalError`. By default steps are equal. The last row is at the end of `t_span`, reached by a partial
        step.
    rtol, atol : float, optional
        Tolerances, relative and absolute, for ``step_control=kd.LocalError(rtol, atol)``; 1e-3 and 1e-6 where one is given.
    max_steps : int, optional
        Largest number of steps that the call may take. The number of variable steps is not known in advance, and has no limit
        where the motion goes to infinity: the run then ends with the states up to there, and ``solution.continue_to`` goes
        on for as many steps again. By default there is no limit.
    args : sequence of float, optional
        Numbers passed to the functions as ``params``.
    compensated : bool
        Whether x and v are summed with compensation (Kahan), so that rounding errors do not grow with the number of steps.
    compile : bool
        Whether to compile Python functions with Numba; False runs them interpreted.
    check_bounds : bool
        Whether an index out of bounds in a compiled function is an error, as in Python: at the start an ArgumentError; later
        it ends the run, which keeps the states until then. With False a wrong index reads or overwrites other memory. Only
        loops that do little else gain from it, up to a third of their time, as along a chain of springs.
    progress : bool, optional
        Whether to show a progress bar. By default one shows on a terminal, for runs longer than two seconds.
    save_to : path, optional
        A folder, such as ``"run.zarr"``, to which the rows are written during the run, instead of memory: a Zarr group in
        chunks along time, with the energy and other invariants, which ``xarray.open_zarr`` can read at any moment. The
        solution has the first and the last row. With `checkpoint` a run resumes in its folder; otherwise an existing folder
        is refused.
    checkpoint : path, optional
        A folder for checkpoints, created if missing. The same call, in any process, resumes from the newest one,
        bit-identically to an uninterrupted run; also with a later end, and with an earlier end from the newest checkpoint
        before it, if the steps divide both spans. One process at a time. Where steps vary, the end must be the same.
    checkpoint_every : int, optional
        Steps from one checkpoint to the next; by default they are about a minute apart. Each holds the rows so far.
    checkpoint_keep : int, optional
        How many of the last to keep; None for all, so that any earlier time can be reached quickly.

    Returns
    -------
    Solution

    Raises
    ------
    ArgumentError
        For an argument that cannot be used, before any work is done.
    MethodMismatchError
        For a method that would lose its order on the problem.
    FileFormatError
        If all checkpoints are damaged. Where one cannot be written, as on a full disk, the run ends, with what was done.

    Warns
    -----
    InterpretedWarning
        If Numba cannot compile the function.

    Notes
    -----
    Span, step, t_eval and start may be quantities of astropy or pint. Functions then take plain numbers, times in the unit
    of t_span, positions in that of x0, and velocities in the unit of x0 over that of t_span; ``solution.t``, ``.x`` and
    ``.v`` are quantities, and ``solution.plain`` has plain numbers.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> def gravity(x):
    ...     return -x / np.linalg.norm(x) ** 3
    >>> sol = kd.solve(gravity, t_span=(0.0, 100.0), x0=[1, 0], v0=[0, 1.1], step=0.01)
    >>> sol.x.shape
    (10001, 2)
    """
    check_wanted(method, order)
    entered = enter(problem, t_span, x0, v0, step, t_eval)
    t_span, x0, v0, step, t_eval = entered.t_span, entered.x0, entered.v0, entered.step, entered.t_eval
    start, params = start_of(problem, x0, v0), parameters(args)
    compensated, compiles = choice("compensated", compensated), choice("compile", compile)
    check_bounds = choice("check_bounds", check_bounds)
    progress = None if progress is None else choice("progress", progress)
    steering = steering_of(step_control, step, rtol, atol, impacts, switches)
    check_checkpoint_every(checkpoint, checkpoint_every)
    kept: Checkpoints | None = None
    store: ZarrStore | None = None
    try:
        grid = steering.lay(t_span, step, t_eval, save_every, start.x.size, save_to is not None, max_steps)
        with compiling_announced(progress):
            adapter = Adapter(grid.t0, start.x, start.v, params, compiles, check_bounds, [])
            system = steering.describe(problem, start, adapter)
            if isinstance(grid, Grid):
                check_between(system, grid)
            chosen = choose(method, order, system, grid.t0, grid.step, grid.t1 - grid.t0, **steering.defaults)
            check_direction(chosen.method, grid.step)
            system, controller = steering.ready(problem, system, chosen.method, grid, adapter, step)
            wanted = events_of(events, adapter.number)
            given = problem, steering.control, steering.impacts, steering.switches, events
            tables = tables_of(given, system, chosen.method, controller, wanted)
            if tables is not None:
                tables.check(grid)
            task = Task(system, chosen, grid, compensated, controller, wanted, progress, entered.inside, tables)
            if checkpoint is not None or save_to is not None:
                known = identity_of(
                    problem, grid, start, params, chosen.method, compensated, compiles, events, steering
                )
                kept, store = _opened(checkpoint, checkpoint_every, checkpoint_keep, save_to, grid, known)
            journey = Journey(task, checkpoints=kept, store=store)
    except MemoryError as error:
        raise ArgumentError(
            f"step={step!r}, save_every={save_every!r} and method={method!r} need more memory than there is ({error});"
            " keep fewer steps, or use an explicit method: implicit ones store a matrix of the state's size squared."
        ) from None
    return entered.leave(carry_out(journey))


def _opened(
    checkpoint: Any, every: Any, keep: Any, save_to: Any, grid: Grid | Course, known: Mapping[str, str]
) -> tuple[Checkpoints | None, ZarrStore | None]:
    """Lock the folders for checkpoints and rows, for a journey that will close them; None for those that are not given."""
    with ExitStack() as locked:
        store = store_of(save_to, grid, known, checkpoint is not None)
        if store is not None:
            locked.enter_context(closing(store))
        kept = None if checkpoint is None else Checkpoints(checkpoint, every, keep, known)
        locked.pop_all()
    return kept, store
