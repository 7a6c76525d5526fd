"""Phase error along a solution: the time by which a run is ahead of the exact motion, or of a finer run."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kickdrift.analysis.drift import slope, times_of_drift
from kickdrift.analysis.solutions import checked
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.engine.phase import time_shift
from kickdrift.engine.solution import Solution

Floats = NDArray[np.float64]


def phase_error(solution: Solution, reference: Solution | None = None) -> Floats:
    """Return the phase error at the times kept: the time by which a run is ahead.

    At a time t the state is nearest to that of the reference at t + `phase_error`, with positions and velocities scaled by
    their root mean squares. The phase error of a symplectic method grows linearly with time; where the energy drifts, it
    grows quadratically.

    Parameters
    ----------
    solution : Solution
    reference : Solution, optional
        A run of the same system over the same time, with a finer step or a better method. By default the exact solution, if
        the system has one, as `kickdrift.systems.kepler` does, and the run began at 0.

    Returns
    -------
    (T,) array
        In units of time: positive if the run is ahead; NaN where the state is not finite.

    Raises
    ------
    ArgumentError
        For a reference with states of another shape, or one that was loaded and so lacks its equations.
    KickdriftError
        Without a reference if there is no exact solution.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> sol = kd.solve(
    ...     kd.systems.kepler(), (0.0, 63.0), step=0.01, method="leapfrog", compensated=False
    ... )
    >>> bool(0.002 < np.abs(kd.analysis.phase_error(sol)).max() < 0.2)
    True
    """
    if reference is None:
        if "phase error" not in checked(solution).derived:
            raise KickdriftError(
                f"reference=None, but {solution.about.system!r} has no exact solution from this initial state; give a"
                " run with a finer step, reference=kd.solve(...)."
            )
        return solution.derived["phase error"]
    if not isinstance(reference, Solution):
        raise ArgumentError(f"reference={reference!r} is not a solution; give one of a finer run, kd.solve(...).")
    solution, dense = checked(solution).plain, reference.plain.dense
    if dense is None or reference.x.shape[1:] != solution.x.shape[1:]:
        raise ArgumentError(
            f"reference={reference!r} has states unlike those of {solution!r}, or no equations, because it was read"
            " from a file; solve it in this process."
        )
    low, high = sorted((float(dense.t[0]), dense.end))
    if not (low <= solution.t.min() and solution.t.max() <= high):
        raise ArgumentError(
            f"reference goes from {low!r} to {high!r}, and the solution from {float(solution.t.min())!r} to"
            f" {float(solution.t.max())!r}; give one that covers it."
        )
    return time_shift(lambda t: dense.states_at(t)[:2], solution.t, solution.x, solution.v, solution.step, (low, high))


def largest_phase_error(solution: Solution, reference: Solution | None = None) -> float:
    """Return the largest magnitude of `phase_error` at the times kept, in units of time.

    Parameters
    ----------
    solution, reference : Solution
        As for `phase_error`.

    Returns
    -------
    float

    Examples
    --------
    >>> import kickdrift as kd
    >>> sol = kd.solve(kd.systems.kepler(), (0.0, 20.0), step=0.01, method="leapfrog")
    >>> 0 < kd.analysis.largest_phase_error(sol) < 0.1
    True
    """
    return float(np.abs(phase_error(solution, reference)).max())


def phase_drift(solution: Solution, reference: Solution | None = None) -> float:
    """Return the slope of the least-squares line through `phase_error`: time gained per unit of time.

    Parameters
    ----------
    solution, reference : Solution
        As for `phase_error`.

    Returns
    -------
    float

    Raises
    ------
    ArgumentError
        If the solution has fewer than two times.

    Examples
    --------
    >>> import kickdrift as kd
    >>> sol = kd.solve(kd.systems.kepler(), (0.0, 20.0), step=0.01, method="leapfrog")
    >>> abs(kd.analysis.phase_drift(sol)) < 0.01
    True
    """
    return slope(times_of_drift(solution), phase_error(solution, reference))
