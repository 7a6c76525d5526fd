"""The loop that runs the step of a world, a word over stages; `kickdrift.world.step.stage_order.word` returns the word.

Two of its letters, `kick` and `drift`, are flows like those of the engine; between and after them are projections onto the
velocities that contacts and joints allow.

A stage is called with the time t, the length h that it covers and the address of the tables: h is the step, s, before and after
the substeps, and the substep within them.
"""

from typing import Any

import numpy as np
from numba import types
from numpy.typing import NDArray

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.world.batch_view import enter
from kickdrift.world.step.status import MIDWAY, REACHED, SAID, STATUS, WARNING
from kickdrift.world.tables import BATCH, STEP_STATUS, integers, rows

STAGE = types.none(types.float64, types.float64, types.intp)

call = caller(STAGE)


@compiled
def run(
    stages: NDArray[np.intp],
    lengths: NDArray[np.float64],
    offsets: NDArray[np.float64],
    begin: int,
    end: int,
    t0: float,
    step: float,
    first: int,
    last: int,
    at: int,
    world: int,
) -> tuple[int, int]:
    """Run the steps from `first` to `last` - 1, counted from t0, beginning at stage `at` of the first.

    Stages from `begin` to `end` - 1 are run on one batch after the other, if there are batches. Then none of these stages sets
    a status that resumes the step at itself, so a step is never resumed in the middle of the batches.

    Returns
    -------
    step, stage : int
        The step and the stage that set a status in `STEP_STATUS`; or `last`, and the set of warnings still to be issued.
    """
    status: Any = integers(world, STEP_STATUS)
    for n in range(first, last):
        t = t0 + n * step
        status[0, REACHED], status[0, MIDWAY] = n, 1
        k, begun, block = at, 0, world
        while k < stages.size:
            if k == end and begun < rows(world, BATCH):
                k = begin
            if k == begin and rows(world, BATCH) > 0:
                block, begun = enter(world, begun), begun + 1
            elif k == end:
                block = world
            call(stages[k], (t + offsets[k], lengths[k], block))
            if status[0, STATUS] != 0:
                return n, k
            k += 1
        at = 0
    status[0, REACHED], status[0, MIDWAY] = last, 0
    return last, status[0, WARNING] & ~status[0, SAID]
