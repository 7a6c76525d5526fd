"""Rows of variable steps that are streamed to disk."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.kinds import Kind
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.dense import DenseOutput
from kickdrift.engine.description import Description
from kickdrift.engine.grid import Course
from kickdrift.engine.processing import Processing
from kickdrift.engine.rows import CourseRows, Mark
from kickdrift.engine.stepper import State
from kickdrift.engine.streaming import StreamedRows
from kickdrift.engine.zarr_store import ZarrStore
from kickdrift.engine.zeros import Zero

Floats = NDArray[np.float64]
_ARRAYS = ("ts", "sizes", "xs", "vs")


class StreamedCourseRows(StreamedRows, CourseRows):
    """The rows of variable steps, one chunk of the store at a time, and those after it.

    The last rows stay in memory until the end of the run, which is reached from the last one by a part of a step.

    Parameters
    ----------
    between : callable
        Returns the method, compiled for steps of any size.
    """

    def __init__(
        self,
        processing: Processing,
        grid: Course,
        store: ZarrStore,
        about: Description,
        between: Callable[[], Processing],
    ) -> None:
        super().__init__(processing.kernel, grid)
        self._processing, self._store, self._about, self._between = processing, store, about, between
        self._end: tuple[Floats, Floats, Floats] | None = None

    def kept(self, step: int, mark: Mark) -> dict[str, NDArray[Any]]:
        """Return the rows that are not in the store yet, and the number of those that are."""
        return {"stored": np.array([self.first]), **super().kept(step, mark)}

    def go_on(self, kept: Mapping[str, NDArray[Any]], step: int, mark: Mark) -> Mark:
        """Resume after a step with the rows kept until then."""
        self.first = int(kept["stored"][0])
        self._store.go_on(self.first)
        return super().go_on(kept, step, mark)

    def full_after(self, step: int) -> int:
        """Return the step after which a chunk is full."""
        return (self.first + self._store.chunk - 1) * self.grid.stride + 1

    def drain(self, mark: Mark) -> None:
        """Write whole chunks, unless the run is at its end.

        Raises
        ------
        FileFormatError
            If they cannot be written.
        """
        chunk = self._store.chunk
        while mark.rows - self.first >= chunk and not self.ended(0):
            self._write(*self._seen(chunk), {})
            for name in _ARRAYS:
                setattr(self, name, getattr(self, name)[chunk:].copy())

    def close(self, step: int, mark: Mark, state: State, stop: Zero | None, status: str) -> None:
        """Write the remaining rows with the last state, and the outcome.

        Raises
        ------
        FileFormatError
            If it cannot be written.
        """
        rows = super().keep_last(state, step, mark, stop is not None) - self.first
        t, xs, vs = self._seen(rows)
        if status == Outcome.COMPLETED.name and t[-1] != self.grid.t1:
            t, xs, vs = self._to_the_end(t, xs, vs, self.sizes[:rows])
        self._end = t[-1:], xs[-1:], vs[-1:]
        chunk = self._store.chunk
        for first in range(0, t.size, chunk):
            part = slice(first, first + chunk)
            self._write(t[part], xs[part], vs[part], {"status": status} if first + chunk >= t.size else {})
        if stop is not None:
            self._write(np.array([stop.t]), stop.x[None], stop.v[None], {})

    def keep_last(self, state: State, step: int, mark: Mark, stopped: bool) -> int:
        """Return the number of rows in the store, which contains the last one."""
        return self.first

    def ends(self, step: int) -> tuple[Floats, Floats, Floats, Floats]:
        """Return time, x, v and step size of the first and of the last row, which may be the same."""
        system = self._processing.system
        t, xs, vs = np.array([self.grid.t0]), system.x0[None].copy(), system.v0[None].copy()
        if step and self._end is not None:
            t, xs, vs = (np.concatenate(pair) for pair in zip((t, xs, vs), self._end, strict=True))
        return t, xs, vs, np.full(t.size, self.grid.step)

    def _seen(self, rows: int) -> tuple[Floats, Floats, Floats]:
        """Return the first rows that are not in the store, as the user's states."""
        t, xs, vs = (getattr(self, name)[:rows].copy() for name in ("ts", "xs", "vs"))
        return t, *self._processing.leave(t, xs, vs, self.grid.t0)

    def _to_the_end(self, t: Floats, xs: Floats, vs: Floats, sizes: Floats) -> tuple[Floats, Floats, Floats]:
        """Add a row at the end of the span, passed by the last step."""
        end = self.grid.t1
        if self._processing.system.kind is Kind.LANGEVIN:
            return t, xs, vs
        try:
            x, v, self.evaluations = DenseOutput(t, xs, vs, end, sizes, True, self._between).states_at(np.array([end]))
        except (Exception, KeyboardInterrupt) as error:
            self.said = f" The rows end before it, since {type(error).__name__} was raised: {error}."
            return t, xs, vs
        return np.append(t, end), np.concatenate((xs, x)), np.concatenate((vs, v))

    def _write(self, t: Floats, xs: Floats, vs: Floats, attributes: Mapping[str, Any]) -> None:
        self._append(t, xs, vs, attributes)
        self.first += t.size
