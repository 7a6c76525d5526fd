"""Division of a world into batches of islands, whose substeps can be done one batch after the other."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.batch_view import AFTER_MEMBER, FIRST_MEMBER, WEIGHT
from kickdrift.world.collision.broad_phase.filters_and_sensors import is_solid
from kickdrift.world.columns import column
from kickdrift.world.contacts import layout as c
from kickdrift.world.disjoint_sets import first_of, unite
from kickdrift.world.layout import AWAKE, BODY_KIND, DYNAMIC, STATIC
from kickdrift.world.step.status import ask_for_room, has_room
from kickdrift.world.tables import (
    BATCH,
    BODY,
    CONTACT,
    MANIFOLD,
    MEMBER,
    MEMBERSHIP,
    STARTED_IMPULSE,
    Tables,
    floats,
    integers,
    room,
    rows,
    set_rows,
)

# Columns of MEMBERSHIP
OWN_BATCH = column(MEMBERSHIP)  # while islands are found: its parent in the disjoint sets
ISLAND_WEIGHT = column(MEMBERSHIP)  # for the first body of an island: the number of its bodies and contacts

# Columns of STARTED_IMPULSE: those of contacts before the step
column(STARTED_IMPULSE, 8, "N s, N m s")  # from NORMAL_IMPULSE to TWIST_IMPULSE
KEPT_ROLLING = column(STARTED_IMPULSE, 3, "N m s")
KEPT_STATE = column(STARTED_IMPULSE)

# Bodies and contacts, of some 900 bytes each: the data that a substep reads fit into half a megabyte.
_MOST = 512
FEW = 1000  # bodies, up to which a whole world fits into the cache
# Free bodies, up to which heaps may be solved directly, and ask for the step to be done again: not in batches.
CROWD = 256


@compiled
def find_batches(t: float, h: float, world: int) -> None:
    """Find islands of bodies connected by contacts, and fill batches with whole islands, in the order of their first bodies."""
    if not has_room(world, BATCH, rows(world, BODY)):
        return
    if rows(world, CONTACT) > room(world, STARTED_IMPULSE):
        ask_for_room(world, STARTED_IMPULSE, 2 * rows(world, CONTACT))
        return
    contact, body, own = integers(world, CONTACT), integers(world, BODY), integers(world, MEMBERSHIP)
    free = 0
    for row in range(rows(world, BODY)):
        free += body[row, BODY_KIND] == DYNAMIC and body[row, AWAKE] != 0
    if free <= CROWD:
        return
    for row in range(rows(world, BODY)):
        own[row, OWN_BATCH], own[row, ISLAND_WEIGHT] = row, 0
    for row in range(rows(world, CONTACT)):
        if not is_solid(contact, row):
            continue
        a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
        if body[a, BODY_KIND] > STATIC and body[b, BODY_KIND] > STATIC:
            unite(own, OWN_BATCH, a, b)
    for row in range(rows(world, BODY)):
        own[first_of(own, OWN_BATCH, row), ISLAND_WEIGHT] += 1
    for row in range(rows(world, CONTACT)):
        if is_solid(contact, row):
            a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
            own[first_of(own, OWN_BATCH, a if body[a, BODY_KIND] > STATIC else b), ISLAND_WEIGHT] += 1
    _fill(world, own)


@compiled
def _fill(world: int, own: Any) -> None:
    """Assign islands to batches, and list the members of each batch."""
    batches, member, last = integers(world, BATCH), integers(world, MEMBER), 0
    batches[0, WEIGHT], batches[0, AFTER_MEMBER] = 0, 0
    for row in range(rows(world, BODY)):
        before, weight = own[row, OWN_BATCH], own[row, ISLAND_WEIGHT]
        if before != row:  # a lower row, whose batch is known by now
            own[row, OWN_BATCH] = own[before, OWN_BATCH]
        else:
            if batches[last, WEIGHT] > 0 and batches[last, WEIGHT] + weight > _MOST:
                last += 1
                batches[last, WEIGHT], batches[last, AFTER_MEMBER] = 0, 0
            batches[last, WEIGHT] += weight
            own[row, OWN_BATCH] = last
        batches[own[row, OWN_BATCH], AFTER_MEMBER] += 1
    first = 0
    for k in range(last + 1):
        batches[k, FIRST_MEMBER] = first
        first += batches[k, AFTER_MEMBER]
        batches[k, AFTER_MEMBER] = batches[k, FIRST_MEMBER]
    for row in range(rows(world, BODY)):
        k = own[row, OWN_BATCH]
        member[batches[k, AFTER_MEMBER], 0] = row
        batches[k, AFTER_MEMBER] += 1
    set_rows(world, BATCH, last + 1)
    _keep_impulses(world)


@compiled
def _keep_impulses(world: int) -> None:
    """Keep what `store` overwrites, which it does for one batch before another one may ask for the step to be done again."""
    kept, manifold, contact = floats(world, STARTED_IMPULSE), floats(world, MANIFOLD), integers(world, CONTACT)
    set_rows(world, STARTED_IMPULSE, rows(world, CONTACT))
    for row in range(rows(world, CONTACT)):
        for k in range(8):
            kept[row, k] = manifold[row, c.NORMAL_IMPULSE + k]
        for k in range(3):
            kept[row, KEPT_ROLLING + k] = manifold[row, c.ROLLING_IMPULSE + k]
        kept[row, KEPT_STATE] = contact[row, c.CONTACT_STATE]


def roll_back_impulses(tables: Tables) -> None:
    """Restore the impulses and states of contacts that batches have stored in the step."""
    kept, manifold = tables.array(STARTED_IMPULSE), tables.array(MANIFOLD)
    count = len(kept)
    manifold[:count, c.NORMAL_IMPULSE : c.TWIST_IMPULSE + 1] = kept[:, :KEPT_ROLLING]
    manifold[:count, c.ROLLING_IMPULSE : c.ROLLING_IMPULSE + 3] = kept[:, KEPT_ROLLING:KEPT_STATE]
    tables.array(CONTACT)[:count, c.CONTACT_STATE] = kept[:, KEPT_STATE]
    tables.resize(STARTED_IMPULSE, 0)
