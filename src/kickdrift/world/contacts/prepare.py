"""From manifolds to constraints: coloured so that no two of a colour move the same body, and laid out in lanes."""

import math
from typing import Any

from numba import carray

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, turned
from kickdrift.world.collision.dispatch import is_round
from kickdrift.world.collision.narrow_phase import placed_pose, smallest
from kickdrift.world.contacts import filling as r
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.lanes import FILL, FILL_FRICTION, LANE_COUNT, SWEEP
from kickdrift.world.flight import AWAKE, LINK_PLACE
from kickdrift.world.layout import FRICTION, RADIUS, ROLLING, SURFACE_VELOCITY
from kickdrift.world.settings import CONTACT_DAMPING, CONTACT_HERTZ, SLOP, STEP, SUBSTEPS
from kickdrift.world.tables import (
    BODY,
    COLOURED,
    COLOURS,
    CONTACT,
    CONTACT_ROW,
    GROUPS,
    LANES,
    MANIFOLD,
    MOTION,
    PLACE,
    POSE,
    RESPONSE,
    SETTINGS,
    SHAPE,
    SWEEPS,
    flat,
    floats,
    integers,
    room,
    rows,
    set_rows,
)
from kickdrift.world.trouble import ask_for_room

_COLOURS = 62
_RAW = r.RAW * c.WIDTH

sweep = caller(SWEEP)

# Of the spring, times the substep. A pyramid of twenty rows sways from 0.2 on, and one of 0.15 leaves it standing.
STIFFEST = 0.15
# Of the smaller shape: where they have slid past each other by more, arms stay as they are, and masses nearly so.
_FARTHEST = 0.3

OVERFLOW = _COLOURS  # contacts that found no colour: one by one, in groups of their own
LINKED = OVERFLOW + 1  # and those that are solved directly: see `kickdrift.world.direct`


@compiled
def colour(t: float, h: float, world: int) -> None:
    """Give every contact that has points a colour, and every colour its groups of lanes.

    Greedy, in the order of the contacts: the first colour that neither body has yet. Bodies that do not move have none.
    """
    contact, response, body = integers(world, CONTACT), floats(world, RESPONSE), integers(world, BODY)
    taken, colours = integers(world, COLOURED), integers(world, COLOURS)
    for k in range(rows(world, COLOURED)):
        taken[k, 0] = 0
    for k in range(LINKED + 1):
        colours[k, 0] = 0
    for row in range(rows(world, CONTACT)):
        contact[row, c.PLACE_IN_GROUPS] = -1
        a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
        if contact[row, c.POINTS] == 0 or contact[row, c.STATE] & c.SENSOR:
            continue
        if body[a, AWAKE] == 0 and body[b, AWAKE] == 0:
            continue
        moves_a, moves_b = response[a, 0] > 0.0, response[b, 0] > 0.0
        node_a, node_b = body[a, LINK_PLACE] > 0, body[b, LINK_PLACE] > 0
        if (node_a or node_b) and (node_a or not moves_a) and (node_b or not moves_b):
            contact[row, c.PLACE_IN_GROUPS] = LINKED
            colours[LINKED, 0] += 1
            continue
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
    for k in range(LINKED + 1):
        count = colours[k, 0]
        colours[k, 1] = first
        first += count if k >= OVERFLOW else (count + c.WIDTH - 1) // c.WIDTH
        colours[k, 2] = first
    if first > room(world, GROUPS):
        ask_for_room(world, GROUPS, first)
        return
    if first * c.FIELDS * c.WIDTH > room(world, LANES):
        ask_for_room(world, LANES, first * c.FIELDS * c.WIDTH)
        return
    if colours[LINKED, 0] > room(world, CONTACT_ROW):
        ask_for_room(world, CONTACT_ROW, colours[LINKED, 0])
        return
    set_rows(world, CONTACT_ROW, colours[LINKED, 0])
    set_rows(world, GROUPS, first)


@compiled
def prepare(t: float, h: float, world: int) -> None:
    """Fill the groups with constraints."""
    contact, colours, groups = integers(world, CONTACT), integers(world, COLOURS), integers(world, GROUPS)
    lanes = flat(world, LANES)
    for g in range(rows(world, GROUPS)):
        for lane in range(c.WIDTH):
            groups[g, lane], groups[g, c.WIDTH + lane], groups[g, 2 * c.WIDTH + lane] = 0, 0, -1
    for k in range(LINKED + 1):
        colours[k, 0] = 0
    for row in range(rows(world, CONTACT)):
        k = contact[row, c.PLACE_IN_GROUPS]
        if k < 0:
            continue
        index = colours[k, 0]
        colours[k, 0] += 1
        group, lane = colours[k, 1] + index // c.WIDTH, index % c.WIDTH
        if k >= OVERFLOW:
            group, lane = colours[k, 1] + index, 0
        contact[row, c.PLACE_IN_GROUPS] = group * c.WIDTH + lane
        groups[group, lane] = contact[row, c.BODY_A]
        groups[group, c.WIDTH + lane] = contact[row, c.BODY_B]
        groups[group, 2 * c.WIDTH + lane] = row
    raw, sweeps, slop = (
        carray(floats_on_stack(_RAW), (_RAW,)),
        integers(world, SWEEPS),
        floats(world, SETTINGS)[0, SLOP],
    )
    soft, softer = _softness(world, True), _softness(world, False)
    for g in range(rows(world, GROUPS)):
        for lane in range(c.WIDTH):
            row = groups[g, 2 * c.WIDTH + lane]
            if row >= 0:
                _gather(world, row, soft, softer, raw[lane:])
                continue
            for k in range(r.RAW):
                raw[k * c.WIDTH + lane] = 0.0
        own = lanes[g * c.FIELDS * c.WIDTH : (g + 1) * c.FIELDS * c.WIDTH]
        sweep(sweeps[0, FILL], (own, raw, slop, 0.0, 0.0, sweeps[0, LANE_COUNT]))
        sweep(sweeps[0, FILL_FRICTION], (own, raw, slop, 0.0, 0.0, sweeps[0, LANE_COUNT]))


@compiled
def _gather(world: int, row: int, soft: Vector, softer: Vector, raw: Any) -> None:
    """Gather what the constraint of one contact is made of; field k is raw[k WIDTH]."""
    contact, manifold = integers(world, CONTACT), floats(world, MANIFOLD)
    pose, response, place = floats(world, POSE), floats(world, RESPONSE), floats(world, PLACE)
    shape_a, shape_b = contact[row, c.SHAPE_A], contact[row, c.SHAPE_B]
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    at_a, turn_a = placed_pose(world, shape_a)
    at_b, turn_b = placed_pose(world, shape_b)
    for k in range(3):
        raw[(r.NORMAL + k) * c.WIDTH] = manifold[row, c.NORMAL + k]
        raw[(r.ARM_A + k) * c.WIDTH] = at_a[k] - pose[a, k]
        raw[(r.ARM_B + k) * c.WIDTH] = at_b[k] - pose[b, k]
        raw[(r.APART + k) * c.WIDTH] = pose[b, k] - pose[a, k]
        raw[(r.SLID + k) * c.WIDTH] = manifold[row, c.FRICTION_IMPULSE + k]
        raw[(r.ROLLED + k) * c.WIDTH] = manifold[row, c.ROLLING_IMPULSE + k]
    for k in range(4):
        raw[(r.TURN_A + k) * c.WIDTH], raw[(r.TURN_B + k) * c.WIDTH] = turn_a[k], turn_b[k]
    points = contact[row, c.POINTS]
    for k in range(4):
        p = c.POINT + c.POINT_SIZE * k
        for j in range(6):
            raw[(r.ON_A + 6 * k + j) * c.WIDTH] = manifold[row, p + j] if k < points else 0.0
        raw[(r.IMPULSE + k) * c.WIDTH] = manifold[row, c.NORMAL_IMPULSE + k] if k < points else 0.0
    raw[r.COUNT * c.WIDTH] = points
    raw[r.MASS_A * c.WIDTH], raw[r.MASS_B * c.WIDTH] = response[a, 0], response[b, 0]
    loose_a, loose_b = _looseness(world, a), _looseness(world, b)
    for k in range(6):
        raw[(r.INERTIA_A + k) * c.WIDTH] = response[a, 1 + k] + (loose_a if k < 3 else 0.0)
        raw[(r.INERTIA_B + k) * c.WIDTH] = response[b, 1 + k] + (loose_b if k < 3 else 0.0)
    raw[r.FRICTION * c.WIDTH] = math.sqrt(place[shape_a, FRICTION] * place[shape_b, FRICTION])
    raw[r.RESISTANCE * c.WIDTH] = max(place[shape_a, ROLLING], place[shape_b, ROLLING])
    raw[r.TWISTED * c.WIDTH] = manifold[row, c.TWIST_IMPULSE]
    fixed = response[a, 0] == 0.0 or response[b, 0] == 0.0
    slide_a, slide_b = _surface_velocity(world, shape_a), _surface_velocity(world, shape_b)
    for k in range(3):
        raw[(r.SLIDE + k) * c.WIDTH] = slide_a[k] - slide_b[k]
        raw[(r.SOFTNESS + k) * c.WIDTH] = soft[k] if fixed else softer[k]
    raw[r.GLIDE_A * c.WIDTH] = _glide(world, shape_a, shape_b, response[a, 0], response[b, 0])
    raw[r.FARTHEST * c.WIDTH] = _FARTHEST * smallest(place[shape_a, RADIUS], place[shape_b, RADIUS])
    for k in range(3):
        fast = contact[row, c.STATE] & c.FAST
        raw[(r.OFFSET + k) * c.WIDTH] = -manifold[row, c.SLIDE_AHEAD + k] if fast else 0.0


@compiled(inline=True)
def _glide(world: int, shape_a: int, shape_b: int, lightness_a: float, lightness_b: float) -> float:
    """Say how much of what bodies move past each other the contact moves away from the first.

    Round shapes take it with them, whatever they roll on. Else the lighter body does, on which a wrong arm would tell more.
    Both arms end at one point, whatever the share, which keeps angular momentum.
    """
    round_a, round_b = is_round(world, shape_a), is_round(world, shape_b)
    if round_a != round_b:
        return 0.0 if round_a else 1.0
    return lightness_b / (lightness_a + lightness_b + 1e-300)


@compiled(inline=True)
def _looseness(world: int, body: int) -> float:
    """Add to the response of a body that turns by more than a quarter of a radian in the step.

    Its response to an arm changes from substep to substep, the effective masses of its contacts do not. A response that is
    taken too large makes a sweep slow; one that is taken too small by half makes it diverge.
    """
    motion, response = floats(world, MOTION), floats(world, RESPONSE)
    square = motion[body, 3] ** 2 + motion[body, 4] ** 2 + motion[body, 5] ** 2
    turn = floats(world, SETTINGS)[0, STEP] * math.sqrt(square)
    if turn <= 0.25:
        return 0.0
    norm = response[body, 1] ** 2 + response[body, 2] ** 2 + response[body, 3] ** 2
    norm += 2.0 * (response[body, 4] ** 2 + response[body, 5] ** 2 + response[body, 6] ** 2)
    share: float = min(2.0 * turn - 0.5, 1.0)
    return share * math.sqrt(norm)


@compiled
def _softness(world: int, fixed: bool) -> Vector:
    """Rate of the bias, scale of the mass and of the impulse of a damped spring, implicit and whatever the masses.

    It is twice as stiff against what cannot move.
    """
    settings = floats(world, SETTINGS)
    h, damping = settings[0, STEP] / settings[0, SUBSTEPS], settings[0, CONTACT_DAMPING]
    hertz = settings[0, CONTACT_HERTZ] if settings[0, CONTACT_HERTZ] > 0.0 else STIFFEST / h
    if fixed:
        hertz, damping = 2.0 * hertz, 0.5 * damping
    rate = 2.0 * math.pi * hertz
    a1 = 2.0 * damping + h * rate
    a2 = h * rate * a1
    a3 = 1.0 / (1.0 + a2)
    return rate / a1, a2 * a3, a3


@compiled
def _surface_velocity(world: int, shape: int) -> Vector:
    place, pose = floats(world, PLACE), floats(world, POSE)
    s = SURFACE_VELOCITY
    velocity = (place[shape, s], place[shape, s + 1], place[shape, s + 2])
    if velocity[0] == 0.0 and velocity[1] == 0.0 and velocity[2] == 0.0:
        return velocity
    body = integers(world, SHAPE)[shape, 1]
    return turned((pose[body, 3], pose[body, 4], pose[body, 5], pose[body, 6]), velocity)
