"""Bounces: impacts between the kick and the drift, at the moment in the substep in which they happen.

A point whose gap closes within the substep faster than the bounce speed hits at a time s with a speed u. By Newton's rule it
leaves with -e u. Bodies are moved to the time of their impact, their velocities change there, and they are moved back by s
times the new velocities. So a ball that falls from a height h onto a floor rises to e^2 h, whatever the step.

Impacts are resolved in rounds, after B. Smith, D. M. Kaufman, E. Vouga, R. Tamstorf and E. Grinspun, "Reflections on
Simultaneous Impact" (2012): in each round all contacts that are the first to hit on their bodies, simultaneously, until nothing
hits any more. So momentum passes through a row of touching balls, and symmetry is preserved. What has hit and still approaches,
slower than the bounce speed, is stopped in the end, together: a light plate that bounces between a floor and a heavy ball would
be pressed into the floor otherwise.

Contacts without restitution are included where shapes are so fast that they may pass each other within the step, since one
sweep over the points of a manifold does not stop them, and in heaps in which others bounce. On these, sweeps act, too, so that
a light body between heavy ones passes impulses on; they also stop what approaches slowly after its impact. Bodies at rest are
carried meanwhile by what they rest on (`kickdrift.world.contacts.impacts.resting_support`).

A row of `IMPACT` is a contact that hits. This module finds its time, speed and coefficient; the other columns are those of
`kickdrift.world.contacts.impacts.impact_rows` and `kickdrift.world.contacts.impacts.simultaneous_impact`.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.arm_refresh import hide_from_sweeps
from kickdrift.world.contacts.bounce_speed import restitution_of, slowest_approach, slowest_bounce
from kickdrift.world.contacts.constraint_groups import constraint
from kickdrift.world.contacts.graph_colouring import is_linked
from kickdrift.world.contacts.impacts.impact_motion import flown, is_moved, leave_impact, move_to_impact
from kickdrift.world.contacts.impacts.impact_rows import (
    APPROACH,
    BOUNCE,
    LISTED,
    ROW,
    SPEED,
    TIME,
    TIMES,
    bodies_of,
    meet,
    normal_impulse,
)
from kickdrift.world.contacts.impacts.impact_time import find_time, rests
from kickdrift.world.contacts.impacts.impact_worklist import (
    BOUNCING_CONTACT,
    HITS_NOT,
    begin_rounds,
    examine_hit_again,
    is_quiet,
    note_hit,
)
from kickdrift.world.contacts.impacts.inelastic_collapse import join_touching
from kickdrift.world.contacts.impacts.resting_support import add_support, remove_support
from kickdrift.world.contacts.impacts.simultaneous_impact import find_impulses
from kickdrift.world.contacts.impacts.struck_bodies import is_struck, mark_struck
from kickdrift.world.layout import IMPACT_TIME, NEXT_IMPACT
from kickdrift.world.settings import BOUNCING_TIME, SLOP, SUBSTEPS
from kickdrift.world.step.status import BOUNCING_BODY, LEFT_BOUNCING, WARNING, has_room
from kickdrift.world.tables import (
    BOUNCING,
    CONTACT,
    IMPACT,
    KICKED,
    SETTINGS,
    STEP_STATUS,
    floats,
    integers,
    rows,
    set_rows,
)

_ROUNDS = 400
# After these all that hits is stopped: a ball between a wall and one of a thousand times its mass is hit a hundred times.
_APART = 300
_SLOW = 1e-6  # of the fastest impact of a substep: slower ones are not stopped together
_ROUGH = 1e-3  # likewise: faster approaches left cause a warning if they come to a tenth of the slop in the substep
_FASTER = 2.0  # times the speed at which a contact seemed to hit and did not: then it may hit after all
# Tolerances of the impulses of a round, of the largest: those that stop what still approaches need no more than `_SLOW`.
_EXACTLY, _ROUGHLY = 1e-15, 1e-7
# Of the speed at which its points approach each other: a contact slower than that where its impulse acts has stopped. Bodies
# that have slid apart since the step began, and turn, approach at one and not at the other.
_STOPPED = 1e-3
_NOISE = 1e-9  # of the fastest hit: slower ones may be rounding, and wait until they are the fastest


@compiled
def find_bouncing(t: float, h: float, world: int) -> None:
    """List the contacts that may bounce, and set the speeds from which on they do."""
    contact, count = integers(world, CONTACT), 0
    if not (has_room(world, BOUNCING, rows(world, CONTACT)) and has_room(world, IMPACT, rows(world, CONTACT))):
        return
    bouncing, substep = integers(world, BOUNCING), h / floats(world, SETTINGS)[0, SUBSTEPS]
    struck = mark_struck(world, substep)
    for row in range(rows(world, CONTACT)):
        e = restitution_of(world, row)
        bounces = e > 0.0 or contact[row, c.CONTACT_STATE] & c.FAST or (struck and is_struck(world, row))
        if not bounces or contact[row, c.PLACE_IN_GROUPS] < 0:
            continue
        linked = is_linked(world, contact[row, c.PLACE_IN_GROUPS] // c.WIDTH)
        if e > 0.0:
            constraint(world, row)[c.BOUNCE_THRESHOLD * c.WIDTH] = slowest_bounce(world, substep, row)
        if not linked:
            bouncing[count, BOUNCING_CONTACT] = row
            count += 1
    set_rows(world, BOUNCING, count)


@compiled
def bounce(t: float, h: float, world: int) -> None:
    """Resolve the bounces of all impacts within the substep."""
    if rows(world, BOUNCING) == 0:
        return
    begin_rounds(world)
    body, first, fastest, near, together = 0, 0.0, 0.0, 0.1 * floats(world, SETTINGS)[0, SLOP], False
    add_support(world)
    for n in range(_ROUNDS):
        fastest = _find_round(world, n, h, together)
        first = max(first, fastest)
        if fastest <= (_SLOW * first if together else 0.0):
            if together or n == 0:
                break
            together = True
            examine_hit_again(world)
            continue
        together = together or n >= _APART
        if together:
            join_touching(world, n >= _APART)
        impact = floats(world, IMPACT)
        a, b = bodies_of(world, impact[0])
        body = b if is_moved(world, b) else a
        for hit in range(rows(world, IMPACT)):
            for struck in bodies_of(world, impact[hit]):
                move_to_impact(world, h, struck)
        for hit in range(rows(world, IMPACT)):
            meet(world, impact[hit], -math.inf if together else _NOISE * fastest)
        find_impulses(world, _ROUGHLY if together and n < _APART else _EXACTLY)
        for hit in range(rows(world, IMPACT)):
            for struck in bodies_of(world, impact[hit]):
                leave_impact(world, h, struck)
                note_hit(world, struck, n)
            own, was_hit = constraint(world, int(impact[hit, ROW])), normal_impulse(impact[hit]) > 0.0
            stopped = impact[hit, SPEED] > 0.0 and impact[hit, APPROACH] <= _STOPPED * impact[hit, SPEED]
            own[c.REFERENCE * c.WIDTH] = c.HIT if was_hit and not stopped else c.MISSED
            own[(c.REFERENCE + 1) * c.WIDTH] = impact[hit, SPEED]
            for k in range(4 if impact[hit, BOUNCE] > 0.0 else 0):
                hide_from_sweeps(own, k)
            if was_hit:
                integers(world, CONTACT)[int(impact[hit, ROW]), c.CONTACT_STATE] |= c.BOUNCED
    else:
        fastest = _find_round(world, _ROUNDS, h, False)
    remove_support(world)
    if fastest > max(_ROUGH * first, near / h):
        _warn_of_impacts(world, body, t)


@compiled(inline=True)
def _warn_of_impacts(world: int, body: int, t: float) -> None:
    """Note that impacts of a body in the substep that begins at t were left unresolved, unless that is known of another."""
    status, settings = integers(world, STEP_STATUS), floats(world, SETTINGS)
    if status[0, WARNING] & LEFT_BOUNCING == 0:
        status[0, BOUNCING_BODY], settings[0, BOUNCING_TIME] = body, t
        status[0, WARNING] |= LEFT_BOUNCING


@compiled
def _find_round(world: int, n: int, h: float, together: bool) -> float:
    """Find the hits of a round, the first on both of their bodies; return the speed of the fastest, m/s, or 0.0 without any.

    Contacts that did not hit are examined again only where the last round, n - 1, has hit one of their bodies. `together` says
    that those which have hit before do so at any speed.
    """
    impact, kicked, contact = floats(world, IMPACT), floats(world, KICKED), integers(world, CONTACT)
    found, fastest = 0, 0.0
    bouncing = integers(world, BOUNCING)
    for k in range(rows(world, BOUNCING)):
        row = bouncing[k, BOUNCING_CONTACT]
        a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
        if is_quiet(world, k, n):
            continue
        own, bouncing[k, HITS_NOT] = constraint(world, row), 1
        missed, slower = own[c.REFERENCE * c.WIDTH] == c.MISSED, own[(c.REFERENCE + 1) * c.WIDTH]
        hits = _find_times(world, h, row, together, impact[found])
        if missed and not (hits and impact[found, SPEED] > _FASTER * slower):
            own[c.REFERENCE * c.WIDTH] = c.MISSED
        elif hits:
            bouncing[k, HITS_NOT] = 0
            fastest = max(fastest, impact[found, SPEED])
            impact[found, ROW], impact[found, LISTED] = row, k
            impact[found, BOUNCE] = restitution_of(world, row)
            kicked[a, NEXT_IMPACT] = kicked[b, NEXT_IMPACT] = math.inf
            found += 1
    for hit in range(found):
        if impact[hit, SPEED] <= _NOISE * fastest:
            continue
        for body in bodies_of(world, impact[hit]):
            kicked[body, NEXT_IMPACT] = min(kicked[body, NEXT_IMPACT], impact[hit, TIME])
    near, count = 0.1 * floats(world, SETTINGS)[0, SLOP], 0
    for hit in range(found):
        first = impact[hit, TIME]
        for body in bodies_of(world, impact[hit]):
            if is_moved(world, body):
                first = min(first, kicked[body, NEXT_IMPACT])
        if impact[hit, SPEED] > _NOISE * fastest and (impact[hit, TIME] - first) * impact[hit, SPEED] <= near:
            for k in range(IMPACT.width):
                impact[count, k] = impact[hit, k]
            count += 1
    set_rows(world, IMPACT, count)
    return fastest


@compiled
def _find_times(world: int, h: float, row: int, together: bool, hit: Any) -> bool:
    """Write times and speed of impact of the points of a contact into `hit`; return whether any hits within the substep."""
    contact, kicked = integers(world, CONTACT), floats(world, KICKED)
    own = constraint(world, row)
    again = together and own[c.REFERENCE * c.WIDTH] == c.HIT and restitution_of(world, row) > 0.0
    slowest = slowest_approach(world, h) if again else slowest_bounce(world, h, row)
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    since = max(kicked[a, IMPACT_TIME], kicked[b, IMPACT_TIME])
    hit[TIME] = math.inf
    if rests(world, h, row, own, slowest):
        return False
    flight_a, flight_b = flown(world, h, a, since), flown(world, h, b, since)
    for k in range(4):
        hit[TIMES + k] = math.inf
    for k in range(contact[row, c.POINTS]):
        when, speed, free = find_time(world, h, row, own, k, since, slowest, flight_a, flight_b)
        hit[TIMES + k] = when
        if speed > 0.0 and when < hit[TIME]:
            hit[TIME], hit[SPEED] = when, speed
        if free and not again:
            hide_from_sweeps(own, k)
            own[c.REFERENCE * c.WIDTH] = c.HIT
    hits: bool = hit[TIME] < math.inf
    return hits
