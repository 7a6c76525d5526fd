"""Runs that go on from where they stand, with the bits of one that was never broken."""

from dataclasses import dataclass, replace
from typing import Any

from kickdrift.engine.grid import lengthen
from kickdrift.engine.report import report
from kickdrift.engine.solution import Solution
from kickdrift.engine.standing import Standing
from kickdrift.engine.task import Journey, Task


@dataclass(frozen=True, eq=False, repr=False)
class Continuation:
    """What ``solution.continue_to`` asks: the task, and where it stands."""

    task: Task
    standing: Standing

    def __copy__(self) -> "Continuation":
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> "Continuation":
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _forgotten, ()  # the system may hold functions that cannot be pickled

    def __call__(self, t: float) -> Solution:
        """Run on to another end; see `Solution.continue_to`."""
        grid = lengthen(self.task.grid, t, self.standing.reached.step, self.task.system.x0.size)
        return carry_out(Journey(replace(self.task, grid=grid), self.standing))


def carry_out(journey: Journey) -> Solution:
    """Run to the end, or as far as it goes, and return what was kept."""
    return report(journey, journey.go(), Continuation)


def _forgotten() -> None:
    """Stand for the continuation of a solution that another process reads."""
