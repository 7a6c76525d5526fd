"""Gears as rows of the equations: their wrenches on the bodies of the two joints that they couple.

A gear holds the sum of rate x position over two axes. Its wrench is the sum of those of both axes times their rates, on up to
four bodies: a and b of the first joint, then a and b of the second.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import (
    Vector,
    applied,
    conjugate,
    cross,
    dot,
    exponential,
    minus,
    plus,
    product,
    times,
    turned,
)
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.kinematics import axis_unit, expected_angle, put_vector, unwound
from kickdrift.world.layout import INVERSE_INERTIA_IN_WORLD, INVERSE_LINEAR_MASS
from kickdrift.world.tables import INVERSE_MASS, JOINT, JOINT_NUMBERS, LINK_NUMBERS, MOTION, POSE, floats, integers

_NOTHING: Vector = (0.0, 0.0, 0.0)


@compiled(cached=False)
def geared_body(world: int, joint: int, i: int) -> int:
    """Return the body that the i-th of the four wrenches of a gear acts on."""
    joints = integers(world, JOINT)
    body: int = joints[joints[joint, j.GEARED_JOINTS + i // 2], j.BODY_A + i % 2]
    return body


@compiled(cached=False)
def put_wrenches(world: int, joint: int, h: float, table: Any, row: int, column: int) -> float:
    """Write the four wrenches of a gear as they will be after a time h at the present velocities.

    Returns
    -------
    float
        The error of the gear then, m or rad of its first axis.
    """
    joints, numbers = integers(world, JOINT), floats(world, JOINT_NUMBERS)
    off: float = -numbers[joint, j.LENGTH]
    for side in range(2):
        rate, k = numbers[joint, j.RATES + side], joints[joint, j.GEARED_AXES + side]
        at, axis, arm_a, arm_b = _axis_ahead(world, joints[joint, j.GEARED_JOINTS + side], k, h)
        off += rate * at
        axis = times(rate, axis)
        push = axis if k < 3 else _NOTHING
        begin = column + 12 * side
        put_vector(table, row, begin, times(-1.0, push))
        put_vector(table, row, begin + 3, times(-1.0, cross(arm_a, axis) if k < 3 else axis))
        put_vector(table, row, begin + 6, push)
        put_vector(table, row, begin + 9, cross(arm_b, axis) if k < 3 else axis)
    return off


@compiled(cached=False)
def _axis_ahead(world: int, joint: int, k: int, h: float) -> tuple[float, Vector, Vector, Vector]:
    """Return the position along or about an axis of a joint after a time h, the axis, and the arms of a and b."""
    pose, motion = floats(world, POSE), floats(world, MOTION)
    joints, numbers = integers(world, JOINT), floats(world, JOINT_NUMBERS)
    a, b = joints[joint, j.BODY_A], joints[joint, j.BODY_B]
    qa = product(exponential(times(h, vector_at(motion, a, j.ANGULAR_PART))), quaternion_at(pose, a, j.ANGULAR_PART))
    qb = product(exponential(times(h, vector_at(motion, b, j.ANGULAR_PART))), quaternion_at(pose, b, j.ANGULAR_PART))
    fa = product(qa, quaternion_at(numbers, joint, j.FRAME_A))
    axis = turned(fa, axis_unit(k % 3))
    if k >= 3:
        relative = product(conjugate(fa), product(qb, quaternion_at(numbers, joint, j.FRAME_B)))
        angle = unwound(2.0 * math.atan2(relative[k - 2], relative[0]), expected_angle(world, joint, k, h))
        return angle, axis, _NOTHING, _NOTHING
    arm_b = turned(qb, vector_at(numbers, joint, j.ANCHOR_B))
    moved = minus(vector_at(motion, b, j.LINEAR_PART), vector_at(motion, a, j.LINEAR_PART))
    arm_a = plus(
        minus(vector_at(pose, b, j.LINEAR_PART), vector_at(pose, a, j.LINEAR_PART)), plus(arm_b, times(h, moved))
    )
    return dot(axis, minus(arm_a, turned(qa, vector_at(numbers, joint, j.ANCHOR_A)))), axis, arm_a, arm_b


@compiled(cached=False)
def speed_of_gear(world: int, joint: int, link: int) -> float:
    """Return the rate of the sum that a gear holds, from the wrenches in a row of `LINK_NUMBERS`."""
    work, motion, total = floats(world, LINK_NUMBERS), floats(world, MOTION), 0.0
    for i in range(4):
        body = geared_body(world, joint, i)
        for m in range(6):
            total += work[link, j.START_WRENCHES + 6 * i + m] * motion[body, m]
    return total


@compiled(cached=False)
def mobility_of_gear(world: int, joint: int, link: int) -> float:
    """Return the speed of a gear per impulse, for its bodies alone, from the wrenches in a row of `LINK_NUMBERS`."""
    work, response, total = floats(world, LINK_NUMBERS), floats(world, INVERSE_MASS), 0.0
    for i in range(4):
        body = geared_body(world, joint, i)
        inverse = symmetric_at(response, body, INVERSE_INERTIA_IN_WORLD)
        push = vector_at(work, link, j.START_WRENCHES + 6 * i)
        turn = applied(inverse, vector_at(work, link, j.START_WRENCHES + 6 * i + 3))
        for other in range(4):
            if geared_body(world, joint, other) == body:
                total += response[body, INVERSE_LINEAR_MASS] * dot(
                    push, vector_at(work, link, j.START_WRENCHES + 6 * other)
                )
                total += dot(turn, vector_at(work, link, j.START_WRENCHES + 6 * other + 3))
    return total
