"""The step of a world: a word over stages, run by one loop.

`kickdrift.world.stage_order.word` spells it. Two of its letters, `kick` and `drift`, are flows as those of the engine are;
between them stand projections onto what contacts and joints allow.
"""

from typing import Any

import numpy as np
from numba import types
from numpy.typing import NDArray

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.world.batch import enter
from kickdrift.world.step_status import MIDWAY, REACHED, SAID, STATUS, WARNING
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
    """Run the steps from `first` to `last`, counted from t0, the first of them from stage `at` on.

    Batches do the stages from number `begin` up to `end` one after the other. Where there are any, none of these stages asks
    for anything, so that a step never goes on in their midst.

    Returns
    -------
    step, stage : int
        Where it ended: the stage that wrote a status into `STEP_STATUS`; after `last`, the set of warnings that are to be said.
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
