"""Preparation of joints before the substeps of a step."""

from kickdrift.core.compilation import compiled
from kickdrift.world.joints.joint_warm_start import note_speeds
from kickdrift.world.joints.layout import CLOSINGS, END, FIRST, LINK_BODY, LINK_JOINT, LINKS, TOTAL
from kickdrift.world.layout import AWAKE
from kickdrift.world.tables import ARTICULATION, BODY, JOINT_NUMBERS, LINK, floats, integers, rows


@compiled
def wake_joints(t: float, h: float, world: int) -> None:
    """Wake all bodies of an articulation if any is awake; sleeping articulations have no links during the step."""
    articulations, links = integers(world, ARTICULATION), integers(world, LINK)
    bodies = integers(world, BODY)
    for row in range(rows(world, ARTICULATION)):
        first, after = articulations[row, FIRST], articulations[row, FIRST] + articulations[row, LINKS]
        awake = False
        for link in range(first, after):
            awake = awake or bodies[links[link, LINK_BODY], AWAKE] != 0
        if awake:
            for link in range(first, after):
                bodies[links[link, LINK_BODY], AWAKE] = 1
        articulations[row, END] = after + articulations[row, CLOSINGS] if awake else first


@compiled
def begin_joints(t: float, h: float, world: int) -> None:
    """Store the speeds before the first kick, and reset the impulses of the step."""
    articulations, links, numbers = integers(world, ARTICULATION), integers(world, LINK), floats(world, JOINT_NUMBERS)
    for row in range(rows(world, ARTICULATION)):
        for link in range(articulations[row, FIRST], articulations[row, END]):
            joint = links[link, LINK_JOINT]
            if joint >= 0:
                note_speeds(world, joint)
                for k in range(6):
                    numbers[joint, TOTAL + k] = 0.0
