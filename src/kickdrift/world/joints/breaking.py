"""The mean forces of joints in a step, and joints that break under them."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import length
from kickdrift.world.columns import vector_at
from kickdrift.world.joints.layout import (
    BREAKING_FORCE,
    BREAKING_TORQUE,
    BROKEN,
    END,
    FIRST,
    JOINT_IMPULSE,
    LAWS,
    LINK_JOINT,
    LOCKED,
    TOTAL,
)
from kickdrift.world.tables import ARTICULATION, JOINT, JOINT_NUMBERS, LINK, floats, integers, rows


@compiled
def finish_joints(t: float, h: float, world: int) -> None:
    """Compute the mean force and torque of the joints in the step, and break those that were overloaded."""
    articulations, links = integers(world, ARTICULATION), integers(world, LINK)
    joints, numbers = integers(world, JOINT), floats(world, JOINT_NUMBERS)
    for row in range(rows(world, ARTICULATION)):
        for link in range(articulations[row, FIRST], articulations[row, END]):
            joint = links[link, LINK_JOINT]
            if joint < 0:
                continue
            for k in range(6):
                numbers[joint, TOTAL + k] /= h
            force, torque = length(vector_at(numbers, joint, TOTAL)), length(vector_at(numbers, joint, TOTAL + 3))
            if force > numbers[joint, BREAKING_FORCE] or torque > numbers[joint, BREAKING_TORQUE]:
                joints[joint, LOCKED], joints[joint, LAWS], joints[joint, BROKEN] = 0, 0, 1
                for k in range(6):
                    numbers[joint, JOINT_IMPULSE + k] = 0.0
