"""What the joints of an articulation hand on of the impulses that contacts have found for its links."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.columns import vector_at
from kickdrift.world.joints.articulated import sweep
from kickdrift.world.joints.impulses import note_speeds, push_bodies, push_body
from kickdrift.world.joints.layout import BODY as LINK_BODY
from kickdrift.world.joints.layout import (
    FIRST,
    GIVEN,
    IMPULSE,
    LINK_JOINT,
    LINKS,
    LOAD,
    SEQUENTIAL,
    SOLVED,
    TOTAL,
    TOUCHED,
    int64,
)
from kickdrift.world.joints.settling import split_impulse
from kickdrift.world.tables import (
    ARTICULATION,
    JOINT_NUMBERS,
    LINK,
    LINK_NUMBERS,
    floats,
    integers,
)


@compiled(cached=False)
def is_touched(row: int, world: int) -> bool:
    """Whether contacts have given the links of an articulation anything."""
    articulation: Any = integers(world, ARTICULATION)[row]
    if articulation[SEQUENTIAL] == 0:
        work = floats(world, LINK_NUMBERS)
        for link in range(articulation[FIRST], articulation[FIRST] + articulation[LINKS]):
            for k in range(6):
                if work[link, LOAD + k] != 0.0:
                    return True
    return False


@compiled(cached=False)
def hand_on(row: int, solving: bool, world: int) -> None:
    """Give the links what contacts have found, and the joints' part in it."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    first, end = articulation[FIRST], articulation[FIRST] + articulation[LINKS]
    for link in range(first, end):
        load = vector_at(work, link, int64(LOAD)), vector_at(work, link, int64(LOAD + 3))
        push_body(links[link, LINK_BODY], load[0], load[1], world)
    work[first, TOUCHED] = 1.0
    sweep(first, end - first, 0.0, world)
    for link in range(first, end):
        joint = links[link, LINK_JOINT]
        if joint >= 0:
            split_impulse(link, joint, world)
            push_bodies(joint, work, link, GIVEN, world)
            for k in range(6):
                if not solving:
                    numbers[joint, TOTAL + k] += work[link, GIVEN + k]
                    continue
                numbers[joint, IMPULSE + k] += work[link, GIVEN + k]
                numbers[joint, SOLVED + k] += work[link, GIVEN + k]
        for k in range(6):
            work[link, LOAD + k] = 0.0
    for link in range(first, end):
        if not solving and links[link, LINK_JOINT] >= 0:
            note_speeds(links[link, LINK_JOINT], world)
