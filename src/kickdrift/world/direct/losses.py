"""Energy that joints lose where their bodies turn too far in a substep: it is said, once.

An island that turns by half a radian in a substep, or more, may have its solution far away, or none: the velocities that
joints then allow are far from those that it had. So may one whose loops come to be stretched taut, however slowly. What it
loses in a step to neither gravity, forces, damping, motors nor friction is lost to the length of the substep. Islands that
touch something are not judged, nor those with limits at work, which take what they like.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot, minus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.direct.layout import (
    AFTER_CONTACT,
    AFTER_JOINT,
    AFTER_NODE,
    FIRST_CONTACT,
    FIRST_JOINT,
    FIRST_NODE,
    GIVEN_UP,
)
from kickdrift.world.direct.nodes import body_of
from kickdrift.world.direct.velocities import energy_of
from kickdrift.world.integration import BODY_KIND, DAMPING, KINEMATIC, MASS, TURN_DAMPING
from kickdrift.world.joints.layout import (
    ANGULAR,
    ANGULAR_PART,
    AXES,
    BODY_A,
    BODY_B,
    HINGE,
    LAWS,
    LINEAR_PART,
    LINK_JOINT,
    LOWER_LIMIT,
    TOTAL,
    UPPER_LIMIT,
)
from kickdrift.world.settings import FAST_BODY, FAST_LOSS, FAST_TIME, FAST_TURN, GRAVITY, SUBSTEPS
from kickdrift.world.step_status import TURNS_TOO_FAST, WARNING
from kickdrift.world.tables import (
    BODY,
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

# Turn of a substep from which on any island is judged, rad, and part of its energy that it may lose in a step.
LONG_TURN, MOST = 0.5, 0.01

TINY = 1e-300  # J


@compiled
def note_losses(t: float, h: float, world: int) -> None:
    """Note which islands turn too fast for the energy that they should keep."""
    islands, settings, status = integers(world, ISLAND), floats(world, SETTINGS), integers(world, STEP_STATUS)
    substep = h / settings[0, SUBSTEPS]
    if status[0, WARNING] & TURNS_TOO_FAST:
        return
    for island in range(rows(world, ISLAND)):
        body, rate = _fastest(island, world)
        if (islands[island, GIVEN_UP] == 0 and rate * substep <= LONG_TURN) or not _is_alone(island, world):
            continue
        loss = _loss(island, h, world)
        if loss > MOST:
            settings[0, FAST_BODY], settings[0, FAST_TIME] = body, t
            settings[0, FAST_TURN], settings[0, FAST_LOSS] = rate * substep, loss
            status[0, WARNING] |= TURNS_TOO_FAST
            return


@compiled(cached=False)
def _is_alone(island: int, world: int) -> bool:
    own = integers(world, ISLAND)[island]
    alone: bool = own[FIRST_CONTACT] == own[AFTER_CONTACT]
    return alone


@compiled(cached=False)
def _fastest(island: int, world: int) -> tuple[int, float]:
    """Return the body of an island that turned the fastest before or after the step, and how fast."""
    own = integers(world, ISLAND)[island]
    before, after, most, fastest = floats(world, STARTED_MOTION), floats(world, MOTION), -1.0, 0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        body = body_of(node, world)
        old, new = vector_at(before, body, ANGULAR_PART), vector_at(after, body, ANGULAR_PART)
        square = max(dot(old, old), dot(new, new))
        if square > most:
            most, fastest = square, body
    return fastest, math.sqrt(most)


@compiled(cached=False)
def _loss(island: int, h: float, world: int) -> float:
    """Part of its energy that an island has lost in a step to nothing that takes it; not a number where that cannot be said."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    inertia, start, end, given = floats(world, INERTIA), 0.0, 0.0, 0.0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        body = body_of(node, world)
        energy = energy_of(body, STARTED_MOTION, STARTED_POSE, world)
        start += energy
        end += energy_of(body, MOTION, POSE, world)
        given += _work(body, h, world) - 2.0 * h * max(inertia[body, DAMPING], inertia[body, TURN_DAMPING]) * energy
    for place in range(own[FIRST_JOINT], own[AFTER_JOINT]):
        given += _work_of_joint(links[order[place, 0], LINK_JOINT], world)
    return (start + given - end) / max(max(start, end), max(abs(given), TINY))


@compiled(cached=False)
def _work(body: int, h: float, world: int) -> float:
    """Work that gravity has done on a body in the step, and the least that other forces may have done.

    Those are taken to be as in the last substep, and the speed that they act on to be between those before and after the step.
    """
    mass, gravity = floats(world, INERTIA)[body, MASS], vector_at(floats(world, SETTINGS), 0, GRAVITY)
    before, after, force = floats(world, STARTED_MOTION), floats(world, MOTION), floats(world, FORCE)
    pose, started = floats(world, POSE), floats(world, STARTED_POSE)
    way = minus(vector_at(pose, body, LINEAR_PART), vector_at(started, body, LINEAR_PART))
    total, least = mass * dot(gravity, way), 0.0
    for part in (LINEAR_PART, ANGULAR_PART):
        push = vector_at(force, body, part)
        least += h * min(dot(push, vector_at(before, body, part)), dot(push, vector_at(after, body, part)))
    work: float = total + least
    return work


@compiled(cached=False)
def _work_of_joint(joint: int, world: int) -> float:
    """Least work that motors, drives and friction of a hinge may have done in the step; not a number where none can be told.

    That is of limits, which stop their axis within the step, of laws of other axes, and of joints to what is moved by hand.
    """
    joints, numbers, laws = integers(world, JOINT), floats(world, JOINT_NUMBERS), floats(world, JOINT_AXES)
    a, b = joints[joint, BODY_A], joints[joint, BODY_B]
    bodies, before, after, total = integers(world, BODY), floats(world, STARTED_MOTION), floats(world, MOTION), 0.0
    if bodies[a, BODY_KIND] == KINEMATIC or bodies[b, BODY_KIND] == KINEMATIC:
        return math.nan
    for k in range(6):
        impulse = numbers[joint, TOTAL + k]
        if joints[joint, LAWS] >> k & 1 and impulse != 0.0:
            row = laws[6 * joint + k]
            if row[LOWER_LIMIT] > -math.inf or row[UPPER_LIMIT] < math.inf or joints[joint, ANGULAR] != HINGE or k < 3:
                return math.nan
            axis = times(impulse, vector_at(numbers, joint, AXES + 3 * k))
            old = minus(vector_at(before, b, ANGULAR_PART), vector_at(before, a, ANGULAR_PART))
            new = minus(vector_at(after, b, ANGULAR_PART), vector_at(after, a, ANGULAR_PART))
            total += min(dot(axis, old), dot(axis, new))
    return total
