"""Pieces of the laws of open axes: which of them a solution assumes, and on which it lies.

The graph of a law (`kickdrift.world.joints.limits_motors`), impulse over speed, falls: a limit, a motor and friction are
vertical segments at their speeds, a drive is a slope between its maxima, and all add up. With a straight line that rises,
speed = free speed + mobility x impulse, it has one intersection. A joint assumes the segment on which this lies; the
articulation is solved with the assumed segments, and solved again as long as a solution lies on other ones (an active-set, or
semi-smooth Newton, method). Vertical ones are then replaced by steep ones, and the solution is repeated with their impulses
until these no longer change.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.joints import layout as j
from kickdrift.world.tables import JOINT, JOINT_AXES, JOINT_NUMBERS, LINK_NUMBERS, floats, integers

# Impulse of an upright piece per error of speed, over the mass that it moves. The remaining error is removed by solutions that
# begin with its impulse.
_RIGID = 1e6

# Codes of pieces: upright ones, and others, which are _OPEN and three digits to the base 3
AT_LOWER, AT_UPPER, STICKS, AT_SPEED, _OPEN = 1, 2, 3, 4, 5


@compiled(inline=True, cached=False)
def _sign(a: float, side: int) -> float:
    return 1.0 if a > 0.0 else -1.0 if a < 0.0 else float(-side)


@compiled(inline=True, cached=False)
def _drive(s: float, constant: float, slope: float, maximum: float) -> float:
    return min(maximum, max(-maximum, constant - slope * s))


@compiled(inline=True, cached=False)
def solution(
    free: float,
    mobility: float,
    lower: float,
    upper: float,
    friction: float,
    motor: float,
    motor_speed: float,
    constant: float,
    slope: float,
    maximum: float,
) -> tuple[int, bool, float, float]:
    """Find the piece of a law that meets the line speed = free + mobility x impulse.

    Parameters
    ----------
    lower, upper : float
        Least and greatest speed.
    friction, motor : float
        Greatest impulses, the latter towards `motor_speed`.
    constant, slope, maximum : float
        Drive: impulse = constant - slope x speed, at most `maximum` to either side.

    Returns
    -------
    code : int
        Of the piece.
    held : bool
        Whether it is upright.
    value, slope : float
        Its speed; or its impulse is the value less the slope times the speed.

    Notes
    -----
    The difference of both graphs grows with the speed, so its sign at either side of a piece says where the solution is.
    """
    if lower > -math.inf:
        pull = friction * _sign(-lower, 1) + motor * _sign(motor_speed - lower, 1)
        if lower - free >= mobility * (pull + _drive(lower, constant, slope, maximum)):
            return AT_LOWER, True, lower, 0.0
    if upper < math.inf:
        pull = friction * _sign(-upper, -1) + motor * _sign(motor_speed - upper, -1)
        if upper - free <= mobility * (pull + _drive(upper, constant, slope, maximum)):
            return AT_UPPER, True, upper, 0.0
    others, code = 0.0, _OPEN
    if friction > 0.0:
        wanted = -free / mobility - _drive(0.0, constant, slope, maximum)
        right = wanted < motor * _sign(motor_speed, 1) - friction
        left = wanted > motor * _sign(motor_speed, -1) + friction
        if not (left or right):
            return STICKS, True, 0.0, 0.0
        others += -friction if right else friction
        code += 1 if right else 2
    if motor > 0.0:
        wanted = (motor_speed - free) / mobility - _drive(motor_speed, constant, slope, maximum)
        right = wanted < friction * _sign(-motor_speed, 1) - motor
        left = wanted > friction * _sign(-motor_speed, -1) + motor
        if not (left or right):
            return AT_SPEED, True, motor_speed, 0.0
        others += -motor if right else motor
        code += 3 if right else 6
    if slope > 0.0 and maximum < math.inf:
        if constant + maximum - slope * free < slope * mobility * (others - maximum):
            return code + 9, False, others - maximum, 0.0
        if constant - maximum - slope * free > slope * mobility * (others + maximum):
            return code + 18, False, others + maximum, 0.0
    return code, False, others + constant, slope


@compiled(inline=True, cached=False)
def _piece(
    work: Any, link: int, k: int, speed: float, impulse: float, mobility: float
) -> tuple[int, bool, float, float]:
    """Find the piece of a law that meets the line of a mobility through a speed and an impulse; see `solution`."""
    law = j.LAW + j.LAW_NUMBERS * k
    return solution(
        speed - mobility * impulse,
        mobility,
        work[link, law + j.LEAST_SPEED],
        work[link, law + j.GREATEST_SPEED],
        work[link, law + j.FRICTION_BOUND],
        work[link, law + j.MOTOR_BOUND],
        work[link, law + j.MOTOR_TARGET],
        work[link, law + j.LAW_CONSTANT],
        work[link, law + j.LAW_SLOPE],
        work[link, law + j.DRIVE_BOUND],
    )


@compiled(cached=False)
def law_impulse(world: int, joint: int, k: int, link: int, moved: float) -> float:
    """Return the impulse that a law adds to the one before the solution, where the speed has changed by `moved`."""
    work, before = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)[joint, j.JOINT_IMPULSE + k]
    mobility = floats(world, JOINT_AXES)[6 * joint + k, j.MOBILITY] / _RIGID
    speed, base = work[link, j.AXIS_SPEED + k] + moved, work[link, j.LAW_BASE + k]
    _, held, value, slope = _piece(work, link, k, speed, before + base, mobility)
    impulse: float = base + (value - speed) / mobility if held else value - slope * speed - before
    return impulse


@compiled(cached=False)
def update_law_states(world: int, joint: int, link: int, first: bool) -> bool:
    """Assume the pieces on which the solution lies, and return whether it was found with them."""
    laws, numbers = integers(world, JOINT)[joint, j.LAWS], floats(world, JOINT_NUMBERS)
    work, settled = floats(world, LINK_NUMBERS), True
    for k in range(6):
        if not laws >> k & 1:
            continue
        mobility = floats(world, JOINT_AXES)[6 * joint + k, j.MOBILITY]
        before, rigid, base = work[link, j.AXIS_SPEED + k], mobility / _RIGID, work[link, j.LAW_BASE + k]
        speed, impulse = before + work[link, j.ACCEPTED_DELTA_SPEED + k], numbers[joint, j.JOINT_IMPULSE + k] + base
        code, held, value, slope = _piece(work, link, k, speed, impulse, mobility if first else rigid)
        settled = settled and code == work[link, j.LAW_STATE + k]
        work[link, j.LAW_STATE + k] = code
        work[link, j.SLOPE + k] = 1.0 / rigid if held else slope
        free = base if held else value - numbers[joint, j.JOINT_IMPULSE + k]
        work[link, j.PUSH + k] = free + (value - before) / rigid if held else free - slope * before
    return settled


@compiled(cached=False)
def fix_laws(world: int, joint: int, link: int) -> None:
    """Fix the impulses of motors and friction that hold a speed to those of the accepted solution, within their bounds.

    Where no solution is found, they would hold that speed whatever it takes. Limits and drives keep their assumed pieces.
    """
    laws, numbers, work = (
        integers(world, JOINT)[joint, j.LAWS],
        floats(world, JOINT_NUMBERS),
        floats(world, LINK_NUMBERS),
    )
    for k in range(6):
        if not laws >> k & 1:
            continue
        law, state = j.LAW + j.LAW_NUMBERS * k, work[link, j.LAW_STATE + k]
        if state != STICKS and state != AT_SPEED:
            continue
        friction, motor = work[link, law + j.FRICTION_BOUND], work[link, law + j.MOTOR_BOUND]
        target = work[link, law + j.MOTOR_TARGET]
        way, speed = _sign(target, 1), 0.0 if state == STICKS else target
        others, most = (motor * way, friction) if state == STICKS else (-friction * way, motor)
        if target == 0.0:  # a brake and friction hold together
            others, most = 0.0, friction + motor
        constant, slope = work[link, law + j.LAW_CONSTANT], work[link, law + j.LAW_SLOPE]
        middle = others + _drive(speed, constant, slope, work[link, law + j.DRIVE_BOUND])
        middle -= numbers[joint, j.JOINT_IMPULSE + k]
        work[link, j.PUSH + k] = min(max(work[link, j.ACCEPTED_IMPULSE + k], middle - most), middle + most)
        work[link, j.SLOPE + k] = 0.0


@compiled(cached=False)
def refine_laws(world: int, joint: int, link: int) -> float:
    """Let vertical segments begin with the impulses of the solution, and return the largest speed that it leaves there."""
    laws, work, worst = integers(world, JOINT)[joint, j.LAWS], floats(world, LINK_NUMBERS), 0.0
    for k in range(6):
        if laws >> k & 1:
            given = work[link, j.PUSH + k] - work[link, j.SLOPE + k] * work[link, j.ACCEPTED_DELTA_SPEED + k]
            if work[link, j.LAW_STATE + k] < _OPEN:
                worst = max(worst, abs(given - work[link, j.LAW_BASE + k]) / work[link, j.SLOPE + k])
            work[link, j.LAW_BASE + k] = given
    return worst
