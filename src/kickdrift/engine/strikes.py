"""Steps that end with impacts: the states just before these, for events."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.processing import Processing

Floats = NDArray[np.float64]


class Strikes(NamedTuple):
    """Steps that end with impacts: their indices, times, and the states before and after the impacts."""

    steps: NDArray[np.intp]
    others: NDArray[np.bool_]
    t: Floats
    x: Floats
    v: Floats
    x_after: Floats
    v_after: Floats


def strikes_at(
    steps: NDArray[np.intp], processing: Processing, t: Floats, xs: Floats, vs: Floats
) -> tuple[Strikes, NDArray[np.int64]]:
    """Repeat the steps that end with impacts, up to these; return the force evaluations, too."""
    after, sizes, once = steps + 1, np.diff(t)[steps], np.ones(steps.size, dtype=np.int64)
    x, v, evaluations = processing.go_on(t[steps], sizes, once, xs[steps], vs[steps])
    others = np.ones(t.size - 1, dtype=bool)
    others[steps] = False
    return Strikes(steps, others, t[after], x, v, xs[after], vs[after]), evaluations
