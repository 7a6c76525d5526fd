"""Impulses of the joints of an island from a solution of its equations, and those that warm start the next substep."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot, exponential, times, turned
from kickdrift.world.columns import vector_at
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_active_set import BOUNCE
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.geometric_stiffness import set_brakes
from kickdrift.world.joints.joint_warm_start import note_speeds, push_bodies
from kickdrift.world.joints.kinematics import put_vector
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
    force, torque = vector_at(work, link, j.JOINT_WRENCH), vector_at(work, link, j.JOINT_WRENCH + 3)
    for k in range(6):
        along = dot(vector_at(numbers, joint, j.AXES + 3 * k), force if k < 3 else torque)
        work[link, j.AXIS_IMPULSE + k] = links[link, j.SIGN] * along


@compiled(cached=False)
def give_joints(world: int, island: int, task: int) -> None:
    """Apply the impulses of the joints of an island to the bodies."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        link = order[place, 0]
        if place < own[d.FIRST_CLOSING]:
            split_impulse(world, link, links[link, j.LINK_JOINT])
        give_joint(world, links[link, j.LINK_JOINT], link, task)


@compiled(cached=False)
def give_joint(world: int, joint: int, link: int, task: int) -> None:
    """Apply the impulses of a joint to its bodies."""
    work, numbers = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    for k in range(6):
        numbers[joint, j.JOINT_IMPULSE + k] += work[link, j.AXIS_IMPULSE + k]
        if task >= BOUNCE:
            numbers[joint, j.TOTAL + k] += work[link, j.AXIS_IMPULSE + k]
    push_bodies(world, joint, work, link, j.AXIS_IMPULSE)


@compiled(cached=False)
def clear_impulses(world: int, island: int) -> None:
    """Let a solution before the kick begin without impulses of joints: in an instant a limit has none that it can take back."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    numbers = floats(world, JOINT_NUMBERS)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        for k in range(6):
            numbers[links[order[place, 0], j.LINK_JOINT], j.JOINT_IMPULSE + k] = 0.0


@compiled(cached=False)
def end_solution(world: int, island: int) -> None:
    """Store the joint impulses of an island before the drift."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        end_joint(world, links[order[place, 0], j.LINK_JOINT])


@compiled(cached=False)
def end_joint(world: int, joint: int) -> None:
    """Store the impulses of a joint before the drift."""
    numbers = floats(world, JOINT_NUMBERS)
    for k in range(6):
        numbers[joint, j.SOLVED + k] = numbers[joint, j.JOINT_IMPULSE + k]


@compiled(cached=False)
def end_relaxation(world: int, island: int, h: float) -> None:
    """Add up the joint impulses of the substep, and prepare those that warm start the next one."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    joints = integers(world, JOINT)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        link = order[place, 0]
        joint = links[link, j.LINK_JOINT]
        if place < own[d.FIRST_CLOSING]:
            set_brakes(world, link, joint, h)
        turn_on(world, joint, links[link, j.LINK_BODY] if place < own[d.FIRST_CLOSING] else joints[joint, j.BODY_B], h)


@compiled(cached=False)
def turn_on(world: int, joint: int, body: int, h: float) -> None:
    """Warm start the next substep of a joint with the impulses of this one before the drift, turned with the body.

    Those of the relaxation, which bend the paths of rotating bodies, are left out: with them the initial guess of Newton's
    method is worse.
    """
    numbers = floats(world, JOINT_NUMBERS)
    note_speeds(world, joint)
    for k in range(6):
        numbers[joint, j.TOTAL + k] += numbers[joint, j.JOINT_IMPULSE + k]
        numbers[joint, j.JOINT_IMPULSE + k] = numbers[joint, j.SOLVED + k]
    if integers(world, JOINT)[joint, j.LINEAR] == j.POINT:
        turn = exponential(times(h, vector_at(floats(world, MOTION), body, j.ANGULAR_PART)))
        put_vector(numbers, joint, j.JOINT_IMPULSE, turned(turn, vector_at(numbers, joint, j.JOINT_IMPULSE)))
    end_joint(world, joint)
