"""Rows at times of the user's choice, along variable steps, that are streamed to disk."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.outcomes import Outcome
from kickdrift.engine.dense import DenseOutput, States
from kickdrift.engine.description import Description
from kickdrift.engine.grid import Course
from kickdrift.engine.processing import Processing
from kickdrift.engine.rows import CourseRows, Mark
from kickdrift.engine.stepper import State
from kickdrift.engine.streamed_times import Known, StreamedTimes
from kickdrift.engine.zarr_store import ZarrStore
from kickdrift.engine.zeros import Zero


class StreamedCourseTimes(StreamedTimes, CourseRows):
    """Rows at times wanted along variable steps.

    Parameters
    ----------
    between : callable
        Returns the method, compiled for steps of any size.
    """

    grid: Course

    def __init__(
        self,
        processing: Processing,
        grid: Course,
        store: ZarrStore,
        about: Description,
        between: Callable[[], Processing],
    ) -> None:
        super().__init__(processing.kernel, grid)
        self._processing, self._store, self._about, self._between = processing, store, about, cache(between)

    def kept(self, step: int, mark: Mark) -> dict[str, NDArray[Any]]:
        """Return the states in memory, and the progress of the store."""
        return {**self._progress(), **super().kept(step, mark)}

    def go_on(self, kept: Mapping[str, NDArray[Any]], step: int, mark: Mark) -> Mark:
        """Resume after a step with the states kept until then."""
        self._resume(kept)
        self.first = mark.rows - len(kept["ts"])
        return super().go_on(kept, step, mark)

    def full_after(self, step: int) -> int:
        """Return the step after which there may be a chunk of states more."""
        return step + self._store.chunk

    def drain(self, mark: Mark) -> None:
        """Write whole chunks of rows, and forget the states before them.

        Raises
        ------
        FileFormatError
            If they cannot be written.
        """
        rows = mark.rows - self.first
        done = self._drain(self.ts[:rows], lambda: self._states(rows))
        if done:
            self.ts, self.sizes, self.xs, self.vs = (
                own[done:].copy() for own in (self.ts, self.sizes, self.xs, self.vs)
            )
            self.first += done

    def close(self, step: int, mark: Mark, state: State, stop: Zero | None, status: str) -> None:
        """Write the remaining rows with the last state, and the outcome.

        Raises
        ------
        FileFormatError
            If it cannot be written.
        """
        rows = super().keep_last(state, step, mark, stop is not None) - self.first
        known, completed = self._states(rows), status == Outcome.COMPLETED.name
        end = self.grid.t1 if completed else self.time(step)
        if stop is not None:
            end = stop.t
            if known.t[-1] != end:
                known.steps[-1] = end - known.t[-1]
            known = known.followed_by(end, stop.x, stop.v, self.grid.step)
        elif completed and known.t[-1] != end:
            known = self._led_to(end, known)
        self._close(known, end, not completed, stop, status)

    def _led_to(self, end: float, known: Known) -> Known:
        """Add the state at the end of the span, which the last step has passed."""
        system = self._processing.system
        dense = DenseOutput.of_rows(self.grid, States(system.x0, system.v0), known, end, self._between)
        try:
            x, v, spent = dense.states_at(np.array([end]))
        except Exception as error:
            self.said = f" The rows end before it, since {type(error).__name__} was raised: {error}."
            return known
        self.evaluations += spent
        return known.followed_by(end, x[0], v[0], self.grid.step)

    def _states(self, rows: int) -> Known:
        """Return the states in memory."""
        return self._as_users(self.ts[:rows].copy(), self.xs[:rows], self.vs[:rows], self.sizes[:rows])
