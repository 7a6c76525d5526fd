"""Phase errors: the time by which a run is ahead of the exact motion, or of another run."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Motion = Callable[[Floats], tuple[Floats, Floats]]

_ROUNDS = 8
_TOLERANCE = 1e-7  # of a step: convergence is quadratic, so that the error after such an increment is much smaller
_DIFFERENCE = 1 / 16  # of a step: the direction of motion has an error of about (step / period)^2 / 40
_MOST = 1000  # rows that are averaged for the scales
_COMPUTED, _PROBES, _MISSED = (
    1 << 15,
    1 << 10,
    1e-3,
)  # rows computed of many; rows to test the splines; allowed error there
_FIRST, _GROWTH = 8, 8  # rows without an initial guess; each batch is a _GROWTH-th of the rows done


def time_shift(
    motion: Motion, t: Floats, x: Floats, v: Floats, step: float, between: tuple[float, float] = (-np.inf, np.inf)
) -> Floats:
    """Return by how much later a motion comes nearest to the states of a run, (T,); NaN where they are not finite.

    It measures the time by which the run is ahead along its orbit, not its distance from it. For many rows in the order of
    time, some 32,000 are computed and interpolated by cubic splines, unless these have errors of more than a thousandth of
    the largest shift at a thousand rows in between.

    At the nearest point the difference of the states is orthogonal to the motion: Newton's method for the least distance, with
    positions and velocities relative to their root mean squares. The initial guess is extrapolated linearly from the rows
    before, so that shifts may grow beyond a period.

    Parameters
    ----------
    motion : callable
        ``motion(times)`` returns x and v, (T, *shape).
    t, x, v : array
        Rows of a run, in any order of time.
    step : float
        Step of the run.
    between : (float, float)
        Times between which the motion is known; times beyond are clipped.
    """
    if t.size <= 2 * _COMPUTED or not (np.diff(np.sign(step) * t) > 0.0).all():
        return _shifts(motion, t, x, v, step, between)
    from scipy.interpolate import CubicSpline

    apart, sign = t.size // _COMPUTED, np.sign(step)
    rows = np.unique(np.append(np.arange(0, t.size, apart), t.size - 1))
    probes = np.arange(apart // 2, t.size, apart * (_COMPUTED // _PROBES))
    seen, found = (_shifts(motion, t[own], x[own], v[own], step, between) for own in (rows, probes))
    if np.isfinite(seen).all():
        shift: Floats = CubicSpline(sign * t[rows], seen)(sign * t)
        if np.abs(shift[probes] - found).max() <= _MISSED * np.abs(found).max():
            return shift
    return _shifts(motion, t, x, v, step, between)


def _shifts(motion: Motion, t: Floats, x: Floats, v: Floats, step: float, between: tuple[float, float]) -> Floats:
    """Compute the shift of every row."""
    if not t.size:
        return np.zeros(0)
    scales = [
        float(np.sqrt(np.mean(half * half))) if half.size else 1.0
        for half in motion(np.sort(t)[:: 1 + t.size // _MOST])
    ]

    def state(x: Floats, v: Floats) -> Floats:
        halves = (half.reshape(half.shape[0], -1) / (scale or 1.0) for half, scale in zip((x, v), scales, strict=True))
        return np.concatenate(list(halves), axis=1)

    states, order = state(x, v), np.argsort(np.abs(t - t[0]), kind="stable")
    shift = np.full(t.size, np.nan)
    order = order[np.isfinite(states[order]).all(axis=1)]
    done = 0
    while done < order.size:
        rows = order[done : done + max(_FIRST, done // _GROWTH)]
        shift[rows] = _nearest(
            lambda times: state(*motion(times)),
            t[rows],
            states[rows],
            _guess(t[order[:done]], shift[order[:done]], t[rows]),
            abs(step),
            between,
        )
        done += rows.size
    return shift


def _guess(t: Floats, shift: Floats, wanted: Floats) -> Floats:
    """Extrapolate shifts by the line through the last one and the one half way back."""
    if t.size < _FIRST or t[-1] == t[t.size // 2]:
        return np.zeros(wanted.size)
    slope = (shift[-1] - shift[t.size // 2]) / (t[-1] - t[t.size // 2])
    guess: Floats = shift[-1] + slope * (wanted - t[-1])
    return guess if np.isfinite(guess).all() else np.zeros(wanted.size)


def _nearest(
    motion: Callable[[Floats], Floats],
    t: Floats,
    states: Floats,
    shift: Floats,
    step: float,
    between: tuple[float, float],
) -> Floats:
    low, high = between
    shift, left = shift.copy(), np.arange(t.size)
    for _ in range(_ROUNDS):
        now, had = t[left], shift[left]
        at = np.clip(now + had, low, high)
        before, after = np.clip(at - _DIFFERENCE * step, low, high), np.clip(at + _DIFFERENCE * step, low, high)
        here, first, last = np.split(motion(np.concatenate((at, before, after))), 3)
        shift[left] = at - now + _newton(states[left] - here, first - here, last - here, before - at, after - at)
        left = left[~(np.abs(shift[left] - had) <= _TOLERANCE * step)]
        if not left.size:
            break
    return shift


def _newton(error: Floats, first: Floats, last: Floats, before: Floats, after: Floats) -> Floats:
    """Return the step to the least |error - motion|, for a motion that is 0 now, `first` at `before` and `last` at `after`."""
    along = (last - first) / (after - before)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        even = np.abs(after + before) < 1e-6 * (after - before)  # false where the motion is known on one side only
        bend = np.where(even[:, None], (first + last) / (after * after)[:, None], 0.0)
    squares, bent = np.einsum("ij,ij->i", along, along), np.einsum("ij,ij->i", error, bend)
    # At the centre of curvature the distance has no minimum: near it, use the Gauss-Newton method.
    steepness = np.where(bent < 0.95 * squares, squares - bent, squares)
    step: Floats = np.einsum("ij,ij->i", along, error) / np.where(steepness > 0.0, steepness, 1.0)
    return step
