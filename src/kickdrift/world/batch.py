"""Batches: parts of a world that nothing connects within a step, small enough for a processor's cache.

The constraints of one batch are made, solved in all substeps and stored before those of the next, with the same bits as if each
stage did it for all. Stages do not know: they get a block of tables in which `MEMBER` and `COLOURS` are the batch's own, and
`LANES` is where the constraints of all batches lie, one after the other.
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
LANES_BEFORE = column(BATCH)  # numbers that the constraints of batches before would take


@compiled
def enter(world: int, batch: int) -> int:
    """Return the address of the block in which the world is a batch; another batch takes its place."""
    view, batches = integers(world, VIEW), integers(world, BATCH)
    for k in range(VIEW.width):
        view[0, k] = word(world, k)
    first, block = batches[batch, FIRST_MEMBER], address(world, VIEW)
    narrow(block, MEMBER, first, batches[batch, AFTER_MEMBER] - first)
    narrow(block, COLOURS, batch * BATCH_COLOURS, BATCH_COLOURS)
    before = batches[batch, LANES_BEFORE]
    narrow(block, LANES, -before, before + room(world, LANES))
    return block
