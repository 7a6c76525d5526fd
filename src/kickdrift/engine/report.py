"""From a run to its solution: what was kept, what it conserves, and how it went."""

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.kinds import Kind
from kickdrift.core.outcomes import Outcome
from kickdrift.engine import multipliers, quantities
from kickdrift.engine.dense import DenseOutput
from kickdrift.engine.events import Watch, Zero
from kickdrift.engine.grid import Grid
from kickdrift.engine.method_selection import Choice
from kickdrift.engine.phase import time_shift
from kickdrift.engine.processing import Processing, compile_method
from kickdrift.engine.run import Ending, Run
from kickdrift.engine.solution import Description, Invariants, Solution
from kickdrift.methods import Method
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


def report(
    system: System,
    chosen: Choice,
    grid: Grid,
    processing: Processing,
    run: Run,
    ending: Ending,
    compensated: bool,
    watch: Watch | None,
) -> Solution:
    """Return what a run has kept, as people see it."""
    t = np.append(grid.times, grid.times[-1])[: ending.saved]
    steps = np.append(grid.save_steps, ending.n_steps)[: ending.saved]
    if not ending.outcome.success and ending.saved:  # the last row is where it ended, on the grid of rows or not
        t[-1], steps[-1] = grid.t0 + ending.n_steps * grid.step, ending.n_steps
    xs, vs = processing.leave(grid, steps, run.xs[: ending.saved], run.vs[: ending.saved])
    evaluations = ending.evaluations + processing.evaluations(ending.saved)
    end = grid.t1 if ending.n_steps == grid.n_steps else grid.t0 + ending.n_steps * grid.step
    if ending.stop is not None:
        end = ending.stop.t
        t, xs, vs = (
            np.append(t, end),
            np.append(xs, ending.stop.x[None], axis=0),
            np.append(vs, ending.stop.v[None], axis=0),
        )
    dense = _dense(system, chosen.method, grid, compensated, end, t, xs, vs)
    message = ending.message
    zeros: tuple[tuple[Zero, ...], ...] = ()
    if watch is not None:
        zeros, trouble = _zeros(watch, end)
        message, evaluations = message + trouble, evaluations + watch.evaluations
    if grid.wanted is not None and dense is not None:
        try:
            t, xs, vs, own = _at_wanted(grid, ending, dense, t, xs, vs)
            evaluations += own
        except (Exception, KeyboardInterrupt) as error:  # Ctrl-C, or a function that fails between steps alone
            message += f" Times between steps are left out, where {type(error).__name__} was raised: {error}."
    for kept in (t, xs, vs):
        kept.flags.writeable = False  # invariants are evaluated later, from the same numbers
    return Solution(
        t=t,
        x=xs,
        v=vs,
        invariants=Invariants(tuple(system.quantities), partial(quantities.evaluate, system, t=t, x=xs, v=vs)),
        status=ending.outcome,
        message=message + quantities.energy_lost(system, t, xs, vs),
        step=grid.step,
        n_steps=ending.n_steps,
        n_force_evaluations=evaluations,
        wall_time=ending.wall_time,
        about=_description(system, chosen, compensated),
        derived=_derived(system, grid, t, xs, vs),
        error_estimate=None if ending.estimated is None else ending.estimated.reshape(system.x0.shape),
        dense=dense,
        t_events=tuple(np.array([zero.t for zero in own]) for own in zeros),
        x_events=tuple(np.array([zero.x for zero in own]).reshape(len(own), *system.x0.shape) for own in zeros),
        v_events=tuple(np.array([zero.v for zero in own]).reshape(len(own), *system.v0.shape) for own in zeros),
    )


def _zeros(watch: Watch, end: float) -> tuple[tuple[tuple[Zero, ...], ...], str]:
    """Return the zeros of each event, and what is to be said where the force fails between the steps in which they are."""
    try:
        return watch.by_event(end), ""
    except (Exception, KeyboardInterrupt) as error:
        return tuple(
            () for _ in watch.events
        ), f" Zeros of events are left out, as {type(error).__name__} was raised: {error}."


def _dense(
    system: System, method: Method, grid: Grid, compensated: bool, end: float, t: Floats, xs: Floats, vs: Floats
) -> DenseOutput | None:
    """Return what gives states between the rows, and between the start and the first; None where noise drives the system."""
    if system.kind is Kind.LANGEVIN:
        return None
    if not t.size or t[0] != grid.t0:
        t = np.append(grid.t0, t)
        xs, vs = np.concatenate((system.x0[None], xs)), np.concatenate((system.v0[None], vs))
    return DenseOutput(t, xs, vs, end, grid.step, lambda: compile_method(system, method, grid, compensated))


def _at_wanted(
    grid: Grid, ending: Ending, dense: DenseOutput, t: Floats, xs: Floats, vs: Floats
) -> tuple[Floats, Floats, Floats, int]:
    """Return the rows at the times that were wanted, as far as the run went, and the last one where it ended early."""
    assert grid.wanted is not None
    low, high = sorted((dense.t[0], dense.end))
    completed = ending.outcome is Outcome.COMPLETED
    wanted = grid.wanted if completed else grid.wanted[(grid.wanted >= low) & (grid.wanted <= high)]
    x, v, evaluations = dense.states_at(np.clip(wanted, low, high))  # which may be outside by a rounding
    if completed:
        return wanted, x, v, evaluations
    return np.append(wanted, t[-1]), np.concatenate((x, xs[-1:])), np.concatenate((v, vs[-1:])), evaluations


def _derived(system: System, grid: Grid, t: Floats, xs: Floats, vs: Floats) -> Invariants:
    functions: dict[str, Callable[[], Floats]] = {}
    if system.kind is Kind.CONSTRAINED:
        functions["multipliers"] = lambda: multipliers.evaluate(system, t, xs, vs)
    exact = system.exact
    if exact is not None and grid.t0 == 0.0:
        functions["phase error"] = lambda: time_shift(exact, t, xs, vs, grid.step)
    return Invariants(tuple(functions), lambda name: functions[name]())


def _description(system: System, chosen: Choice, compensated: bool) -> Description:
    method = chosen.method
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
        choice=chosen.reason,
        gm=() if system.gm is None else tuple(system.gm.tolist()),
    )
