"""Bodies that may be struck within the step, whose other contacts must therefore be resolved as impacts, too, even with e = 0.

The sweeps act too late where shapes may pass each other within a substep, and not at all on a contact that is about to bounce:
a heavy body without restitution would press a light one through the floor on which that bounces.
"""

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.narrow_phase.manifolds import smallest
from kickdrift.world.collision.predicted_motion import STRUCK
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.bounce_speed import restitution_of, slowest_bounce
from kickdrift.world.contacts.constraint_groups import constraint
from kickdrift.world.contacts.impacts.impact_motion import is_moved
from kickdrift.world.contacts.impacts.impact_time import rests
from kickdrift.world.disjoint_sets import first_of, unite
from kickdrift.world.layout import HEAP, HEAP_SIZE, RADIUS
from kickdrift.world.settings import MARGIN, SUBSTEPS
from kickdrift.world.tables import BODY, CONTACT, MANIFOLD, PLACE, PREDICTED, SETTINGS, floats, integers, rows

# Bits of a heap: one of its contacts has restitution; one may move faster than the bounce speed.
_BOUNCES, _MOVES = 1, 2


@compiled
def mark_struck(world: int, h: float) -> bool:
    """Mark bodies that may be struck in a substep h; return whether there are any."""
    contact, predicted, fast, bouncing = integers(world, CONTACT), floats(world, PREDICTED), False, False
    for row in range(rows(world, CONTACT)):
        fast = fast or strikes(world, row)
        bouncing = bouncing or _bounces(world, row)
    if not (fast or bouncing):
        return False
    for body in range(rows(world, PREDICTED)):
        predicted[body, STRUCK] = 0.0
    for row in range(rows(world, CONTACT)):
        if strikes(world, row):
            predicted[contact[row, c.BODY_A], STRUCK] = predicted[contact[row, c.BODY_B], STRUCK] = 1.0
    return fast or (bouncing and _mark_heaps(world, h))


@compiled
def _mark_heaps(world: int, h: float) -> bool:
    """Mark the bodies of heaps in which some contact bounces and some is fast enough to; return whether there are any."""
    contact, body, predicted, found = integers(world, CONTACT), integers(world, BODY), floats(world, PREDICTED), False
    for row in range(rows(world, BODY)):
        body[row, HEAP], body[row, HEAP_SIZE] = row, 0
    for row in range(rows(world, CONTACT)):
        a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
        if contact[row, c.PLACE_IN_GROUPS] >= 0 and is_moved(world, a) and is_moved(world, b):
            unite(body, HEAP, a, b)
    for row in range(rows(world, CONTACT)):
        if contact[row, c.PLACE_IN_GROUPS] < 0:
            continue
        a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
        first = first_of(body, HEAP, a if is_moved(world, a) else b)
        if _bounces(world, row):
            body[first, HEAP_SIZE] |= _BOUNCES
        if not rests(world, h, row, constraint(world, row), slowest_bounce(world, h, row)):
            body[first, HEAP_SIZE] |= _MOVES
    for row in range(rows(world, BODY)):
        if body[first_of(body, HEAP, row), HEAP_SIZE] == _BOUNCES | _MOVES:
            predicted[row, STRUCK], found = 1.0, True
    return found


@compiled(inline=True)
def strikes(world: int, row: int) -> bool:
    """Whether the shapes of a fast contact approach by more than half the size of the smaller one in a substep."""
    contact, place, settings = integers(world, CONTACT), floats(world, PLACE), floats(world, SETTINGS)
    if contact[row, c.CONTACT_STATE] & c.FAST == 0 or contact[row, c.PLACE_IN_GROUPS] < 0:
        return False
    way = floats(world, MANIFOLD)[row, c.RECYCLED] - settings[0, MARGIN]
    size = smallest(place[contact[row, c.SHAPE_A], RADIUS], place[contact[row, c.SHAPE_B], RADIUS])
    strikes: bool = way > 0.5 * settings[0, SUBSTEPS] * size
    return strikes


@compiled(inline=True)
def is_struck(world: int, row: int) -> bool:
    """Whether a body of a contact is movable and marked by `mark_struck`."""
    contact = integers(world, CONTACT)
    struck: bool = _is_marked(world, contact[row, c.BODY_A]) or _is_marked(world, contact[row, c.BODY_B])
    return struck


@compiled(inline=True)
def _is_marked(world: int, body: int) -> bool:
    marked: bool = is_moved(world, body) and floats(world, PREDICTED)[body, STRUCK] != 0.0
    return marked


@compiled(inline=True)
def _bounces(world: int, row: int) -> bool:
    """Whether a contact has restitution."""
    bounces: bool = integers(world, CONTACT)[row, c.PLACE_IN_GROUPS] >= 0 and restitution_of(world, row) > 0.0
    return bounces
