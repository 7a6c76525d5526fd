"""Runs that continue from their current state, with the bits of an uninterrupted run, or go back from there."""

from contextlib import closing
from dataclasses import dataclass, replace
from typing import Any

from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.engine.grid import Course, Grid, lengthen
from kickdrift.engine.report import report
from kickdrift.engine.reversal import back_from
from kickdrift.engine.solution import Solution
from kickdrift.engine.standing import Standing
from kickdrift.engine.task import Journey, Task


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
        grid = self._grid(t)
        if self.task.tables is not None:
            self.task.tables.check(grid)
        return carry_out(Journey(replace(self.task, grid=grid), self.standing))

    def _grid(self, t: float) -> Grid | Course:
        grid = self.task.grid
        if isinstance(grid, Grid):
            return lengthen(grid, t, self.standing.step, self.task.system.x0.size)
        if self.ended or t != grid.t1:
            rest = "" if self.ended else f" This run can be continued to its end, {grid.t1!r}."
            raise ArgumentError(
                f"t={t!r}: the steps vary, and the steps and rows of this run depend on its end; solve to the later"
                f" end from the start, with checkpoint='folder' if that takes long.{rest}"
            )
        return grid


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
