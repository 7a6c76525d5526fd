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
    t0, step : float
        Start, and the step with its sign.
    n_steps : int
        How many steps there are.
    save_steps : (T,) array of int
        The steps after which the state is kept, 0 for the start.
    times : (T,) array
        Their times.
    """

    t0: float
    step: float
    n_steps: int
    save_steps: NDArray[np.int64]
    times: NDArray[np.float64]


def lay_grid(
    t_span: Sequence[float], step: float, t_eval: ArrayLike | None, save_every: int | None, state_size: int
) -> Grid:
    """Lay a whole number of equal steps, none larger than `step`, over the span.

    Raises
    ------
    ArgumentError
        For a span or step that cannot be, times off the grid, or more rows than fit in memory.
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
        if save_every is not None:
            raise ArgumentError(
                f"save_every={save_every!r} and t_eval are both given, but each says which times to keep; give one."
            )
        times, save_steps = _wanted_times(t_eval, t0, t1, h, n_steps)
    else:
        save_steps = _every(save_every, n_steps, state_size)
        times = np.asarray(t0 + save_steps * h, dtype=np.float64)
        times[-1] = t1
    return Grid(t0, h, n_steps, save_steps, times)


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


def _largest_step(step: float, length: float, rounding: float) -> float:
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


def _every(save_every: int | None, n_steps: int, state_size: int) -> NDArray[np.int64]:
    stride = 1 if save_every is None else save_every
    if isinstance(stride, bool) or not isinstance(stride, int | np.integer) or stride < 1:
        raise ArgumentError(f"save_every={save_every!r} must be a positive whole number of steps.")
    check_kept(None if save_every is None else int(stride), n_steps, 16 * (state_size + 1), ", or t_eval")
    steps = np.arange(0, n_steps + 1, min(int(stride), n_steps), dtype=np.int64)
    return steps if steps[-1] == n_steps else np.append(steps, n_steps)


def _wanted_times(
    t_eval: ArrayLike, t0: float, t1: float, h: float, n_steps: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    try:
        times = reals(t_eval)
    except TypeError:
        raise ArgumentError(f"t_eval={t_eval!r} must be a list of times.") from None
    if times.ndim != 1 or times.size == 0:
        raise ArgumentError(f"t_eval of shape {times.shape} must be a list of at least one time.")
    positions = (times - t0) / h
    outside = ~((positions >= -1e-9) & (positions <= n_steps + 1e-9))
    if outside.any():
        bad = times[outside][0]
        raise ArgumentError(f"t_eval={bad!r} lies outside t_span=({t0!r}, {t1!r}); leave it out or widen t_span.")
    if (np.diff(times) * np.sign(h) <= 0).any():
        raise ArgumentError("t_eval must be ordered from the start to the end of t_span, without repetitions; sort it.")
    save_steps = np.rint(positions).astype(np.int64)
    if (np.diff(save_steps) == 0).any():
        i = int(np.argmax(np.diff(save_steps) == 0))
        raise ArgumentError(
            f"t_eval={float(times[i])!r} and {float(times[i + 1])!r} are one time on the grid of steps of {abs(h)!r};"
            " leave one out."
        )
    # A time on the grid differs from it by rounding alone.
    rounding = 1e-9 + 4 * np.finfo(float).eps * np.maximum(abs(times), max(abs(t0), abs(t1))) / abs(h)
    off = abs(positions - save_steps) > rounding
    if off.any():
        bad, near = float(times[off][0]), t0 + float(save_steps[off][0]) * h
        raise ArgumentError(
            f"t_eval={bad!r} is not on the grid of steps of {abs(h)!r} from {t0!r}; the nearest grid time is {near!r}."
            " Choose a step that divides the times wanted."
        )
    return times, save_steps
