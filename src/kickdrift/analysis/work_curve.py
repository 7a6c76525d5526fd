"""Errors over work: cost and accuracy of a method at several steps."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Curve:
    """Runs of a method.

    Attributes
    ----------
    label : str
        The method, with the library where there are several.
    errors, evaluations : (n,) array
        Of the runs; an error is infinite where a run failed, and evaluations are nan where nobody counts them.
    seconds : (rounds, n) array
        Of the runs in each round.
    steps : (n,) array, optional
        Their steps.
    """

    label: str
    errors: Floats
    evaluations: Floats
    seconds: Floats
    steps: Floats | None = None

    @property
    def median(self) -> Floats:
        """Median of the seconds over the rounds."""
        return np.asarray(np.median(self.seconds, axis=0))


def _envelope(work: Floats, errors: Floats) -> tuple[Floats, Floats]:
    """Logarithms of the work in ascending order, and of the least error that so much work gives."""
    usable = np.isfinite(errors)
    order = np.argsort(work[usable], kind="stable")
    smallest = max(errors[errors > 0].min(initial=np.inf), 1e-17) if usable.any() else 1e-17
    found = np.minimum.accumulate(np.maximum(errors[usable][order], smallest))
    return np.log(work[usable][order]), np.log(found)


def error_at(work: Floats, errors: Floats, given: float) -> float:
    """Interpolate the error that so much work gives; both axes are logarithmic.

    More work than was measured gives the least error measured, and less gives infinity: nothing is extrapolated.
    """
    x, y = _envelope(work, errors)
    if x.size == 0 or np.log(given) < x[0]:
        return np.inf
    return float(np.exp(np.interp(np.log(given), x, y)))


def work_for(work: Floats, errors: Floats, wanted: float) -> float:
    """Interpolate the work that an error takes; both axes are logarithmic.

    An error larger than was measured takes the least work measured, a smaller one infinitely much: nothing is
    extrapolated.
    """
    x, y = _envelope(work, errors)
    if x.size == 0 or np.log(wanted) < y[-1]:
        return np.inf
    reached = int(np.argmax(y <= np.log(wanted)))
    if reached == 0:
        return float(np.exp(x[0]))
    part = (y[reached - 1] - np.log(wanted)) / (y[reached - 1] - y[reached])
    return float(np.exp(x[reached - 1] + part * (x[reached] - x[reached - 1])))


def nearest(curve: Curve, error: float) -> int:
    """Find the run whose error is nearest, by its logarithm."""
    with np.errstate(divide="ignore"):
        return int(np.argmin(np.abs(np.log(curve.errors) - np.log(error))))
