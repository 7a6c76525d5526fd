"""One stage of a world's step, run as worlds run it: the interpreter would have it compiled once more."""

import numpy as np

from kickdrift.core.calls import address_of
from kickdrift.world.step.stage_loop import STAGE, run


def run_stage(stage, step, tables):
    """Run a stage with its length, s, on the tables of a world."""
    at = np.array([address_of(stage, STAGE)])
    run(at, np.array([step]), np.zeros(1), -1, -1, 0.0, step, 0, 1, 0, tables.address)
