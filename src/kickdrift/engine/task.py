"""What is to be run, made ready and run: from its start, or on from where it stands."""

import sys
import time
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial

from kickdrift.core.errors import FileFormatError
from kickdrift.core.interruption import InterruptionNoted
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.checkpoints import Checkpoints
from kickdrift.engine.controller import Controller
from kickdrift.engine.events import Event, watch_for
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.keeping import find, keep
from kickdrift.engine.method_selection import Choice
from kickdrift.engine.processing import compile_method
from kickdrift.engine.progress import Bar
from kickdrift.engine.run import Ending, Failure, Run
from kickdrift.engine.standing import Standing
from kickdrift.systems.system import System


@dataclass(frozen=True, eq=False)
class Task:
    """All that determines a run.

    Attributes
    ----------
    system : System
        With the start.
    chosen : Choice
        The method.
    grid : Grid or Course
    compensated : bool
    controller : Controller or None
        What chooses the steps of a course.
    events : tuple of Event
    progress : bool or None
        Whether a bar shows, which determines nothing.
    """

    system: System
    chosen: Choice
    grid: Grid | Course
    compensated: bool
    controller: Controller | None
    events: tuple[Event, ...]
    progress: bool | None


class Journey:
    """A task on its way: compiled, with room for its rows.

    Parameters
    ----------
    task : Task
    before : Standing, optional
        Where it begins.
    checkpoints : Checkpoints, optional
        Where it is kept as it goes on; if it was kept there already, it begins there.

    Attributes
    ----------
    task : Task
        The grid of which has the step that the run began with.
    processing : Processing
    between : callable
        Returns the method, compiled for steps of any size, with a state of its own.
    watch : Watch or None
    run : Run
    said : str
        What is to be said of where it began.
    """

    def __init__(self, task: Task, before: Standing | None = None, checkpoints: Checkpoints | None = None) -> None:
        self.task, self.said, self._checkpoints = task, "", checkpoints
        self._compile()
        if checkpoints is not None:
            found = find(checkpoints, task.grid, self.processing.kernel.state, len(task.events))
            if found is not None:
                grid, before, self.said = found
                if grid.step != task.grid.step:
                    self.task = replace(task, grid=grid)
                    self._compile()
        if before is None or before.step == 0:
            self.processing.enter()
        else:
            self.run.go_on(before)

    def _compile(self) -> None:
        task = self.task
        made = partial(compile_method, task.system, task.chosen.method, task.grid, task.compensated)
        self.processing = made(turns=not task.events, controller=task.controller)
        transformed = self.processing.kernel.program.transformed
        self.between = partial(made, controller=task.controller if transformed else None)
        self.watch = watch_for(task.events, task.system, partial(self.between, turns=False), task.grid.t1)
        self.run = Run(self.processing.kernel, task.grid, self.watch)

    def go(self) -> Ending:
        """Run to the end of the grid, or as far as it goes."""
        started, run, failure = time.perf_counter(), self.run, None
        with closing(Bar(run.rows.progress(0)[1], self.task.progress)) as bar:
            while failure is None and not run.ended:
                first, until = run.step, sys.maxsize
                if self._checkpoints is not None:
                    until = self._checkpoints.until(first, until)
                began = time.perf_counter()
                failure = run.go(bar, started, until)
                if self._checkpoints is not None:
                    self._checkpoints.pace(run.step - first, time.perf_counter() - began)
                    failure = self._kept(self._checkpoints, failure)
        return run.ending(*(failure or (Outcome.COMPLETED, "")))

    def _kept(self, checkpoints: Checkpoints, failure: Failure | None) -> Failure | None:
        """Keep where the run stands, while Ctrl-C waits, and say what ends it, if anything does."""
        with InterruptionNoted(passed_on=False) as interruption:
            try:
                keep(checkpoints, self.task.grid, self.run.standing())
            except FileFormatError as error:
                outcome, cause = failure or (Outcome.NOT_WRITTEN, "")
                return outcome, f"{cause} {error}"
        if interruption.noted and not self.run.ended:
            return failure or (Outcome.INTERRUPTED, "")
        return failure
