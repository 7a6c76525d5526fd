"""The rows that a run keeps: where they go as it goes on."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.grid import Grid
from kickdrift.engine.stepper import State

Floats = NDArray[np.float64]
Room = tuple[NDArray[np.int64], Floats, Floats]


class Rows(Protocol):
    """Where rows go, the states of the loop after some of its steps."""

    def room(self, until: int) -> Room:
        """Return the steps up to one after which there will be rows, and room for these, and for one more."""

    def take(self, count: int) -> None:
        """Keep so many rows of that room."""

    def end(self, step: int, state: State) -> None:
        """Keep the state after the last step, if that is not kept yet."""


class RowsInMemory:
    """Rows in two arrays.

    Attributes
    ----------
    save_steps : (T,) array of int
        The steps after which there are rows, if the run does not end early.
    count : int
        How many rows there are; the last may be one of a run that ended between two of the grid's.
    xs, vs : (T + 1, n) array
        The rows.
    """

    def __init__(self, grid: Grid, first: int, state: State) -> None:
        self.save_steps, self.count = grid.save_steps[first:], 0
        size = self.save_steps.size + 1
        self.xs, self.vs = np.empty((size, state.x.size)), np.empty((size, state.v.size))

    def room(self, until: int) -> Room:
        """Return what of the arrays is to be filled next."""
        last = int(np.searchsorted(self.save_steps, until, side="right"))
        rows = slice(self.count, last + 1)
        return self.save_steps[self.count : last], self.xs[rows], self.vs[rows]

    def take(self, count: int) -> None:
        """Count the rows that were filled."""
        self.count += count

    def end(self, step: int, state: State) -> None:
        """Add the state after the last step, if it was not to be kept."""
        if self.steps(step)[-1:] == [step]:
            return
        self.xs[self.count], self.vs[self.count] = state.x, state.v
        self.count += 1

    def steps(self, last: int) -> NDArray[np.int64]:
        """Return the steps of the rows that there are, of a run that ended after the step `last`."""
        return np.append(np.minimum(self.save_steps, last), last)[: self.count]
