"""Which contacts a round of impacts, or a sweep over one, has to examine: those of bodies whose velocities have just changed.

All others would give the same again. In a crowd most of them are others: of 2000 balls that fall into a hopper, a step takes
half as long.
"""

from kickdrift.core.compilation import compiled
from kickdrift.world.columns import column
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.constraint_groups import constraint
from kickdrift.world.contacts.impacts.impact_motion import is_moved
from kickdrift.world.layout import LAST_ROUND, LAST_SWEEP
from kickdrift.world.tables import BOUNCING, CONTACT, KICKED, floats, integers, rows

# Columns of BOUNCING
BOUNCING_CONTACT = column(BOUNCING)
HITS_NOT = column(BOUNCING)  # 1 if it did not hit when it was examined last in the substep
IN_ROUND = column(BOUNCING)  # 1 for a contact of the present round, while others join it


@compiled
def begin_rounds(world: int) -> None:
    """Let the first round of a substep examine all contacts."""
    bouncing, contact, kicked = integers(world, BOUNCING), integers(world, CONTACT), floats(world, KICKED)
    for k in range(rows(world, BOUNCING)):
        row = bouncing[k, BOUNCING_CONTACT]
        bouncing[k, HITS_NOT] = 0
        kicked[contact[row, c.BODY_A], LAST_ROUND] = kicked[contact[row, c.BODY_B], LAST_ROUND] = -1.0


@compiled
def examine_hit_again(world: int) -> None:
    """Let the next round examine all contacts that have hit in the substep."""
    bouncing = integers(world, BOUNCING)
    for k in range(rows(world, BOUNCING)):
        if constraint(world, bouncing[k, BOUNCING_CONTACT])[c.REFERENCE * c.WIDTH] == c.HIT:
            bouncing[k, HITS_NOT] = 0


@compiled(inline=True)
def is_quiet(world: int, k: int, n: int) -> bool:
    """Whether round n need not examine a row of BOUNCING: it did not hit, and the last round has hit neither of its bodies."""
    bouncing, contact, kicked = integers(world, BOUNCING), integers(world, CONTACT), floats(world, KICKED)
    row = bouncing[k, BOUNCING_CONTACT]
    last = max(kicked[contact[row, c.BODY_A], LAST_ROUND], kicked[contact[row, c.BODY_B], LAST_ROUND])
    quiet: bool = bouncing[k, HITS_NOT] != 0 and last < n - 1
    return quiet


@compiled(inline=True)
def note_hit(world: int, body: int, n: int) -> None:
    """Note that round n has hit a body."""
    if is_moved(world, body):
        floats(world, KICKED)[body, LAST_ROUND] = n


@compiled(inline=True)
def begin_sweeps(world: int, row: int) -> None:
    """Let the first sweep over a round include a contact."""
    contact, kicked = integers(world, CONTACT), floats(world, KICKED)
    kicked[contact[row, c.BODY_A], LAST_SWEEP] = kicked[contact[row, c.BODY_B], LAST_SWEEP] = 0.0


@compiled(inline=True)
def may_change(world: int, row: int, sweep: int) -> bool:
    """Whether this sweep or the last one has changed the velocity of a body of a contact."""
    contact, kicked = integers(world, CONTACT), floats(world, KICKED)
    may: bool = max(kicked[contact[row, c.BODY_A], LAST_SWEEP], kicked[contact[row, c.BODY_B], LAST_SWEEP]) >= sweep - 1
    return may


@compiled(inline=True)
def note_change(world: int, row: int, sweep: int) -> None:
    """Note that a sweep has changed the velocities of the bodies of a contact."""
    contact = integers(world, CONTACT)
    for body in (contact[row, c.BODY_A], contact[row, c.BODY_B]):
        if is_moved(world, body):
            floats(world, KICKED)[body, LAST_SWEEP] = sweep
