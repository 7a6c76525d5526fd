"""The impulses of an impact: found for all points of a manifold at once, and applied at a moment of the substep."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import (
    Vector,
    applied,
    cross,
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
from kickdrift.world.columns import symmetric_at, vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.flight import BODY_INERTIA, IMPACT_TIME, SPHERICAL, SPIN
from kickdrift.world.tables import CHANGE, CONTACT, INERTIA, KICKED, MOTION, POSE, RESPONSE, floats, integers

# Of each of four points on the stack: time of the hit, speed, velocity wanted, impulse
HIT_TIME, SPEED, WANTED, IMPULSE, POINT_SIZE = 0, 1, 2, 3, 4
_SWEEPS = 400
_INVERSE = 1  # column of RESPONSE: inverse inertia


@compiled(inline=True)
def field_at(own: Any, field: int) -> Vector:
    """Three fields of a constraint, whose lane `own` begins at."""
    return (own[field * c.WIDTH], own[(field + 1) * c.WIDTH], own[(field + 2) * c.WIDTH])


@compiled(inline=True)
def arms_of(own: Any, point: int) -> tuple[Vector, Vector]:
    """Arms of both bodies to a point, times the normal."""
    arm = field_at(own, c.P + c.POINT_FIELDS * point + c.ARM)
    return arm, minus(arm, cross(field_at(own, c.BETWEEN), field_at(own, c.N)))


@compiled(inline=True)
def glides(own: Any, slid: Vector) -> tuple[Vector, Vector]:
    """Add what to the arms of both bodies, one of which has moved away from the other."""
    share = own[c.GLIDE_A * c.WIDTH]
    return times(share, slid), times(share - 1.0, slid)


@compiled
def find_impulses(world: int, row: int, own: Any, hit: Any, points: int, slid: Vector) -> None:
    """Impulses >= 0 that give every point at least the velocity wanted, zero where it has more: Gauss-Seidel."""
    contact, motion, response = integers(world, CONTACT), floats(world, MOTION), floats(world, RESPONSE)
    a, b, normal = contact[row, c.BODY_A], contact[row, c.BODY_B], field_at(own, c.N)
    inverse_a, inverse_b = symmetric_at(response, a, _INVERSE), symmetric_at(response, b, _INVERSE)
    mass, aside = response[a, 0] + response[b, 0], glides(own, cross(slid, normal))
    v = dot(normal, minus(vector_at(motion, b, 0), vector_at(motion, a, 0)))
    w_a, w_b = vector_at(motion, a, 3), vector_at(motion, b, 3)
    scale = 0.0
    for _ in range(_SWEEPS):
        largest = 0.0
        for k in range(points):
            p = POINT_SIZE * k
            if hit[p + WANTED] == -1e300:
                continue
            arm_a, arm_b = arms_of(own, k)
            arm_a, arm_b = plus(arm_a, aside[0]), plus(arm_b, aside[1])
            missing = hit[p + WANTED] - (v + dot(arm_b, w_b) - dot(arm_a, w_a))
            old = hit[p + IMPULSE]
            # Of now: bodies that spin fast have turned since the step began, and another mass would diverge.
            yielding = mass + dot(arm_a, applied(inverse_a, arm_a)) + dot(arm_b, applied(inverse_b, arm_b))
            new = max(old + missing / yielding, 0.0)
            hit[p + IMPULSE] = new
            d = new - old
            v += d * mass
            w_a = minus(w_a, times(d, applied(inverse_a, arm_a)))
            w_b = plus(w_b, times(d, applied(inverse_b, arm_b)))
            largest = max(largest, abs(d))
            scale = max(scale, new)
        if largest <= 1e-14 * scale:
            return


@compiled
def strike(world: int, row: int, own: Any, hit: Any, points: int, slid: Vector, when: float) -> None:
    """Apply the impulses, and friction for as much as they carry, at a time of the substep."""
    contact, motion, response = integers(world, CONTACT), floats(world, MOTION), floats(world, RESPONSE)
    a, b, normal = contact[row, c.BODY_A], contact[row, c.BODY_B], field_at(own, c.N)
    inverse_a, inverse_b = symmetric_at(response, a, _INVERSE), symmetric_at(response, b, _INVERSE)
    contact[row, c.STATE] |= c.HIT
    total = 0.0
    turn_a = (0.0, 0.0, 0.0)
    turn_b = (0.0, 0.0, 0.0)
    for k in range(points):
        impulse, (arm_a, arm_b) = hit[POINT_SIZE * k + IMPULSE], arms_of(own, k)
        total += impulse
        turn_a, turn_b = plus(turn_a, times(impulse, arm_a)), plus(turn_b, times(impulse, arm_b))
    push = times(total, normal)
    aside = glides(own, cross(slid, push))
    turn_a, turn_b = plus(turn_a, aside[0]), plus(turn_b, aside[1])
    v_a = minus(vector_at(motion, a, 0), times(response[a, 0], push))
    v_b = plus(vector_at(motion, b, 0), times(response[b, 0], push))
    w_a = minus(vector_at(motion, a, 3), applied(inverse_a, turn_a))
    w_b = plus(vector_at(motion, b, 3), applied(inverse_b, turn_b))
    # Friction at the centre
    first, centre, more = field_at(own, c.T), field_at(own, c.CENTRE), glides(own, slid)
    arm_a, arm_b = plus(centre, more[0]), plus(minus(centre, field_at(own, c.BETWEEN)), more[1])
    second = cross(normal, first)
    slip = minus(plus(v_b, cross(w_b, arm_b)), plus(v_a, cross(w_a, arm_a)))
    s1, s2 = dot(slip, first) - own[c.SLIDE * c.WIDTH], dot(slip, second) - own[(c.SLIDE + 1) * c.WIDTH]
    k11, k22, k12 = field_at(own, c.GRIP)
    f1, f2 = -(k11 * s1 + k12 * s2), -(k12 * s1 + k22 * s2)
    most, size = own[c.FRICTION * c.WIDTH] * total, math.sqrt(f1 * f1 + f2 * f2)
    if size > most:
        f1, f2 = f1 * most / size, f2 * most / size
    grip = plus(times(f1, first), times(f2, second))
    v_a, v_b = minus(v_a, times(response[a, 0], grip)), plus(v_b, times(response[b, 0], grip))
    w_a = minus(w_a, applied(inverse_a, cross(arm_a, grip)))
    w_b = plus(w_b, applied(inverse_b, cross(arm_b, grip)))
    _set(world, a, v_a, w_a, when)
    _set(world, b, v_b, w_b, when)


@compiled
def _set(world: int, body: int, velocity: Vector, turn: Vector, when: float) -> None:
    """Give a body new velocities, and set it back by what they would move it before the impact."""
    if floats(world, RESPONSE)[body, 0] == 0.0:
        return
    motion, kicked, change, pose = (
        floats(world, MOTION),
        floats(world, KICKED),
        floats(world, CHANGE),
        floats(world, POSE),
    )
    back = times(-when, minus(velocity, vector_at(motion, body, 0)))
    turn_back = times(-when, minus(turn, vector_at(motion, body, 3)))
    q = (pose[body, 3], pose[body, 4], pose[body, 5], pose[body, 6])
    inertia = floats(world, INERTIA)
    if inertia[body, SPHERICAL] == 0.0:
        moments = symmetric_at(inertia, body, BODY_INERTIA)
        won = turned(q, applied(moments, turned_back(q, minus(turn, vector_at(motion, body, 3)))))
        responses = turned_symmetric(exponential(turn_back), symmetric_at(floats(world, RESPONSE), body, _INVERSE))
        for k in range(3):
            kicked[body, SPIN + k] += won[k]
        for k in range(6):
            floats(world, RESPONSE)[body, 1 + k] = responses[k]
    for k in range(3):
        motion[body, k], kicked[body, k] = velocity[k], velocity[k]
        motion[body, 3 + k], kicked[body, 3 + k] = turn[k], turn[k]
        pose[body, k] += back[k]
        change[body, k] += back[k]
        change[body, 3 + k] += turn_back[k]
    q = unit(product(exponential(turn_back), q))
    for k in range(4):
        pose[body, 3 + k] = q[k]
    kicked[body, IMPACT_TIME] = when
