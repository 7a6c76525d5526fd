"""What is to be run, made ready and run: from its start, or on from where it stands."""

import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.events import Event, Seen, Watch, watch_for
from kickdrift.engine.grid import Grid
from kickdrift.engine.method_selection import Choice
from kickdrift.engine.processing import Processing, compile_method
from kickdrift.engine.progress import Bar
from kickdrift.engine.rows import RowsInMemory
from kickdrift.engine.run import Ending, Leg, Mark, Run
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


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


@dataclass(frozen=True, eq=False)
class Standing:
    """Where a run stands: the state of the loop, and the rows up to there as people see them.

    Attributes
    ----------
    mark : Mark
    steps : (T,) array of int
        The steps after which there are rows, on the grid alone.
    xs, vs : (T, *shape) array
        The rows.
    wall_time : float
        Seconds in the loop.
    seen : Seen or None
        What was found of events.
    """

    mark: Mark
    steps: NDArray[np.int64]
    xs: Floats
    vs: Floats
    wall_time: float
    seen: Seen | None


class Journey:
    """A task on its way: compiled, with room for its rows.

    Attributes
    ----------
    task : Task
    before : Standing or None
        Where it begins.
    processing : Processing
    watch : Watch or None
    rows : RowsInMemory
        Those after the beginning.
    """

    def __init__(self, task: Task, before: Standing | None = None) -> None:
        system, method, grid = task.system, task.chosen.method, task.grid
        self.task, self.before = task, before
        self.processing: Processing = compile_method(system, method, grid, task.compensated, turns=not task.events)
        self.watch: Watch | None = watch_for(task.events, system, method, grid, task.compensated)
        self._state = self.processing.kernel.state
        if before is None:
            self.processing.enter()
        elif self.watch is not None and before.seen is not None:
            state = before.mark.state
            self.watch.go_on(before.seen, before.mark.step, state.x.copy(), state.v.copy())
        self.rows = RowsInMemory(grid, 0 if before is None else before.steps.size, self._state)

    def go(self) -> Ending:
        """Run to the end of the grid, or as far as it goes."""
        started, bar = time.perf_counter(), Bar(self.task.grid.n_steps, self.task.progress)
        begin = None if self.before is None else self.before.mark
        try:
            leg = Leg(begin, self.task.grid.n_steps, *self.rows.room(self.task.grid.n_steps))
            run = Run(self.processing.kernel, self.task.grid, leg, self.watch)
            ending = run.go(bar, started)
            self.rows.take(ending.saved)
        finally:
            bar.close()
        before = 0.0 if self.before is None else self.before.wall_time
        return replace(ending, wall_time=ending.wall_time + before)

    def standing(self, ending: Ending, xs: Floats, vs: Floats) -> Standing:
        """Say where the run stands at its end, with the rows, as people see them, that a longer run would have, too."""
        steps, every = self.task.grid.save_steps, self.task.grid.every
        steps = steps[: int(np.searchsorted(steps, ending.n_steps, side="right"))]
        if every is not None and steps.size and steps[-1] % every:
            steps = steps[:-1]
        beyond = None if ending.stop is None else ending.stop.t
        return Standing(
            mark=Mark(self._state.copy(), ending.n_steps),
            steps=steps,
            xs=xs[: steps.size],
            vs=vs[: steps.size],
            wall_time=ending.wall_time,
            seen=None if self.watch is None else self.watch.seen(ending.n_steps, beyond),
        )
