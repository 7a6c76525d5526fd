"""Impulses of joints on their bodies, and warm starting."""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import cross, dot, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.impulses import push_body
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.gear_wrenches import geared_body, put_wrenches
from kickdrift.world.joints.kinematics import relative_velocity
from kickdrift.world.tables import ARTICULATION, JOINT, JOINT_AXES, JOINT_NUMBERS, LINK, floats, integers, rows


@compiled
def warm_start_joints(t: float, h: float, world: int) -> None:
    """Apply the impulses of the previous substep, so that contacts act on bodies that their joints already hold."""
    articulations, links, numbers = integers(world, ARTICULATION), integers(world, LINK), floats(world, JOINT_NUMBERS)
    for row in range(rows(world, ARTICULATION)):
        for link in range(articulations[row, j.FIRST], articulations[row, j.END]):
            if links[link, j.LINK_JOINT] >= 0:
                push_bodies(world, links[link, j.LINK_JOINT], numbers, links[link, j.LINK_JOINT], j.JOINT_IMPULSE)


@compiled(cached=False)
def note_speeds(world: int, joint: int) -> None:
    """Store the speeds along axes that have laws, before the next kick."""
    axes, numbers, laws = integers(world, JOINT)[joint, j.LAWS], floats(world, JOINT_NUMBERS), floats(world, JOINT_AXES)
    if axes == 0:
        return
    v, w = relative_velocity(world, joint)
    for k in range(6):
        if axes >> k & 1:
            laws[6 * joint + k, j.START_SPEED] = dot(vector_at(numbers, joint, j.AXES + 3 * k), v if k < 3 else w)


@compiled(cached=False)
def push_bodies(world: int, joint: int, source: Any, row: int, column: int) -> None:
    """Apply six impulses along and about the axes of a joint to b, and their opposites at the same point to a."""
    joints, numbers = integers(world, JOINT), floats(world, JOINT_NUMBERS)
    if joints[joint, j.LINEAR] == j.GEARED:
        _push_geared(world, joint, source[row, column + joints[joint, j.PRINCIPAL]])
        return
    force, torque = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(3):
        force = plus(force, times(source[row, column + k], vector_at(numbers, joint, j.AXES + 3 * k)))
        torque = plus(torque, times(source[row, column + 3 + k], vector_at(numbers, joint, j.AXES + 9 + 3 * k)))
    for side in range(2):
        sign = 1.0 if side == 1 else -1.0
        turn = plus(torque, cross(vector_at(numbers, joint, j.ARM_B if side == 1 else j.ARM_A), force))
        push_body(world, joints[joint, j.BODY_A + side], times(sign, force), times(sign, turn))


@compiled(cached=False)
def _push_geared(world: int, joint: int, impulse: float) -> None:
    """Apply the impulse of a gear to the bodies of its joints."""
    wrenches = carray(floats_on_stack(24), (1, 24))
    put_wrenches(world, joint, 0.0, wrenches, 0, 0)
    for i in range(4):
        push = times(impulse, vector_at(wrenches, 0, 6 * i))
        turn = times(impulse, vector_at(wrenches, 0, 6 * i + 3))
        push_body(world, geared_body(world, joint, i), push, turn)
