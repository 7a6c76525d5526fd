"""The rows that a run keeps: of equal steps on a grid, or of variable steps."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.flows.layout import CLOCK, LARGEST, SMALLEST, at_end
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.loop import ACCEPTED, ROWS, TRIALS, WANTED
from kickdrift.engine.stepper import State, Stepper

Floats = NDArray[np.float64]
_CLOCK_ROUNDING = 16 * np.finfo(float).eps  # of a few thousand steps there and back
_BAR = 1000  # parts of a progress bar if the number of steps is not known


class Mark(NamedTuple):
    """Progress of the rows: rows filled, wanted times passed, and steps tried."""

    rows: int = 0
    wanted: int = 0
    trials: int = 0


class Stretch(NamedTuple):
    """Consecutive steps in which events are sought: times from their start on, and the states after each."""

    t: Floats
    xs: Floats
    vs: Floats


@dataclass
class GridRows:
    """The rows of equal steps: those of the grid, and one more if the run ends between two of them."""

    stepper: Stepper
    grid: Grid

    def __post_init__(self) -> None:
        state, rows = self.stepper.state, self.grid.save_steps.size + 1
        self.xs, self.vs = np.empty((rows, state.x.size)), np.empty((rows, state.v.size))
        self.first, self.save_steps = (
            0,
            self.grid.save_steps,
        )  # of the arrays: the number of their first row, and the steps

    def begin(self) -> Mark:
        """Keep the initial state, if it is a row."""
        if self.grid.save_steps[0] != 0:
            return Mark()
        self.xs[0], self.vs[0] = self.stepper.state.x, self.stepper.state.v
        return Mark(1)

    def kept(self, step: int, mark: Mark) -> dict[str, NDArray[Any]]:
        """Return the rows up to a step that a longer run would also have."""
        steps = self.grid.rows_after(step)
        return {"steps": steps, "xs": self.xs[: steps.size], "vs": self.vs[: steps.size]}

    def go_on(self, kept: Mapping[str, NDArray[Any]], step: int, mark: Mark) -> Mark:
        """Resume after a step with the rows kept until then."""
        rows = kept["steps"].size
        self.xs[:rows], self.vs[:rows] = kept["xs"], kept["vs"]
        if (
            self.ended(step) and rows < self.grid.save_steps.size
        ):  # the end of a run is a row of it, and not of a longer one
            self.xs[rows], self.vs[rows] = self.stepper.state.x, self.stepper.state.v
            rows += 1
        return Mark(rows, 0, step)

    def target(self, step: int) -> int:
        """Return the step, or the last one."""
        return min(step, self.grid.n_steps)

    def ended(self, step: int) -> bool:
        """Whether the run is at its end after a step."""
        return step == self.grid.n_steps

    def progress(self, step: int) -> tuple[int, int]:
        """Return the progress, and its value at the end."""
        return step, self.grid.n_steps

    def time(self, step: int) -> float:
        """Return the time after a step."""
        return self.grid.t0 + step * self.grid.step

    def steps_of(self, step: int) -> str:
        """Return the number of steps done, for display."""
        return f"{step} of {self.grid.n_steps} steps"

    def advance(self, step: int, target: int, mark: Mark) -> tuple[int, Mark]:
        """Do steps and keep rows; return the step reached."""
        saved = mark.rows - self.first
        reached, saved = self.stepper.advance(step, target, self.save_steps, saved, self.xs, self.vs)
        return reached, Mark(self.first + saved, 0, reached)

    def advance_watched(self, step: int, target: int, mark: Mark) -> tuple[int, Mark, Stretch]:
        """Do steps and keep rows as `advance` does; return all states, too."""
        grid, state, every = self.grid, self.stepper.state, np.arange(step + 1, target + 1)
        xs, vs = np.empty((every.size, state.x.size)), np.empty((every.size, state.v.size))
        reached, count = self.stepper.advance(step, target, every, 0, xs, vs)
        saved, until = mark.rows - self.first, int(np.searchsorted(self.save_steps, reached, side="right"))
        wanted = self.save_steps[saved:until] - step - 1
        self.xs[saved:until], self.vs[saved:until] = xs[wanted], vs[wanted]
        t = np.asarray(grid.t0 + grid.step * np.arange(step, reached + 1), dtype=np.float64)
        return reached, Mark(self.first + until, 0, reached), Stretch(t, xs[:count], vs[:count])

    def keep_last(self, state: State, step: int, mark: Mark, stopped: bool) -> int:
        """Add the state reached as a last row, if the run ended between two rows; return the number of rows."""
        saved = mark.rows - self.first
        on_a_row = saved > 0 and self.save_steps[saved - 1] == step
        if self.ended(step) or stopped or on_a_row:
            return mark.rows
        self.xs[saved], self.vs[saved] = state.x, state.v
        return mark.rows + 1

    def seen(self, rows: int) -> int:
        """Return the number of rows of the solution, given the number kept."""
        return rows

    def times(self, rows: int, step: int, early: bool) -> Floats:
        """Return the times of the rows of a run that ended after a step."""
        times = self.grid.times
        t = times[:rows].copy() if rows <= times.size else np.append(times, times[-1])
        if early and rows:  # the last row is the end, whether or not on the grid of rows
            t[-1] = self.time(step)
        return t

    def steps(self, t: Floats) -> Floats:
        """Return the size of the steps from each of the rows on."""
        steps = np.empty(t.size)
        steps.fill(self.grid.step)  # np.full takes four times as long
        return steps

    def step_range(self, state: State) -> tuple[float, float]:
        """Return the sizes of the smallest and of the largest step."""
        return abs(self.grid.step), abs(self.grid.step)


@dataclass
class CourseRows:
    """The rows of variable steps: the states before one step in `stride`, or before the wanted times."""

    stepper: Stepper
    grid: Course

    def __post_init__(self) -> None:
        state = self.stepper.state
        self.first = 0  # number of the first row of the arrays
        self.ts, self.sizes = np.empty(0), np.empty(0)
        self.xs, self.vs = np.empty((0, state.x.size)), np.empty((0, state.v.size))

    def begin(self) -> Mark:
        """Keep nothing yet, since a row is the state before a step."""
        return Mark()

    def kept(self, step: int, mark: Mark) -> dict[str, NDArray[Any]]:
        """Return the rows so far."""
        rows = slice(mark.rows - self.first)
        return {"ts": self.ts[rows], "sizes": self.sizes[rows], "xs": self.xs[rows], "vs": self.vs[rows]}

    def go_on(self, kept: Mapping[str, NDArray[Any]], step: int, mark: Mark) -> Mark:
        """Resume after a step with the rows kept until then."""
        self.ts, self.sizes, self.xs, self.vs = (kept[name].copy() for name in ("ts", "sizes", "xs", "vs"))
        return mark

    def target(self, step: int) -> int:
        """Return the step."""
        return step

    def ended(self, step: int) -> bool:
        """Whether the run is at its end, or beyond it by a fraction of a step."""
        return bool(at_end(self.stepper.state.work))

    def progress(self, step: int) -> tuple[int, int]:
        """Return the progress, and its value at the end."""
        done = (self.time(step) - self.grid.t0) / (self.grid.t1 - self.grid.t0)
        return max(1, min(round(_BAR * done), _BAR)), _BAR

    def time(self, step: int) -> float:
        """Return the time reached."""
        return float(self.stepper.state.work[CLOCK])

    def steps_of(self, step: int) -> str:
        """Return the number of steps done, for display."""
        return f"{step} steps"

    def advance(self, step: int, target: int, mark: Mark) -> tuple[int, Mark]:
        """Do steps and keep rows; return the step reached."""
        most = target - step if self.grid.stride else min(target - step, self.grid.marks.size - mark.wanted + 1)
        self._make_room(mark.rows - self.first + most + 1)
        marks = np.array([step, mark.trials, mark.rows - self.first, mark.wanted])
        rows = self.ts, self.sizes, self.xs, self.vs
        reached = self.stepper.advance_adaptively(target, self.grid.stride, self.grid.marks, marks, *rows)
        return reached, Mark(self.first + int(marks[ROWS]), int(marks[WANTED]), int(marks[TRIALS]))

    def advance_watched(self, step: int, target: int, mark: Mark) -> tuple[int, Mark, Stretch]:
        """Do steps and keep rows as `advance` does; return all states, too."""
        state, most = self.stepper.state, target - step + 1
        t, sizes = np.empty(most), np.empty(most)
        xs, vs = np.empty((most, state.x.size)), np.empty((most, state.v.size))
        marks = np.array([step, mark.trials, 0, mark.wanted])
        reached = self.stepper.advance_adaptively(target, 1, self.grid.marks, marks, t, sizes, xs, vs)
        count = int(marks[ACCEPTED]) - step
        t[count], xs[count], vs[count] = state.work[CLOCK], state.x, state.v
        t, xs, vs = t[: count + 1], xs[: count + 1], vs[: count + 1]
        sign = np.sign(self.grid.step)
        passed = np.searchsorted(sign * self.grid.marks, sign * t[1:], side="left")
        kept = np.diff(np.append(mark.wanted, passed)) > 0
        of = np.arange(step, reached)
        kept |= of % self.grid.stride == 0 if self.grid.stride else of == 0
        rows = np.flatnonzero(kept)
        first, end = mark.rows - self.first, mark.rows - self.first + rows.size
        self._make_room(end + 1)
        for kept_rows, all_rows in ((self.ts, t), (self.sizes, sizes), (self.xs, xs), (self.vs, vs)):
            kept_rows[first:end] = all_rows[rows]
        return reached, Mark(self.first + end, int(marks[WANTED]), int(marks[TRIALS])), Stretch(t, xs[1:], vs[1:])

    def keep_last(self, state: State, step: int, mark: Mark, stopped: bool) -> int:
        """Add the state reached as a last row, unless it is beyond the end; return the number of rows."""
        if at_end(state.work) and is_beyond(self.grid, state.work[CLOCK]):
            return mark.rows
        row = mark.rows - self.first
        self._make_room(row + 1)
        self.ts[row] = self.grid.t1 if at_end(state.work) else state.work[CLOCK]
        self.xs[row], self.vs[row], self.sizes[row] = state.x, state.v, self.grid.step
        return mark.rows + 1

    def seen(self, rows: int) -> int:
        """Return the number of rows of the solution, given the number kept."""
        return rows

    def times(self, rows: int, step: int, early: bool) -> Floats:
        """Return the times of the rows."""
        return self.ts[:rows].copy()

    def steps(self, t: Floats) -> Floats:
        """Return the size of the steps from each of the rows on."""
        return self.sizes[: t.size].copy()

    def step_range(self, state: State) -> tuple[float, float]:
        """Return the sizes of the smallest and of the largest step."""
        return float(state.work[SMALLEST]), float(state.work[LARGEST])

    def _make_room(self, rows: int) -> None:
        if rows > self.ts.size:
            size = max(rows, 2 * self.ts.size)
            self.ts, self.sizes, self.xs, self.vs = (
                _larger(array, size) for array in (self.ts, self.sizes, self.xs, self.vs)
            )


Rows = GridRows | CourseRows


def is_beyond(grid: Course, t: float) -> bool:
    """Whether a time is beyond the end by more than the rounding of the clock."""
    return bool(abs(t - grid.t0) > abs(grid.t1 - grid.t0) + _CLOCK_ROUNDING * max(abs(grid.t0), abs(grid.t1)))


def _larger(array: Floats, size: int) -> Floats:
    room = np.empty((size, *array.shape[1:]))
    room[: len(array)] = array
    return room
