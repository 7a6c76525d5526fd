"""The one loop: every method on every system."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.engine.flows import TROUBLE

Floats = NDArray[np.float64]
MOST_FLOWS = 4  # the tuple of flows has one length, so that the loop is compiled once


@compiled
def advance(
    flows: Any,
    letters: NDArray[np.int64],
    weights: Floats,
    offsets: Floats,
    t0: float,
    h: float,
    first: int,
    last: int,
    state: Any,
    x: Floats,
    v: Floats,
    work: Floats,
    save_steps: NDArray[np.int64],
    saved: int,
    xs: Floats,
    vs: Floats,
) -> tuple[int, int]:
    """Run the steps from `first` to `last`, copying the state into the rows of xs and vs after each of `save_steps`.

    Returns
    -------
    step : int
        Where it ended: `last`, or the step that a flow could not do.
    saved : int
        How many rows are filled.
    """
    for step in range(first, last):
        t = t0 + step * h
        for k in range(letters.size):
            flows[letters[k]](t + offsets[k] * h, weights[k] * h, state)
        if work[TROUBLE] != 0.0:
            return step, saved
        if saved < save_steps.size and save_steps[saved] == step + 1:
            xs[saved] = x
            vs[saved] = v
            saved += 1
    return last, saved
