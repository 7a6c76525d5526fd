"""The broad phase: shapes whose fat bounds overlap form contacts, updated when a shape leaves its fat bounds."""

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.broad_phase.bvh_update import update_trees
from kickdrift.world.collision.broad_phase.filters_and_sensors import may_touch
from kickdrift.world.collision.broad_phase.pair_hash import clear, insert, key_of, slots_for
from kickdrift.world.collision.broad_phase.pair_search import FIRST_SHAPE, PAIR, PART, SECOND_SHAPE, overlap, seek
from kickdrift.world.collision.broad_phase.search_state import (
    AT_HOME,
    CONTACTS,
    FOUND,
    NEW,
    PAIRS_AT,
    PARTS_AT,
    REVIEW,
    SHAPES_AT,
    SLOTS,
)
from kickdrift.world.collision.broad_phase.shape_lists import update_bounds
from kickdrift.world.contacts.layout import (
    BODY_A,
    BODY_B,
    CONTACT_STATE,
    SENSOR,
    SHAPE_A,
    SHAPE_B,
    TOUCHING,
    TRIANGLE_INDEX,
)
from kickdrift.world.layout import BEGINS, BODY_ROW, FIRST_BODY, FROM_SENSOR, IS_SENSOR, SEARCH_STATE, SECOND_BODY
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    CONTACT,
    EVENTS,
    MANIFOLD,
    SCRATCH,
    SEARCH,
    SHAPE,
    SOUGHT,
    TRIANGLE_TREE,
    flat,
    floats,
    integers,
    room,
    rows,
    set_rows,
)


@compiled
def find_pairs(t: float, h: float, world: int) -> None:
    """Update the contacts for a step of h: remove those whose fat bounds no longer overlap, append new ones without points.

    New contacts are ordered by the rows of the shapes that were sought, then of the others, so that their order does not depend
    on how the trees were built. When a contact is removed, the last one takes its row.
    """
    search, sought, shapes = integers(world, SEARCH), integers(world, SOUGHT), integers(world, SHAPE)
    if not update_bounds(world, h) or (rows(world, SOUGHT) == 0 and search[0, REVIEW] == 0):
        return
    if not update_trees(world) or not _lay_out_scratch(world):
        return
    if not _remove_contacts(world):
        return
    for k in range(rows(world, SOUGHT)):
        seek(world, sought[k, 0])
    if not _has_room(world):
        return
    _append(world)
    for k in range(rows(world, SOUGHT)):
        shapes[sought[k, 0], SEARCH_STATE] = AT_HOME
    set_rows(world, SOUGHT, 0)
    search[0, REVIEW] = 0


@compiled
def _lay_out_scratch(world: int) -> bool:
    """Lay out SCRATCH; False if there is no room."""
    search = integers(world, SEARCH)
    search[0, SLOTS] = slots_for(rows(world, CONTACT))
    search[0, SHAPES_AT] = search[0, SLOTS]
    search[0, PARTS_AT] = search[0, SHAPES_AT] + rows(world, SHAPE) + 1
    search[0, PAIRS_AT] = search[0, PARTS_AT] + rows(world, TRIANGLE_TREE) + 1
    search[0, FOUND] = 0
    if room(world, SCRATCH) >= search[0, PAIRS_AT]:
        return True
    ask_for_room(world, SCRATCH, search[0, PAIRS_AT] + PAIR * 8 * rows(world, SOUGHT))
    return False


@compiled
def _remove_contacts(world: int) -> bool:
    """Remove contacts that no longer exist, and insert those that the search may find again into the hash table.

    Without room for the event that two shapes stop touching it returns False, and continues when it is run again.
    """
    contact, manifold, shapes = integers(world, CONTACT), floats(world, MANIFOLD), integers(world, SHAPE)
    clear(world)
    row = 0
    while row < rows(world, CONTACT):
        a, b, part = contact[row, SHAPE_A], contact[row, SHAPE_B], contact[row, TRIANGLE_INDEX]
        if shapes[a, SEARCH_STATE] == AT_HOME and shapes[b, SEARCH_STATE] == AT_HOME:
            row += 1
        elif _stays(world, a, b, part):
            insert(world, key_of(world, a, b, part))
            row += 1
        elif not _note_parting(world, row):
            return False
        else:
            last = rows(world, CONTACT) - 1
            for k in range(CONTACT.width):
                contact[row, k] = contact[last, k]
            for k in range(MANIFOLD.width):
                manifold[row, k] = manifold[last, k]
            _set_count(world, last)
    return True


@compiled(inline=True)
def _stays(world: int, a: int, b: int, part: int) -> bool:
    """Whether two shapes, of which one is sought again or was removed, still form a contact."""
    shapes = integers(world, SHAPE)
    if shapes[a, SEARCH_STATE] == NEW or shapes[b, SEARCH_STATE] == NEW:
        return False
    return overlap(world, a, b, part) and (integers(world, SEARCH)[0, REVIEW] == 0 or may_touch(world, a, b))


@compiled
def _note_parting(world: int, row: int) -> bool:
    """Append the event that the shapes of a contact stop touching, if they did; False if there is no room."""
    contact, events = integers(world, CONTACT), integers(world, EVENTS)
    if contact[row, CONTACT_STATE] & TOUCHING == 0:
        return True
    count = rows(world, EVENTS)
    if room(world, EVENTS) <= count:
        ask_for_room(world, EVENTS, count + 1)
        return False
    events[count, BEGINS] = 0
    events[count, FIRST_BODY], events[count, SECOND_BODY] = contact[row, BODY_A], contact[row, BODY_B]
    events[count, FROM_SENSOR] = contact[row, CONTACT_STATE] & SENSOR != 0
    set_rows(world, EVENTS, count + 1)
    return True


@compiled
def _has_room(world: int) -> bool:
    """Whether there is room for the pairs found; requests it if not."""
    search = integers(world, SEARCH)
    count = rows(world, CONTACT) + search[0, FOUND]
    if room(world, SCRATCH) < search[0, PAIRS_AT] + PAIR * search[0, FOUND]:
        ask_for_room(world, SCRATCH, search[0, PAIRS_AT] + PAIR * search[0, FOUND])
    elif room(world, CONTACT) < count:
        ask_for_room(world, CONTACT, count)
    elif room(world, MANIFOLD) < count:
        ask_for_room(world, MANIFOLD, count)
    else:
        return True
    return False


@compiled
def _append(world: int) -> None:
    """Append contacts for the pairs that were found."""
    contact, manifold, shapes = integers(world, CONTACT), floats(world, MANIFOLD), integers(world, SHAPE)
    search, pairs = integers(world, SEARCH), flat(world, SCRATCH)
    row = rows(world, CONTACT)
    at = search[0, PAIRS_AT]
    for _ in range(search[0, FOUND]):
        a, b = int(pairs[at + FIRST_SHAPE]), int(pairs[at + SECOND_SHAPE])
        for k in range(CONTACT.width):
            contact[row, k] = 0
        for k in range(MANIFOLD.width):
            manifold[row, k] = 0.0
        contact[row, SHAPE_A], contact[row, SHAPE_B], contact[row, TRIANGLE_INDEX] = a, b, int(pairs[at + PART])
        contact[row, BODY_A], contact[row, BODY_B] = shapes[a, BODY_ROW], shapes[b, BODY_ROW]
        if shapes[a, IS_SENSOR] != 0 or shapes[b, IS_SENSOR] != 0:
            contact[row, CONTACT_STATE] = SENSOR
        row += 1
        at += PAIR
    _set_count(world, row)


@compiled
def _set_count(world: int, count: int) -> None:
    """Set the number of contacts."""
    set_rows(world, CONTACT, count)
    set_rows(world, MANIFOLD, count)
    integers(world, SEARCH)[0, CONTACTS] = count
