"""Rows and outcomes of members, filled as they come."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.outcomes import Outcome
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.run import ended_early
from kickdrift.scale.moments import Moments, none_of

Floats = NDArray[np.float64]


@dataclass(eq=False)
class Results:
    """Results of the members: rows, (M, T, *shape), the number filled, outcomes, and costs.

    And the zeros of events, and rows at other times, such as that of an early end. Results of members that are `done` do not
    change any more.
    """

    x: Floats
    v: Floats
    rows: NDArray[np.int64]
    status: NDArray[np.object_]  # outcomes
    messages: NDArray[np.object_]
    step: Floats
    step_range: Floats
    n_steps: NDArray[np.int64]
    rejected: NDArray[np.int64]
    evaluations: NDArray[np.int64]
    done: NDArray[np.bool_]
    zeros: list[Moments]
    last: list[Moments]

    @classmethod
    def empty(
        cls, count: int, times: int, shape: tuple[int, ...], shape_of_v: tuple[int, ...], events: int = 0
    ) -> "Results":
        """Allocate the results of members before they begin."""
        return cls(
            np.empty((count, times, *shape)),
            np.empty((count, times, *shape_of_v)),
            np.zeros(count, dtype=np.int64),
            np.full(count, Outcome.INTERRUPTED, dtype=object),
            np.full(count, f"{Outcome.INTERRUPTED.value} It did not start.", dtype=object),
            np.zeros(count),
            np.zeros((count, 2)),
            np.zeros(count, dtype=np.int64),
            np.zeros(count, dtype=np.int64),
            np.zeros(count, dtype=np.int64),
            np.zeros(count, dtype=bool),
            [none_of(events, shape, shape_of_v)] * count,
            [none_of(1, shape, shape_of_v)] * count,
        )

    def fill(self) -> None:
        """Set the rows after those filled to NaN."""
        for i in np.flatnonzero(self.rows < self.x.shape[1]):
            self.x[i, self.rows[i] :] = self.v[i, self.rows[i] :] = np.nan

    def note(
        self,
        indices: NDArray[np.intp],
        grid: Grid | Course,
        steps: int | NDArray[np.int64],
        rows: int,
        evaluations: NDArray[np.int64],
    ) -> None:
        """Note the steps that members have done, and the rows that they have filled; all rows, if their steps vary."""
        self.rows[indices], self.evaluations[indices] = rows, evaluations
        self.step[indices], self.n_steps[indices] = grid.step, steps
        self.step_range[indices] = abs(grid.step)
        outcome = Outcome.COMPLETED if isinstance(grid, Course) or steps == grid.n_steps else Outcome.INTERRUPTED
        message = outcome.value
        if isinstance(grid, Grid) and not outcome.success:
            message = ended_early(outcome, float(grid.t0 + steps * grid.step), f"{steps} of {grid.n_steps} steps")
        self.status[indices], self.messages[indices] = outcome, message
        self.done[indices] = outcome.success

    def put(self, first: int, other: "Results") -> None:
        """Take over those of the members from `first` on."""
        last = first + len(other.status)
        self.x[first:last], self.v[first:last] = other.x, other.v
        self.rows[first:last] = other.rows
        self.status[first:last], self.messages[first:last] = other.status, other.messages
        self.step[first:last], self.step_range[first:last] = other.step, other.step_range
        self.n_steps[first:last], self.rejected[first:last] = other.n_steps, other.rejected
        self.evaluations[first:last] = other.evaluations
        self.done[first:last] = other.done
        self.zeros[first:last], self.last[first:last] = other.zeros, other.last
