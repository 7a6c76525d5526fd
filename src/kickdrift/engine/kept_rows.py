"""The rows that a run keeps: where they go as it goes on."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.grid import Grid
from kickdrift.engine.processing import Processing
from kickdrift.engine.stepper import State

Floats = NDArray[np.float64]
Room = tuple[NDArray[np.int64], Floats, Floats]


class Rows(Protocol):
    """Where rows go, the states of the loop after some of its steps."""

    def room(self, until: int) -> Room:
        """Return the steps up to one after which there will be rows, and room for these, and for one more."""

    def take(self, count: int, step: int) -> None:
        """Keep so many rows of that room, which were filled up to a step."""

    def end(self, step: int, state: State) -> None:
        """Keep the state after the last step, if that is not kept yet."""


class RowsInMemory:
    """Rows in two arrays, as people see them.

    Attributes
    ----------
    count : int
        How many there are; the last may be one of a run that ended between two of the grid's.
    """

    def __init__(self, grid: Grid, processing: Processing) -> None:
        self._grid, self._processing, self.count = grid, processing, 0
        self._shapes, state = (processing.system.x0.shape, processing.system.v0.shape), processing.kernel.state
        size = grid.save_steps.size + 1
        self._xs, self._vs = np.empty((size, state.x.size)), np.empty((size, state.v.size))

    def fill(self, xs: Floats, vs: Floats) -> None:
        """Begin with rows that there are already."""
        self.count = len(xs)
        for rows, values in ((self._xs[: self.count], xs), (self._vs[: self.count], vs)):
            rows[:] = values.reshape(rows.shape)

    def room(self, until: int) -> Room:
        """Return what of the arrays is to be filled next."""
        last = int(np.searchsorted(self._grid.save_steps, until, side="right"))
        rows = slice(self.count, last + 1)
        return self._grid.save_steps[self.count : last], self._xs[rows], self._vs[rows]

    def take(self, count: int, step: int) -> None:
        """Keep so many rows that were filled, up to a step, as people see them."""
        new = slice(self.count, self.count + count)
        steps = np.append(np.minimum(self._grid.save_steps, step), step)[new]
        xs, vs = self._processing.leave(self._grid, steps, self._xs[new], self._vs[new])
        if self._processing.frame is not None:
            for rows, values in ((self._xs[new], xs), (self._vs[new], vs)):
                rows[:] = values.reshape(rows.shape)
        self.count += count

    def end(self, step: int, state: State) -> None:
        """Add the state after the last step, if it was not to be kept."""
        if self.count and min(int(self._grid.save_steps[self.count - 1]), step) == step:
            return
        self._xs[self.count], self._vs[self.count] = state.x, state.v
        self.take(1, step)

    def seen(self, count: int) -> tuple[Floats, Floats]:
        """Return the first so many rows, in the shape of the state."""
        xs, vs = self._xs[:count], self._vs[:count]
        return xs.reshape(count, *self._shapes[0]), vs.reshape(count, *self._shapes[1])
