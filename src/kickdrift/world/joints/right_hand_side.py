"""The right-hand sides of the axes of joints, set before the equations are solved."""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import (
    axes,
    conjugate,
    cross,
    dot,
    exponential,
    length,
    minus,
    plus,
    product,
    rotation_vector,
    times,
    turned,
)
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.gear_wrenches import geared_body, put_wrenches, speed_of_gear
from kickdrift.world.joints.kinematics import (
    along,
    axis_unit,
    put_cross,
    put_frame,
    put_line,
    put_vector,
    relative_velocity,
)
from kickdrift.world.layout import BOUNDING_RADIUS
from kickdrift.world.tables import JOINT, JOINT_NUMBERS, LINK, LINK_NUMBERS, MOTION, POSE, RESTED, floats, integers

# Aims of a solution
AHEAD = 0  # no error at the end of the substep
GENTLY = 1  # no speed along locked axes, before the drift
RELAX = 2  # no speed along locked axes
REPAIR = 3  # a change of position, as a speed, after which there is no error


@compiled(cached=False)
def write_right_hand_side(world: int, joint: int, link: int, h: float, mode: int) -> float:
    """Set the right-hand side of the axes of a joint: for locked ones the speed that corrects them, for laws zero.

    Returns
    -------
    float
        The error of locked axes to come, as an angle or relative to arms and bodies; zero in modes that do not need it.
    """
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    if integers(world, JOINT)[joint, j.LINEAR] == j.GEARED:
        return _write_gear(world, joint, link, h, mode)
    locked = integers(world, JOINT)[joint, j.LOCKED]
    links[link, j.HELD_AXES] = locked
    v, w = relative_velocity(world, joint)
    look_here(world, joint, link)
    if mode != RELAX:
        _look_ahead(world, joint, link, h if mode == AHEAD else 0.0)
    for column in (j.LAW_STATE, j.LAW_BASE, j.DELTA_SPEED, j.AXIS_IMPULSE, j.ACCEPTED_DELTA_SPEED, j.ACCEPTED_IMPULSE):
        for k in range(6):
            work[link, column + k] = 0.0
    off, turned_off, per_h = 0.0, 0.0, 1.0 / h
    for k in range(6):
        speed = dot(vector_at(numbers, joint, j.AXES + 3 * k), v if k < 3 else w)
        brake = numbers[joint, j.BRAKE + k - 3] if mode == AHEAD and k >= 3 else 0.0
        wrong = numbers[joint, j.MISALIGNMENT + k]
        work[link, j.AXIS_SPEED + k] = speed
        work[link, j.RIGHT_HAND_SIDE + k] = 0.0
        if locked >> k & 1:
            work[link, j.RIGHT_HAND_SIDE + k] = -wrong * per_h if mode in (AHEAD, REPAIR) else -speed
            off += wrong * wrong if k < 3 else 0.0
            turned_off += wrong * wrong if k >= 3 else 0.0
        work[link, j.SLOPE + k] = brake
        work[link, j.PUSH + k] = 0.0
        if mode in (AHEAD, GENTLY):
            work[link, j.PUSH + k] = -brake * speed - numbers[joint, j.JOINT_IMPULSE + k]
    joints, rested = integers(world, JOINT), floats(world, RESTED)
    size = length(vector_at(numbers, joint, j.ARM_A)) + length(vector_at(numbers, joint, j.ARM_B))
    size += rested[joints[joint, j.BODY_A], BOUNDING_RADIUS] + rested[joints[joint, j.BODY_B], BOUNDING_RADIUS]
    off = off / (size * size) if size > 0.0 else 0.0
    return math.sqrt(turned_off + off) if mode == AHEAD else 0.0


@compiled(cached=False)
def _write_gear(world: int, joint: int, link: int, h: float, mode: int) -> float:
    """Set the right-hand side of a gear; return the error that it will have, as an angle or in parts of its bodies."""
    joints, work, numbers = integers(world, JOINT), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    k = joints[joint, j.PRINCIPAL]
    integers(world, LINK)[link, j.HELD_AXES] = 1 << k
    put_wrenches(world, joint, 0.0, work, link, j.START_WRENCHES)
    wrong = put_wrenches(world, joint, h if mode == AHEAD else 0.0, work, link, j.AHEAD_WRENCHES)
    for column in (j.RIGHT_HAND_SIDE, j.SLOPE, j.PUSH, j.AXIS_SPEED, j.LAW_STATE, j.DELTA_SPEED, j.AXIS_IMPULSE):
        for axis in range(6):
            work[link, column + axis] = 0.0
    work[link, j.AXIS_SPEED + k] = speed_of_gear(world, joint, link)
    work[link, j.RIGHT_HAND_SIDE + k] = -wrong / h if mode in (AHEAD, REPAIR) else -work[link, j.AXIS_SPEED + k]
    numbers[joint, j.MISALIGNMENT + k] = wrong
    if mode == RELAX:
        numbers[joint, j.JOINT_POSITION + k] = wrong
    size = 0.0
    for i in range(4):
        size += floats(world, RESTED)[geared_body(world, joint, i), BOUNDING_RADIUS]
    if mode != AHEAD:
        return 0.0
    return abs(wrong) if k >= 3 else abs(wrong) / size if size > 0.0 else 0.0


@compiled(inline=True, cached=False)
def look_here(world: int, joint: int, link: int) -> None:
    """Use the present axes and arms in place of those at the end of the substep."""
    work, numbers = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    for k in range(18):
        work[link, j.AXES_AHEAD + k] = numbers[joint, j.AXES + k]
    put_vector(work, link, j.ARM_A_AHEAD, vector_at(numbers, joint, j.ARM_A))
    put_vector(work, link, j.ARM_B_AHEAD, vector_at(numbers, joint, j.ARM_B))


@compiled(inline=True, cached=False)
def _keep_passing_line(world: int, joint: int, link: int) -> None:
    """Use the present axes where a line turns over in the substep, as that of a spring one end of which passes the other.

    Its force along the line at the start would act against its speed along that at the end: the median of twenty masses that
    pass through the other end of their springs at 20 m/s, 13 times a second, then has 3.7 times its energy after 4 s.
    """
    work, numbers = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    if dot(vector_at(numbers, joint, j.AXES + 6), vector_at(work, link, j.AXES_AHEAD + 6)) < 0.0:
        for k in range(9):
            work[link, j.AXES_AHEAD + k] = numbers[joint, j.AXES + k]


@compiled(cached=False)
def _look_ahead(world: int, joint: int, link: int, h: float) -> None:
    """Compute the error of locked axes at the end of the substep with the present velocities, and where they then are.

    One step of Newton's method from there leaves an error of the third order in h, if axes and arms are those at the end:
    with those at the start, errors grow where masses differ by more than a substep turns the joint by. A
    chain with an end 1000 times as heavy as its links then tears.
    """
    pose, motion, work = floats(world, POSE), floats(world, MOTION), floats(world, LINK_NUMBERS)
    joints, numbers = integers(world, JOINT), floats(world, JOINT_NUMBERS)
    a, b = joints[joint, j.BODY_A], joints[joint, j.BODY_B]
    qa = product(exponential(times(h, vector_at(motion, a, j.ANGULAR_PART))), quaternion_at(pose, a, j.ANGULAR_PART))
    qb = product(exponential(times(h, vector_at(motion, b, j.ANGULAR_PART))), quaternion_at(pose, b, j.ANGULAR_PART))
    arm_b = turned(qb, vector_at(numbers, joint, j.ANCHOR_B))
    arm_a = plus(minus(vector_at(pose, b, j.LINEAR_PART), vector_at(pose, a, j.LINEAR_PART)), arm_b)
    moved = minus(vector_at(motion, b, j.LINEAR_PART), vector_at(motion, a, j.LINEAR_PART))
    arm_a = plus(arm_a, times(h, moved))
    way = minus(arm_a, turned(qa, vector_at(numbers, joint, j.ANCHOR_A)))
    put_vector(work, link, j.ARM_A_AHEAD, arm_a)
    put_vector(work, link, j.ARM_B_AHEAD, arm_b)
    fa = product(qa, quaternion_at(numbers, joint, j.FRAME_A))
    frame = axes(fa)
    if joints[joint, j.LINEAR] == j.FRAME:
        put_frame(work, link, j.AXES_AHEAD, frame)
        put_vector(numbers, joint, j.MISALIGNMENT, along(frame, way))
    else:
        off = way
        if joints[joint, j.LINEAR] == j.LINE:
            off = put_line(work, link, j.AXES_AHEAD, way, fa, numbers[joint, j.LENGTH])
            _keep_passing_line(world, joint, link)
        put_vector(numbers, joint, j.MISALIGNMENT, off)
    if joints[joint, j.ANGULAR] >= j.LOOSE:
        return
    relative = product(conjugate(fa), product(qb, quaternion_at(numbers, joint, j.FRAME_B)))
    put_frame(work, link, j.AXES_AHEAD + 9, frame)
    i = joints[joint, j.PIVOT]
    if joints[joint, j.ANGULAR] == j.RIGID:
        off = rotation_vector(relative)
    elif joints[joint, j.ANGULAR] == j.HINGE:
        off = cross(axis_unit(i), turned(relative, axis_unit(i)))
    else:
        second = turned(relative, axis_unit((i + 1) % 3))
        put_cross(work, link, j.AXES_AHEAD + 9, i, fa, second)
        off = times(-second[i], axis_unit((i + 2) % 3))
    put_vector(numbers, joint, j.MISALIGNMENT + 3, off)
