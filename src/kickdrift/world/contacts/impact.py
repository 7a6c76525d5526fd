"""Bounces: impacts between the kick and the drift, at the moment in the substep in which they happen.

A point whose gap closes within the substep faster than the bounce speed hits at the time s with the speed u that it then
has. Newton's rule asks for -e u afterwards. The velocities change by an impulse, as if from the start of the substep, and
bodies are set back by what the change would have moved them up to s. So a ball that falls on a floor has the height
e^2 h, whatever the step. Impacts happen one manifold after the other, the points of one at once, until none is left:
momentum goes through a row of balls that touch.
"""

import math
from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
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
    unit,
)
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.looking import RESTITUTION
from kickdrift.world.flight import ADDED, BODY_INERTIA, IMPACT_TIME, SPHERICAL, SPIN
from kickdrift.world.settings import BOUNCE_SPEED, GRAVITY, MIDPOINT, SLOP
from kickdrift.world.tables import (
    CHANGE,
    CONTACT,
    INERTIA,
    KICKED,
    LANES,
    MOTION,
    PLACE,
    POSE,
    RESPONSE,
    SETTINGS,
    flat,
    floats,
    integers,
    rows,
)

_ROUNDS = 100
_SWEEPS = 400
_SIZE = c.FIELDS * c.WIDTH
# Of each of four points on the stack: time of the hit, speed, response, velocity still wanted, impulse
_TIME, _SPEED, _WANTED, _IMPULSE, _POINT_SIZE = 0, 1, 2, 3, 4


@compiled
def bounce(t: float, h: float, world: int) -> None:
    """Let everything bounce that hits something within the substep."""
    contact, place = integers(world, CONTACT), floats(world, PLACE)
    for _ in range(_ROUNDS):
        hits = 0
        for row in range(rows(world, CONTACT)):
            if contact[row, c.PLACE_IN_GROUPS] < 0:
                continue
            e = max(place[contact[row, c.SHAPE_A], RESTITUTION], place[contact[row, c.SHAPE_B], RESTITUTION])
            if e > 0.0:
                hits += _bounce_one(world, row, e, h)
        if hits == 0:
            return


@compiled
def _bounce_one(world: int, row: int, e: float, h: float) -> int:
    """Let one manifold bounce, and return 1 if it did."""
    points = integers(world, CONTACT)[row, c.POINTS]
    hit = carray(floats_on_stack(16), (16,))
    own = _constraint(world, row)
    first = _times_of_hits(world, row, own, hit, points, h)
    if first >= 2.0 * h:
        return 0
    found = _speeds_wanted(world, row, own, hit, points, first, e, h)
    if found == 0:
        return 0
    _find_impulses(world, row, own, hit, points)
    _apply(world, row, own, hit, points, first)
    return 1


@compiled(inline=True)
def _constraint(world: int, row: int) -> Any:
    place = integers(world, CONTACT)[row, c.PLACE_IN_GROUPS]
    begin = place // c.WIDTH * _SIZE + place % c.WIDTH
    return flat(world, LANES)[begin : begin + _SIZE - c.WIDTH + 1]


@compiled(inline=True)
def _vector(own: Any, field: int) -> Vector:
    return (own[field * c.WIDTH], own[(field + 1) * c.WIDTH], own[(field + 2) * c.WIDTH])


@compiled(inline=True)
def _three(table: Any, body: int, column: int) -> Vector:
    return (table[body, column], table[body, column + 1], table[body, column + 2])


@compiled(inline=True)
def _along(table: Any, a: int, b: int, normal: Vector, arm_a: Vector, arm_b: Vector) -> float:
    """Velocity (or displacement) of a point of b against one of a along the normal."""
    linear = dot(normal, minus(_three(table, b, 0), _three(table, a, 0)))
    return linear + dot(arm_b, _three(table, b, 3)) - dot(arm_a, _three(table, a, 3))


@compiled
def _times_of_hits(world: int, row: int, own: Any, hit: Any, points: int, h: float) -> float:
    """Find when and how fast each point hits, and return the first time; beyond h if none does."""
    contact, motion, change, kicked = (
        integers(world, CONTACT),
        floats(world, MOTION),
        floats(world, CHANGE),
        floats(world, KICKED),
    )
    settings = floats(world, SETTINGS)
    a, b, normal = contact[row, c.BODY_A], contact[row, c.BODY_B], _vector(own, c.N)
    slowest = settings[0, BOUNCE_SPEED]
    if slowest < 0.0:
        g = _three(settings, 0, GRAVITY)
        slowest = 4.0 * h * math.sqrt(dot(g, g))
    added = settings[0, MIDPOINT] * dot(normal, minus(_three(kicked, b, ADDED), _three(kicked, a, ADDED)))
    since = max(kicked[a, IMPACT_TIME], kicked[b, IMPACT_TIME])
    first = 2.0 * h
    for k in range(points):
        f = c.P + c.POINT_FIELDS * k
        arm_a, arm_b = _vector(own, f + c.ARM_A), _vector(own, f + c.ARM_B)
        gap = own[(f + c.GAP) * c.WIDTH] + _along(change, a, b, normal, arm_a, arm_b)
        # gap(s) = gap + start s + added / (2 h) s^2: free flight by the midpoint rule; without it, added is 0.
        velocity = _along(motion, a, b, normal, arm_a, arm_b)
        start = velocity - added
        root = start * start - 2.0 * added / h * gap
        when = 2.0 * h
        if gap <= 0.0:
            when = since
        elif root >= 0.0 and math.sqrt(root) > start:
            when = max(2.0 * gap / (math.sqrt(root) - start), since)
        speed = start + added * when / h
        hit[_POINT_SIZE * k + _TIME] = when
        hit[_POINT_SIZE * k + _SPEED] = speed
        # What the solver would stop in this substep hits in it, a few per cent after its end though it may be: the solver
        # asks the velocity after the kick, which in free flight is reached only at the end.
        if speed < -slowest and when < first and (when <= h or gap + h * velocity <= 0.0):
            first = when
    return first


@compiled
def _speeds_wanted(world: int, row: int, own: Any, hit: Any, points: int, first: float, e: float, h: float) -> int:
    """Say which velocity each point that hits at the same time shall have, by Newton's rule; return how many do."""
    contact, motion = integers(world, CONTACT), floats(world, MOTION)
    a, b, normal = contact[row, c.BODY_A], contact[row, c.BODY_B], _vector(own, c.N)
    near = 0.1 * floats(world, SETTINGS)[0, SLOP]
    found = 0
    for k in range(points):
        f = c.P + c.POINT_FIELDS * k
        p = _POINT_SIZE * k
        speed = hit[p + _SPEED]
        hit[p + _IMPULSE] = 0.0
        hit[p + _WANTED] = -1e300
        if speed < 0.0 and (hit[p + _TIME] - first) * -speed <= near:
            velocity = _along(motion, a, b, normal, _vector(own, f + c.ARM_A), _vector(own, f + c.ARM_B))
            hit[p + _WANTED] = velocity - (1.0 + e) * speed
            found += 1
    return found


@compiled
def _find_impulses(world: int, row: int, own: Any, hit: Any, points: int) -> None:
    """Impulses >= 0 that give every point at least the velocity wanted, zero where it has more: Gauss-Seidel."""
    contact, motion, response = integers(world, CONTACT), floats(world, MOTION), floats(world, RESPONSE)
    a, b, normal = contact[row, c.BODY_A], contact[row, c.BODY_B], _vector(own, c.N)
    inverse_a, inverse_b = _inverse_inertia(response, a), _inverse_inertia(response, b)
    mass = response[a, 0] + response[b, 0]
    v = dot(normal, minus(_three(motion, b, 0), _three(motion, a, 0)))
    w_a, w_b = _three(motion, a, 3), _three(motion, b, 3)
    scale = 0.0
    for _ in range(_SWEEPS):
        largest = 0.0
        for k in range(points):
            p, f = _POINT_SIZE * k, c.P + c.POINT_FIELDS * k
            if hit[p + _WANTED] == -1e300:
                continue
            arm_a, arm_b = _vector(own, f + c.ARM_A), _vector(own, f + c.ARM_B)
            missing = hit[p + _WANTED] - (v + dot(arm_b, w_b) - dot(arm_a, w_a))
            old = hit[p + _IMPULSE]
            # Of now: bodies that spin fast have turned since the step began, and another mass would diverge.
            response = mass + dot(arm_a, applied(inverse_a, arm_a)) + dot(arm_b, applied(inverse_b, arm_b))
            new = max(old + missing / response, 0.0)
            hit[p + _IMPULSE] = new
            d = new - old
            v += d * mass
            w_a = minus(w_a, times(d, applied(inverse_a, arm_a)))
            w_b = plus(w_b, times(d, applied(inverse_b, arm_b)))
            largest = max(largest, abs(d))
            scale = max(scale, new)
        if largest <= 1e-14 * scale:
            return


@compiled
def _apply(world: int, row: int, own: Any, hit: Any, points: int, when: float) -> None:
    """Apply the impulses, and friction for as much as they carry, at a time of the substep."""
    contact, motion, response = integers(world, CONTACT), floats(world, MOTION), floats(world, RESPONSE)
    a, b, normal = contact[row, c.BODY_A], contact[row, c.BODY_B], _vector(own, c.N)
    inverse_a, inverse_b = _inverse_inertia(response, a), _inverse_inertia(response, b)
    contact[row, c.STATE] |= c.HIT
    total = 0.0
    turn_a = (0.0, 0.0, 0.0)
    turn_b = (0.0, 0.0, 0.0)
    for k in range(points):
        f, impulse = c.P + c.POINT_FIELDS * k, hit[_POINT_SIZE * k + _IMPULSE]
        total += impulse
        turn_a = plus(turn_a, times(impulse, _vector(own, f + c.ARM_A)))
        turn_b = plus(turn_b, times(impulse, _vector(own, f + c.ARM_B)))
    push = times(total, normal)
    v_a = minus(_three(motion, a, 0), times(response[a, 0], push))
    v_b = plus(_three(motion, b, 0), times(response[b, 0], push))
    w_a = minus(_three(motion, a, 3), applied(inverse_a, turn_a))
    w_b = plus(_three(motion, b, 3), applied(inverse_b, turn_b))
    # Friction at the centre
    first, arm_a, arm_b = _vector(own, c.T), _vector(own, c.CENTRE_A), _vector(own, c.CENTRE_B)
    second = cross(normal, first)
    slip = minus(plus(v_b, cross(w_b, arm_b)), plus(v_a, cross(w_a, arm_a)))
    s1, s2 = dot(slip, first) - own[c.SLIDE * c.WIDTH], dot(slip, second) - own[(c.SLIDE + 1) * c.WIDTH]
    k11, k22, k12 = _vector(own, c.GRIP)
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
    back = times(-when, minus(velocity, _three(motion, body, 0)))
    turn_back = times(-when, minus(turn, _three(motion, body, 3)))
    q = (pose[body, 3], pose[body, 4], pose[body, 5], pose[body, 6])
    inertia = floats(world, INERTIA)
    if inertia[body, SPHERICAL] == 0.0:
        m = BODY_INERTIA
        moments = (
            inertia[body, m],
            inertia[body, m + 1],
            inertia[body, m + 2],
            inertia[body, m + 3],
            inertia[body, m + 4],
            inertia[body, m + 5],
        )
        won = turned(q, applied(moments, turned_back(q, minus(turn, _three(motion, body, 3)))))
        for k in range(3):
            kicked[body, SPIN + k] += won[k]
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


@compiled(inline=True)
def _inverse_inertia(response: Any, body: int) -> Any:
    return (
        response[body, 1],
        response[body, 2],
        response[body, 3],
        response[body, 4],
        response[body, 5],
        response[body, 6],
    )
