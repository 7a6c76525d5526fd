"""Drifts: slopes of errors over time."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.engine.solution import Solution

Floats = NDArray[np.float64]


def slope(t: Floats, error: Floats) -> float:
    """Return the slope of the least-squares line; NaN where the error is infinite."""
    centred = t - t.mean()
    with np.errstate(invalid="ignore"):
        return float(centred @ (error - error.mean()) / (centred @ centred))


def times_of_drift(solution: Solution) -> Floats:
    """Return the times kept, as plain numbers.

    Raises
    ------
    ArgumentError
        If there are fewer than two.
    """
    if solution.t.size < 2:
        raise ArgumentError(
            f"solution holds {solution.t.size} time, but a drift needs at least two; keep more, with t_eval or"
            " save_every."
        )
    return solution.plain.t
