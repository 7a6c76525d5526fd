"""Tasks, which describe runs, and journeys, which carry them out: from the start, or from a checkpoint."""

import sys
import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from kickdrift.core.errors import FileFormatError
from kickdrift.core.interruption import InterruptionNoted
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.checkpoints import Checkpoints
from kickdrift.engine.controller import Controller
from kickdrift.engine.description import Description
from kickdrift.engine.event_functions import Event
from kickdrift.engine.events import Watch, watch_for
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.keeping import find, keep
from kickdrift.engine.method_selection import Choice
from kickdrift.engine.processing import compile_method
from kickdrift.engine.progress import Bar
from kickdrift.engine.rows import CourseRows, GridRows, Rows
from kickdrift.engine.run import Ending, Failure, Run
from kickdrift.engine.standing import Standing
from kickdrift.engine.streamed_course import StreamedCourseRows
from kickdrift.engine.streamed_course_times import StreamedCourseTimes
from kickdrift.engine.streamed_times import StreamedGridTimes
from kickdrift.engine.streaming import StreamedGridRows, StreamedRows
from kickdrift.engine.table_ranges import Tables
from kickdrift.engine.zarr_store import ZarrStore
from kickdrift.systems.system import System
from kickdrift.systems.units import Units


class Task(NamedTuple):
    """Everything that determines a run.

    Attributes
    ----------
    system : System
        The system with its initial state.
    chosen : Choice
        The method.
    grid : Grid or Course
    compensated : bool
    controller : Controller or None
        The control of variable steps.
    events : tuple of Event
    progress : bool or None
        Whether a bar is shown; has no effect on the results.
    units : Units
        Of the numbers, where users gave quantities; which determines nothing either.
    tables : Tables or None
        Those that functions call.
    """

    system: System
    chosen: Choice
    grid: Grid | Course
    compensated: bool
    controller: Controller | None
    events: tuple[Event, ...]
    progress: bool | None
    units: Units
    tables: Tables | None

    def describe(self) -> Description:
        """Describe the run, for display."""
        about, units = description_of(self.system, self.chosen, self.compensated, self.controller), self.units.names
        return replace(about, units={**about.units, **units}) if units else about


def description_of(system: System, chosen: Choice, compensated: bool, controller: Controller | None) -> Description:
    """Describe a run, for display."""
    method = chosen.method
    units = dict(system.units) | {name: quantity.unit for name, quantity in system.quantities.items() if quantity.unit}
    scales = {name: quantity.scale for name, quantity in system.quantities.items() if quantity.scale is not None}
    return Description(
        system=system.name,
        method=chosen.name,
        kind=system.kind.name,
        order=method.order,
        word=method.spelling,
        compensated=compensated,
        dimensions=system.dimensions or tuple(f"axis_{i}" for i in range(system.x0.ndim)),
        coordinates=dict(system.coordinates),
        units=units,
        scales=scales,
        source=system.source,
        choice=chosen.reason,
        gm=() if system.gm is None else tuple(system.gm.tolist()),
        step_control="" if controller is None else f"{controller.name} ({controller.conserves})",
    )


class Journey:
    """A task that is carried out: compiled, with memory for its rows.

    Parameters
    ----------
    task : Task
    before : Standing, optional
        The progress from which it continues.
    checkpoints : Checkpoints, optional
        Where it is kept as it goes on; if it was kept there already, it begins there.
    store : ZarrStore, optional
        The store for its rows, if they do not stay in memory.

    Attributes
    ----------
    task : Task
        The grid of which has the step that the run began with.
    processing : Processing
    between : callable
        Returns the method, compiled for steps of any size, with its own state.
    watch : Watch or None
    run : Run
    said : str
        A sentence about its start for the message.
    """

    def __init__(
        self,
        task: Task,
        before: Standing | None = None,
        checkpoints: Checkpoints | None = None,
        store: ZarrStore | None = None,
    ) -> None:
        self.task, self.said, self._checkpoints, self.store = task, "", checkpoints, store
        try:
            self._make_ready(before)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Release the folders of checkpoints and rows to other runs."""
        for folder in (self._checkpoints, self.store):
            if folder is not None:
                folder.close()

    def _make_ready(self, before: Standing | None) -> None:
        task, checkpoints = self.task, self._checkpoints
        self._compile()
        if checkpoints is not None:
            found = find(checkpoints, task.grid, self.processing.kernel.state, len(task.events))
            if found is not None:
                grid, before, self.said = found
                if grid.step != task.grid.step:
                    self.task = task._replace(grid=grid)
                    self._compile()
        if before is None or before.step == 0:
            self.processing.enter()
            if self.streamed is not None:
                self.streamed.create()
        else:
            self.run.go_on(before)

    def _compile(self) -> None:
        task = self.task
        made = partial(compile_method, task.system, task.chosen.method, task.grid, task.compensated)
        self.processing = made(turns=not task.events, controller=task.controller)
        self.between = partial(made, controller=None if task.controller is None else task.controller.between)
        self.watch: Watch | None = None
        if task.events:
            surfaces = None if task.controller is None else task.controller.surfaces
            self.watch = watch_for(task.events, task.system, partial(self.between, turns=False), task.grid.t1, surfaces)
        self.run = Run(self.processing.kernel, self._rows(), self.watch)

    def _rows(self) -> Rows:
        kernel, grid = self.processing.kernel, self.task.grid
        if self.store is not None:
            to_disk = self.store, self.task.describe()
            if isinstance(grid, Course):
                kind = StreamedCourseRows if grid.stride else StreamedCourseTimes
                return kind(self.processing, grid, *to_disk, self.between)
            if grid.every is None:
                return StreamedGridTimes(self.processing, grid, *to_disk, self.between)
            return StreamedGridRows(self.processing, grid, *to_disk)
        if isinstance(grid, Course):
            return CourseRows(kernel, grid)
        return GridRows(kernel, grid)

    @property
    def streamed(self) -> StreamedRows | None:
        """The rows, if they go to disk."""
        rows = self.run.rows
        return rows if self.store is not None and isinstance(rows, StreamedRows) else None

    def go(self) -> Ending:
        """Run to the end of the grid, or as far as possible."""
        started, run, streamed, failure = time.perf_counter(), self.run, self.streamed, None
        with closing(Bar(run.rows.progress(0)[1], self.task.progress)) as bar:
            while failure is None and not run.ended:
                first, began = run.step, time.perf_counter()
                due = until = sys.maxsize if self._checkpoints is None else self._checkpoints.until(first, sys.maxsize)
                if streamed is not None:
                    until = min(due, streamed.full_after(first))
                failure = run.go(bar, started, until)
                if self._checkpoints is not None:
                    self._checkpoints.pace(run.step - first, time.perf_counter() - began)
                if self._checkpoints is not None or self.store is not None:
                    failure = self._kept(failure, due)
        if streamed is not None:
            outcome = Outcome.COMPLETED if failure is None else failure[0]
            with InterruptionNoted(passed_on=False):
                failure = self._written(failure, partial(run.close, streamed, outcome))
        return run.ending(*(failure or (Outcome.COMPLETED, "")))

    def _kept(self, failure: Failure | None, due: int) -> Failure | None:
        """Store the state of the run, while Ctrl-C is deferred, and return a failure, if there is one."""
        run, checkpoints = self.run, self._checkpoints
        with InterruptionNoted(passed_on=False) as interruption:
            if self.streamed is not None:
                failure = self._written(failure, partial(run.drain, self.streamed))
            if checkpoints is not None and (run.step == due or run.ended or failure is not None):
                failure = self._written(failure, lambda: keep(checkpoints, self.task.grid, run.standing()))
        if interruption.noted and not run.ended:
            return failure or (Outcome.INTERRUPTED, "")
        return failure

    def _written(self, failure: Failure | None, write: Callable[[], None]) -> Failure | None:
        """Write something, and return a failure, if there is one."""
        try:
            write()
        except FileFormatError as error:
            outcome, cause = failure or (Outcome.NOT_WRITTEN, "")
            return outcome, f"{cause} {error}"
        return failure
