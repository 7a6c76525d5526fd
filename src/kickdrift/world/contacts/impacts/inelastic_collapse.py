"""Inelastic collapse: a light body between heavy ones is hit infinitely often in a finite time, where e is small."""

import math

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.constraint_groups import constraint
from kickdrift.world.contacts.impacts.impact_motion import is_moved
from kickdrift.world.contacts.impacts.impact_rows import BOUNCE, LISTED, ROW, SPEED, TIME, TIMES, bodies_of
from kickdrift.world.contacts.impacts.impact_worklist import BOUNCING_CONTACT, IN_ROUND
from kickdrift.world.layout import GROUP, LAST_ROUND, NEXT_IMPACT
from kickdrift.world.tables import BOUNCING, CONTACT, IMPACT, KICKED, floats, integers, rows, set_rows


@compiled
def join_touching(world: int, all_stop: bool) -> None:
    """Make the impacts of a round inelastic, and solve them together with the contacts that have hit before in the substep.

    So it ends as if all were hit at once. Unless `all_stop`, contacts that have not hit before bounce.
    """
    impact, contact, kicked = floats(world, IMPACT), integers(world, CONTACT), floats(world, KICKED)
    bouncing, count, known = integers(world, BOUNCING), rows(world, IMPACT), 0
    for k in range(rows(world, BOUNCING)):
        row = bouncing[k, BOUNCING_CONTACT]
        bouncing[k, IN_ROUND] = 0
        kicked[contact[row, c.BODY_A], GROUP] = kicked[contact[row, c.BODY_B], GROUP] = math.inf
    for hit in range(count):
        if all_stop or constraint(world, int(impact[hit, ROW]))[c.REFERENCE * c.WIDTH] == c.HIT:
            impact[hit, BOUNCE] = 0.0
        bouncing[int(impact[hit, LISTED]), IN_ROUND] = 1
        _note_first(world, hit)
    while known < count:
        known = count
        for k in range(rows(world, BOUNCING)):
            row = bouncing[k, BOUNCING_CONTACT]
            if bouncing[k, IN_ROUND] or constraint(world, row)[c.REFERENCE * c.WIDTH] != c.HIT:
                continue
            a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
            first = min(kicked[a, GROUP], kicked[b, GROUP])
            if first == math.inf:
                continue
            when, bouncing[k, IN_ROUND] = impact[int(first), TIME], 1
            impact[count, ROW], impact[count, LISTED], impact[count, TIME] = row, k, when
            impact[count, BOUNCE], impact[count, SPEED] = 0.0, 0.0
            for j in range(4):
                impact[count, TIMES + j] = when
            kicked[a, NEXT_IMPACT] = kicked[b, NEXT_IMPACT] = when
            _note_first(world, count)
            count += 1
    for k in range(rows(world, BOUNCING)):  # the same column as GROUP; the end of this round notes it
        row = bouncing[k, BOUNCING_CONTACT]
        kicked[contact[row, c.BODY_A], LAST_ROUND] = kicked[contact[row, c.BODY_B], LAST_ROUND] = -1.0
    set_rows(world, IMPACT, count)


@compiled(inline=True)
def _note_first(world: int, hit: int) -> None:
    """Note a hit of the round with its movable bodies, unless they have an earlier one."""
    kicked = floats(world, KICKED)
    for body in bodies_of(world, floats(world, IMPACT)[hit]):
        if is_moved(world, body):
            kicked[body, GROUP] = min(kicked[body, GROUP], float(hit))
