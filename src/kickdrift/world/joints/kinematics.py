"""Kinematics of joints: axes, arms, positions and angles, and the mobility along axes."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import (
    Quaternion,
    Symmetric,
    Vector,
    applied,
    axes,
    conjugate,
    cross,
    dot,
    length,
    minus,
    normal_to,
    plus,
    product,
    rotation_vector,
    times,
    turned,
    turned_back,
)
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.joints import layout as j
from kickdrift.world.layout import INVERSE_INERTIA_IN_WORLD, INVERSE_LINEAR_MASS
from kickdrift.world.tables import (
    ARTICULATION,
    INVERSE_MASS,
    JOINT,
    JOINT_AXES,
    JOINT_NUMBERS,
    LINK,
    MOTION,
    POSE,
    floats,
    integers,
    rows,
)

_ROUNDING = 1e-12
_LEAST_SCALE = 0.05  # at a swing of 174 degrees; at 180 degrees twist is undefined


@compiled(inline=True, cached=False)
def put_vector(table: Any, row: int, column: int, a: Vector) -> None:
    """Write three numbers of a row."""
    table[row, column], table[row, column + 1], table[row, column + 2] = a


@compiled(inline=True, cached=False)
def put_frame(table: Any, row: int, column: int, frame: tuple[Vector, Vector, Vector]) -> None:
    """Write three axes into nine numbers of a row."""
    put_vector(table, row, column, frame[0])
    put_vector(table, row, column + 3, frame[1])
    put_vector(table, row, column + 6, frame[2])


@compiled(inline=True, cached=False)
def along(frame: tuple[Vector, Vector, Vector], a: Vector) -> Vector:
    """Return the components of a vector along three axes."""
    return (dot(frame[0], a), dot(frame[1], a), dot(frame[2], a))


@compiled(inline=True, cached=False)
def relative_velocity(world: int, joint: int) -> tuple[Vector, Vector]:
    """Return the velocity of b relative to a where the joint acts, m/s, and the relative angular velocity, rad/s."""
    joints, numbers, motion = integers(world, JOINT), floats(world, JOINT_NUMBERS), floats(world, MOTION)
    a, b = joints[joint, j.BODY_A], joints[joint, j.BODY_B]
    wa, wb = vector_at(motion, a, j.ANGULAR_PART), vector_at(motion, b, j.ANGULAR_PART)
    va = plus(vector_at(motion, a, j.LINEAR_PART), cross(wa, vector_at(numbers, joint, j.ARM_A)))
    vb = plus(vector_at(motion, b, j.LINEAR_PART), cross(wb, vector_at(numbers, joint, j.ARM_B)))
    return minus(vb, va), minus(wb, wa)


@compiled(inline=True, cached=False)
def axis_unit(k: int) -> Vector:
    """Return the unit vector of an axis."""
    return (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)


@compiled(inline=True, cached=False)
def normalised(a: Vector, otherwise: Vector) -> Vector:
    """Return the unit vector of a, or `otherwise` if a is zero."""
    size = length(a)
    return times(1.0 / size, a) if size > 1e-150 else otherwise


@compiled(inline=True, cached=False)
def unwound(angle: float, before: float) -> float:
    """Return an angle, rad, with the number of full turns for which it is closest to `before`."""
    return angle + 2.0 * math.pi * math.floor((before - angle) / (2.0 * math.pi) + 0.5)


@compiled(inline=True, cached=False)
def expected_angle(world: int, joint: int, k: int, h: float) -> float:
    """Predict the angle about an axis a time h after it was measured, from the present angular velocities, rad."""
    joints, numbers, motion = integers(world, JOINT), floats(world, JOINT_NUMBERS), floats(world, MOTION)
    wa = vector_at(motion, joints[joint, j.BODY_A], j.ANGULAR_PART)
    wb = vector_at(motion, joints[joint, j.BODY_B], j.ANGULAR_PART)
    angle: float = numbers[joint, j.JOINT_POSITION + k] + h * dot(
        minus(wb, wa), vector_at(numbers, joint, j.AXES + 3 * k)
    )
    return angle


@compiled
def measure_joints(t: float, h: float, world: int) -> None:
    """Measure joints in the present poses, before the substeps."""
    _measure_all(world, 0.0)


@compiled
def follow_joints(t: float, h: float, world: int) -> None:
    """Measure joints after a drift."""
    _measure_all(world, h)


@compiled(cached=False)
def _measure_all(world: int, h: float) -> None:
    """Measure all joints of articulations that are awake."""
    articulations, links = integers(world, ARTICULATION), integers(world, LINK)
    for row in range(rows(world, ARTICULATION)):
        for link in range(articulations[row, j.FIRST], articulations[row, j.END]):
            if links[link, j.LINK_JOINT] >= 0:
                measure_joint(world, links[link, j.LINK_JOINT], h)


@compiled(cached=False)
def measure_joint(world: int, joint: int, h: float) -> None:
    """Compute axes, arms, positions and angles of a joint from the poses of its bodies, a time h after the last measurement.

    Full turns are counted with the speed in this time, as wheels at 1000 rad/s turn by more than half a turn in a substep.
    """
    pose, joints, numbers = floats(world, POSE), integers(world, JOINT), floats(world, JOINT_NUMBERS)
    if joints[joint, j.LINEAR] == j.GEARED:
        return  # it is measured after its joints, when its right-hand side is written
    a, b = joints[joint, j.BODY_A], joints[joint, j.BODY_B]
    qa, qb = quaternion_at(pose, a, j.ANGULAR_PART), quaternion_at(pose, b, j.ANGULAR_PART)
    arm_b = turned(qb, vector_at(numbers, joint, j.ANCHOR_B))
    # The joint acts at the anchor of b: for axes fixed in a, this gives the exact gradient of the constraint.
    arm_a = minus(plus(vector_at(pose, b, j.LINEAR_PART), arm_b), vector_at(pose, a, j.LINEAR_PART))
    way = minus(arm_a, turned(qa, vector_at(numbers, joint, j.ANCHOR_A)))
    put_vector(numbers, joint, j.ARM_A, arm_a)
    put_vector(numbers, joint, j.ARM_B, arm_b)
    fa = product(qa, quaternion_at(numbers, joint, j.FRAME_A))
    frame = axes(fa)
    relative = product(conjugate(fa), product(qb, quaternion_at(numbers, joint, j.FRAME_B)))
    if joints[joint, j.LINEAR] == j.POINT:
        for k in range(3):
            put_vector(numbers, joint, j.AXES + 3 * k, axis_unit(k))
        put_vector(numbers, joint, j.JOINT_POSITION, way)
    elif joints[joint, j.LINEAR] == j.LINE:
        put_vector(
            numbers, joint, j.JOINT_POSITION, put_line(numbers, joint, j.AXES, way, fa, numbers[joint, j.LENGTH])
        )
    else:
        put_frame(numbers, joint, j.AXES, frame)
        put_vector(numbers, joint, j.JOINT_POSITION, along(frame, way))
    mode = joints[joint, j.ANGULAR]
    if mode == j.UNIVERSAL:
        _measure_universal(world, joint, joints[joint, j.PIVOT], fa, relative, h)
    elif mode == j.SWING_TWIST:
        _measure_cone(world, joint, fa, relative)
    else:
        put_frame(numbers, joint, j.AXES + 9, frame)
        if mode == j.HINGE:
            k = 3 + joints[joint, j.PIVOT]
            angle = 2.0 * math.atan2(relative[k - 2], relative[0])
            numbers[joint, j.JOINT_POSITION + k] = unwound(angle, expected_angle(world, joint, k, h))
        elif mode == j.VECTOR:
            put_vector(numbers, joint, j.JOINT_POSITION + 3, rotation_vector(relative))
    if joints[joint, j.LAWS] != 0:
        _measure_laws(world, joint)


@compiled(cached=False)
def _measure_laws(world: int, joint: int) -> None:
    """Compute the mobilities along axes that have laws, and their angles less the targets of drives.

    Axes that share their friction have the largest mobility of the three.
    """
    joints, numbers, laws = integers(world, JOINT), floats(world, JOINT_NUMBERS), floats(world, JOINT_AXES)
    for k in range(6):
        if joints[joint, j.LAWS] >> k & 1:
            laws[6 * joint + k, j.MOBILITY] = mobility(world, joint, k)
            if k >= 3 and joints[joint, j.ANGULAR] != j.SWING_TWIST:
                numbers[joint, j.DRIVEN + k - 3] = numbers[joint, j.JOINT_POSITION + k] - laws[6 * joint + k, j.TARGET]
    if shares_friction(world, joint):
        first, most = 6 * joint + 3, 0.0
        for row in range(first, first + 3):
            most = max(most, laws[row, j.MOBILITY])
        for row in range(first, first + 3):
            laws[row, j.MOBILITY] = most


@compiled(inline=True, cached=False)
def shares_friction(world: int, joint: int) -> bool:
    """Whether a joint has dry friction as strong about any axis, of which the size is bounded, as in a ball joint."""
    joints, laws = integers(world, JOINT), floats(world, JOINT_AXES)
    row = 6 * joint + 3
    x, y, z = laws[row, j.JOINT_FRICTION], laws[row + 1, j.JOINT_FRICTION], laws[row + 2, j.JOINT_FRICTION]
    return bool(joints[joint, j.ANGULAR] >= j.VECTOR and x > 0.0 and y == x and z == x)


@compiled(cached=False)
def put_line(table: Any, row: int, column: int, way: Vector, fa: Quaternion, rest: float) -> Vector:
    """Write the axes of a joint along a line, and return its positions along them."""
    line = normalised(way, turned(fa, axis_unit(2)))
    side = normal_to(line)
    put_vector(table, row, column, side)
    put_vector(table, row, column + 3, cross(line, side))
    put_vector(table, row, column + 6, line)
    return (0.0, 0.0, length(way) - rest)


@compiled(cached=False)
def put_cross(table: Any, row: int, column: int, i: int, fa: Quaternion, second_in_a: Vector) -> None:
    """Write the angular axes of a universal joint: axis i of a, that of b made perpendicular to it, and the normal to both."""
    m, k = (i + 1) % 3, (i + 2) % 3
    first = turned(fa, axis_unit(i))
    third = normalised(cross(first, turned(fa, second_in_a)), turned(fa, axis_unit(k)))
    put_vector(table, row, column + 3 * i, first)
    put_vector(table, row, column + 3 * m, cross(third, first))
    put_vector(table, row, column + 3 * k, third)


@compiled(cached=False)
def _measure_universal(world: int, joint: int, i: int, fa: Quaternion, relative: Quaternion, h: float) -> None:
    """Measure a universal joint: axis i is fixed in a and m in b, and b is rotated about m first, then about i."""
    numbers = floats(world, JOINT_NUMBERS)
    m, k = (i + 1) % 3, (i + 2) % 3
    second_in_a = turned(relative, axis_unit(m))
    put_cross(numbers, joint, j.AXES + 9, i, fa, second_in_a)
    first_in_b = turned_back(relative, axis_unit(i))
    p = j.JOINT_POSITION + 3
    numbers[joint, p + i] = unwound(
        math.atan2(dot(second_in_a, axis_unit(k)), dot(second_in_a, axis_unit(m))),
        expected_angle(world, joint, 3 + i, h),
    )
    numbers[joint, p + m] = unwound(
        math.atan2(dot(first_in_b, axis_unit(k)), dot(first_in_b, axis_unit(i))), expected_angle(world, joint, 3 + m, h)
    )


@compiled(cached=False)
def _measure_cone(world: int, joint: int, fa: Quaternion, relative: Quaternion) -> None:
    """Measure swing and twist: b is twisted about axis 2, which is then swung away from that of a.

    The rate of the swing is the angular velocity about the normal to axes 2 of a and b; that of the twist is the angular
    velocity about their mean, over the cosine of half the swing.
    """
    numbers, laws = floats(world, JOINT_NUMBERS), floats(world, JOINT_AXES)
    axis = turned(relative, axis_unit(2))
    swing = math.atan2(math.sqrt(axis[0] * axis[0] + axis[1] * axis[1]), axis[2])
    out = normalised((-axis[1], axis[0], 0.0), axis_unit(0))
    mean = times(math.cos(0.5 * swing), axis_unit(2))
    mean = plus(mean, times(math.sin(0.5 * swing), cross(out, axis_unit(2))))
    put_vector(numbers, joint, j.AXES + 9, turned(fa, out))
    put_vector(numbers, joint, j.AXES + 12, turned(fa, cross(mean, out)))
    put_vector(numbers, joint, j.AXES + 15, turned(fa, mean))
    twist = 2.0 * math.atan2(relative[3], relative[0])
    put_vector(
        numbers,
        joint,
        j.JOINT_POSITION + 3,
        (swing, 0.0, twist - 2.0 * math.pi * math.floor(twist / (2.0 * math.pi) + 0.5)),
    )
    numbers[joint, j.TWIST_SCALE] = max(math.cos(0.5 * swing), _LEAST_SCALE)
    first = 6 * joint + 3
    target = (laws[first, j.TARGET], laws[first + 1, j.TARGET], laws[first + 2, j.TARGET])
    off = minus(rotation_vector(relative), target)
    put_vector(numbers, joint, j.DRIVEN, (dot(off, out), dot(off, cross(mean, out)), dot(off, mean)))


@compiled(inline=True, cached=False)
def turning(inverse: Symmetric, turn: Vector) -> float:
    """Return turn . I^-1 turn, or zero if it is only rounding, about a locked axis."""
    speed: float = dot(turn, applied(inverse, turn))
    return speed if speed > _ROUNDING * (inverse[0] + inverse[1] + inverse[2]) * dot(turn, turn) else 0.0


@compiled(cached=False)
def mobility(world: int, joint: int, k: int) -> float:
    """Return the speed along an axis per unit impulse along it, for the two bodies alone."""
    joints, numbers, response = integers(world, JOINT), floats(world, JOINT_NUMBERS), floats(world, INVERSE_MASS)
    axis, total = vector_at(numbers, joint, j.AXES + 3 * k), 0.0
    for side in range(2):
        body = joints[joint, j.BODY_B if side == 1 else j.BODY_A]
        turn = axis
        if k < 3:
            turn = cross(vector_at(numbers, joint, j.ARM_B if side == 1 else j.ARM_A), axis)
            total += response[body, INVERSE_LINEAR_MASS]
        total += turning(symmetric_at(response, body, INVERSE_INERTIA_IN_WORLD), turn)
    return total
