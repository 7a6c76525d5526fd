"""Runs that continue from their current state, with the bits of an uninterrupted run, or go back from there."""

import math
from contextlib import closing
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from kickdrift.core.arguments import real
from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.engine.flows.layout import CLOCK
from kickdrift.engine.grid import Course, Grid, lengthen
from kickdrift.engine.report import report
from kickdrift.engine.reversal import back_from
from kickdrift.engine.solution import Solution
from kickdrift.engine.standing import Standing
from kickdrift.engine.task import Journey, Task

_SAME_ZERO = 1e-3  # of the first step, by which other last steps may move the zero of an event


@dataclass(frozen=True, eq=False, repr=False)
class Continuation:
    """The function behind ``solution.continue_to``: the task, its progress, and whether that is its end."""

    task: Task
    standing: Standing
    ended: bool

    def __copy__(self) -> "Continuation":
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> "Continuation":
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _forgotten, ()  # the system may hold functions that cannot be pickled

    def __call__(self, t: float, back: bool = False) -> Solution:
        """Run on to another end, see `Solution.continue_to`, or back; see `Solution.return_to`."""
        if back:
            return carry_out(back_from(self.task, self.standing, t))
        try:
            t = real(t)
        except TypeError:
            raise ArgumentError(f"t={t!r} must be a time, the new end.") from None
        grid = self._grid(t)
        if self.task.tables is not None:
            self.task.tables.check(grid)
        task = self.task._replace(grid=grid)
        if isinstance(grid, Grid) or grid is self.task.grid:
            return carry_out(Journey(task, self.standing))
        journey = Journey(task)  # from the start: the last steps of a run, where they vary, depend on its end
        journey.run.repeat(self.standing.step)
        if journey.watch is not None and self._stopped is not None:
            journey.watch.beyond = self._stopped + _SAME_ZERO * grid.step
        return carry_out(journey)

    @property
    def _stopped(self) -> float | None:
        """Time of the latest event that ended the run, or one that it continued."""
        return None if self.standing.seen is None else self.standing.seen.beyond

    def _grid(self, t: float) -> Grid | Course:
        grid, standing = self.task.grid, self.standing
        if isinstance(grid, Grid):
            return lengthen(grid, t, standing.step, self.task.system.x0.size)
        if t == grid.t1 and not self.ended:
            return grid
        if grid.returns:
            raise ArgumentError(
                f"t={t!r}: these are the steps of another run in reverse; use return_to(t) of that one."
            )
        times = [grid.t1 if self.ended else float(standing.state.work[CLOCK]), self._stopped]
        reached = max((time for time in times if time is not None), key=lambda time: time * grid.step)
        if not (math.isfinite(t) and (t - reached) * grid.step > 0.0):
            raise ArgumentError(
                f"t={t!r} must be finite, and beyond the end of the solution, {reached!r}; for earlier times use"
                " solution(t)."
            )
        wanted = None if grid.wanted is None else np.append(grid.wanted[(grid.wanted - t) * grid.step < 0.0], t)
        marks = np.array([t]) if wanted is None else np.unique(wanted)[:: 1 if grid.step > 0.0 else -1].copy()
        return grid._replace(t1=t, marks=marks, wanted=wanted)


def carry_out(journey: Journey) -> Solution:
    """Run to the end, or as far as possible, and return the rows kept."""
    with closing(journey):
        solution = report(journey, journey.go(), Continuation)
        if journey.store is not None:
            try:
                solution.presenters.keep(solution)
            except FileFormatError as error:
                solution = replace(solution, message=f"{solution.message} kickdrift.load will not find it: {error}")
        return solution


def _forgotten() -> None:
    """Stand for the continuation of a solution that another process reads."""
