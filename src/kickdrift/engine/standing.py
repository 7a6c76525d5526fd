"""Where a run stands, so that it can go on from there."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.events import Seen
from kickdrift.engine.run import Reached

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Standing:
    """Where a run stands: the state of the loop, and the rows up to there as people see them.

    Attributes
    ----------
    reached : Reached
    steps : (T,) array of int
        The steps after which there are rows, on the grid alone.
    xs, vs : (T, *shape) array
        The rows.
    wall_time : float
        Seconds in the loop.
    seen : Seen or None
        What was found of events.
    """

    reached: Reached
    steps: NDArray[np.int64]
    xs: Floats
    vs: Floats
    wall_time: float
    seen: Seen | None
