"""Runs back from the end of a run with steps that vary, by its own steps in reverse."""

from dataclasses import replace

import numpy as np

from kickdrift.core.arguments import real
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.controller import turn_back
from kickdrift.engine.flows.layout import CLOCK
from kickdrift.engine.grid import Course
from kickdrift.engine.method_selection import check_direction
from kickdrift.engine.processing import compile_method
from kickdrift.engine.rows import Mark
from kickdrift.engine.standing import Standing
from kickdrift.engine.task import Journey, Task


def back_from(task: Task, standing: Standing, t: float) -> Journey:
    """Return the journey back to a time, with the state of the steps that is reached, and so their density.

    Raises
    ------
    ArgumentError
        For a time that is not an earlier one of the run, and for steps that do not lead back.
    """
    grid, control, system, method = task.grid, task.controller, task.system, task.chosen.method
    if control is None or not isinstance(grid, Course):
        raise ArgumentError(
            "the steps of this run are equal, and those of a run from its end lead back if the method is symmetric: solve"
            f" to t={t!r} from its last state, with the same step."
        )
    if not control.reversible:
        raise ArgumentError(
            f"the steps of this run, by {control.name}, do not lead back; solve to t={t!r} from its last state."
        )
    check_direction(method, -grid.step)
    now = float(standing.state.work[CLOCK])
    back = _course_back(grid, now, t)
    if task.tables is not None:
        task.tables.check(back)
    processing = compile_method(system, method, grid, task.compensated, turns=not task.events, controller=control)
    state = standing.state.copy()
    xs, vs = processing.seen(np.array([now]), state.x[None].copy(), state.v[None].copy())
    journey = Journey(task._replace(grid=back, system=replace(system, x0=xs[0], v0=vs[0], exact=None)))
    turn_back(state.work, back.t1)
    journey.run.go_on(Standing(state, 0, Mark(), journey.run.rows.kept(0, Mark()), 0.0, None))
    return journey


def _course_back(grid: Course, now: float, t: float) -> Course:
    """Lay out the way back, with rows as on the way there: one step in as many, or those times of them."""
    try:
        end = real(t)
    except TypeError:
        raise ArgumentError(f"t={t!r} must be a time, an earlier one of the run.") from None
    low, high = sorted((grid.t0, now))
    if not low <= end <= high or end == now:
        raise ArgumentError(f"t={t!r} must be a time of the run before its end, from {grid.t0!r} to {now!r}.")
    if grid.wanted is None:
        return Course(now, end, -grid.step, grid.stride, np.array([end]), returns=True)
    between = grid.wanted[(grid.wanted > min(now, end)) & (grid.wanted < max(now, end))]
    marks = np.unique(np.append(between, end))
    marks = marks if end > now else marks[::-1].copy()
    return Course(now, end, -grid.step, 0, marks, wanted=marks, returns=True)
