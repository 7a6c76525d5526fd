"""The status of a stage that cannot proceed: columns of the one row of `kickdrift.world.tables.STEP_STATUS`.

A stage that cannot proceed sets a status and returns. Once the cause is removed it is run again from its beginning, so the data
that it has written until then must not change its result. `BEGIN_AGAIN` has the whole step rolled back and repeated,
`DO_IN_PARTS` has it done in shorter parts. The loop that runs the stages checks the status after each.
"""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.world.columns import column
from kickdrift.world.tables import STEP_STATUS, Table, Tables, integers, room

# Columns
STATUS = column(STEP_STATUS)
TABLE = column(STEP_STATUS)  # place of the table that is full
ROWS_WANTED = column(STEP_STATUS)  # rows that it needs
LOST_BODY = column(STEP_STATUS)  # row of a body or a cloth that is not finite
REACHED = column(STEP_STATUS)  # number of the step in progress, counted from the start time
WARNING = column(STEP_STATUS)  # set of warnings found; no reason to stop
SAID = column(STEP_STATUS)  # those of them that were issued
MIDWAY = column(STEP_STATUS)  # 1 while a step is in progress
REPEATED = column(STEP_STATUS)  # 1 if it is repeated because the sweeps had left a heap far from solved
HALVINGS = column(STEP_STATUS)  # how often the step was halved: the present part is that over 2 to this power
STARTED_WARNING = column(STEP_STATUS)  # WARNING at the beginning of the step or part
BOUNCING_BODY = column(STEP_STATUS)  # row of a body whose impacts had no end, for the warning
EXPECTED_HALVINGS = column(STEP_STATUS)  # how often the next step is halved before it is tried

# Bits of WARNING
LEFT_UNSOLVED = 1  # a body has rested for long on contacts that the sweeps leave unsolved
TURNS_TOO_FAST = 2  # joints have lost or gained energy, as bodies turn too far in a substep
MISSES_CONTACT = 4  # a body may have passed through another in a step, although that was repeated
LEFT_BOUNCING = 8  # impacts of a substep have not been resolved, or their impulses have not converged
LEFT_JAMMED = 16  # joints and contacts of an island have had no solution together for long

# Values of STATUS
OK = 0
FULL = 1  # a table needs more room: make it, clear the row and run the stage again
NOT_FINITE = 2  # a body has a pose or a velocity that is not finite
NEEDS_TIME_OF_IMPACT = 3  # shapes are so fast that the step needs the stage `find_impacts`
NEEDS_DIRECT_SOLVER = 4  # a heap is left unsolved by the sweeps
LOST_CLOTH = 5  # a cloth has a particle whose position or velocity is not finite
BEGIN_AGAIN = 6  # the step now knows data that it needed at its start: roll it back, and repeat it
DO_IN_PARTS = 7  # the step is too long for its impacts or rotations: roll it back, and halve it
# The same for a linkage; the next step begins whole. Of 600 linkages thrown at walls five gain more than a hundredth of their
# energy if the steps after one that was halved are halved, too, and one does otherwise.
DO_LINKAGE_IN_PARTS = 8
HALVED = (DO_IN_PARTS, DO_LINKAGE_IN_PARTS)

MOST_HALVINGS = 10  # of a step

_REQUEST = [STATUS, TABLE, ROWS_WANTED, LOST_BODY]


def halving(row: NDArray[np.int64]) -> int:
    """Return the status in a row of the table if it requests that a step is halved, and `OK` otherwise."""
    status = int(row[STATUS])
    return status if status in HALVED else OK


def take_request(tables: Tables) -> tuple[int, int, int, int]:
    """Return the status of a stage that cannot proceed, the table, the rows wanted and the lost body, and clear them."""
    row = tables.row(STEP_STATUS, 0)
    status, table, wanted, body = row[_REQUEST].tolist()
    row[_REQUEST] = OK
    return status, table, wanted, body


@compiled(inline=True)
def ask_for_room(world: int, table: Table, count: int) -> None:
    """Request room for a number of rows of a table, unless another error is set already."""
    row = integers(world, STEP_STATUS)
    if row[0, STATUS] == OK:
        row[0, STATUS], row[0, TABLE], row[0, ROWS_WANTED] = FULL, table[0], count


@compiled(inline=True)
def has_room(world: int, table: Table, count: int) -> bool:
    """Whether a table has room for a number of rows; requests it if not."""
    if count > room(world, table):
        ask_for_room(world, table, count)
        return False
    return True


@compiled(inline=True)
def report_body(world: int, body: int) -> None:
    """Report a body whose pose or velocity is not finite, unless another error is set already."""
    row = integers(world, STEP_STATUS)
    if row[0, STATUS] == OK:
        row[0, STATUS], row[0, LOST_BODY] = NOT_FINITE, body


@compiled(inline=True)
def report_cloth(world: int, cloth: int) -> None:
    """Report a cloth whose particles are not finite, unless another error is set already."""
    row = integers(world, STEP_STATUS)
    if row[0, STATUS] == OK:
        row[0, STATUS], row[0, LOST_BODY] = LOST_CLOTH, cloth
