"""Graph colouring of contacts, so that no two of a colour move the same body, and the groups of lanes of each colour."""

from kickdrift.core.compilation import compiled
from kickdrift.world.batch_view import BATCH_COLOURS, LANES_BEFORE
from kickdrift.world.collision.broad_phase.filters_and_sensors import is_solid
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.batch_division import OWN_BATCH
from kickdrift.world.layout import AWAKE, BODY_KIND, INVERSE_LINEAR_MASS, LINK_PLACE, STATIC
from kickdrift.world.step.status import has_room
from kickdrift.world.tables import (
    BATCH,
    BODY,
    COLOURED,
    COLOURS,
    CONTACT,
    CONTACT_ROW,
    GROUPS,
    INVERSE_MASS,
    LANES,
    MEMBERSHIP,
    floats,
    integers,
    rows,
    set_rows,
)

_COLOURS = 62
OVERFLOW = _COLOURS  # of contacts for which no colour was left: solved one by one, each in a group of its own
LINKED = OVERFLOW + 1  # of contacts that are solved directly: see `kickdrift.world.direct`


@compiled
def colour(t: float, h: float, world: int) -> None:
    """Give every contact that has points a colour, and every colour its groups of lanes.

    Every batch has its own colours, whose constraints share the same space in `LANES`. Contacts that are solved directly come
    last.
    """
    batches = max(rows(world, BATCH), 1)
    if not has_room(world, COLOURS, batches * BATCH_COLOURS):
        return
    _choose_colours(world, batches)
    if _lay_out_groups(world, batches):
        _place(world)


@compiled
def _choose_colours(world: int, batches: int) -> None:
    """Choose the colours of contacts, kept as their places in the groups until they have these, and count those of each colour.

    Greedy, in the order of the contacts: the first colour that neither body has yet; bodies that impulses do not move do not
    count.
    """
    contact, inverse_mass, body = integers(world, CONTACT), floats(world, INVERSE_MASS), integers(world, BODY)
    taken, colours, own = integers(world, COLOURED), integers(world, COLOURS), integers(world, MEMBERSHIP)
    for k in range(rows(world, COLOURED)):
        taken[k, 0] = 0
    for k in range(batches * BATCH_COLOURS):
        colours[k, c.COLOUR_CONTACTS] = 0
    for row in range(rows(world, CONTACT)):
        contact[row, c.PLACE_IN_GROUPS] = -1
        a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
        if not is_solid(contact, row):
            continue
        if body[a, AWAKE] == 0 and body[b, AWAKE] == 0:
            continue
        moves_a, moves_b = inverse_mass[a, INVERSE_LINEAR_MASS] > 0.0, inverse_mass[b, INVERSE_LINEAR_MASS] > 0.0
        node_a, node_b = body[a, LINK_PLACE] > 0, body[b, LINK_PLACE] > 0
        if (node_a or node_b) and (node_a or not moves_a) and (node_b or not moves_b):
            contact[row, c.PLACE_IN_GROUPS] = LINKED
            colours[LINKED, c.COLOUR_CONTACTS] += 1
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
        if batches > 1:
            k += BATCH_COLOURS * own[a if body[a, BODY_KIND] != STATIC else b, OWN_BATCH]
        contact[row, c.PLACE_IN_GROUPS] = k
        colours[k, c.COLOUR_CONTACTS] += 1


@compiled
def _lay_out_groups(world: int, batches: int) -> bool:
    """Give every colour its range of groups; False if a table has no room for their constraints."""
    colours = integers(world, COLOURS)
    first = 0
    for k in range(batches * BATCH_COLOURS):
        count = colours[k, c.COLOUR_CONTACTS]
        colours[k, c.FIRST_GROUP] = first
        first += count if k % BATCH_COLOURS == OVERFLOW else (count + c.WIDTH - 1) // c.WIDTH
        colours[k, c.AFTER_GROUP] = first
    most = 0
    for k in range(0, batches * BATCH_COLOURS, BATCH_COLOURS):
        most = max(most, colours[k + LINKED, c.AFTER_GROUP] - colours[k, c.FIRST_GROUP])
    linked = colours[LINKED, c.COLOUR_CONTACTS]
    if not (
        has_room(world, GROUPS, first)
        and has_room(world, LANES, most * c.GROUP_SIZE)
        and has_room(world, CONTACT_ROW, linked)
    ):
        return False
    set_rows(world, CONTACT_ROW, linked)
    set_rows(world, GROUPS, first)
    for k in range(rows(world, BATCH)):
        integers(world, BATCH)[k, LANES_BEFORE] = colours[k * BATCH_COLOURS, c.FIRST_GROUP] * c.GROUP_SIZE
    return True


@compiled
def _place(world: int) -> None:
    """Assign a group and a lane to every contact that has a colour."""
    contact, colours, groups = integers(world, CONTACT), integers(world, COLOURS), integers(world, GROUPS)
    for g in range(rows(world, GROUPS)):
        for lane in range(c.WIDTH):
            groups[g, c.BODIES_A + lane], groups[g, c.BODIES_B + lane], groups[g, c.GROUP_CONTACTS + lane] = 0, 0, -1
    for k in range(max(rows(world, BATCH), 1) * BATCH_COLOURS):
        colours[k, c.COLOUR_CONTACTS] = 0
    for row in range(rows(world, CONTACT)):
        k = contact[row, c.PLACE_IN_GROUPS]
        if k < 0:
            continue
        index = colours[k, c.COLOUR_CONTACTS]
        colours[k, c.COLOUR_CONTACTS] += 1
        group, lane = colours[k, c.FIRST_GROUP] + index // c.WIDTH, index % c.WIDTH
        if k % BATCH_COLOURS == OVERFLOW:
            group, lane = colours[k, c.FIRST_GROUP] + index, 0
        contact[row, c.PLACE_IN_GROUPS] = group * c.WIDTH + lane
        groups[group, c.BODIES_A + lane] = contact[row, c.BODY_A]
        groups[group, c.BODIES_B + lane] = contact[row, c.BODY_B]
        groups[group, c.GROUP_CONTACTS + lane] = row


@compiled(inline=True)
def is_linked(world: int, g: int) -> bool:
    """Whether the contacts of a group are solved directly; several of them may share a movable body."""
    linked: bool = g >= integers(world, COLOURS)[LINKED, c.FIRST_GROUP]
    return linked
