"""Detection of energy errors of joints whose bodies move too far in a substep, for a warning that is issued once.

The equations of an island that turns by half a radian or more in a substep may have a distant solution, or none: the velocities
that joints then allow are far from the present ones. The same happens, at any speed, to loops that are pulled taut or pass
through a singular pose, and to a chain whose light end cracks like a whip. Energy that an island loses or gains in a step and
that gravity, forces, damping, motors and friction do not account for is an error due to the length of the substep. Islands with
contacts are not judged, nor those with active limits, whose losses are arbitrary, nor slow ones whose initial velocities
violate their joints.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import cross, dot, length, minus, plus, product, times, turned
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.direct_bodies import body_of
from kickdrift.world.direct.energy_drift import drift_of_energy, forget_drift, judged_since
from kickdrift.world.direct.island_velocities import energy_of
from kickdrift.world.direct.loop_closures import has_loops
from kickdrift.world.direct.substep_estimate import LONG_TURN, refinement
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.kinematics import axis_unit
from kickdrift.world.layout import BODY_KIND, DAMPING, KINEMATIC, MASS, TURN_DAMPING
from kickdrift.world.settings import (
    FAST_BODY,
    FAST_LOSS,
    FAST_RATE,
    FAST_SINCE,
    FAST_SUBSTEP,
    FAST_TIME,
    GRAVITY,
    SUBSTEPS,
)
from kickdrift.world.step.status import TURNS_TOO_FAST, WARNING
from kickdrift.world.tables import (
    BODY,
    DELTA_POSE,
    FORCE,
    INERTIA,
    ISLAND,
    ISLAND_JOINT,
    JOINT,
    JOINT_AXES,
    JOINT_NUMBERS,
    LINK,
    MOTION,
    POSE,
    SETTINGS,
    STARTED_MOTION,
    STARTED_POSE,
    STEP_STATUS,
    floats,
    integers,
    rows,
)

# Turns in a substep from which single steps of islands without and with loops are judged, rad. MOST is the part of its energy
# that an island may lose or gain in many steps, or in one with a turn above `LONG_TURN`, and LEAP in any other: chains of six
# random rods jump by up to 2 %, and are within 1 % after 5 s.
JUDGED_TURN, JUDGED_TURN_OF_LOOPS = 0.1, 0.01
MOST, LEAP = 0.01, 0.03

RESTING_TURN = 1e-3  # rad in a step, below which rounding errors may be all that a body has

TINY = 1e-300  # J

# Fraction of the rate of its fastest body by which initial velocities of an island may violate its joints.
_ALLOWED = 1e-3


@compiled
def note_losses(t: float, h: float, world: int) -> None:
    """Note the first island whose energy changes in the step by more than it should, for a warning."""
    islands, settings, status = integers(world, ISLAND), floats(world, SETTINGS), integers(world, STEP_STATUS)
    substep = h / settings[0, SUBSTEPS]
    if status[0, WARNING] & TURNS_TOO_FAST:
        return
    for island in range(rows(world, ISLAND)):
        if islands[island, d.FIRST_JOINT] == islands[island, d.AFTER_JOINT]:
            continue
        if islands[island, d.TOUCHES] != 0:
            forget_drift(world, island)
            continue
        body, rate = _fastest(world, island)
        far = islands[island, d.GIVEN_UP] != 0 or rate * substep > LONG_TURN
        judged = JUDGED_TURN_OF_LOOPS if has_loops(world, island) else JUDGED_TURN
        loss, since = drift_of_energy(world, island, t, h), judged_since(world, island)
        found = abs(loss) > MOST and rate * h > RESTING_TURN
        if not found and (far or rate * substep > judged):
            loss, since = _loss(world, island, h), t - h
            found = abs(loss) > (MOST if far else LEAP) and (far or _began_as_joints_allow(world, island, rate))
        if found:
            settings[0, FAST_BODY], settings[0, FAST_TIME], settings[0, FAST_SINCE] = body, t, since
            settings[0, FAST_RATE], settings[0, FAST_LOSS] = rate, loss
            settings[0, FAST_SUBSTEP] = substep / refinement(world, island, rate * substep, substep)
            status[0, WARNING] |= TURNS_TOO_FAST
            return


@compiled(cached=False)
def _fastest(world: int, island: int) -> tuple[int, float]:
    """Return the body of an island that turns the fastest before or after the step, and its rate, rad/s."""
    own = integers(world, ISLAND)[island]
    before, after, most, fastest = floats(world, STARTED_MOTION), floats(world, MOTION), -1.0, 0
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        body = body_of(world, node)
        old, new = vector_at(before, body, j.ANGULAR_PART), vector_at(after, body, j.ANGULAR_PART)
        square = max(dot(old, old), dot(new, new))
        if square > most:
            most, fastest = square, body
    return fastest, math.sqrt(most)


@compiled(cached=False)
def _loss(world: int, island: int, h: float) -> float:
    """Return the fraction of its energy that an island has lost in a step without a cause, negative for a gain.

    NaN if it cannot be determined.
    """
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    inertia, start, end, least, most = floats(world, INERTIA), 0.0, 0.0, 0.0, 0.0
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        body = body_of(world, node)
        energy = energy_of(world, body, STARTED_MOTION, STARTED_POSE)
        start += energy
        end += energy_of(world, body, MOTION, POSE)
        work = _work(world, body, h)
        least += work[0] - 2.0 * h * max(inertia[body, DAMPING], inertia[body, TURN_DAMPING]) * energy
        most += work[1]
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        work = _work_of_joint(world, links[order[place, 0], j.LINK_JOINT])
        least, most = least + work[0], most + work[1]
    scale = max(max(start, end), max(max(abs(least), abs(most)), TINY))
    lost = (start + least - end) / scale
    return lost if not lost < 0.0 else min((start + most - end) / scale, 0.0)


@compiled(cached=False)
def _began_as_joints_allow(world: int, island: int, rate: float) -> bool:
    """Whether the velocities before the step satisfied points and hinge axes of joints, up to `_ALLOWED` times a rate."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    joints, numbers, worst = integers(world, JOINT), floats(world, JOINT_NUMBERS), 0.0
    motion, pose = floats(world, STARTED_MOTION), floats(world, STARTED_POSE)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        joint = links[order[place, 0], j.LINK_JOINT]
        a, b = joints[joint, j.BODY_A], joints[joint, j.BODY_B]
        arm_b = turned(quaternion_at(pose, b, j.ANGULAR_PART), vector_at(numbers, joint, j.ANCHOR_B))
        arm_a = plus(minus(vector_at(pose, b, j.LINEAR_PART), vector_at(pose, a, j.LINEAR_PART)), arm_b)
        turn_a, turn_b = vector_at(motion, a, j.ANGULAR_PART), vector_at(motion, b, j.ANGULAR_PART)
        v = minus(vector_at(motion, b, j.LINEAR_PART), vector_at(motion, a, j.LINEAR_PART))
        v, w = plus(v, minus(cross(turn_b, arm_b), cross(turn_a, arm_a))), minus(turn_b, turn_a)
        if joints[joint, j.ANGULAR] == j.HINGE:
            frame = product(quaternion_at(pose, a, j.ANGULAR_PART), quaternion_at(numbers, joint, j.FRAME_A))
            axis = turned(frame, axis_unit(joints[joint, j.PIVOT]))
            worst = max(worst, length(cross(w, axis)))
        if joints[joint, j.LINEAR] == j.POINT and length(arm_b) > 0.0:
            worst = max(worst, length(v) / length(arm_b))
    return worst < _ALLOWED * rate


@compiled(cached=False)
def _work(world: int, body: int, h: float) -> tuple[float, float]:
    """Return bounds of the work of gravity and other forces on a body in the step, J.

    That of gravity is in between the one at the present velocities and the one at those half a kick later.
    Other forces are taken to be constant, as in the last substep, and to act along the displacement of the body, or at its
    velocity before or after the step: the three estimates bracket the work in the substeps.
    """
    mass, gravity = floats(world, INERTIA)[body, MASS], vector_at(floats(world, SETTINGS), 0, GRAVITY)
    before, after, force = floats(world, STARTED_MOTION), floats(world, MOTION), floats(world, FORCE)
    pose, started = floats(world, POSE), floats(world, STARTED_POSE)
    way = minus(vector_at(pose, body, j.LINEAR_PART), vector_at(started, body, j.LINEAR_PART))
    turn = vector_at(floats(world, DELTA_POSE), body, j.ANGULAR_PART)
    gained = minus(vector_at(after, body, j.LINEAR_PART), vector_at(before, body, j.LINEAR_PART))
    fall = mass * dot(gravity, way)
    lag = 0.5 * h / floats(world, SETTINGS)[0, SUBSTEPS] * mass * dot(gravity, gained)
    least, most = fall - max(lag, 0.0), fall - min(lag, 0.0)
    for part in (j.LINEAR_PART, j.ANGULAR_PART):
        push = vector_at(force, body, part)
        old, new = h * dot(push, vector_at(before, body, part)), h * dot(push, vector_at(after, body, part))
        along = dot(push, way if part == j.LINEAR_PART else turn)
        least, most = least + min(min(old, new), along), most + max(max(old, new), along)
    return least, most


@compiled(cached=False)
def _work_of_joint(world: int, joint: int) -> tuple[float, float]:
    """Return bounds of the work of motors, drives and friction of a hinge in the step, J, or NaN if there are none.

    There are none for limits, which stop their axis within the step, laws of other axes, and joints to kinematic bodies.
    """
    joints, numbers, laws = integers(world, JOINT), floats(world, JOINT_NUMBERS), floats(world, JOINT_AXES)
    a, b = joints[joint, j.BODY_A], joints[joint, j.BODY_B]
    bodies, before, after = integers(world, BODY), floats(world, STARTED_MOTION), floats(world, MOTION)
    least, most = 0.0, 0.0
    if bodies[a, BODY_KIND] == KINEMATIC or bodies[b, BODY_KIND] == KINEMATIC:
        return math.nan, math.nan
    for k in range(6):
        impulse = numbers[joint, j.TOTAL + k]
        if joints[joint, j.LAWS] >> k & 1 and impulse != 0.0:
            row = laws[6 * joint + k]
            if (
                row[j.LOWER_LIMIT] > -math.inf
                or row[j.UPPER_LIMIT] < math.inf
                or joints[joint, j.ANGULAR] != j.HINGE
                or k < 3
            ):
                return math.nan, math.nan
            axis = times(impulse, vector_at(numbers, joint, j.AXES + 3 * k))
            old = minus(vector_at(before, b, j.ANGULAR_PART), vector_at(before, a, j.ANGULAR_PART))
            new = minus(vector_at(after, b, j.ANGULAR_PART), vector_at(after, a, j.ANGULAR_PART))
            least, most = least + min(dot(axis, old), dot(axis, new)), most + max(dot(axis, old), dot(axis, new))
    return least, most
