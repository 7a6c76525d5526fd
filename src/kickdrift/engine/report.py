"""From a run to its solution: rows, conserved quantities, outcome and costs."""

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.deferred import deferred
from kickdrift.core.kinds import Kind
from kickdrift.core.outcomes import Outcome
from kickdrift.engine import multipliers, quantities
from kickdrift.engine.dense import DenseOutput, States
from kickdrift.engine.event_values import chattering
from kickdrift.engine.events import Watch
from kickdrift.engine.flows.layout import CLOCK
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.invariants import Invariants
from kickdrift.engine.phase import time_shift
from kickdrift.engine.processing import Processing
from kickdrift.engine.rows import Rows
from kickdrift.engine.run import Ending
from kickdrift.engine.solution import Solution
from kickdrift.engine.standing import Standing
from kickdrift.engine.streaming import StreamedRows
from kickdrift.engine.task import Journey, Task
from kickdrift.engine.zeros import Zero
from kickdrift.systems.system import System

Floats = NDArray[np.float64]
_ROUNDED = 1e-6  # of a step


class _Kept(NamedTuple):
    """Rows as the user's states: times, states, and the size of the steps from each on."""

    t: Floats
    x: Floats
    v: Floats
    steps: Floats

    def followed_by(self, t: float, x: Floats, v: Floats, step: float) -> "_Kept":
        """Add a row at the end of a run; no step begins there, but `step` has the size and sign of the others."""
        return _Kept(
            np.append(self.t, t),
            np.concatenate((self.x, x[None])),
            np.concatenate((self.v, v[None])),
            np.append(self.steps, step),
        )


def report(
    journey: Journey, ending: Ending, continuation: Callable[[Task, Standing, bool], Callable[[float], Solution]]
) -> Solution:
    """Return the solution of a run, with the continuation that `continuation` makes."""
    task, processing, between, watch = journey.task, journey.processing, journey.between, journey.watch
    system, grid, rows = task.system, task.grid, journey.run.rows
    early, message = not ending.outcome.success, ending.message + journey.said
    standing = journey.run.standing(beyond_the_stop=True)
    kept = _kept(rows, ending, early, processing) if journey.streamed is None else _ends(journey.streamed, ending)
    evaluations = ending.evaluations + processing.evaluations(rows.seen(ending.saved))
    if journey.streamed is not None:
        message, evaluations = message + journey.streamed.said, evaluations + journey.streamed.evaluations
    end = rows.time(ending.n_steps) if early else grid.t1
    if ending.stop is not None:
        end, kept = ending.stop.t, _with_stop(kept, ending.stop, grid)
    has_path = not journey.store and system.kind is not Kind.LANGEVIN
    if isinstance(grid, Course) and has_path and ending.outcome is Outcome.COMPLETED and kept.t[-1] != end:
        kept, own, trouble = _with_part_of_last_step(journey, grid, standing, kept)
        message, evaluations = message + trouble, evaluations + own
    dense = deferred(_dense, system, grid, between, end, kept) if has_path else None
    events: dict[str, Any] = {}
    if watch is not None:
        zeros, trouble = _zeros(watch, end)
        events = _events(zeros, system)
        message += trouble + chattering(watch.events, [len(own) for own in zeros], ending.n_steps)
        evaluations += watch.evaluations
    t, xs, vs, _ = kept
    if grid.wanted is not None and dense is not None:
        try:
            t, xs, vs, own = _at_wanted(grid, ending, dense(), t, xs, vs)
            evaluations += own
        except (Exception, KeyboardInterrupt) as error:  # Ctrl-C, or a function that fails only between steps
            message += f" Times between steps are missing where {type(error).__name__} was raised: {error}."
    for array in (t, xs, vs):
        array.flags.writeable = False  # invariants are evaluated later from these arrays
    return Solution(
        t=t,
        x=xs,
        v=vs,
        invariants=Invariants(tuple(system.quantities), partial(quantities.evaluate, system, t=t, x=xs, v=vs)),
        status=ending.outcome,
        message=deferred(_message, message, system, t, xs, vs),
        step=grid.step,
        n_steps=ending.n_steps,
        n_force_evaluations=evaluations,
        wall_time=ending.wall_time,
        about=deferred(task.describe),
        saved_to=str(journey.store.path) if journey.store else "",
        derived=_derived(system, grid, ending.step_range, t, xs, vs),
        error_estimate=None if ending.estimated is None else ending.estimated.reshape(system.x0.shape),
        dense=dense,
        continuation=None if journey.store else continuation(task, standing, journey.run.ended),
        step_range=ending.step_range,
        n_rejected=ending.trials - ending.n_steps,
        **events,
    )


def _with_stop(kept: _Kept, stop: Zero, grid: Grid | Course) -> _Kept:
    """Add the state at which a terminal event ended the run."""
    if isinstance(grid, Course) and kept.t.size and kept.t[-1] != stop.t:  # the state before that step is always a row
        kept.steps[-1] = stop.t - kept.t[-1]
    return kept.followed_by(stop.t, stop.x, stop.v, grid.step)


def _message(said: str, system: System, t: Floats, x: Floats, v: Floats) -> str:
    """Return what is said about a run, with a sentence on its energy if that is far off."""
    return said + quantities.energy_lost(system, t, x, v)


def _with_part_of_last_step(journey: Journey, grid: Course, standing: Standing, kept: _Kept) -> tuple[_Kept, int, str]:
    """Add the state at the end, which the last step leads beyond.

    Return also the force evaluations, and a sentence if the force failed.
    """
    try:
        x, v, evaluations = _in_last_step(journey, grid, standing, kept)
        return kept.followed_by(grid.t1, x[0], v[0], grid.step), evaluations, ""
    except (Exception, KeyboardInterrupt) as error:
        return kept, 0, f" The rows end before it, since {type(error).__name__} was raised: {error}."


def _in_last_step(journey: Journey, grid: Course, standing: Standing, kept: _Kept) -> tuple[Floats, Floats, int]:
    """Return the state at the end, which the last step leads beyond, and the force evaluations.

    Steps in reverse lead to the start but for rounding, some 1e-9 of a step. A part of the last one would be a step of its own,
    by 4e-4 elsewhere for `TimeTransformed` and e = 0.87: the way from its end back to the start is shorter.
    """
    clock, end = np.array([standing.state.work[CLOCK]]), np.array([grid.t1])
    if not (grid.returns and abs(clock[0] - grid.t1) < _ROUNDED * abs(kept.steps[-1])):
        return _dense(journey.task.system, grid, journey.between, grid.t1, kept).states_at(end)
    xs, vs = journey.processing.seen(clock, standing.state.x[None].copy(), standing.state.v[None].copy())
    x, v, own = journey.between().go_on(clock, end - clock, np.ones(1, dtype=np.int64), xs, vs)
    return x, v, int(own.sum())


def _ends(rows: StreamedRows, ending: Ending) -> _Kept:
    """Return the first and the last of the rows on disk."""
    return _Kept(*rows.ends(ending.n_steps))


def _kept(rows: Rows, ending: Ending, early: bool, processing: Processing) -> _Kept:
    """Return the rows in memory."""
    t = rows.times(ending.saved, ending.n_steps, early)
    xs, vs = rows.xs[: ending.saved], rows.vs[: ending.saved]
    if processing.postprocessor is not None:  # it overwrites rows with which the run may continue
        xs, vs = xs.copy(), vs.copy()
    return _Kept(t, *processing.leave(t, xs, vs, rows.grid.t0), rows.steps(t))


def _zeros(watch: Watch, end: float) -> tuple[tuple[tuple[Zero, ...], ...], str]:
    """Return the zeros of each event, and a sentence if the force failed within a step that contains one."""
    try:
        return watch.by_event(end), ""
    except (Exception, KeyboardInterrupt) as error:
        said = f" Zeros of events are missing, since {type(error).__name__} was raised: {error}."
        return tuple(() for _ in watch.events), said


def _events(zeros: tuple[tuple[Zero, ...], ...], system: System) -> dict[str, Any]:
    """Return the times and the states of the zeros of each event, by their names in a solution."""
    shapes = {"t": (), "x": system.x0.shape, "v": system.v0.shape}
    return {
        f"{name}_events": tuple(
            np.array([getattr(zero, name) for zero in own]).reshape(len(own), *shape) for own in zeros
        )
        for name, shape in shapes.items()
    }


def _dense(
    system: System, grid: Grid | Course, between: Callable[[], Processing], end: float, kept: _Kept
) -> DenseOutput:
    """Return the dense output, from the start on."""
    return DenseOutput.of_rows(grid, States(system.x0, system.v0), kept, end, between)


def _at_wanted(
    grid: Grid | Course, ending: Ending, dense: DenseOutput, t: Floats, xs: Floats, vs: Floats
) -> tuple[Floats, Floats, Floats, int]:
    """Return the rows at the wanted times that the run reached, and its last state if it ended early."""
    assert grid.wanted is not None
    low, high = sorted((dense.t[0], dense.end))
    completed = ending.outcome is Outcome.COMPLETED
    wanted = grid.wanted if completed else grid.wanted[(grid.wanted >= low) & (grid.wanted <= high)]
    x, v, evaluations = dense.states_at(np.clip(wanted, low, high))  # times may be outside by a rounding
    if completed:
        return wanted, x, v, evaluations
    return np.append(wanted, t[-1]), np.concatenate((x, xs[-1:])), np.concatenate((v, vs[-1:])), evaluations


def _derived(
    system: System, grid: Grid | Course, step_range: tuple[float, float], t: Floats, xs: Floats, vs: Floats
) -> Mapping[str, Floats]:
    functions: dict[str, Callable[[], Floats]] = {}
    if system.kind is Kind.CONSTRAINED:
        functions["multipliers"] = lambda: multipliers.evaluate(system, t, xs, vs)
    exact = system.exact
    if exact is not None and grid.t0 == 0.0:
        usual = math.sqrt(abs(step_range[0] * step_range[1])) or abs(grid.step)
        functions["phase error"] = lambda: time_shift(exact, t, xs, vs, usual)
    return Invariants(tuple(functions), lambda name: functions[name]()) if functions else {}
