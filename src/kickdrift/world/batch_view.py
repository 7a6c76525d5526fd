"""Batches: sets of islands that do not interact within a step, small enough to stay in a processor's cache.

The constraints of one batch are prepared, solved in all substeps and stored before those of the next, with the same bits as if
each stage processed the whole world. Stages are unaware of batches: they get a block of tables in which `MEMBER` and `COLOURS`
are those of the batch, and the pointer to `LANES` is moved back by the size of all earlier groups, so that the constraints of
the batch, which are numbered after those, lie at the start of the memory: all batches use the same.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import word
from kickdrift.world.columns import column
from kickdrift.world.tables import BATCH, COLOURS, LANES, MEMBER, VIEW, address, integers, narrow, room

BATCH_COLOURS = 64  # rows of COLOURS

# Columns of BATCH
FIRST_MEMBER = column(BATCH)
AFTER_MEMBER = column(BATCH)
WEIGHT = column(BATCH)  # bodies and contacts
LANES_BEFORE = column(BATCH)  # size of the constraints of all earlier batches, in rows of LANES


@compiled
def enter(world: int, batch: int) -> int:
    """Return the address of a block of tables restricted to a batch; the next call overwrites it."""
    view, batches = integers(world, VIEW), integers(world, BATCH)
    for k in range(VIEW.width):
        view[0, k] = word(world, k)
    first, block = batches[batch, FIRST_MEMBER], address(world, VIEW)
    narrow(block, MEMBER, first, batches[batch, AFTER_MEMBER] - first)
    narrow(block, COLOURS, batch * BATCH_COLOURS, BATCH_COLOURS)
    before = batches[batch, LANES_BEFORE]
    narrow(block, LANES, -before, before + room(world, LANES))
    return block
