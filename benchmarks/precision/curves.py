"""Errors at equal time and times at equal error, from curves of work and precision."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.precision.laws import Floats
from kickdrift.analysis.work_curve import Curve, error_at, work_for


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
