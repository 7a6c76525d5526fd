"""The two letters of a world that are flows: the kick by forces, and the drift of free rigid bodies.

A free rigid body conserves its angular momentum L = R I R^T w, while its angular velocity w changes. The drift turns it by
exp(h w*), where w* is chosen to conserve energy too: of all rotations that keep L fixed in space, those about
w* = I^-1 (P + P') / 2 conserve P . I^-1 P, because P' - P is perpendicular to the axis (P, P': angular momentum in the body's
axes before and after). Between the two letters the angular velocity of a body is w*, with which it will drift, so that contacts
and joints act on the actual motion.

`KICKED` carries L from step to step: computed anew from the angular velocity after every drift, it would accumulate rounding
errors.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import (
    Quaternion,
    Vector,
    applied,
    dot,
    exponential,
    minus,
    plus,
    product,
    times,
    turned,
    turned_back,
    turned_symmetric,
    unit,
)
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.free_rotation import free_rotation, mean_turn, turned_product
from kickdrift.world.layout import (
    ADDED,
    ANGULAR_VELOCITY,
    AWAKE,
    BODY_INERTIA,
    BODY_KIND,
    DAMPING,
    DISPLACEMENT,
    DYNAMIC,
    FORCE_BEFORE,
    FREE_KICK,
    HALF_KICK,
    IMPACT_TIME,
    INERTIA_KIND,
    INVERSE_INERTIA,
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    KICK,
    KICKED_ANGULAR_VELOCITY,
    KICKED_VELOCITY,
    KINEMATIC,
    LEFT_POSE,
    LEFT_TURN,
    LINK_COUNT,
    ORIENTATION,
    POSITION,
    ROTATION,
    SPIN,
    SUBSTEP_FORCE,
    SUBSTEP_TORQUE,
    TUMBLES,
    TURN_DAMPING,
    VELOCITY,
    WHOLE_KICK,
)
from kickdrift.world.settings import GRAVITY, LAST_SUBSTEP, MIDPOINT, PLANE_NORMAL, SUBSTEPS
from kickdrift.world.tables import (
    BODY,
    DELTA_POSE,
    FORCE,
    INERTIA,
    INVERSE_MASS,
    KICKED,
    LOAD,
    MEMBER,
    MOTION,
    POSE,
    SETTINGS,
    STARTED_IMPULSE,
    floats,
    integers,
    rows,
    set_rows,
)


@compiled
def finish(t: float, h: float, world: int) -> None:
    """Clear the loads and what is kept for a rollback, and note the length of the substeps, to which impulses belong."""
    load, settings = floats(world, LOAD), floats(world, SETTINGS)
    settings[0, LAST_SUBSTEP] = h / settings[0, SUBSTEPS]
    for body in range(rows(world, LOAD)):
        for k in range(6):
            load[body, k] = 0.0
    set_rows(world, STARTED_IMPULSE, 0)


@compiled
def flatten(t: float, h: float, world: int) -> None:
    """Project velocities and angular velocities onto the motions of a planar world."""
    motion, plane = floats(world, MOTION), vector_at(floats(world, SETTINGS), 0, PLANE_NORMAL)
    member = integers(world, MEMBER)
    for place in range(rows(world, MEMBER)):
        body = member[place, 0]
        v, w = vector_at(motion, body, VELOCITY), vector_at(motion, body, ANGULAR_VELOCITY)
        v, w = minus(v, times(dot(plane, v), plane)), times(dot(plane, w), plane)
        for k in range(3):
            motion[body, VELOCITY + k], motion[body, ANGULAR_VELOCITY + k] = v[k], w[k]


@compiled
def kick(t: float, h: float, world: int) -> None:
    """Add h times the accelerations to the velocities, and replace angular velocities by those of the drift, w*.

    Bodies that are marked with HALF_KICK get half of that.
    """
    motion, kicked, force = floats(world, MOTION), floats(world, KICKED), floats(world, FORCE)
    inertia, inverse_mass, pose = floats(world, INERTIA), floats(world, INVERSE_MASS), floats(world, POSE)
    body_kind, settings, member = integers(world, BODY), floats(world, SETTINGS), integers(world, MEMBER)
    for place in range(rows(world, MEMBER)):
        body = member[place, 0]
        if body_kind[body, BODY_KIND] != DYNAMIC or body_kind[body, AWAKE] == 0:
            for k in range(6):
                kicked[body, k] = motion[body, k]
            for k in range(6, 13):
                kicked[body, k] = 0.0
            for k in range(4):  # so that the angular momentum of a body that wakes is computed anew
                kicked[body, LEFT_POSE + k] = 0.0
            continue
        keep = 1.0 / (1.0 + h * inertia[body, DAMPING])
        time = 0.5 * h if kicked[body, KICK] == HALF_KICK else h
        for k in range(3):
            old = motion[body, VELOCITY + k]
            pushed = inverse_mass[body, INVERSE_LINEAR_MASS] * force[body, SUBSTEP_FORCE + k]
            motion[body, VELOCITY + k] = keep * (old + time * (settings[0, GRAVITY + k] + pushed))
            kicked[body, KICKED_VELOCITY + k] = motion[body, VELOCITY + k]
            kicked[body, ADDED + k] = motion[body, VELOCITY + k] - old
        if inertia[body, INERTIA_KIND] == TUMBLES:
            follow_pose(world, body)
        torque = vector_at(force, body, SUBSTEP_TORQUE)
        turn = applied(symmetric_at(inverse_mass, body, INVERSE_INERTIA_IN_WORLD), torque)
        keep = 1.0 / (1.0 + h * inertia[body, TURN_DAMPING])
        for k in range(3):
            motion[body, ANGULAR_VELOCITY + k] = keep * (motion[body, ANGULAR_VELOCITY + k] + time * turn[k])
        if inertia[body, INERTIA_KIND] == TUMBLES:
            _set_mean_turn(body, h, pose, motion, inertia, kicked)
        for k in range(3):
            kicked[body, KICKED_ANGULAR_VELOCITY + k] = motion[body, ANGULAR_VELOCITY + k]
        kicked[body, IMPACT_TIME] = 0.0


@compiled
def follow_pose(world: int, body: int) -> None:
    """Update a body's inverse inertia in the world's axes and its angular momentum, unless it is oriented as the drift left it.

    Bodies that are new, and those that users or joints have turned, need it. In a planar world the inverse inertia is that of a
    rotation about the normal of the plane alone.
    """
    pose, motion, kicked = floats(world, POSE), floats(world, MOTION), floats(world, KICKED)
    inertia, inverse_mass = floats(world, INERTIA), floats(world, INVERSE_MASS)
    same = True
    for k in range(4):
        same = same and pose[body, ORIENTATION + k] == kicked[body, LEFT_POSE + k]
    if same:
        return
    q, moments = quaternion_at(pose, body, ORIENTATION), symmetric_at(inertia, body, BODY_INERTIA)
    inverse = turned_symmetric(q, symmetric_at(inertia, body, INVERSE_INERTIA))
    normal = vector_at(floats(world, SETTINGS), 0, PLANE_NORMAL)
    if dot(normal, normal) > 0.0 and inverse[0] + inverse[1] + inverse[2] > 0.0:
        x, y, z = normal
        per_moment = 1.0 / dot(normal, turned_product(q, moments, normal))
        u, v, w = times(per_moment, normal)
        inverse = (u * x, v * y, w * z, u * y, u * z, v * z)
    spin = turned_product(q, moments, vector_at(motion, body, ANGULAR_VELOCITY))
    for k in range(6):
        inverse_mass[body, INVERSE_INERTIA_IN_WORLD + k] = inverse[k]
    for k in range(3):
        kicked[body, SPIN + k] = spin[k]
        kicked[body, LEFT_TURN + k] = motion[body, ANGULAR_VELOCITY + k]


@compiled
def _set_mean_turn(body: int, h: float, pose: Any, motion: Any, inertia: Any, kicked: Any) -> None:
    """Replace the angular velocity of a body by that of its rotation in free flight, w* = I^-1 (P + P') / 2."""
    q = quaternion_at(pose, body, ORIENTATION)
    moments = symmetric_at(inertia, body, BODY_INERTIA)
    won = minus(vector_at(motion, body, ANGULAR_VELOCITY), vector_at(kicked, body, LEFT_TURN))
    spin = plus(vector_at(kicked, body, SPIN), turned_product(q, moments, won))
    turn = mean_turn(h, q, moments, spin, vector_at(motion, body, ANGULAR_VELOCITY))
    for k in range(3):
        kicked[body, SPIN + k] = spin[k]
        motion[body, ANGULAR_VELOCITY + k] = turn[k]


@compiled
def drift(t: float, h: float, world: int) -> None:
    """Move bodies with their velocities, and rotate them by the exponential of h times their angular velocities."""
    motion, kicked, delta_pose = floats(world, MOTION), floats(world, KICKED), floats(world, DELTA_POSE)
    inertia, inverse_mass, pose = floats(world, INERTIA), floats(world, INVERSE_MASS), floats(world, POSE)
    body_kind, midpoint = integers(world, BODY), floats(world, SETTINGS)[0, MIDPOINT]
    member = integers(world, MEMBER)
    for place in range(rows(world, MEMBER)):
        body = member[place, 0]
        kind = body_kind[body, BODY_KIND]
        if kind < KINEMATIC or body_kind[body, AWAKE] == 0:
            continue
        _translate(body, h, midpoint != 0.0, pose, delta_pose, motion, kicked)
        before, w = quaternion_at(pose, body, ORIENTATION), vector_at(motion, body, ANGULAR_VELOCITY)
        tumbles, spin = inertia[body, INERTIA_KIND] == TUMBLES and kind == DYNAMIC, (0.0, 0.0, 0.0)
        left, turn = h, times(h, w)
        if tumbles:
            moments = symmetric_at(inertia, body, BODY_INERTIA)
            was, last = vector_at(kicked, body, KICKED_ANGULAR_VELOCITY), kicked[body, IMPACT_TIME]
            spin = plus(vector_at(kicked, body, SPIN), turned_product(before, moments, minus(w, was)))
            if body_kind[body, LINK_COUNT] == 0:
                now = applied(symmetric_at(inverse_mass, body, INVERSE_INERTIA_IN_WORLD), spin)
                before, left, w, turn = free_rotation(h, before, moments, spin, now, was, w, last)
        q = unit(product(exponential(times(left, w)), before))
        for k in range(3):
            delta_pose[body, ROTATION + k] += turn[k]
        for k in range(4):
            pose[body, ORIENTATION + k] = q[k]
        if tumbles:
            _store_spin(body, spin, q, motion, kicked, inertia, inverse_mass)


@compiled
def _translate(body: int, h: float, midpoint: bool, pose: Any, delta_pose: Any, motion: Any, kicked: Any) -> None:
    """Move a body with its velocity, and record in KICK whether it is in free flight.

    In free flight the position moves with the mean of the velocities before and after the kick: exact for gravity.
    """
    free = midpoint and kicked[body, KICK] != HALF_KICK
    # Contacts without impulses change a velocity by rounding errors.
    added = abs(kicked[body, ADDED]) + abs(kicked[body, ADDED + 1]) + abs(kicked[body, ADDED + 2])
    for k in range(3):
        alone = abs(motion[body, VELOCITY + k] - kicked[body, KICKED_VELOCITY + k]) <= 1e-9 * added
        free = free and alone
    back = 0.5 if free else 0.0
    if kicked[body, KICK] != HALF_KICK:
        kicked[body, KICK] = FREE_KICK if free else WHOLE_KICK
    for k in range(3):
        way = h * (motion[body, VELOCITY + k] - back * kicked[body, ADDED + k])
        pose[body, POSITION + k] += way
        delta_pose[body, DISPLACEMENT + k] += way


@compiled
def _store_spin(
    body: int, spin: Vector, q: Quaternion, motion: Any, kicked: Any, inertia: Any, inverse_mass: Any
) -> None:
    """Store a body's angular momentum, and what follows from it in its new orientation."""
    inverse = symmetric_at(inertia, body, INVERSE_INERTIA)
    w, inverse_in_world = turned(q, applied(inverse, turned_back(q, spin))), turned_symmetric(q, inverse)
    for k in range(3):
        motion[body, ANGULAR_VELOCITY + k], kicked[body, LEFT_TURN + k] = w[k], w[k]
        kicked[body, SPIN + k] = spin[k]
    for k in range(4):
        kicked[body, LEFT_POSE + k] = q[k]
    for k in range(6):
        inverse_mass[body, INVERSE_INERTIA_IN_WORLD + k] = inverse_in_world[k]


@compiled
def complete_free_kicks(t: float, h: float, world: int) -> None:
    """Add half of the change of forces that are functions to the velocities of bodies that have drifted freely.

    They have moved with v + h a / 2; with v + h (a + a') / 2 at the end the substep is velocity Verlet's, while v + h a is not
    symplectic where forces depend on positions: a spring of 30 rad/s would gain half of its amplitude in a fifth of a second.
    """
    motion, kicked, force = floats(world, MOTION), floats(world, KICKED), floats(world, FORCE)
    inertia, inverse_mass, member = floats(world, INERTIA), floats(world, INVERSE_MASS), integers(world, MEMBER)
    for place in range(rows(world, MEMBER)):
        body = member[place, 0]
        if kicked[body, KICK] == FREE_KICK:
            late = 0.5 * h * inverse_mass[body, INVERSE_LINEAR_MASS] / (1.0 + h * inertia[body, DAMPING])
            for k in range(3):
                motion[body, VELOCITY + k] += late * (force[body, SUBSTEP_FORCE + k] - force[body, FORCE_BEFORE + k])
