"""The grid of a run: steps over the span, and the rows to keep."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import MOST_STEPS, number_of_steps, real, reals
from kickdrift.core.errors import ArgumentError
from kickdrift.core.room import check_kept


class Grid(NamedTuple):
    """Equal steps from t0, and the rows of the solution.

    Attributes
    ----------
    t0, t1, step : float
        Start and end, and the signed step.
    n_steps : int
        Number of steps.
    save_steps : (T,) array of int
        The steps after which the state is kept, 0 for the start.
    times : (T,) array
        Their times.
    wanted : array or None
        The times of the solution's rows, if they were given; they may lie between steps.
    every : int or None
        Number of steps between rows; None if times were given.
    streamed : bool
        Whether rows go to disk: then `save_steps` and `times` are empty, to save memory, unless times were given.
    """

    t0: float
    t1: float
    step: float
    n_steps: int
    save_steps: NDArray[np.int64]
    times: NDArray[np.float64]
    wanted: NDArray[np.float64] | None = None
    every: int | None = None
    streamed: bool = False

    def rows_after(self, step: int) -> NDArray[np.int64]:
        """Return the steps up to `step` after which rows are kept by a run that ends there or later."""
        steps = self.save_steps
        if step < self.n_steps:
            steps = steps[: int(steps.searchsorted(step, side="right"))]
        return steps if self.every is None or not steps.size or steps[-1] % self.every == 0 else steps[:-1]


class Course(NamedTuple):
    """A span covered by variable steps, and the rows of the solution.

    Attributes
    ----------
    t0, t1, step : float
        Start and end, and the signed first step.
    stride : int
        Number of steps between rows, 0 if times were given.
    marks : (M,) array
        Times before each of which the last state is kept, in the order of the run; the last is the end.
    wanted : array or None
        The times of the solution's rows, if they were given; they may lie between steps.
    streamed : bool
        Whether rows go to disk.
    most : int
        Number of steps that one call may take.
    returns : bool
        Whether the steps are those of another run in reverse.
    """

    t0: float
    t1: float
    step: float
    stride: int
    marks: NDArray[np.float64]
    wanted: NDArray[np.float64] | None = None
    streamed: bool = False
    most: int = MOST_STEPS
    returns: bool = False


def lay_course(
    t_span: Sequence[float],
    step: float | None,
    t_eval: ArrayLike | None,
    save_every: int | None,
    divides: bool = False,
    streamed: bool = False,
    max_steps: int | None = None,
) -> Course:
    """Lay out a run with variable steps, of at most `max_steps`; the first one is by default a thousandth of the span.

    With `divides`, for steps that are equal but for cuts, the first one divides the span.

    Raises
    ------
    ArgumentError
        For an invalid span or step, or times outside the span.
    """
    t0, t1 = _span(t_span)
    length, most = abs(t1 - t0), number_of_steps("max_steps", max_steps)
    first = math.copysign(1e-3 * length if step is None else min(_largest_step(step, length, 0.0), length), t1 - t0)
    if divides:
        first = (t1 - t0) / max(1, math.ceil(length / abs(first) * (1 - 1e-12)))
    if t_eval is None:
        return Course(
            t0, t1, first, number_of_steps("save_every", save_every, 1), np.array([t1]), streamed=streamed, most=most
        )
    _check_one_of(t_eval, save_every)
    wanted = _wanted_times(t_eval, t0, t1)
    marks = np.unique(np.append(np.clip(wanted, min(t0, t1), max(t0, t1)), t1))
    return Course(t0, t1, first, 0, marks if t1 > t0 else marks[::-1].copy(), wanted, streamed, most)


def lay_grid(
    t_span: Sequence[float],
    step: float | None,
    t_eval: ArrayLike | None,
    save_every: int | None,
    state_size: int,
    streamed: bool = False,
    max_steps: int | None = None,
) -> Grid:
    """Lay a whole number of equal steps, none larger than `step`, over the span.

    Raises
    ------
    ArgumentError
        For an invalid span or step, times outside the span, more steps than `max_steps`, or more rows than fit in memory,
        unless they are `streamed` to disk.
    """
    t0, t1 = _span(t_span)
    length, farthest = abs(t1 - t0), max(abs(t0), abs(t1))
    # A quotient that exceeds a whole number by a few roundings is that number: 1.1 / 0.1 = 11.000000000000002. The length
    # contains the rounding of the times: 20.1 - 20 = 0.10000000000000142.
    rounding = sys.float_info.epsilon * (8 + 4 * (farthest / length))
    largest = _largest_step(step, length, rounding)
    n_steps = max(1, math.ceil(length / largest * (1 - rounding)))
    if length / n_steps < 4 * math.ulp(farthest):
        raise ArgumentError(
            f"step={step!r} is lost to rounding beside times of {farthest!r}; shift the origin of time closer."
        )
    if n_steps > number_of_steps("max_steps", max_steps):
        raise ArgumentError(
            f"max_steps={max_steps!r}: step={step!r} cuts t_span into {n_steps} steps; give a larger max_steps or step."
        )
    # A step that divides the span is taken as it is, so that runs to other ends have the same bits.
    divides = abs(n_steps * largest - length) <= min(rounding * length, 1e-6 * largest)
    h = math.copysign(largest, t1 - t0) if divides else (t1 - t0) / n_steps
    if t_eval is not None:
        _check_one_of(t_eval, save_every)
        wanted = _wanted_times(t_eval, t0, t1)
        save_steps, on_grid = _steps_before(wanted, t0, h, n_steps)
        if on_grid.all() and (np.diff(save_steps) > 0).all():
            return Grid(t0, t1, h, n_steps, save_steps, wanted, streamed=streamed)
        save_steps = np.unique(save_steps)
        times = np.where(save_steps == n_steps, t1, t0 + save_steps * h)
        return Grid(t0, t1, h, n_steps, save_steps, times, wanted, streamed=streamed)
    every = number_of_steps("save_every", save_every, 1)
    if streamed:
        nothing = np.zeros(0)
        return Grid(t0, t1, h, n_steps, nothing.astype(np.int64), nothing, every=every, streamed=True)
    check_kept(None if save_every is None else every, n_steps, 16 * (state_size + 1), ", t_eval, or save_to='run.zarr'")
    return _every(t0, t1, h, n_steps, every)


def _span(t_span: Sequence[float]) -> tuple[float, float]:
    try:
        t0, t1 = (real(t) for t in t_span)
    except (TypeError, ValueError):
        raise ArgumentError(f"t_span={t_span!r} must be two numbers, (start, end).") from None
    if not (math.isfinite(t0) and math.isfinite(t1)):
        raise ArgumentError(f"t_span={t_span!r} must be finite; give two finite times.")
    if t0 == t1 or t0 + (t1 - t0) / 2 in (t0, t1):
        raise ArgumentError(
            f"t_span={t_span!r} is empty; start and end must differ (the end may lie before the start)."
        )
    return t0, t1


def _largest_step(step: float | None, length: float, rounding: float) -> float:
    try:
        value = real(step)
    except TypeError:
        raise ArgumentError(f"step={step!r} must be a number, the largest step allowed.") from None
    if not (math.isfinite(value) and value > 0):
        remedy = "give its size; t_span sets the direction." if value < 0 else "give a positive number."
        raise ArgumentError(f"step={step!r} must be positive and finite; {remedy}")
    if value > length * (1 + 1e-12 + rounding):
        raise ArgumentError(f"step={step!r} is larger than t_span, which is {length!r} long; give a smaller step.")
    if length / value > 2**53:
        raise ArgumentError(
            f"step={step!r} cuts t_span into {length / value:.3g} steps, more than float64 can count; give a larger"
            " step."
        )
    return value


def lengthen(grid: Grid, t1: float, done: int, state_size: int) -> Grid:
    """Extend the grid to another end with the same steps, and the rows of a single run to that end.

    If times were given, the new end is kept, too.

    Raises
    ------
    ArgumentError
        For an end that is not a whole number of steps away, or not after the steps that are `done`; and for more rows than fit
        in memory.
    """
    ahead = (t1 - grid.t0) / grid.step
    if not math.isfinite(t1) or ahead > 2**53:
        raise ArgumentError(f"t={t1!r} must be finite, and less than 2**53 steps of {grid.step!r} away.")
    rounding = min(1e-9 + 8 * np.finfo(float).eps * max(abs(t1), abs(grid.t0)) / abs(grid.step), 0.1)
    n_steps = round(ahead)
    if ahead <= done + rounding:
        end = grid.t0 + done * grid.step
        raise ArgumentError(
            f"t={t1!r} does not lie beyond the end of the solution, {end!r}; for earlier times use solution(t)."
        )
    if abs(ahead - n_steps) > rounding:
        near = [grid.t0 + (math.floor(ahead) + k) * grid.step for k in (0, 1)]
        raise ArgumentError(
            f"t={t1!r} is not a whole number of steps of {grid.step!r} from {grid.t0!r}, and the step cannot change;"
            f" the nearest times are {near[0]!r} and {near[1]!r}."
        )
    if grid.every is not None:
        check_kept(grid.every, n_steps, 16 * (state_size + 1))
        return _every(grid.t0, t1, grid.step, n_steps, grid.every)
    before = grid.save_steps < n_steps
    save_steps, times = np.append(grid.save_steps[before], n_steps), np.append(grid.times[before], t1)
    wanted = None
    if grid.wanted is not None:
        before = (grid.wanted - t1) * grid.step < 0.0
        wanted = np.append(grid.wanted[before], t1)
    return grid._replace(t1=t1, n_steps=n_steps, save_steps=save_steps, times=times, wanted=wanted)


def with_step(grid: Grid, step: float) -> Grid | None:
    """Return the grid with another step; None if it differs by more than rounding, so that it would end elsewhere."""
    rounding = 1e-9 * abs(step) + 4 * np.spacing(max(abs(grid.t0), abs(grid.t1)))
    if abs(grid.t0 + grid.n_steps * step - grid.t1) > rounding:
        return None
    if grid.every is not None and not grid.streamed:
        return _every(grid.t0, grid.t1, step, grid.n_steps, grid.every)
    return grid._replace(step=step)


def _every(t0: float, t1: float, h: float, n_steps: int, every: int) -> Grid:
    """Return a grid that keeps one row in `every` steps, and the last."""
    save_steps = np.arange(0, n_steps + 1, min(every, n_steps), dtype=np.int64)
    if save_steps[-1] != n_steps:
        save_steps = np.append(save_steps, n_steps)
    times = np.asarray(t0 + save_steps * h, dtype=np.float64)
    times[-1] = t1
    return Grid(t0, t1, h, n_steps, save_steps, times, every=every)


def _check_one_of(t_eval: ArrayLike, save_every: int | None) -> None:
    if save_every is not None:
        raise ArgumentError(
            f"save_every={save_every!r} and t_eval are both given, but each determines the times to keep; give one."
        )


def _wanted_times(t_eval: ArrayLike, t0: float, t1: float) -> NDArray[np.float64]:
    try:
        times = reals(t_eval)
    except TypeError as error:
        raise ArgumentError(f"t_eval={t_eval!r} must be a list of times: {error}.") from None
    if times.ndim != 1 or times.size == 0:
        raise ArgumentError(f"t_eval of shape {times.shape} must be a list of at least one time.")
    rounding = 1e-12 * abs(t1 - t0) + 4 * np.spacing(max(abs(t0), abs(t1)))
    outside = ~((times >= min(t0, t1) - rounding) & (times <= max(t0, t1) + rounding))
    if outside.any():
        raise ArgumentError(
            f"t_eval={float(times[outside][0])!r} lies outside t_span=({t0!r}, {t1!r}); leave this time out or extend t_span."
        )
    return times


def _steps_before(
    times: NDArray[np.float64], t0: float, h: float, n_steps: int
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return the last step of the grid that is not after each time, and which times are on the grid up to rounding."""
    positions = (times - t0) / h
    nearest = np.rint(positions)
    farthest = max(abs(t0), abs(t0 + n_steps * h))
    rounding = 1e-9 + 4 * np.finfo(float).eps * np.maximum(abs(times), farthest) / abs(h)
    on_grid = abs(positions - nearest) <= rounding
    steps = np.where(on_grid, nearest, np.floor(positions)).astype(np.int64)
    return np.clip(steps, 0, n_steps), on_grid
