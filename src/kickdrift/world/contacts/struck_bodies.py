"""Bodies that may be struck within the step, whose other contacts must therefore be resolved as impacts, too, even with e = 0.

The sweeps act too late where shapes may pass each other within a substep, and not at all on a contact that is about to bounce:
a heavy body without restitution would press a light one through the floor on which that bounces.
"""

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.narrow_phase import smallest
from kickdrift.world.collision.predicted_path import STRUCK
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.bounce_speed import restitution_of, slowest_bounce
from kickdrift.world.contacts.impact_motion import constraint, is_moved
from kickdrift.world.contacts.impact_time import rests
from kickdrift.world.layout import RADIUS
from kickdrift.world.settings import MARGIN, SUBSTEPS
from kickdrift.world.tables import CONTACT, MANIFOLD, PLACE, PREDICTED, SETTINGS, floats, integers, rows


@compiled
def mark_struck(world: int, h: float) -> bool:
    """Mark bodies that may be struck in a substep h; return whether there are any."""
    contact, predicted, fast, bouncing = integers(world, CONTACT), floats(world, PREDICTED), False, False
    for row in range(rows(world, CONTACT)):
        fast = fast or strikes(world, row)
        bouncing = bouncing or _bounces(world, row)
    bouncing = bouncing and _any_approaches(world, h)
    if not (fast or bouncing):
        return False
    for body in range(rows(world, PREDICTED)):
        predicted[body, STRUCK] = 0.0
    for row in range(rows(world, CONTACT)):
        if strikes(world, row) or (bouncing and _bounces(world, row)):
            predicted[contact[row, c.BODY_A], STRUCK] = predicted[contact[row, c.BODY_B], STRUCK] = 1.0
    spreads = bouncing
    while spreads:
        spreads = False
        for row in range(rows(world, CONTACT)):
            spreads = _spread(world, row) or spreads
    return True


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


@compiled
def _any_approaches(world: int, h: float) -> bool:
    """Whether the shapes of any contact approach faster than the bounce speed."""
    contact = integers(world, CONTACT)
    for row in range(rows(world, CONTACT)):
        placed, slowest = contact[row, c.PLACE_IN_GROUPS] >= 0, slowest_bounce(world, h, row)
        if placed and not rests(world, h, row, constraint(world, row), slowest):
            return True
    return False


@compiled(inline=True)
def _spread(world: int, row: int) -> bool:
    """Mark the second body of a contact if one is marked; return whether that is new."""
    contact, predicted = integers(world, CONTACT), floats(world, PREDICTED)
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    if contact[row, c.PLACE_IN_GROUPS] < 0 or not is_moved(world, a) or not is_moved(world, b):
        return False
    if predicted[a, STRUCK] == predicted[b, STRUCK]:
        return False
    predicted[a, STRUCK] = predicted[b, STRUCK] = 1.0
    return True
