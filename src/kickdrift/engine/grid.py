"""The grid of a run: equal steps over the span, and which of them are kept."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import real, reals
from kickdrift.core.errors import ArgumentError
from kickdrift.core.room import check_kept


@dataclass(frozen=True)
class Grid:
    """Equal steps from t0, and the rows of the solution.

    Attributes
    ----------
    t0, t1, step : float
        Start and end, and the step with its sign.
    n_steps : int
        How many steps there are.
    save_steps : (T,) array of int
        The steps after which the state is kept, 0 for the start.
    times : (T,) array
        Their times.
    wanted : array or None
        The times that the solution has instead, between those as they may be.
    """

    t0: float
    t1: float
    step: float
    n_steps: int
    save_steps: NDArray[np.int64]
    times: NDArray[np.float64]
    wanted: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Course:
    """A span that steps of varying sizes lead over, and the rows of the solution.

    Attributes
    ----------
    t0, t1, step : float
        Start and end, and the first step with its sign.
    stride : int
        The state is kept before every so many steps, 0 for none.
    marks : (M,) array
        Times before which the last state is kept, in the order in which they come, the end for the last.
    wanted : array or None
        The times that the solution has instead of those of its steps, between them as they may be.
    """

    t0: float
    t1: float
    step: float
    stride: int
    marks: NDArray[np.float64]
    wanted: NDArray[np.float64] | None = None


def lay_course(t_span: Sequence[float], step: float | None, t_eval: ArrayLike | None, save_every: int | None) -> Course:
    """Lay out a run whose steps vary, from the first one on; without one it is a thousandth of the span at most.

    Raises
    ------
    ArgumentError
        For a span or step that cannot be, or times outside of the span.
    """
    t0, t1 = _span(t_span)
    length = abs(t1 - t0)
    first = math.copysign(1e-3 * length if step is None else min(_largest_step(step, length, 0.0), length), t1 - t0)
    if t_eval is None:
        return Course(t0, t1, first, _stride(save_every), np.array([t1]))
    _check_one_of(t_eval, save_every)
    wanted = _wanted_times(t_eval, t0, t1)
    marks = np.unique(np.append(np.clip(wanted, min(t0, t1), max(t0, t1)), t1))
    return Course(t0, t1, first, 0, marks if t1 > t0 else marks[::-1].copy(), wanted)


def lay_grid(
    t_span: Sequence[float], step: float | None, t_eval: ArrayLike | None, save_every: int | None, state_size: int
) -> Grid:
    """Lay a whole number of equal steps, none larger than `step`, over the span.

    Raises
    ------
    ArgumentError
        For a span or step that cannot be, times outside of the span, or more rows than fit in memory.
    """
    t0, t1 = _span(t_span)
    length, farthest = abs(t1 - t0), max(abs(t0), abs(t1))
    # A quotient a few roundings above a whole number is that number: 1.1 / 0.1 = 11.000000000000002. The length has
    # the rounding of the times in it: 20.1 - 20 = 0.10000000000000142.
    rounding = np.finfo(float).eps * (8 + 4 * (farthest / length))
    largest = _largest_step(step, length, rounding)
    n_steps = max(1, math.ceil(length / largest * (1 - rounding)))
    if length / n_steps < 4 * np.spacing(farthest):
        raise ArgumentError(f"step={step!r} is lost beside times of {farthest!r}; count time from a nearer origin.")
    h = (t1 - t0) / n_steps
    if t_eval is not None:
        _check_one_of(t_eval, save_every)
        wanted = _wanted_times(t_eval, t0, t1)
        save_steps, on_grid = _steps_before(wanted, t0, h, n_steps)
        if on_grid.all() and (np.diff(save_steps) > 0).all():
            return Grid(t0, t1, h, n_steps, save_steps, wanted)
        save_steps = np.unique(save_steps)
        times = np.where(save_steps == n_steps, t1, t0 + save_steps * h)
        return Grid(t0, t1, h, n_steps, save_steps, times, wanted)
    save_steps = _every(save_every, n_steps, state_size)
    times = np.asarray(t0 + save_steps * h, dtype=np.float64)
    times[-1] = t1
    return Grid(t0, t1, h, n_steps, save_steps, times)


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
        remedy = "give its size; the direction is that of t_span." if value < 0 else "give a positive number."
        raise ArgumentError(f"step={step!r} must be positive and finite; {remedy}")
    if value > length * (1 + 1e-12 + rounding):
        raise ArgumentError(f"step={step!r} is larger than t_span, which is {length!r} long; give a smaller step.")
    if length / value > 2**53:
        raise ArgumentError(
            f"step={step!r} cuts t_span into {length / value:.3g} steps, more than float64 counts; give a larger one."
        )
    return value


def _check_one_of(t_eval: ArrayLike, save_every: int | None) -> None:
    if save_every is not None:
        raise ArgumentError(
            f"save_every={save_every!r} and t_eval are both given, but each says which times to keep; give one."
        )


def _stride(save_every: int | None) -> int:
    stride = 1 if save_every is None else save_every
    if isinstance(stride, bool) or not isinstance(stride, int | np.integer) or stride < 1:
        raise ArgumentError(f"save_every={save_every!r} must be a positive whole number of steps.")
    return int(stride)


def _every(save_every: int | None, n_steps: int, state_size: int) -> NDArray[np.int64]:
    stride = _stride(save_every)
    check_kept(None if save_every is None else stride, n_steps, 16 * (state_size + 1), ", or t_eval")
    steps = np.arange(0, n_steps + 1, min(stride, n_steps), dtype=np.int64)
    return steps if steps[-1] == n_steps else np.append(steps, n_steps)


def _wanted_times(t_eval: ArrayLike, t0: float, t1: float) -> NDArray[np.float64]:
    try:
        times = reals(t_eval)
    except TypeError:
        raise ArgumentError(f"t_eval={t_eval!r} must be a list of times.") from None
    if times.ndim != 1 or times.size == 0:
        raise ArgumentError(f"t_eval of shape {times.shape} must be a list of at least one time.")
    rounding = 1e-12 * abs(t1 - t0) + 4 * np.spacing(max(abs(t0), abs(t1)))
    outside = ~((times >= min(t0, t1) - rounding) & (times <= max(t0, t1) + rounding))
    if outside.any():
        bad = times[outside][0]
        raise ArgumentError(f"t_eval={bad!r} lies outside t_span=({t0!r}, {t1!r}); leave it out or widen t_span.")
    return times


def _steps_before(
    times: NDArray[np.float64], t0: float, h: float, n_steps: int
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return the last step of the grid that is not after each time, and which times are on the grid but for rounding."""
    positions = (times - t0) / h
    nearest = np.rint(positions)
    farthest = max(abs(t0), abs(t0 + n_steps * h))
    rounding = 1e-9 + 4 * np.finfo(float).eps * np.maximum(abs(times), farthest) / abs(h)
    on_grid = abs(positions - nearest) <= rounding
    steps = np.where(on_grid, nearest, np.floor(positions)).astype(np.int64)
    return np.clip(steps, 0, n_steps), on_grid
