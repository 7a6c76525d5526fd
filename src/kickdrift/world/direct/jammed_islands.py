"""Detection of islands whose joints and contacts cannot be satisfied together, for a warning that is issued once.

Where Newton's method finds no impulses, velocities are projected instead, and overlaps are not pushed apart as they should be:
a ball of 150 kg sinks 3 cm into planks of 1 kg on hinges, one of 1000 kg falls through them. Neither the residual, a speed,
nor the energy shows it.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.narrow_phase.manifolds import deepest
from kickdrift.world.collision.shape_poses import relative_pose, shape_pose
from kickdrift.world.contacts import layout as c
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_lookup import row_of
from kickdrift.world.direct.direct_bodies import body_of
from kickdrift.world.direct.islands import direct_islands
from kickdrift.world.settings import JAMMED_BODY, JAMMED_SINCE, SLOP, SUBSTEPS
from kickdrift.world.step.status import HALVINGS, LEFT_JAMMED, WARNING
from kickdrift.world.tables import CONTACT, ISLAND, ISLAND_CONTACT, MANIFOLD, SETTINGS, STEP_STATUS, floats, integers

# Seconds of consecutive steps without a solution in any substep, and with a deep overlap, after which a warning says so.
_TOO_LONG = 0.25
_DEEP = 2.0  # slops: depth from which it matters


@compiled
def note_jammed(t: float, h: float, world: int) -> None:
    """Note since when the joints and contacts of an island have had no solution, and report it after too long."""
    islands, settings, status = integers(world, ISLAND), floats(world, SETTINGS), integers(world, STEP_STATUS)
    if status[0, WARNING] & LEFT_JAMMED:
        return
    jammed = -1
    for island in range(direct_islands(world)):
        given_up = islands[island, d.GIVEN_UP] >= settings[0, SUBSTEPS] and islands[island, d.HAS_JOINTS] != 0
        if jammed < 0 and given_up and _overlap(world, island) > _DEEP * settings[0, SLOP]:
            jammed = body_of(world, islands[island, d.FIRST_NODE])
    if jammed < 0 or jammed != settings[0, JAMMED_BODY] or status[0, HALVINGS] != 0:
        settings[0, JAMMED_BODY], settings[0, JAMMED_SINCE] = jammed, t - h
    elif t - settings[0, JAMMED_SINCE] > _TOO_LONG:
        status[0, WARNING] |= LEFT_JAMMED


@compiled(cached=False)
def _overlap(world: int, island: int) -> float:
    """Return the depth of the deepest contact of an island at the present poses, m; negative for a gap."""
    own, order, contact = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), integers(world, CONTACT)
    least = math.inf
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        row = row_of(world, order[k, 0])
        at, turn = relative_pose(shape_pose(world, contact[row, c.SHAPE_A]), shape_pose(world, contact[row, c.SHAPE_B]))
        gap, _ = deepest(floats(world, MANIFOLD), row, contact[row, c.POINTS], at, turn)
        least = min(least, gap)
    return -least
