"""Rows at times of the user's choice that are streamed to disk: states between steps, a chunk of times at a time.

The states from which steps lead to these times stay in memory until the next one is known, which may be nearer to a time.
"""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.outcomes import Outcome
from kickdrift.engine.dense import DenseOutput, States
from kickdrift.engine.description import Description
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.processing import Processing
from kickdrift.engine.rows import GridRows, Mark
from kickdrift.engine.stepper import State
from kickdrift.engine.streaming import StreamedRows
from kickdrift.engine.zarr_store import ZarrStore
from kickdrift.engine.zeros import Zero

Floats = NDArray[np.float64]

_NEAR = 1e-6  # of a step: a time so near to a state may be led to from that


class Known(NamedTuple):
    """States as users see them, from which steps lead on: their times, and the size of the steps."""

    t: Floats
    x: Floats
    v: Floats
    steps: Floats

    def followed_by(self, t: float, x: Floats, v: Floats, step: float) -> "Known":
        """Add a state at the end of a run; no step leads on from it, but `step` has the size and sign of the others."""
        xs, vs = np.concatenate((self.x, x[None])), np.concatenate((self.v, v[None]))
        return Known(np.append(self.t, t), xs, vs, np.append(self.steps, step))


class StreamedTimes(StreamedRows):
    """Rows at the times wanted, which are in the order of the run.

    Attributes
    ----------
    stored : int
        Number of rows in the store.
    """

    grid: Grid | Course
    _between: Callable[[], Processing]
    stored = 0

    def seen(self, rows: int) -> int:
        """Return the number of states that were seen by the user, given the number kept."""
        return rows

    def ends(self, step: int) -> tuple[Floats, Floats, Floats, Floats]:
        """Return time, x, v and step size of the first and of the last row, which may be the same."""
        t, x, v = self._store.rows_at(np.unique([0, self.stored - 1]) if self.stored else np.zeros(0, dtype=np.intp))
        system = self._processing.system
        x, v = x.reshape(t.size, *system.x0.shape), v.reshape(t.size, *system.v0.shape)
        return t, x, v, np.full(t.size, self.grid.step)

    @property
    def _wanted(self) -> Floats:
        """Times of the rows."""
        if self.grid.wanted is not None:
            return self.grid.wanted
        return self.grid.times if isinstance(self.grid, Grid) else np.zeros(0)

    def _progress(self) -> dict[str, NDArray[Any]]:
        """Return the number of rows in the store, and the force evaluations that they took."""
        return {"stored": np.array([self.stored]), "spent": np.array([self.evaluations])}

    def _resume(self, kept: Mapping[str, NDArray[Any]]) -> None:
        self.stored, self.evaluations = int(kept["stored"][0]), int(kept["spent"][0])
        self._store.go_on(self.stored)

    def _drain(self, t: Floats, known: Callable[[], Known]) -> int:
        """Write whole chunks of rows up to the last of the states at times `t`; return how many of these are done with."""
        if not t.size:
            return 0
        sign = np.sign(self.grid.step)
        sure = np.searchsorted(sign * self._wanted, sign * t[-1] - _NEAR * abs(self.grid.step), side="left")
        chunks = max(0, int(sure) - self.stored) // self._store.chunk
        if not chunks:
            return 0
        self._store_until(self.stored + chunks * self._store.chunk, known(), self.grid.t1)
        if self.stored == self._wanted.size:
            return t.size - 1
        return max(0, int(np.searchsorted(sign * t, sign * self._wanted[self.stored], side="right")) - 1)

    def _close(self, known: Known, end: float, with_last: bool, stop: Zero | None, status: str) -> None:
        """Write the remaining rows up to an end, and the last state if the run ended early, or at an event."""
        low, high = sorted((self.grid.t0, end))
        completed = status == Outcome.COMPLETED.name
        until = self._wanted.size if completed else int(((self._wanted >= low) & (self._wanted <= high)).sum())
        self._store_until(until, known, end)
        last = slice(-1, None) if with_last else slice(0)
        self._append(known.t[last], known.x[last], known.v[last], {"status": status})
        self.stored += with_last and stop is None

    def _store_until(self, count: int, known: Known, end: float) -> None:
        """Write rows up to a number of them; where a function fails between two steps, they are NaN."""
        system, (low, high) = self._processing.system, sorted((self.grid.t0, end))
        dense = DenseOutput.of_rows(self.grid, States(system.x0, system.v0), known, end, self._between)
        while self.stored < count:
            t = self._wanted[self.stored : min(count, self.stored + self._store.chunk)]
            try:
                x, v, spent = dense.states_at(np.clip(t, low, high))
                self.evaluations += spent
            except Exception as error:
                x, v = (np.full((t.size, *own.shape), np.nan) for own in (system.x0, system.v0))
                self.said = f" Times between steps are missing where {type(error).__name__} was raised: {error}."
            self._append(t, x, v, {})
            self.stored += t.size

    def _as_users(self, t: Floats, xs: Floats, vs: Floats, steps: Floats) -> Known:
        """Return states as users see them."""
        return Known(t, *self._processing.leave(t, xs.copy(), vs.copy(), self.grid.t0), steps.copy())


class StreamedGridTimes(StreamedTimes, GridRows):
    """Rows at times wanted along equal steps.

    Parameters
    ----------
    between : callable
        Returns the method, compiled for steps of any size.
    """

    grid: Grid

    def __init__(
        self,
        processing: Processing,
        grid: Grid,
        store: ZarrStore,
        about: Description,
        between: Callable[[], Processing],
    ) -> None:
        self.stepper, self.grid, self._processing, self._store = processing.kernel, grid, processing, store
        self._about, self._between = about, cache(between)
        self._begin_at(0)

    def begin_chunk(self) -> None:
        """Allocate the states of two chunks, of which one waits for times in the same steps; and one for an early end."""
        state, rows = self.stepper.state, 2 * self._store.chunk + 3
        self.xs, self.vs = np.empty((rows, state.x.size)), np.empty((rows, state.v.size))
        self._begin_at(self.first)

    def _begin_at(self, first: int) -> None:
        """Begin the states in memory with one of those of the grid."""
        self.first, self.save_steps = first, self.grid.save_steps[first : first + 2 * self._store.chunk + 2]

    def kept(self, step: int, mark: Mark) -> dict[str, NDArray[Any]]:
        """Return the states in memory, and the progress of the store."""
        rows = slice(mark.rows - self.first)
        return {**self._progress(), "xs": self.xs[rows], "vs": self.vs[rows]}

    def go_on(self, kept: Mapping[str, NDArray[Any]], step: int, mark: Mark) -> Mark:
        """Resume after a step with the states kept until then."""
        self._resume(kept)
        self.begin_chunk()
        rows = len(kept["xs"])
        self._begin_at(mark.rows - rows)
        self.xs[:rows], self.vs[:rows] = kept["xs"], kept["vs"]
        return Mark(mark.rows, 0, step)

    def full_after(self, step: int) -> int:
        """Return the step after which no more states fit."""
        more = self.first + self.save_steps.size < self.grid.save_steps.size
        return int(self.save_steps[-1]) if more else self.grid.n_steps

    def drain(self, mark: Mark) -> None:
        """Write whole chunks of rows, and make room for more states.

        Raises
        ------
        FileFormatError
            If they cannot be written.
        """
        rows = mark.rows - self.first
        done = self._drain(self.grid.times[self.first : mark.rows], lambda: self._states(rows))
        if done:
            for states in (self.xs, self.vs):
                states[: rows - done] = states[done:rows].copy()
            self._begin_at(self.first + done)

    def close(self, step: int, mark: Mark, state: State, stop: Zero | None, status: str) -> None:
        """Write the remaining rows with the last state, and the outcome.

        Raises
        ------
        FileFormatError
            If it cannot be written.
        """
        rows = super().keep_last(state, step, mark, stop is not None) - self.first
        known, end, early = self._states(rows), self.grid.t1, not self.ended(step) and stop is None
        if early:
            end = known.t[-1] = self.time(step)
        if stop is not None:
            known, end = known.followed_by(stop.t, stop.x, stop.v, self.grid.step), stop.t
        added = self.grid.wanted is not None or rows > mark.rows - self.first
        self._close(known, end, stop is not None or (early and added), stop, status)

    def _states(self, rows: int) -> Known:
        """Return the states in memory; the last may be one more than those of the grid."""
        t = np.append(self.grid.times[self.first :], self.grid.t1)[:rows]
        return self._as_users(t, self.xs[:rows], self.vs[:rows], self.steps(t))
