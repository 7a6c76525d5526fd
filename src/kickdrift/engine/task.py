"""What is to be run, made ready and run: from its start, or on from where it stands."""

import time
from contextlib import closing
from dataclasses import dataclass, replace

from kickdrift.core.errors import FileFormatError
from kickdrift.core.interruption import InterruptionNoted
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.checkpoints import Checkpoints
from kickdrift.engine.events import Event, watch_for
from kickdrift.engine.grid import Grid
from kickdrift.engine.keeping import find, keep
from kickdrift.engine.kept_rows import RowsInMemory
from kickdrift.engine.method_selection import Choice
from kickdrift.engine.processing import compile_method
from kickdrift.engine.progress import Bar
from kickdrift.engine.run import Ending, Leg, Reached, Run, sentence
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
    grid : Grid
    compensated : bool
    events : tuple of Event
    progress : bool or None
        Whether a bar shows, which determines nothing.
    """

    system: System
    chosen: Choice
    grid: Grid
    compensated: bool
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
    watch : Watch or None
    rows : RowsInMemory
    said : str
        What is to be said of where it began.
    """

    def __init__(self, task: Task, before: Standing | None = None, checkpoints: Checkpoints | None = None) -> None:
        system, method, compensated = task.system, task.chosen.method, task.compensated
        self.processing = compile_method(system, method, task.grid, compensated, turns=not task.events)
        self._state, self.said = self.processing.kernel.state, ""
        found = None if checkpoints is None else find(checkpoints, task.grid, self._state, len(task.events))
        if found is not None:
            grid, before, self.said = found
            task = replace(task, grid=grid)
            self.processing = compile_method(system, method, grid, compensated, turns=not task.events)
            self._state = self.processing.kernel.state
        self.task, self._before, self._checkpoints = task, before, checkpoints
        self.watch = watch_for(task.events, system, method, task.grid, compensated)
        self.rows = RowsInMemory(task.grid, self.processing)
        if before is None:
            self.processing.enter()
            return
        self.rows.fill(before.xs, before.vs)
        if self.watch is not None and before.seen is not None:
            state = before.reached.state
            self.watch.go_on(before.seen, before.reached.step, state.x.copy(), state.v.copy())

    def go(self) -> Ending:
        """Run to the end of the grid, or as far as it goes."""
        started, grid = time.perf_counter(), self.task.grid
        begin, seconds = (None, 0.0) if self._before is None else (self._before.reached, self._before.wall_time)
        with closing(Bar(grid.n_steps, self.task.progress)) as bar:
            while True:
                step = 0 if begin is None else begin.step
                until = grid.n_steps if self._checkpoints is None else self._checkpoints.until(step, grid.n_steps)
                run = Run(self.processing.kernel, grid, Leg(begin, until, *self.rows.room(until)), self.watch)
                ending = run.go(bar, started)
                self.rows.take(ending.saved, ending.n_steps)
                if self._checkpoints is not None:
                    self._checkpoints.pace(ending.n_steps - step, ending.wall_time)
                seconds += ending.wall_time
                ending = replace(ending, wall_time=seconds)
                if self._checkpoints is not None:
                    ending = self._kept(self._checkpoints, ending)
                if ending.n_steps == grid.n_steps and self.rows.count < grid.save_steps.size:
                    self.rows.end(ending.n_steps, self._state)  # it was done before, but not kept, being no regular row
                if ending.outcome is not Outcome.COMPLETED or ending.n_steps == grid.n_steps:
                    return ending
                begin = Reached(self._state, ending.n_steps)

    def standing(self, ending: Ending, beyond: float | None = None) -> Standing:
        """Say where the run stands, with the rows that a longer one would have, too; no event up to `beyond` will end it."""
        after = self.task.grid.rows_after(ending.n_steps)
        xs, vs = self.rows.seen(after.size)
        seen = None if self.watch is None else self.watch.seen(ending.n_steps, beyond)
        return Standing(Reached(self._state.copy(), ending.n_steps), after, xs, vs, ending.wall_time, seen)

    def _kept(self, checkpoints: Checkpoints, ending: Ending) -> Ending:
        """Keep where the run stands, while Ctrl-C waits, and say how it ended if that is the end of it."""
        outcome, cause = Outcome.COMPLETED, ""
        with InterruptionNoted(passed_on=False) as interruption:
            try:
                keep(checkpoints, self.task.grid, self.standing(ending))
            except FileFormatError as error:
                outcome, cause = Outcome.NOT_WRITTEN, f" {error}"
        if ending.outcome is not Outcome.COMPLETED:
            return replace(ending, message=ending.message + cause)
        if interruption.noted and outcome is Outcome.COMPLETED and ending.n_steps < self.task.grid.n_steps:
            outcome = Outcome.INTERRUPTED
        if outcome is Outcome.COMPLETED:
            return ending
        self.rows.end(ending.n_steps, self._state)
        return replace(ending, outcome=outcome, message=sentence(outcome, cause, ending.n_steps, self.task.grid))
