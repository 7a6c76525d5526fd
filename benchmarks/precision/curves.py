"""Errors at equal time and times at equal error, from curves of work and precision."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.precision.laws import Floats


@dataclass(frozen=True)
class Curve:
    """The runs of a contestant, from the least work to the most.

    Attributes
    ----------
    label : str
        Library and method.
    errors, evaluations : (n,) array
        Of the runs; an error is infinite where a run failed, and evaluations are nan where nobody counts them.
    seconds : (rounds, n) array
        Of the runs in each round.
    """

    label: str
    errors: Floats
    evaluations: Floats
    seconds: Floats

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


@dataclass(frozen=True)
class Comparison:
    """A run of a peer against the best of ours.

    Attributes
    ----------
    errors : (rounds,) array
        Its error over the least of ours at the time that it takes; 0 where ours all take longer.
    times : (rounds,) array
        Its time over the least that ours take to its error; 0 where ours do not reach it.
    most_exact, quickest : str
        Whose those of ours are, in most rounds.
    """

    errors: Floats
    times: Floats
    most_exact: str
    quickest: str


def compare(peer: Curve, run: int, ours: Sequence[Curve]) -> Comparison:
    """Compare a run of a peer with our curves, round by round."""
    seconds, error = peer.seconds[:, run], peer.errors[run]
    errors = [
        [error_at(work, curve.errors, given) for work, given in zip(curve.seconds, seconds, strict=True)]
        for curve in ours
    ]
    times = [[work_for(work, curve.errors, error) for work in curve.seconds] for curve in ours]
    return Comparison(
        errors=error / np.min(errors, axis=0),
        times=seconds / np.min(times, axis=0),
        most_exact=ours[int(np.argmin(np.median(errors, axis=1)))].label,
        quickest=ours[int(np.argmin(np.median(times, axis=1)))].label,
    )
