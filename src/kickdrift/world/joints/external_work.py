"""Bounds of the energy that joints add to an island in a substep, by motors and drives, and from kinematic bodies."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import cross, dot, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.kinematics import relative_velocity
from kickdrift.world.layout import BODY_KIND, KINEMATIC
from kickdrift.world.tables import BODY, JOINT, JOINT_AXES, JOINT_NUMBERS, MOTION, floats, integers


@compiled(cached=False)
def external_work(world: int, joint: int) -> float:
    """Bound the energy that a joint adds to its dynamic bodies in the substep, J."""
    joints, bodies = integers(world, JOINT), integers(world, BODY)
    work = _work_of_laws(world, joint) if joints[joint, j.LAWS] != 0 else 0.0
    for side in range(2):
        body = joints[joint, j.BODY_A + side]
        if bodies[body, BODY_KIND] == KINEMATIC:
            work += _work_of_kinematic(world, joint, body, j.ARM_A if side == 0 else j.ARM_B)
    return work


@compiled(cached=False)
def _work_of_laws(world: int, joint: int) -> float:
    """Bound the work of motors and drives: impulse times the speeds before and after, where positive, J.

    Limits do none, except for the energy with which a joint beyond its limit returns, that of its two bodies alone. Times their
    impulses, which have no bound where they jam bodies against each other, it would be far more: two limbs of 1 kg, 1 cm into
    each other, then reach 16 m/s.
    """
    axes, numbers, laws = integers(world, JOINT)[joint, j.LAWS], floats(world, JOINT_NUMBERS), floats(world, JOINT_AXES)
    v, w = relative_velocity(world, joint)
    most = 0.0
    for k in range(6):
        if not axes >> k & 1:
            continue
        row = 6 * joint + k
        speed = dot(vector_at(numbers, joint, j.AXES + 3 * k), v if k < 3 else w)
        if laws[row, j.DRIVE_STIFFNESS] + laws[row, j.DRIVE_DAMPING] + laws[row, j.MOTOR_MAXIMUM] > 0.0:
            impulse = numbers[joint, j.JOINT_IMPULSE + k]
            most += max(impulse * laws[row, j.START_SPEED], 0.0) + max(impulse * speed, 0.0)
        else:
            at = numbers[joint, j.JOINT_POSITION + k]
            if (at < laws[row, j.LOWER_LIMIT] and speed > 0.0) or (at > laws[row, j.UPPER_LIMIT] and speed < 0.0):
                most += speed * speed / laws[row, j.MOBILITY]
    return most


@compiled(cached=False)
def _work_of_kinematic(world: int, joint: int, body: int, arm: int) -> float:
    """Bound the work of a kinematic body on a joint: its impulse times the velocity of the point where it acts, J."""
    numbers, motion = floats(world, JOINT_NUMBERS), floats(world, MOTION)
    v, w = vector_at(motion, body, j.LINEAR_PART), vector_at(motion, body, j.ANGULAR_PART)
    v = plus(v, cross(w, vector_at(numbers, joint, arm)))
    force, torque = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(3):
        force = plus(force, times(numbers[joint, j.JOINT_IMPULSE + k], vector_at(numbers, joint, j.AXES + 3 * k)))
        torque = plus(
            torque, times(numbers[joint, j.JOINT_IMPULSE + 3 + k], vector_at(numbers, joint, j.AXES + 9 + 3 * k))
        )
    return abs(dot(force, v)) + abs(dot(torque, w))
