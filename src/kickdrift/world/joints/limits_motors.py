"""Laws of open axes in a substep: limits, motor, drive and dry friction as one relation between impulse and speed.

A drive acts by the position and the speed that it will have,

    impulse = -h (k (x + h ((alpha + beta) s' - beta s)) + c (s' - s*)),

with s before and s' after the substep, beta = (1 - alpha) / 4 and alpha = r^2 / (1 + r^2), r = h^2 k / m. With alpha = 0 that
is Newmark's method of average acceleration: symplectic, stable for any stiffness, and free of numerical damping.
Only drives too stiff for the substep, which no integrator of this order could follow, are damped: alpha = 1 is implicit
Euler, which brings them to rest. Newmark, J. Eng. Mech. Div. 85 (1959) 67; Kane et al., Int. J. Numer. Meth. Eng. 49 (2000)
1295 for the symplecticity. How laws are satisfied is in `kickdrift.world.joints.law_pieces`.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, length
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.kinematics import shares_friction
from kickdrift.world.tables import JOINT, JOINT_AXES, JOINT_NUMBERS, LINK_NUMBERS, floats, integers

# Speed at which a joint beyond a limit returns to it, m/s or rad/s: a few hundredths of a radian in a substep, which joints can
# follow. A joint is beyond a limit if it was created there, as the straight knees of a robot whose limits exclude them. Along
# lines the number is the same for bodies of any size: ropes may be wound up with it, and the speed is not kept.
_RETURN = 5.0

# When laws act
BEFORE_DRIFT = 0
AFTER_DRIFT = 1  # laws of drives are those computed before the last drift
IN_IMPACT = 2  # motors, drives and friction are forces, which do nothing in an instant: a limit is a rigid stop


@compiled(inline=True, cached=False)
def _begin_drive(world: int, joint: int, k: int, h: float) -> None:
    """Compute the law of a drive, which holds for the whole substep; see the top of this file."""
    numbers, laws = floats(world, JOINT_NUMBERS), floats(world, JOINT_AXES)
    row = 6 * joint + k
    stiffness, damping = laws[row, j.DRIVE_STIFFNESS], laws[row, j.DRIVE_DAMPING]
    off = numbers[joint, j.DRIVEN + k - 3] if k >= 3 else numbers[joint, j.JOINT_POSITION + k] - laws[row, j.TARGET]
    stiff, mass = h * h * stiffness, laws[row, j.DRIVEN_MASS]
    alpha = stiff * stiff / (mass * mass + stiff * stiff) if stiff > 0.0 else 0.0
    beta = 0.25 * (1.0 - alpha)
    constant = h * (damping * laws[row, j.TARGET_SPEED] - stiffness * (off - h * beta * laws[row, j.START_SPEED]))
    slope = h * (damping + h * stiffness * (alpha + beta))
    if k >= 3:
        slope += numbers[joint, j.BRAKE + k - 3]
    laws[row, j.DRIVE_CONSTANT], laws[row, j.DRIVE_SLOPE] = constant, slope


@compiled(inline=True, cached=False)
def _begin_law(world: int, joint: int, link: int, k: int, h: float, phase: int, friction: float) -> None:
    """Write the law of an axis for a solution, with this greatest impulse of friction."""
    joints, numbers, laws = integers(world, JOINT), floats(world, JOINT_NUMBERS), floats(world, JOINT_AXES)
    work, law, row = floats(world, LINK_NUMBERS), j.LAW + j.LAW_NUMBERS * k, 6 * joint + k
    at, back = numbers[joint, j.JOINT_POSITION + k], h * _RETURN
    lower, upper = min(laws[row, j.LOWER_LIMIT] - at, back), max(laws[row, j.UPPER_LIMIT] - at, -back)
    if phase != BEFORE_DRIFT:  # limits that were passed do not change
        lower, upper = min(lower, 0.0), max(upper, 0.0)
    scale = numbers[joint, j.TWIST_SCALE] if k == 5 and joints[joint, j.ANGULAR] == j.SWING_TWIST else 1.0
    work[link, law + j.LEAST_SPEED], work[link, law + j.GREATEST_SPEED] = scale * lower / h, scale * upper / h
    acts = phase != IN_IMPACT
    work[link, law + j.FRICTION_BOUND] = friction if acts else 0.0
    work[link, law + j.MOTOR_BOUND] = h * laws[row, j.MOTOR_MAXIMUM] if acts else 0.0
    work[link, law + j.MOTOR_TARGET] = laws[row, j.MOTOR_SPEED]
    work[link, law + j.LAW_CONSTANT] = laws[row, j.DRIVE_CONSTANT] if acts else 0.0
    work[link, law + j.LAW_SLOPE] = laws[row, j.DRIVE_SLOPE] if acts else 0.0
    work[link, law + j.DRIVE_BOUND] = h * laws[row, j.DRIVE_MAXIMUM]


@compiled(cached=False)
def _friction_shares(world: int, joint: int, link: int, h: float) -> Vector:
    """Share the friction of a ball joint among its axes, as it bounds the size of the torque.

    Friction acts along the impulse that would hold the joint, as it is when the solution starts; the squares of the shares add
    up to one. If nothing is to be held yet, they are equal. With shares that follow the solution, laws are not convex: of 30
    bent chains of eight balls that friction can hold 5 fall, since most solutions are not found.
    """
    if not shares_friction(world, joint):
        return (1.0, 1.0, 1.0)
    wish = (
        _held_torque(world, joint, link, 3, h),
        _held_torque(world, joint, link, 4, h),
        _held_torque(world, joint, link, 5, h),
    )
    size, equal = length(wish), math.sqrt(1.0 / 3.0)
    return (wish[0] / size, wish[1] / size, wish[2] / size) if size > 0.0 else (equal, equal, equal)


@compiled(inline=True, cached=False)
def _held_torque(world: int, joint: int, link: int, k: int, h: float) -> float:
    """Return the size of the impulse of friction that would hold an axis."""
    work, numbers, laws = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS), floats(world, JOINT_AXES)
    row = 6 * joint + k
    held = numbers[joint, j.JOINT_IMPULSE + k] - work[link, j.AXIS_SPEED + k] / laws[row, j.MOBILITY]
    most = h * laws[row, j.DRIVE_MAXIMUM]
    size: float = abs(held - min(most, max(-most, laws[row, j.DRIVE_CONSTANT])))
    return size


@compiled(cached=False)
def begin_laws(world: int, joint: int, link: int, h: float, phase: int) -> None:
    """Write the laws of a joint for a solution; drives are computed before the drift, and kept after it."""
    laws, axes = integers(world, JOINT)[joint, j.LAWS], floats(world, JOINT_AXES)
    if phase == BEFORE_DRIFT:
        for k in range(6):
            if laws >> k & 1:
                _begin_drive(world, joint, k, h)
    shares = _friction_shares(world, joint, link, h)
    for k in range(6):
        if laws >> k & 1:
            share = 1.0 if k < 3 else shares[0] if k == 3 else shares[1] if k == 4 else shares[2]
            _begin_law(world, joint, link, k, h, phase, h * axes[6 * joint + k, j.JOINT_FRICTION] * share)
