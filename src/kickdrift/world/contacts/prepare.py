"""From manifolds to constraints: coloured so that no two of a colour move the same body, and laid out in lanes."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import prefetch
from kickdrift.core.vectors import (
    Symmetric,
    Vector,
    applied,
    cross,
    dot,
    length,
    minus,
    normal_to,
    plus,
    times,
    turned,
)
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.update import FRICTION, ROLLING, SURFACE_VELOCITY, placed_pose
from kickdrift.world.flight import AWAKE
from kickdrift.world.settings import CONTACT_DAMPING, CONTACT_HERTZ, SLOP, STEP, SUBSTEPS
from kickdrift.world.tables import (
    BODY,
    COLOURED,
    COLOURS,
    CONTACT,
    GROUPS,
    LANES,
    MANIFOLD,
    PLACE,
    POSE,
    RESPONSE,
    SETTINGS,
    SHAPE,
    flat,
    floats,
    integers,
    room,
    rows,
    set_rows,
)
from kickdrift.world.trouble import ask_for_room

_COLOURS = 62
# Of the spring, times the substep. A pyramid of twenty rows sways from 0.2 on, and one of 0.15 leaves it standing.
STIFFEST = 0.15
OVERFLOW = _COLOURS  # contacts that found no colour: one by one, in groups of their own


@compiled
def colour(t: float, h: float, world: int) -> None:
    """Give every contact that has points a colour, and every colour its groups of lanes.

    Greedy, in the order of the contacts: the first colour that neither body has yet. Bodies that do not move have none.
    """
    contact, response, body = integers(world, CONTACT), floats(world, RESPONSE), integers(world, BODY)
    taken, colours = integers(world, COLOURED), integers(world, COLOURS)
    for k in range(rows(world, COLOURED)):
        taken[k, 0] = 0
    for k in range(_COLOURS + 1):
        colours[k, 0] = 0
    for row in range(rows(world, CONTACT)):
        contact[row, c.PLACE_IN_GROUPS] = -1
        a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
        if contact[row, c.POINTS] == 0 or contact[row, c.STATE] & c.SENSOR:
            continue
        if body[a, AWAKE] == 0 and body[b, AWAKE] == 0:
            continue
        moves_a, moves_b = response[a, 0] > 0.0, response[b, 0] > 0.0
        used = (taken[a, 0] if moves_a else 0) | (taken[b, 0] if moves_b else 0)
        k = 0
        while k < _COLOURS and used >> k & 1:
            k += 1
        if k < _COLOURS:
            if moves_a:
                taken[a, 0] |= 1 << k
            if moves_b:
                taken[b, 0] |= 1 << k
        contact[row, c.PLACE_IN_GROUPS] = k
        colours[k, 0] += 1
    first = 0
    for k in range(_COLOURS + 1):
        count = colours[k, 0]
        colours[k, 1] = first
        first += count if k == OVERFLOW else (count + c.WIDTH - 1) // c.WIDTH
        colours[k, 2] = first
    if first > room(world, GROUPS):
        ask_for_room(world, GROUPS, first)
        return
    if first * c.FIELDS * c.WIDTH > room(world, LANES):
        ask_for_room(world, LANES, first * c.FIELDS * c.WIDTH)
        return
    set_rows(world, GROUPS, first)


@compiled
def prepare(t: float, h: float, world: int) -> None:
    """Fill the groups with constraints."""
    contact, colours, groups = integers(world, CONTACT), integers(world, COLOURS), integers(world, GROUPS)
    lanes = flat(world, LANES)
    for g in range(rows(world, GROUPS)):
        for lane in range(c.WIDTH):
            groups[g, lane], groups[g, c.WIDTH + lane], groups[g, 2 * c.WIDTH + lane] = 0, 0, -1
    for k in range(_COLOURS + 1):
        colours[k, 0] = 0
    for row in range(rows(world, CONTACT)):
        k = contact[row, c.PLACE_IN_GROUPS]
        if k < 0:
            continue
        index = colours[k, 0]
        colours[k, 0] += 1
        group, lane = colours[k, 1] + index // c.WIDTH, index % c.WIDTH
        if k == OVERFLOW:
            group, lane = colours[k, 1] + index, 0
        contact[row, c.PLACE_IN_GROUPS] = group * c.WIDTH + lane
        groups[group, lane] = contact[row, c.BODY_A]
        groups[group, c.WIDTH + lane] = contact[row, c.BODY_B]
        groups[group, 2 * c.WIDTH + lane] = row
    # Group by group, whose lanes share their cache lines. Their manifolds lie far apart, and are fetched a group ahead: of
    # 5050 boxes, without it this stage takes twice the time.
    manifold, count = flat(world, MANIFOLD), rows(world, GROUPS)
    for g in range(count):
        if g + 1 < count:
            for lane in range(c.WIDTH):
                row = groups[g + 1, 2 * c.WIDTH + lane]
                for line in range(6):
                    prefetch(manifold, MANIFOLD.width * row + 8 * line)
        for lane in range(c.WIDTH):
            own = lanes[g * c.FIELDS * c.WIDTH + lane : (g + 1) * c.FIELDS * c.WIDTH]
            row = groups[g, 2 * c.WIDTH + lane]
            if row >= 0:
                _fill(world, row, own)
                continue
            for k in range(c.FIELDS):
                own[k * c.WIDTH] = 0.0


@compiled(fast=True)
def _fill(world: int, row: int, own: Any) -> None:
    """Make the constraint of one contact; field k is own[k WIDTH]."""
    contact, manifold = integers(world, CONTACT), floats(world, MANIFOLD)
    pose, response, settings = floats(world, POSE), floats(world, RESPONSE), floats(world, SETTINGS)
    shape_a, shape_b = contact[row, c.SHAPE_A], contact[row, c.SHAPE_B]
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    at_a, turn_a = placed_pose(world, shape_a)
    at_b, turn_b = placed_pose(world, shape_b)
    mass_a, mass_b = response[a, 0], response[b, 0]
    inverse_a, inverse_b = _inverse_inertia(response, a), _inverse_inertia(response, b)
    body_a, body_b = (pose[a, 0], pose[a, 1], pose[a, 2]), (pose[b, 0], pose[b, 1], pose[b, 2])
    normal = turned(turn_a, (manifold[row, 0], manifold[row, 1], manifold[row, 2]))
    points = contact[row, c.POINTS]
    weight = 0.0
    centre = (0.0, 0.0, 0.0)
    for k in range(points):
        place = c.POINT + c.POINT_SIZE * k
        on_a = plus(at_a, turned(turn_a, (manifold[row, place], manifold[row, place + 1], manifold[row, place + 2])))
        on_b = plus(
            at_b, turned(turn_b, (manifold[row, place + 3], manifold[row, place + 4], manifold[row, place + 5]))
        )
        gap = dot(normal, minus(on_b, on_a))
        point = times(0.5, plus(on_a, on_b))
        arm_a, arm_b = cross(minus(point, body_a), normal), cross(minus(point, body_b), normal)
        stiffness = mass_a + mass_b + dot(arm_a, applied(inverse_a, arm_a)) + dot(arm_b, applied(inverse_b, arm_b))
        f = c.P + c.POINT_FIELDS * k
        _put(own, f + c.ARM_A, arm_a)
        _put(own, f + c.ARM_B, arm_b)
        own[(f + c.GAP) * c.WIDTH] = gap
        own[(f + c.POINT_MASS) * c.WIDTH] = 1.0 / stiffness
        own[(f + c.IMPULSE) * c.WIDTH] = manifold[row, place + c.NORMAL_IMPULSE]
        # Points that touch carry the friction: the centre must not jump where a distant one comes or goes.
        share = min(max(2.0 - gap / (4.0 * settings[0, SLOP]), 1e-10), 1.0)
        weight += share
        centre = plus(centre, times(share, point))
    centre = times(1.0 / weight, centre)
    for k in range(c.P + c.POINT_FIELDS * points, c.FIELDS):
        own[k * c.WIDTH] = 0.0
    for k in range(points):
        place = c.POINT + c.POINT_SIZE * k
        on_b = plus(
            at_b, turned(turn_b, (manifold[row, place + 3], manifold[row, place + 4], manifold[row, place + 5]))
        )
        off = minus(on_b, centre)
        off = minus(off, times(dot(off, normal), normal))
        own[(c.P + c.POINT_FIELDS * k + c.LEVER) * c.WIDTH] = length(off)
    _put(own, c.N, normal)
    own[c.MASS_A * c.WIDTH], own[c.MASS_B * c.WIDTH] = mass_a, mass_b
    _fill_softness(settings, mass_a == 0.0 or mass_b == 0.0, own)
    _fill_friction(world, row, normal, minus(centre, body_a), minus(centre, body_b), own)


@compiled(fast=True)
def _fill_friction(world: int, row: int, normal: Vector, arm_a: Vector, arm_b: Vector, own: Any) -> None:
    contact, manifold, place = integers(world, CONTACT), floats(world, MANIFOLD), floats(world, PLACE)
    response = floats(world, RESPONSE)
    shape_a, shape_b = contact[row, c.SHAPE_A], contact[row, c.SHAPE_B]
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    inverse_a, inverse_b = _inverse_inertia(response, a), _inverse_inertia(response, b)
    first = normal_to(normal)
    second = cross(normal, first)
    _put(own, c.T, first)
    _put(own, c.CENTRE_A, arm_a)
    _put(own, c.CENTRE_B, arm_b)
    mass = response[a, 0] + response[b, 0]
    a1, a2, b1, b2 = cross(arm_a, first), cross(arm_a, second), cross(arm_b, first), cross(arm_b, second)
    k11 = mass + dot(a1, applied(inverse_a, a1)) + dot(b1, applied(inverse_b, b1))
    k22 = mass + dot(a2, applied(inverse_a, a2)) + dot(b2, applied(inverse_b, b2))
    k12 = dot(a1, applied(inverse_a, a2)) + dot(b1, applied(inverse_b, b2))
    scale = 1.0 / (k11 * k22 - k12 * k12)
    own[c.GRIP * c.WIDTH] = k22 * scale
    own[(c.GRIP + 1) * c.WIDTH] = k11 * scale
    own[(c.GRIP + 2) * c.WIDTH] = -k12 * scale
    own[c.FRICTION * c.WIDTH] = math.sqrt(place[shape_a, FRICTION] * place[shape_b, FRICTION])
    slide = minus(_surface_velocity(world, shape_a), _surface_velocity(world, shape_b))
    own[c.SLIDE * c.WIDTH], own[(c.SLIDE + 1) * c.WIDTH] = dot(slide, first), dot(slide, second)
    f = c.FRICTION_IMPULSE
    impulse = (manifold[row, f], manifold[row, f + 1], manifold[row, f + 2])
    own[c.SLID * c.WIDTH], own[(c.SLID + 1) * c.WIDTH] = dot(impulse, first), dot(impulse, second)
    spin = dot(normal, applied(inverse_a, normal)) + dot(normal, applied(inverse_b, normal))
    own[c.TWIST * c.WIDTH] = 1.0 / spin if spin > 0.0 else 0.0
    own[(c.TWIST + 1) * c.WIDTH] = manifold[row, c.TWIST_IMPULSE]
    resistance = max(place[shape_a, ROLLING], place[shape_b, ROLLING])
    own[c.ROLL * c.WIDTH] = resistance
    for k in range(1, 5):
        own[(c.ROLL + k) * c.WIDTH] = 0.0
    if resistance > 0.0:
        trace = 0.0
        for k in range(3):
            trace += inverse_a[k] + inverse_b[k]
        # The mean of the three moments of inertia: one number serves every axis of rolling.
        own[(c.ROLL + 1) * c.WIDTH] = 3.0 / trace if trace > 0.0 else 0.0
        f = c.ROLLING_IMPULSE
        _put(own, c.ROLL + 2, (manifold[row, f], manifold[row, f + 1], manifold[row, f + 2]))


@compiled(inline=True)
def _fill_softness(settings: Any, fixed: bool, own: Any) -> None:
    """Damped spring of so many hertz, implicit and whatever the masses; twice as stiff against what cannot move."""
    h = settings[0, STEP] / settings[0, SUBSTEPS]
    hertz = settings[0, CONTACT_HERTZ] if settings[0, CONTACT_HERTZ] > 0.0 else STIFFEST / h
    damping = settings[0, CONTACT_DAMPING]
    if fixed:
        hertz, damping = 2.0 * hertz, 0.5 * damping
    rate = 2.0 * math.pi * hertz
    a1 = 2.0 * damping + h * rate
    a2 = h * rate * a1
    a3 = 1.0 / (1.0 + a2)
    own[c.SOFTNESS * c.WIDTH] = rate / a1
    own[(c.SOFTNESS + 1) * c.WIDTH] = a2 * a3
    own[(c.SOFTNESS + 2) * c.WIDTH] = a3


@compiled(inline=True)
def _surface_velocity(world: int, shape: int) -> Vector:
    place, pose = floats(world, PLACE), floats(world, POSE)
    body = integers(world, SHAPE)[shape, 1]
    s = SURFACE_VELOCITY
    q = (pose[body, 3], pose[body, 4], pose[body, 5], pose[body, 6])
    return turned(q, (place[shape, s], place[shape, s + 1], place[shape, s + 2]))


@compiled(inline=True)
def _put(own: Any, field: int, vector: Vector) -> None:
    for k in range(3):
        own[(field + k) * c.WIDTH] = vector[k]


@compiled(inline=True)
def _inverse_inertia(response: Any, body: int) -> Symmetric:
    return (
        response[body, 1],
        response[body, 2],
        response[body, 3],
        response[body, 4],
        response[body, 5],
        response[body, 6],
    )
