"""`solve_ensemble`: many members of one problem, in one solution."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing, nullcontext, suppress
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.arguments import check_checkpoint_every, choice, is_whole
from kickdrift.core.errors import ArgumentError, FileFormatError, depth_of_caller
from kickdrift.core.naming import digest
from kickdrift.engine.description import Description
from kickdrift.engine.event_functions import functions_of
from kickdrift.engine.identity import version
from kickdrift.engine.impacts import Impacts
from kickdrift.engine.invariants import Invariants
from kickdrift.engine.lane_letters import LANES
from kickdrift.engine.method_selection import check_wanted
from kickdrift.engine.progress import Bar
from kickdrift.engine.steering import steering_of
from kickdrift.engine.step_control import StepControl
from kickdrift.engine.task import description_of
from kickdrift.methods import Method
from kickdrift.scale.chunks import members_of_chunk, run_here
from kickdrift.scale.ensemble_solution import EnsembleSolution
from kickdrift.scale.executors import NoWorkerError, run_on, workers_of
from kickdrift.scale.keeping import Kept, identity_of
from kickdrift.scale.member_store import MemberStore
from kickdrift.scale.members import members_of
from kickdrift.scale.prepared import Prepared, Settings, prepare
from kickdrift.scale.results import Results
from kickdrift.scale.running import Runs
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System

_MOST_THREADS = 1024


def solve_ensemble(
    problem: System | Problem | Callable[..., Any],
    t_span: Sequence[float],
    x0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    step: ArrayLike | None = None,
    method: str | Method | None = None,
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
    args: ArrayLike | Mapping[str, Any] | None = None,
    seeds: Sequence[int] | None = None,
    compensated: bool = True,
    compile: bool = True,  # noqa: A002 - a promised name
    check_bounds: bool = True,
    progress: bool | None = None,
    threads: int | None = None,
    executor: Any = None,
    save_to: str | Path | None = None,
    checkpoint: str | Path | None = None,
    checkpoint_every: int | None = None,
) -> EnsembleSolution:
    """Integrate many members of one problem, with different starts, parameters, steps or seeds.

    Each member is bit-identical to a run of `kickdrift.solve` of its own, on any number of threads. Explicit methods on
    small states run eight or more members at once, vectorised.

    Parameters
    ----------
    problem : System, Problem or callable
        As for `kickdrift.solve`; or a function that creates a system or problem, such as `kickdrift.systems.kepler`, with
        `args` by the names of its arguments.
    t_span : (float, float)
        Start and end of all members.
    x0, v0 : array_like
        Initial states, with members along the first axis: (M, *shape). They broadcast, so that one v0 can be combined with
        many x0. For a system, a single state of its shape applies to all; by default its own.
    step : float or (M,) array_like
        Largest step allowed, or one per member. For members with different steps `t_eval` sets the times to keep.
    method, order
        As for `kickdrift.solve`. ``"auto"`` selects for all members the method that it selects for the first.
    t_eval, save_every
        As for `kickdrift.solve`: the times kept for all members.
    events : callable or list of callable, optional
        As for `kickdrift.solve`, separately for each member: ``solution.t_events[i][k]`` are the times of the zeros of event
        k in member i. A member that a terminal event ends has its last state in ``solution.x_last``, and NaN at later
        times; the others go on.
    impacts, switches, step_control, rtol, atol
        As for `kickdrift.solve`: variable steps, separately for each member, with `t_eval` for the times to keep.
    max_steps : int, optional
        As for `kickdrift.solve`: the largest number of steps of a member, so that none keeps the others waiting for ever.
    args : array_like or mapping, optional
        Numbers passed to the functions as ``params``: p for all, or (M, p). Or a range for each by name, in the order of
        ``params``, ``{"stiffness": np.linspace(1, 9, 81), "damping": [0.1, 0.2]}``: the members are the product of all
        ranges, the last of which varies fastest; a single number applies to all. The names label the members.
    seeds : sequence of int, optional
        One per member, for `kickdrift.Langevin`.
    compensated, compile, check_bounds
        As for `kickdrift.solve`.
    progress : bool, optional
        Whether to show a progress bar for all members. By default one shows on a terminal, for runs longer than two seconds.
    threads : int, optional
        By default the number of cores available to this process.
    executor : concurrent.futures.Executor or dask.distributed.Client, optional
        Runs the members in its workers, one chunk of members per task, instead of on threads. The tasks of a worker that
        dies are repeated, with the same bits. `concurrent.futures` sends functions by their names in their modules; Dask can
        send others, too.
    save_to : path, optional
        A folder, such as ``"sweep.zarr"``, to which the rows are written instead of memory: a Zarr group of chunks of
        members, with the energy and other invariants, which ``xarray.open_zarr`` can read at any moment, NaN where a member
        is not finished. Each chunk is written by the process that computes it, so that workers on other machines must share
        the folder. The solution reads only the parts that are accessed. The same call computes the missing members.
    checkpoint : path, optional
        A folder for checkpoints of the finished members. The same call, in any process, continues with the others,
        bit-identically to an uninterrupted run.
    checkpoint_every : int, optional
        Members from one checkpoint to the next; by default they are about a minute apart.

    Returns
    -------
    EnsembleSolution
        A member that fails is marked with its message, and the others finish. Ctrl-C keeps the finished members.

    Raises
    ------
    ArgumentError
        For an argument that cannot be used, before any work is done; and for a Dask cluster without workers.

    Warns
    -----
    InterpretedWarning
        If Numba cannot compile the function.
    RuntimeWarning
        If a worker dies; and if members cannot be written or no worker is left, which ends the ensemble with the finished
        members.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> def spring(x, params):
    ...     return -params[0] * x
    >>> stiffness = {"k": np.linspace(1, 4, 31)}
    >>> sol = kd.solve_ensemble(
    ...     spring, (0.0, 10.0), x0=[1.0], v0=[0.0], args=stiffness, step=0.1
    ... )
    >>> sol.x.shape
    (31, 101)
    """
    check_wanted(method, order)
    compensated, compiles = choice("compensated", compensated), choice("compile", compile)
    check_bounds = choice("check_bounds", check_bounds)
    progress = None if progress is None else choice("progress", progress)
    if executor is not None and threads is not None:
        raise ArgumentError(f"threads={threads!r} and executor={executor!r} are both given; give one of them.")
    check_checkpoint_every(checkpoint, checkpoint_every)
    if checkpoint is not None and save_to is not None:
        raise ArgumentError(
            f"checkpoint={str(checkpoint)!r} and save_to={str(save_to)!r} are both given, but save_to also stores the"
            " finished members; leave checkpoint out."
        )
    threads = _threads(threads)
    members = members_of(problem, x0, v0, args, step, seeds)
    steering = steering_of(step_control, members.step_of(0), rtol, atol, impacts, switches)
    settings = Settings(
        t_span,
        method,
        order,
        t_eval,
        save_every,
        steering,
        compensated,
        compiles,
        check_bounds,
        functions_of(events),
        max_steps,
    )
    prepared = prepare(members, settings, progress, to_disk=save_to is not None)
    results = prepared.room(save_to is not None)
    store = (
        None if save_to is None else MemberStore(save_to, digest((version(), sorted(identity_of(prepared).items()))))
    )
    kept = None if checkpoint is None else Kept(checkpoint, checkpoint_every, prepared, results)
    with closing(store) if store else nullcontext(), closing(kept) if kept else nullcontext():
        if store is not None:
            least = LANES * threads if executor is None else 1
            size = members_of_chunk(prepared, threads if executor is None else workers_of(executor), True, least)
            store.begin(prepared, _description(prepared), size, results)
        return _run(prepared, results, executor, threads, progress, kept, store)


def _run(
    prepared: Prepared,
    results: Results,
    executor: Any,
    threads: int,
    progress: bool | None,
    kept: Kept | None,
    store: MemberStore | None,
) -> EnsembleSolution:
    """Run the members that are not done."""
    go: Callable[[Callable[[int], None]], None]
    if executor is not None:
        go = partial(run_on, executor, prepared, results, store)
    elif store is not None:
        go = partial(run_here, prepared, results, store, threads)
    else:
        go = Runs(prepared, threads, progress, results).go
    started = time.perf_counter()
    total = sum(cohort.length * int((~results.done[cohort.indices]).sum()) for cohort in prepared.cohorts)
    bar = Bar(total, progress)

    def tell(done: int) -> None:
        if done:
            bar.show(done, time.perf_counter() - started)
        if kept is not None:
            kept.look()

    try:
        with suppress(KeyboardInterrupt):  # members that are left are marked
            go(tell)
        if kept is not None:
            kept.write()
    except (FileFormatError, NoWorkerError) as error:  # as on a full disk
        warnings.warn(
            f"the ensemble ends with the finished members: {error}", RuntimeWarning, stacklevel=depth_of_caller()
        )
    finally:
        bar.close()
    solution = _solution(prepared, results, store, time.perf_counter() - started)
    if store is not None:
        try:
            solution.presenters.keep(solution)
        except FileFormatError as error:
            warnings.warn(f"kickdrift.load will not find it: {error}", RuntimeWarning, stacklevel=depth_of_caller())
    return solution


def _threads(threads: int | None) -> int:
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not is_whole(threads, 1):
        raise ArgumentError(f"threads={threads!r} must be a positive whole number.")
    if threads > _MOST_THREADS:
        raise ArgumentError(f"threads={threads!r} is more than any machine has cores; give {_MOST_THREADS} at most.")
    return int(threads)


def _description(prepared: Prepared) -> Description:
    return description_of(prepared.system, prepared.chosen, prepared.settings.compensated, prepared.controller)


def _solution(prepared: Prepared, results: Results, store: MemberStore | None, seconds: float) -> EnsembleSolution:
    system, x, v = prepared.system, results.x, results.v
    evaluated: Callable[[str], Any] = partial(prepared.evaluate, x=x, v=v)
    at_last: Callable[[str], Any] = partial(prepared.evaluate_last, last=results.last)
    for array in (x, v):
        array.flags.writeable = False  # invariants are evaluated later, from the same numbers
    if store is not None:
        x, evaluated = store.array("x"), store.array
        v = store.array("v") if system.v0.shape == system.x0.shape else np.empty((*x.shape[:2], *system.v0.shape))
    zeros: dict[str, Any] = {f"{name}_events": tuple(getattr(own, name) for own in results.zeros) for name in "txv"}
    return EnsembleSolution(
        t=prepared.t,
        x=x,
        v=v,
        invariants=Invariants(tuple(system.quantities), evaluated),
        status=tuple(results.status),
        messages=tuple(results.messages),
        step=results.step,
        step_range=results.step_range,
        n_steps=results.n_steps,
        n_rejected=results.rejected,
        n_force_evaluations=results.evaluations,
        wall_time=seconds,
        about=_description(prepared),
        parameters=prepared.members.parameters,
        saved_to="" if store is None else str(store.path),
        **(zeros if prepared.events else {}),
        **{f"{name}_last": tuple(getattr(own, name)[0] for own in results.last) for name in "txv"},
        last_invariants=Invariants(tuple(system.quantities), at_last),
    )
