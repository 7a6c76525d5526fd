"""Impulses of the joints of an island from a solution of its equations, and those that warm start the next substep."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot, exponential, times, turned
from kickdrift.world.columns import vector_at
from kickdrift.world.direct.contact_active_set import BOUNCE
from kickdrift.world.direct.layout import AFTER_JOINT, FIRST_CLOSING, FIRST_JOINT
from kickdrift.world.joints.geometric_stiffness import set_brakes
from kickdrift.world.joints.joint_warm_start import note_speeds, push_bodies
from kickdrift.world.joints.kinematics import put_vector
from kickdrift.world.joints.layout import (
    ANGULAR_PART,
    AXES,
    AXIS_IMPULSE,
    BODY_B,
    JOINT_IMPULSE,
    JOINT_WRENCH,
    LINEAR,
    LINK_BODY,
    LINK_JOINT,
    POINT,
    SIGN,
    SOLVED,
    TOTAL,
)
from kickdrift.world.tables import (
    ISLAND,
    ISLAND_JOINT,
    JOINT,
    JOINT_NUMBERS,
    LINK,
    LINK_NUMBERS,
    MOTION,
    floats,
    integers,
)


@compiled(cached=False)
def split_impulse(world: int, link: int, joint: int) -> None:
    """Resolve the impulse at a joint of a tree into components along its axes."""
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    force, torque = vector_at(work, link, JOINT_WRENCH), vector_at(work, link, JOINT_WRENCH + 3)
    for k in range(6):
        along = dot(vector_at(numbers, joint, AXES + 3 * k), force if k < 3 else torque)
        work[link, AXIS_IMPULSE + k] = links[link, SIGN] * along


@compiled(cached=False)
def give_joints(world: int, island: int, task: int) -> None:
    """Apply the impulses of the joints of an island to the bodies."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    for place in range(own[FIRST_JOINT], own[AFTER_JOINT]):
        link = order[place, 0]
        if place < own[FIRST_CLOSING]:
            split_impulse(world, link, links[link, LINK_JOINT])
        give_joint(world, links[link, LINK_JOINT], link, task)


@compiled(cached=False)
def give_joint(world: int, joint: int, link: int, task: int) -> None:
    """Apply the impulses of a joint to its bodies."""
    work, numbers = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    for k in range(6):
        numbers[joint, JOINT_IMPULSE + k] += work[link, AXIS_IMPULSE + k]
        if task >= BOUNCE:
            numbers[joint, TOTAL + k] += work[link, AXIS_IMPULSE + k]
    push_bodies(world, joint, work, link, AXIS_IMPULSE)


@compiled(cached=False)
def clear_impulses(world: int, island: int) -> None:
    """Let a solution before the kick begin without impulses of joints: in an instant a limit has none that it can take back."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    numbers = floats(world, JOINT_NUMBERS)
    for place in range(own[FIRST_JOINT], own[AFTER_JOINT]):
        for k in range(6):
            numbers[links[order[place, 0], LINK_JOINT], JOINT_IMPULSE + k] = 0.0


@compiled(cached=False)
def end_solution(world: int, island: int, h: float) -> None:
    """Store the joint impulses of an island before the drift."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    for place in range(own[FIRST_JOINT], own[AFTER_JOINT]):
        end_joint(world, links[order[place, 0], LINK_JOINT])


@compiled(cached=False)
def end_joint(world: int, joint: int) -> None:
    """Store the impulses of a joint before the drift."""
    numbers = floats(world, JOINT_NUMBERS)
    for k in range(6):
        numbers[joint, SOLVED + k] = numbers[joint, JOINT_IMPULSE + k]


@compiled(cached=False)
def end_relaxation(world: int, island: int, h: float) -> None:
    """Add up the joint impulses of the substep, and prepare those that warm start the next one."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    joints = integers(world, JOINT)
    for place in range(own[FIRST_JOINT], own[AFTER_JOINT]):
        link = order[place, 0]
        joint = links[link, LINK_JOINT]
        if place < own[FIRST_CLOSING]:
            set_brakes(world, link, joint, h)
        turn_on(world, joint, links[link, LINK_BODY] if place < own[FIRST_CLOSING] else joints[joint, BODY_B], h)


@compiled(cached=False)
def turn_on(world: int, joint: int, body: int, h: float) -> None:
    """Warm start the next substep of a joint with the impulses of this one before the drift, turned with the body.

    Those of the relaxation, which bend the paths of rotating bodies, are left out: with them the initial guess of Newton's
    method is worse.
    """
    numbers = floats(world, JOINT_NUMBERS)
    note_speeds(world, joint)
    for k in range(6):
        numbers[joint, TOTAL + k] += numbers[joint, JOINT_IMPULSE + k]
        numbers[joint, JOINT_IMPULSE + k] = numbers[joint, SOLVED + k]
    if integers(world, JOINT)[joint, LINEAR] == POINT:
        turn = exponential(times(h, vector_at(floats(world, MOTION), body, ANGULAR_PART)))
        put_vector(numbers, joint, JOINT_IMPULSE, turned(turn, vector_at(numbers, joint, JOINT_IMPULSE)))
    end_joint(world, joint)
