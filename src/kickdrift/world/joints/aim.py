"""What is wanted of each axis of each joint, before the equations are solved."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import (
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
    turned_back,
)
from kickdrift.world.joints.impulses import relative_velocity
from kickdrift.world.joints.layout import (
    ANCHOR_A,
    ANCHOR_B,
    ANGULAR,
    ANGULAR_PART,
    ARM_A,
    ARM_B,
    AXES,
    BODY_A,
    BODY_B,
    BRAKE,
    CHANGE,
    END,
    FIRST,
    FRAME_A,
    FRAME_B,
    GIVEN,
    HELD,
    HINGE,
    LENGTH,
    LINE,
    LINEAR,
    LINEAR_PART,
    LINK_JOINT,
    LOCKED,
    LOOSE,
    MISALIGNMENT,
    MOVED,
    PARENT,
    PIVOT,
    POINT,
    PULL,
    PUSH,
    RELAXING,
    RIGID,
    SEQUENTIAL,
    SIGN,
    SLOPE,
    SPEED,
    STATE,
    YIELD,
)
from kickdrift.world.joints.measure import axis_unit, put_vector, quaternion_at, vector_at
from kickdrift.world.tables import (
    ARTICULATION,
    JOINT,
    JOINT_NUMBERS,
    LINK,
    LINK_NUMBERS,
    MOTION,
    POSE,
    floats,
    integers,
    rows,
)

_RESOLVED, _BRAKING = 0.1, 0.5


@compiled
def aim_joints(t: float, h: float, world: int) -> None:
    """Say what is wanted: of locked axes the speed that puts them right, or none after the drift; of laws nothing yet."""
    articulations, links = integers(world, ARTICULATION), integers(world, LINK)
    for row in range(rows(world, ARTICULATION)):
        for link in range(articulations[row, FIRST], articulations[row, END]):
            joint = links[link, LINK_JOINT]
            if joint >= 0 and articulations[row, SEQUENTIAL] == 0:
                aim(joint, link, h, articulations[row, RELAXING] != 0, world)


@compiled(cached=False)
def aim(joint: int, link: int, h: float, relaxing: bool, world: int) -> None:
    """Fill in the row of numbers of a joint."""
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    joints = integers(world, JOINT)
    links[link, HELD] = joints[joint, LOCKED]
    v, w = relative_velocity(joint, world)
    if not relaxing:
        _look_ahead(joint, h, world)
    for k in range(6):
        speed = dot(vector_at(numbers, joint, AXES + 3 * k), v if k < 3 else w)
        work[link, SPEED + k] = speed
        work[link, CHANGE + k] = 0.0
        if joints[joint, LOCKED] >> k & 1:
            work[link, CHANGE + k] = -speed if relaxing else -numbers[joint, MISALIGNMENT + k] / h
        brake = 0.0 if relaxing or k < 3 or links[link, PARENT] < 0 else _brake(joint, link, k, h, world)
        work[link, BRAKE + k] = brake
        work[link, PUSH + k] = -brake * speed
        work[link, SLOPE + k] = brake
        for column in (STATE, MOVED, GIVEN):
            work[link, column + k] = 0.0


@compiled(cached=False)
def _brake(joint: int, link: int, k: int, h: float, world: int) -> float:
    """Damp what swings too fast for the substep: impulse per speed about an open angular axis.

    A link that is pulled at its joint by a force F at an arm r turns back with the stiffness K = r . F - (s . r) (s . F) about
    an axis s, the geometric stiffness. Chains of light links with a heavy end have modes that swing against each other with
    h^2 K far above the inertia D that the joint turns, and feed on each other. They are damped from h^2 K / D = 0.1 on, where
    the fastest of them takes some six substeps for a turn; hinges that turn against what nothing moves are left alone.
    Tournier, Nesme, Gilles, Faure, ACM Trans. Graph. 34 (2015) 132 has other means to the same end.
    """
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    if integers(world, JOINT)[joint, LOCKED] >> k & 1 or not work[link, YIELD + k] > 0.0:
        return 0.0
    force, axis = (0.0, 0.0, 0.0), vector_at(numbers, joint, AXES + 3 * k)
    for i in range(3):
        force = plus(force, times(numbers[joint, PULL + i], vector_at(numbers, joint, AXES + 3 * i)))
    arm = vector_at(numbers, joint, ARM_B if links[link, SIGN] > 0 else ARM_A)
    stiffness = h * links[link, SIGN] * (dot(arm, force) - dot(axis, arm) * dot(axis, force))
    return max(0.0, _BRAKING * (stiffness - _RESOLVED / work[link, YIELD + k]))


@compiled(cached=False)
def _look_ahead(joint: int, h: float, world: int) -> None:
    """Fill in how far locked axes will be off once the bodies have moved for a time h with the velocities that they have.

    One Newton step from there, with the axes as they stand now, leaves an error of the third order in h: that of a row
    linearised at the start of the substep, with the distance that curves away from its tangent, is of the second.
    """
    pose, motion = floats(world, POSE), floats(world, MOTION)
    joints, numbers = integers(world, JOINT), floats(world, JOINT_NUMBERS)
    a, b = joints[joint, BODY_A], joints[joint, BODY_B]
    qa = product(exponential(times(h, vector_at(motion, a, ANGULAR_PART))), quaternion_at(pose, a, ANGULAR_PART))
    qb = product(exponential(times(h, vector_at(motion, b, ANGULAR_PART))), quaternion_at(pose, b, ANGULAR_PART))
    way = minus(
        plus(vector_at(pose, b, LINEAR_PART), times(h, vector_at(motion, b, LINEAR_PART))),
        vector_at(pose, a, LINEAR_PART),
    )
    way = minus(way, times(h, vector_at(motion, a, LINEAR_PART)))
    way = plus(way, turned(qb, vector_at(numbers, joint, ANCHOR_B)))
    way = minus(way, turned(qa, vector_at(numbers, joint, ANCHOR_A)))
    fa = product(qa, quaternion_at(numbers, joint, FRAME_A))
    if joints[joint, LINEAR] == POINT:
        put_vector(numbers, joint, MISALIGNMENT, way)
    elif joints[joint, LINEAR] == LINE:
        put_vector(numbers, joint, MISALIGNMENT, (0.0, 0.0, length(way) - numbers[joint, LENGTH]))
    else:
        put_vector(numbers, joint, MISALIGNMENT, turned_back(fa, way))
    mode = joints[joint, ANGULAR]
    if mode >= LOOSE:
        return
    relative = product(conjugate(fa), product(qb, quaternion_at(numbers, joint, FRAME_B)))
    i = joints[joint, PIVOT]
    if mode == RIGID:
        off = rotation_vector(relative)
    elif mode == HINGE:
        off = cross(axis_unit(i), turned(relative, axis_unit(i)))
    else:
        off = times(-turned(relative, axis_unit((i + 1) % 3))[i], axis_unit((i + 2) % 3))
    put_vector(numbers, joint, MISALIGNMENT + 3, off)
