"""Putting bodies back to where their joints hold them, without velocities."""

from typing import Any

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.vectors import Vector, exponential, length, product, times, turned, turned_symmetric, unit
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.joints.aim import REPAIR, aim_all
from kickdrift.world.joints.layout import ANGULAR_PART, END, FIRST, GAIN, LINK_JOINT, LINKS, TURN_RESPONSE
from kickdrift.world.joints.layout import BODY as LINK_BODY
from kickdrift.world.joints.measure import measure
from kickdrift.world.tables import ARTICULATION, LINK, LINK_NUMBERS, MOTION, POSE, RESPONSE, floats, integers
from kickdrift.world.tables import CHANGE as CHANGES

answer = unbound  # solves the equations

# With three of them a chain of 60 links with an end 1000 times as heavy does not come together again after a whip cracks.
REPAIRS = 8


def repair_positions(row: int, h: float, world: int) -> None:
    """Put bodies where joints hold them, by changes of position that have no velocity."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, work = integers(world, LINK), floats(world, LINK_NUMBERS)
    for _ in range(REPAIRS):
        aim_all(row, h, REPAIR, 0.0, world)
        answer(row, -1.0, world)
        for link in range(articulation[FIRST], articulation[FIRST] + articulation[LINKS]):
            body = links[link, LINK_BODY]
            way, turn = times(h, vector_at(work, link, GAIN)), times(h, vector_at(work, link, GAIN + 3))
            turn = times(1.0 / max(1.0, 2.0 * length(turn)), turn)
            shift_body(body, way, turn, world)
        for link in range(articulation[FIRST], articulation[END]):
            if links[link, LINK_JOINT] >= 0:
                measure(links[link, LINK_JOINT], world)


@compiled(cached=False)
def shift_body(body: int, way: Vector, turn: Vector, world: int) -> None:
    """Change the pose of a body, and turn its angular velocity with it, which keeps its energy."""
    pose, change, motion, response = (
        floats(world, POSE),
        floats(world, CHANGES),
        floats(world, MOTION),
        floats(world, RESPONSE),
    )
    by = exponential(turn)
    q = unit(product(by, quaternion_at(pose, body, ANGULAR_PART)))
    w = turned(by, vector_at(motion, body, ANGULAR_PART))
    inverse = turned_symmetric(by, symmetric_at(response, body, TURN_RESPONSE))
    for k in range(3):
        pose[body, k] += way[k]
        change[body, k] += way[k]
        change[body, 3 + k] += turn[k]
        motion[body, 3 + k] = w[k]
    for k in range(4):
        pose[body, 3 + k] = q[k]
    for k in range(6):
        response[body, 1 + k] = inverse[k]
