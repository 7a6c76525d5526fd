"""The mean forces of joints in a step, and joints that break under them."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import length
from kickdrift.world.columns import vector_at
from kickdrift.world.joints import layout as j
from kickdrift.world.tables import ARTICULATION, JOINT, JOINT_NUMBERS, LINK, floats, integers, rows


@compiled
def finish_joints(t: float, h: float, world: int) -> None:
    """Compute the mean force and torque of the joints in the step, and break those that were overloaded."""
    articulations, links = integers(world, ARTICULATION), integers(world, LINK)
    joints, numbers = integers(world, JOINT), floats(world, JOINT_NUMBERS)
    for row in range(rows(world, ARTICULATION)):
        for link in range(articulations[row, j.FIRST], articulations[row, j.END]):
            joint = links[link, j.LINK_JOINT]
            if joint < 0:
                continue
            for k in range(6):
                numbers[joint, j.TOTAL + k] /= h
            force, torque = length(vector_at(numbers, joint, j.TOTAL)), length(vector_at(numbers, joint, j.TOTAL + 3))
            if force > numbers[joint, j.BREAKING_FORCE] or torque > numbers[joint, j.BREAKING_TORQUE]:
                joints[joint, j.LOCKED], joints[joint, j.LAWS], joints[joint, j.BROKEN] = 0, 0, 1
                for k in range(6):
                    numbers[joint, j.JOINT_IMPULSE + k] = 0.0
