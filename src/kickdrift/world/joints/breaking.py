"""The mean forces of joints in a step, and joints that break under them."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.world.joints import layout as j
from kickdrift.world.tables import ARTICULATION, JOINT, JOINT_NUMBERS, LINK, Tables, floats, integers, rows


@compiled
def finish_joints(t: float, h: float, world: int) -> None:
    """Compute the mean force and torque of the joints in the step, or in a part of one."""
    articulations, links, numbers = integers(world, ARTICULATION), integers(world, LINK), floats(world, JOINT_NUMBERS)
    for row in range(rows(world, ARTICULATION)):
        for link in range(articulations[row, j.FIRST], articulations[row, j.END]):
            joint = links[link, j.LINK_JOINT]
            if joint < 0:
                continue
            for k in range(6):
                numbers[joint, j.TOTAL + k] /= h


def overloaded(tables: Tables) -> NDArray[np.intp]:
    """Return the rows of joints that bore more in the last step than they can."""
    numbers = tables.array(JOINT_NUMBERS)
    force, torque = (np.linalg.norm(numbers[:, k : k + 3], axis=1) for k in (j.TOTAL, j.TOTAL + 3))
    over = (force > numbers[:, j.BREAKING_FORCE]) | (torque > numbers[:, j.BREAKING_TORQUE])
    return np.flatnonzero(over & (tables.array(JOINT)[:, j.JOINT_KIND] != j.REMOVED_JOINT))
