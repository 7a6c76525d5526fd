"""Bounces: impacts between the kick and the drift, at the moment in the substep in which they happen.

A point whose gap closes within the substep faster than the bounce speed hits at the time s with the speed u that it then
has. Newton's rule asks for -e u afterwards. The velocities change by an impulse, as if from the start of the substep, and
bodies are set back by what the change would have moved them up to s. So a ball that falls on a floor has the height
e^2 h, whatever the step. Impacts happen one manifold after the other, the points of one at once, until none is left:
momentum goes through a row of balls that touch.

Of shapes so fast that they may pass each other within the step, impacts with e = 0 are among them: one sweep over the points
of a manifold does not stop them.
"""

import math
from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import (
    Vector,
    cross,
    dot,
    length,
    minus,
    plus,
    times,
)
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.prepare import LINKED
from kickdrift.world.contacts.strike import (
    HIT_TIME,
    IMPULSE,
    POINT_SIZE,
    SPEED,
    WANTED,
    arms_of,
    field_at,
    find_impulses,
    glides,
    strike,
)
from kickdrift.world.flight import ADDED, IMPACT_TIME
from kickdrift.world.layout import RESTITUTION
from kickdrift.world.settings import BOUNCE_SPEED, GRAVITY, MIDPOINT, SLOP
from kickdrift.world.tables import (
    CHANGE,
    COLOURS,
    CONTACT,
    KICKED,
    LANES,
    MOTION,
    PLACE,
    SETTINGS,
    flat,
    floats,
    integers,
    rows,
)

_ROUNDS = 100
_SIZE = c.FIELDS * c.WIDTH


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
            if (e > 0.0 or contact[row, c.STATE] & c.FAST) and not _is_linked(world, row):
                hits += _bounce_one(world, row, e, h)
        if hits == 0:
            return


@compiled(inline=True)
def _is_linked(world: int, row: int) -> bool:
    """Whether a contact is solved directly, and bounces there: see `kickdrift.world.direct.bounces`."""
    place: int = integers(world, CONTACT)[row, c.PLACE_IN_GROUPS]
    linked: bool = place // c.WIDTH >= integers(world, COLOURS)[LINKED, 1]
    return linked


@compiled
def _bounce_one(world: int, row: int, e: float, h: float) -> int:
    """Let one manifold bounce, and return 1 if it did."""
    points = integers(world, CONTACT)[row, c.POINTS]
    hit = carray(floats_on_stack(16), (16,))
    own = _constraint(world, row)
    first = _times_of_hits(world, row, own, hit, points, h)
    if first >= 2.0 * h:
        return 0
    slid = _slid(world, row, own, first)
    found = _speeds_wanted(world, row, own, hit, points, slid, first, e)
    if found == 0:
        return 0
    find_impulses(world, row, own, hit, points, slid)
    strike(world, row, own, hit, points, slid, first)
    return 1


@compiled
def slowest_bounce(h: float, world: int) -> float:
    """Return the speed from which on things bounce."""
    settings = floats(world, SETTINGS)
    slowest: float = settings[0, BOUNCE_SPEED]
    return slowest if slowest >= 0.0 else 4.0 * h * length(vector_at(settings, 0, GRAVITY))


@compiled(inline=True)
def _constraint(world: int, row: int) -> Any:
    place = integers(world, CONTACT)[row, c.PLACE_IN_GROUPS]
    begin = place // c.WIDTH * _SIZE + place % c.WIDTH
    return flat(world, LANES)[begin : begin + _SIZE - c.WIDTH + 1]


@compiled(inline=True)
def _along(table: Any, a: int, b: int, normal: Vector, arm_a: Vector, arm_b: Vector) -> float:
    """Velocity (or displacement) of a point of b against one of a along the normal."""
    linear = dot(normal, minus(vector_at(table, b, 0), vector_at(table, a, 0)))
    return linear + dot(arm_b, vector_at(table, b, 3)) - dot(arm_a, vector_at(table, a, 3))


@compiled
def _slid(world: int, row: int, own: Any, when: float) -> Vector:
    """Say what the second body has slid past the first when they hit, within bounds."""
    contact, motion, change = integers(world, CONTACT), floats(world, MOTION), floats(world, CHANGE)
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    by_now = minus(vector_at(change, b, 0), vector_at(change, a, 0))
    slid = plus(by_now, times(when, minus(vector_at(motion, b, 0), vector_at(motion, a, 0))))
    slid = plus(slid, field_at(own, c.OFFSET))
    return times(min(1.0, own[c.FARTHEST * c.WIDTH] / (length(slid) + 1e-300)), slid)


@compiled
def _times_of_hits(world: int, row: int, own: Any, hit: Any, points: int, h: float) -> float:
    """Find when and how fast each point hits, and return the first time; beyond h if none does."""
    contact, motion, change, kicked = (
        integers(world, CONTACT),
        floats(world, MOTION),
        floats(world, CHANGE),
        floats(world, KICKED),
    )
    settings, slowest = floats(world, SETTINGS), slowest_bounce(h, world)
    a, b, normal = contact[row, c.BODY_A], contact[row, c.BODY_B], field_at(own, c.N)
    added = settings[0, MIDPOINT] * dot(normal, minus(vector_at(kicked, b, ADDED), vector_at(kicked, a, ADDED)))
    since = max(kicked[a, IMPACT_TIME], kicked[b, IMPACT_TIME])
    first = 2.0 * h
    for k in range(points):
        f = c.P + c.POINT_FIELDS * k
        arm_a, arm_b = arms_of(own, k)
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
        hit[POINT_SIZE * k + HIT_TIME] = when
        hit[POINT_SIZE * k + SPEED] = speed
        # What the solver would stop in this substep hits in it, a few per cent after its end though it may be: the solver
        # asks the velocity after the kick, which in free flight is reached only at the end.
        if speed < -slowest and when < first and (when <= h or gap + h * velocity <= 0.0):
            first = when
    return first


@compiled
def _speeds_wanted(world: int, row: int, own: Any, hit: Any, points: int, slid: Vector, first: float, e: float) -> int:
    """Say which velocity each point that hits at the same time shall have, by Newton's rule; return how many do."""
    contact, motion = integers(world, CONTACT), floats(world, MOTION)
    a, b, normal = contact[row, c.BODY_A], contact[row, c.BODY_B], field_at(own, c.N)
    near, aside = 0.1 * floats(world, SETTINGS)[0, SLOP], glides(own, cross(slid, normal))
    found = 0
    for k in range(points):
        p = POINT_SIZE * k
        speed = hit[p + SPEED]
        hit[p + IMPULSE] = 0.0
        hit[p + WANTED] = -1e300
        if speed < 0.0 and (hit[p + HIT_TIME] - first) * -speed <= near:
            arm_a, arm_b = arms_of(own, k)
            before = _along(motion, a, b, normal, arm_a, arm_b)
            velocity = _along(motion, a, b, normal, plus(arm_a, aside[0]), plus(arm_b, aside[1]))
            hit[p + WANTED] = velocity - (1.0 + e) * (speed + velocity - before)
            found += 1
    return found
