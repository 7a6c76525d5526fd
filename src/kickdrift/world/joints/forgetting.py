"""Contacts of links that begin a substep with no impulse: where that of the substep before says nothing about this one."""

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.coupled import forget
from kickdrift.world.contacts.prepare import LINKED
from kickdrift.world.joints.answers import link_row
from kickdrift.world.joints.layout import ANEW, WILD
from kickdrift.world.tables import COLOURS, GROUPS, LANES, LINK_NUMBERS, flat, floats, integers

_SIZE = c.FIELDS * c.WIDTH


@compiled
def forget_impulses(t: float, h: float, world: int) -> None:
    """Forget the impulses of contacts of articulations that turn fast, or whose joints found no solution.

    A contact and a joint that squeeze a body between them carry large impulses, which cancel in one pose alone.
    """
    colours, groups, lanes = integers(world, COLOURS), integers(world, GROUPS), flat(world, LANES)
    work = floats(world, LINK_NUMBERS)
    for g in range(colours[LINKED, 1], colours[LINKED, 2]):
        wild = False
        for side in range(2):
            link = link_row(groups[g, c.WIDTH * side], world)
            wild = wild or (link >= 0 and work[link, ANEW] == WILD)
        if wild:
            forget(lanes[g * _SIZE : (g + 1) * _SIZE])
