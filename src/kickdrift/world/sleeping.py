"""Sleep: islands of bodies that touch, nearly touch or are joined fall asleep and wake together."""

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.broad_phase.filters_and_sensors import is_solid
from kickdrift.world.contacts import layout as c
from kickdrift.world.disjoint_sets import first_of, unite
from kickdrift.world.joints import layout as j
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    AWAKE,
    BODY_KIND,
    BOUNDING_RADIUS,
    DYNAMIC,
    ISLAND_TIME_AT_REST,
    KINEMATIC,
    SLEEP_ISLAND,
    SLEPT_POSE,
    TIME_AT_REST,
    VELOCITY,
    WAKES,
)
from kickdrift.world.settings import SLEEP_SPEED, SLEEP_TIME
from kickdrift.world.tables import BODY, CONTACT, JOINT, LOAD, MOTION, POSE, RESTED, SETTINGS, floats, integers, rows


@compiled
def wake_moved(t: float, h: float, world: int) -> None:
    """Wake islands in which the user has moved a body, or given it a velocity or a force, before contacts are sought."""
    body, load, found = integers(world, BODY), floats(world, LOAD), False
    for row in range(rows(world, BODY)):
        if body[row, BODY_KIND] < KINEMATIC or body[row, AWAKE] != 0:
            continue
        pushed = _moves(world, row)
        for k in range(6):
            pushed = pushed or load[row, k] != 0.0
        if pushed and body[row, BODY_KIND] == DYNAMIC:
            mark_island(world, row)
            found = True
        elif pushed:
            body[row, AWAKE] = 1
    if found:
        wake_marked(world)


@compiled
def wake_touched(t: float, h: float, world: int) -> None:
    """Wake islands that a body that is awake touches, or is joined to."""
    contact, joint, found = integers(world, CONTACT), integers(world, JOINT), False
    for row in range(rows(world, CONTACT)):
        if _is_near(world, row):
            found = _wakes_other(world, contact[row, c.BODY_A], contact[row, c.BODY_B]) or found
    for row in range(rows(world, JOINT)):
        if joint[row, j.JOINT_KIND] != j.REMOVED_JOINT:
            found = _wakes_other(world, joint[row, j.BODY_A], joint[row, j.BODY_B]) or found
    if found:
        wake_marked(world)


@compiled
def _moves(world: int, row: int) -> bool:
    """Whether a body has a velocity, or another pose than when it fell asleep."""
    motion, pose, rested = floats(world, MOTION), floats(world, POSE), floats(world, RESTED)
    moves = False
    for k in range(6):
        moves = moves or motion[row, k] != 0.0
    for k in range(7):
        moves = moves or pose[row, k] != rested[row, SLEPT_POSE + k]
    return moves


@compiled(inline=True)
def _is_near(world: int, row: int) -> bool:
    """Whether a contact has points, so that its bodies wake each other and must sleep together; sensors do not count."""
    return bool(is_solid(integers(world, CONTACT), row))


@compiled
def _wakes_other(world: int, a: int, b: int) -> bool:
    """Mark the island of a body if it sleeps and the other body does not; return whether it was marked."""
    body = integers(world, BODY)
    awake_a, awake_b = is_awake(world, a), is_awake(world, b)
    if awake_a and not awake_b and body[b, BODY_KIND] == DYNAMIC:
        mark_island(world, b)
        return True
    if awake_b and not awake_a and body[a, BODY_KIND] == DYNAMIC:
        mark_island(world, a)
        return True
    return False


@compiled(inline=True)
def is_awake(world: int, row: int) -> bool:
    """Whether a body is awake, or its island is marked."""
    body = integers(world, BODY)
    awake: bool = body[row, AWAKE] != 0 or (
        body[row, BODY_KIND] == DYNAMIC and floats(world, RESTED)[body[row, SLEEP_ISLAND], WAKES] != 0.0
    )
    return awake


@compiled(inline=True)
def mark_island(world: int, row: int) -> None:
    """Mark the island of a sleeping body, for `wake_marked`."""
    floats(world, RESTED)[integers(world, BODY)[row, SLEEP_ISLAND], WAKES] = 1.0


@compiled
def wake_marked(world: int) -> None:
    """Wake the bodies of all islands that are marked."""
    body, rested = integers(world, BODY), floats(world, RESTED)
    for row in range(rows(world, BODY)):
        if body[row, AWAKE] == 0 and is_awake(world, row):
            body[row, AWAKE] = 1
            rested[row, TIME_AT_REST] = 0.0
    for row in range(rows(world, BODY)):
        rested[row, WAKES] = 0.0


@compiled
def sleep(t: float, h: float, world: int) -> None:
    """Put islands to sleep that have rested long enough, and set their velocities to zero.

    Kinematic bodies are not part of islands: each is awake while it moves.
    """
    body, motion, contact = integers(world, BODY), floats(world, MOTION), integers(world, CONTACT)
    joint, rested, settings = integers(world, JOINT), floats(world, RESTED), floats(world, SETTINGS)
    for row in range(rows(world, BODY)):
        if body[row, AWAKE] != 0:
            body[row, SLEEP_ISLAND] = row
            rested[row, TIME_AT_REST] = rested[row, TIME_AT_REST] + h if _rests(world, row) else 0.0
        if body[row, BODY_KIND] == KINEMATIC:
            body[row, AWAKE] = int(_moves(world, row))
            _keep_pose(world, row)
    for row in range(rows(world, CONTACT)):
        if _is_near(world, row):
            _unite(world, contact[row, c.BODY_A], contact[row, c.BODY_B])
    for row in range(rows(world, JOINT)):
        if joint[row, j.JOINT_KIND] != j.REMOVED_JOINT:
            _unite(world, joint[row, j.BODY_A], joint[row, j.BODY_B])
    # The time of rest of an island is the shortest of its bodies, stored with the first.
    for row in range(rows(world, BODY)):
        if body[row, BODY_KIND] == DYNAMIC and body[row, AWAKE] != 0:
            first = first_of(body, SLEEP_ISLAND, row)
            own, so_far = rested[row, TIME_AT_REST], rested[first, ISLAND_TIME_AT_REST]
            rested[first, ISLAND_TIME_AT_REST] = own if first == row else min(so_far, own)
    for row in range(rows(world, BODY)):
        if body[row, BODY_KIND] != DYNAMIC or body[row, AWAKE] == 0:
            continue
        first = first_of(body, SLEEP_ISLAND, row)
        body[row, SLEEP_ISLAND] = first
        if rested[first, ISLAND_TIME_AT_REST] >= settings[0, SLEEP_TIME]:
            body[row, AWAKE] = 0
            for k in range(6):
                motion[row, k] = 0.0
            _keep_pose(world, row)


@compiled
def _keep_pose(world: int, row: int) -> None:
    """Store the pose of a body as the one in which it sleeps."""
    pose, rested = floats(world, POSE), floats(world, RESTED)
    for k in range(7):
        rested[row, SLEPT_POSE + k] = pose[row, k]


@compiled
def _rests(world: int, row: int) -> bool:
    """Whether no point of a body moves faster than the sleep speed."""
    motion, rested = floats(world, MOTION), floats(world, RESTED)
    speed = 0.0
    turn = 0.0
    for k in range(3):
        speed += motion[row, VELOCITY + k] * motion[row, VELOCITY + k]
        turn += motion[row, ANGULAR_VELOCITY + k] * motion[row, ANGULAR_VELOCITY + k]
    slowest: float = floats(world, SETTINGS)[0, SLEEP_SPEED]
    reach = rested[row, BOUNDING_RADIUS]
    rests: bool = speed + turn * reach * reach < slowest * slowest
    return rests


@compiled
def _unite(world: int, a: int, b: int) -> None:
    """Unite the islands of two bodies, if both are dynamic and awake."""
    body = integers(world, BODY)
    if body[a, BODY_KIND] != DYNAMIC or body[b, BODY_KIND] != DYNAMIC or body[a, AWAKE] == 0 or body[b, AWAKE] == 0:
        return
    unite(body, SLEEP_ISLAND, a, b)
