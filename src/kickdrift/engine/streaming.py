"""Rows that are streamed to disk during a run, so that memory holds one chunk at a time."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.core.naming import digest
from kickdrift.engine import quantities
from kickdrift.engine.description import Description
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.processing import Processing
from kickdrift.engine.rows import GridRows, Mark
from kickdrift.engine.stepper import State
from kickdrift.engine.zarr_group import Array
from kickdrift.engine.zarr_store import ZarrStore
from kickdrift.engine.zeros import Zero

Floats = NDArray[np.float64]


class StreamedRows(ABC):
    """Rows that go to a store, a whole chunk at a time; in memory they are `GridRows` or `CourseRows`.

    Attributes
    ----------
    first : int
        Number of the rows before those in memory; where rows are between states, see `StreamedTimes`, of such states.
    evaluations : int
        Force evaluations of the last row.
    said : str
        A sentence about the last row for the message.
    """

    first: int
    evaluations, said = 0, ""
    _processing: Processing
    _store: ZarrStore
    _about: Description

    def create(self) -> None:
        """Create the empty store."""
        system, about, units = self._processing.system, self._about, self._about.units
        arrays = {
            "time": Array((), (), units.get("t", "")),
            "x": Array(about.dimensions, system.x0.shape, units.get("x", "")),
        }
        if system.v0.shape == system.x0.shape:  # first-order equations have no v
            arrays["v"] = Array(about.dimensions, system.v0.shape, units.get("v", ""))
        for name, quantity in system.quantities.items():
            key = name.replace(" ", "_")
            vector = quantity.size > 1
            arrays[key] = Array((f"{key}_component",) * vector, (quantity.size,) * vector, quantity.unit)
        step = self._processing.kernel.step
        words = {"system": about.system, "method": about.method, "step": step, "status": "RUNNING"}
        self._store.create({**words, "source": about.source}, arrays, about.coordinates)
        self.begin_chunk()

    def begin_chunk(self) -> None:  # noqa: B027 - variable steps need nothing here
        """Make room for a chunk of the store."""

    @abstractmethod
    def full_after(self, step: int) -> int:
        """Return the step after which a chunk is full, of a run that has done `step`."""

    @abstractmethod
    def drain(self, mark: Mark) -> None:
        """Write whole chunks."""

    @abstractmethod
    def close(self, step: int, mark: Mark, state: State, stop: Zero | None, status: str) -> None:
        """Write the remaining rows with the last state, and the outcome."""

    @abstractmethod
    def ends(self, step: int) -> tuple[Floats, Floats, Floats, Floats]:
        """Return time, x, v and step size of the first and of the last row, which may be the same."""

    def seen(self, rows: int) -> int:
        """Return the number of rows of the solution."""
        return self.first

    def _append(self, t: Floats, xs: Floats, vs: Floats, attributes: Mapping[str, Any]) -> None:
        """Write rows as the user's states."""
        system = self._processing.system
        rows = {"time": t, "x": xs, "v": vs}
        if system.v0.size == 0:
            del rows["v"]
        for name in system.quantities:
            rows[name.replace(" ", "_")] = quantities.evaluate(system, name, t, xs, vs)
        self._store.append(rows, attributes)


class StreamedGridRows(StreamedRows, GridRows):
    """The rows of equal steps, one chunk of the store at a time."""

    def __init__(self, processing: Processing, grid: Grid, store: ZarrStore, about: Description) -> None:
        self.stepper, self.grid, self._processing, self._store = processing.kernel, grid, processing, store
        self._about, self._start, self._every = about, processing.kernel.state.copy(), grid.every or 1
        self.first, self.save_steps = 0, np.zeros(0, dtype=np.int64)

    def begin_chunk(self) -> None:
        """Allocate a chunk, and one row more in case the run ends between two."""
        state, rows = self.stepper.state, self._store.chunk + 1
        self.xs, self.vs = np.empty((rows, state.x.size)), np.empty((rows, state.v.size))
        self._begin_at(self.first)

    def _begin_at(self, first: int) -> None:
        """Begin the chunk with a row."""
        steps = np.arange(first, first + self._store.chunk, dtype=np.int64) * self._every
        self.first, self.save_steps = first, np.unique(np.minimum(steps, self.grid.n_steps))

    def begin(self) -> Mark:
        """Keep the initial state."""
        self.xs[0], self.vs[0] = self.stepper.state.x, self.stepper.state.v
        return Mark(1)

    def kept(self, step: int, mark: Mark) -> dict[str, NDArray[Any]]:
        """Return the rows not in the store yet that a longer run would also have, and the number of those in the store."""
        rows = step // self._every + 1 - self.first
        return {"stored": np.array([self.first]), "xs": self.xs[:rows], "vs": self.vs[:rows]}

    def go_on(self, kept: Mapping[str, NDArray[Any]], step: int, mark: Mark) -> Mark:
        """Resume after a step with the rows kept until then."""
        self.first, rows = int(kept["stored"][0]), len(kept["xs"])
        self._store.go_on(self.first)
        self.begin_chunk()
        self.xs[:rows], self.vs[:rows] = kept["xs"], kept["vs"]
        if self.ended(step) and step % self._every:
            self.xs[rows], self.vs[rows] = self.stepper.state.x, self.stepper.state.v
            rows += 1
        return Mark(self.first + rows, 0, step)

    def full_after(self, step: int) -> int:
        """Return the step after which a chunk is full."""
        return min(self.grid.n_steps, (self.first + self._store.chunk - 1) * self._every)

    def drain(self, mark: Mark) -> None:
        """Write the chunk if it is full.

        Raises
        ------
        FileFormatError
            If it cannot be written.
        """
        if mark.rows - self.first == self._store.chunk:
            self._write(self.save_steps, {})
            self._begin_at(mark.rows)

    def close(self, step: int, mark: Mark, state: State, stop: Zero | None, status: str) -> None:
        """Write the remaining rows with the last state, and the outcome.

        Raises
        ------
        FileFormatError
            If it cannot be written.
        """
        written = self.first > 0 and mark.rows == self.first and (self.first - 1) * self._every == step
        rows = 0 if written else super().keep_last(state, step, mark, stop is not None) - self.first
        steps = np.append(self.save_steps, step)[:rows]
        if rows:
            steps[-1] = min(int(steps[-1]), step)
        self._write(steps, {"status": status})
        self.first += rows
        if stop is not None:
            self._append(np.array([stop.t]), stop.x[None], stop.v[None], {})

    def keep_last(self, state: State, step: int, mark: Mark, stopped: bool) -> int:
        """Keep the state reached, once the store is closed."""
        self._last = state
        return self.first

    def ends(self, step: int) -> tuple[Floats, Floats, Floats, Floats]:
        """Return time, x, v and step size of the first and of the last row, which may be the same."""
        count, last = (2 if step else 1), self.grid.t1 if self.ended(step) else self.time(step)
        t = np.array([self.grid.t0, last])[:count]
        xs, vs = np.stack((self._start.x, self._last.x)), np.stack((self._start.v, self._last.v))
        return t, *self._processing.leave(t, xs[:count], vs[:count], self.grid.t0), self.steps(t)

    def _write(self, steps: NDArray[np.int64], attributes: Mapping[str, Any]) -> None:
        """Write rows of the chunk."""
        t = np.where(steps == self.grid.n_steps, self.grid.t1, self.grid.t0 + steps * self.grid.step)
        xs, vs = self._processing.leave(t, self.xs[: t.size].copy(), self.vs[: t.size].copy(), self.grid.t0)
        self._append(t, xs, vs, attributes)


def store_of(path: Any, grid: Grid | Course, identity: Mapping[str, str], again: bool) -> ZarrStore | None:
    """Return the store for the rows, None for memory; with `again`, a run may resume in an existing one.

    Raises
    ------
    ArgumentError
        For an invalid path, an existing folder, and runs whose rows cannot go to disk.
    """
    if path is None:
        return None
    if grid.wanted is not None and (np.sign(grid.step) * np.diff(grid.wanted) < 0.0).any():
        raise ArgumentError(
            f"save_to={str(path)!r} needs t_eval in the order of the run, from t={grid.t0!r} to {grid.t1!r}; sort the times."
        )
    store = ZarrStore(path, digest((sorted(identity.items()), f"{grid.step:.9g}")))
    store.check(again)
    return store
