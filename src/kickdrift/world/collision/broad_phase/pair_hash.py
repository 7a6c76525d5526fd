"""Hash table, by their shapes, of the contacts that a search may find again, at the start of SCRATCH."""

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.broad_phase.search_state import SLOTS
from kickdrift.world.collision.shape_properties import sort_of
from kickdrift.world.layout import FIRST_TREE_NODE
from kickdrift.world.shapes.record import SURFACE
from kickdrift.world.tables import BOUNDS, SCRATCH, SEARCH, SHAPE, floats, integers, rows

_EMPTY = -1


@compiled
def slots_for(contacts: int) -> int:
    """Return the size of the table for a number of contacts: a power of two, at most half full."""
    size = 64
    while size < 2 * contacts:
        size *= 2
    return size


@compiled
def clear(world: int) -> None:
    """Empty the table."""
    table = integers(world, SCRATCH)
    for slot in range(integers(world, SEARCH)[0, SLOTS]):
        table[slot, 0] = _EMPTY


@compiled(inline=True)
def key_of(world: int, a: int, b: int, part: int) -> int:
    """Return the key of a contact, whichever shape is first; triangles of meshes are numbered after all shapes."""
    if sort_of(world, a) == SURFACE:
        a = rows(world, SHAPE) + int(floats(world, BOUNDS)[a, FIRST_TREE_NODE]) + part
    return (min(a, b) << 32) | max(a, b)


@compiled
def insert(world: int, key: int) -> None:
    """Enter a contact."""
    integers(world, SCRATCH)[_slot(world, key), 0] = key


@compiled
def is_known(world: int, key: int) -> bool:
    """Whether a contact has been entered."""
    return bool(integers(world, SCRATCH)[_slot(world, key), 0] == key)


@compiled
def _slot(world: int, key: int) -> int:
    """Return the slot of a key, or the empty one where it belongs."""
    table = integers(world, SCRATCH)
    last = integers(world, SEARCH)[0, SLOTS] - 1
    # The product with an odd number wraps around; from bit 32 on it depends on all bits of both shapes.
    slot: int = ((key * 0x1E3779B97F4A7C15) >> 32) & last
    while table[slot, 0] != _EMPTY and table[slot, 0] != key:
        slot = (slot + 1) & last
    return slot
