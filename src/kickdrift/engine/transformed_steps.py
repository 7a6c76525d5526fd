"""Steps of transformed time that end at a given time: their size is found by root finding."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import KickdriftError
from kickdrift.engine.stepper import NO_NUMBERS, Stepper, rows_of
from kickdrift.engine.zeros import search

Floats = NDArray[np.float64]

_DOUBLINGS = 60


def change_in_time(
    stepper: Stepper,
    times: Floats,
    sizes: Floats,
    counts: NDArray[np.int64],
    xs: Floats,
    vs: Floats,
    numbers: Floats = NO_NUMBERS,
) -> NDArray[np.int64]:
    """Advance each row in place by a number of steps from its time, each of which takes the time `sizes`.

    Returns
    -------
    evaluations : (T,) array of int
        Force evaluations.
    """
    evaluations, here = np.zeros(times.size, dtype=np.int64), times.copy()
    for done in range(int(counts.max(initial=0))):
        rows = np.flatnonzero(counts > done)
        x, v = xs[rows], vs[rows]
        evaluations[rows] += _change_once(stepper, here[rows], sizes[rows], x, v, rows_of(numbers, rows))
        xs[rows], vs[rows] = x, v
        here[rows] += sizes[rows]
    return evaluations


def _change_once(
    stepper: Stepper, times: Floats, sizes: Floats, xs: Floats, vs: Floats, numbers: Floats
) -> NDArray[np.int64]:
    """Do one such step from each row."""
    start_x, start_v, evaluations = xs.copy(), vs.copy(), np.zeros(times.size, dtype=np.int64)

    def beyond(rows: NDArray[np.intp], shares: Floats) -> Floats:
        """Do steps of a multiple of the size, in transformed time, and return by how much they pass the time wanted."""
        x, v, once = start_x[rows], start_v[rows], np.ones(rows.size, dtype=np.int64)
        own, clocks = stepper.change(times[rows], shares * sizes[rows], once, x, v, rows_of(numbers, rows))
        evaluations[rows] += own
        xs[rows], vs[rows] = x, v
        left = (clocks - times[rows]) / sizes[rows] - 1.0
        return np.where(np.isfinite(x).all(axis=1), left, np.nan)

    rows, ends = np.arange(times.size), np.ones(times.size)
    reached = beyond(rows, ends)
    for _ in range(_DOUBLINGS):
        short = np.flatnonzero(reached < 0.0)
        if not short.size:
            break
        ends[short] *= 2.0
        reached[short] = beyond(short, ends[short])
    if (reached < 0.0).any():
        raise KickdriftError(f"no valid step was found after t={float(times[reached < 0.0][0])!r}; use a smaller step.")
    tolerance = 4.0 * np.spacing(np.abs(times) + np.abs(sizes)) / np.abs(sizes)
    beyond(rows, search(np.zeros(times.size), ends, np.full(times.size, -1.0), reached, beyond, tolerance))
    return evaluations
