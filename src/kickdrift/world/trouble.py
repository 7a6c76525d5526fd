"""What a stage says where it cannot go on: columns of the one row of `kickdrift.world.tables.TROUBLE`.

A stage that has trouble leaves the tables as they were and returns. Who runs the stages looks here after each.
"""

from kickdrift.core.compilation import compiled
from kickdrift.world.columns import column
from kickdrift.world.tables import TROUBLE, Table, integers

# Columns
KIND = column(TROUBLE)
TABLE = column(TROUBLE)  # place of the table that is full
WANTED = column(TROUBLE)  # rows that it needs
BODY = column(TROUBLE)  # that is nowhere
REACHED = column(TROUBLE)  # the step at hand, counted from the first of `kickdrift.world.step.run`

# Kinds
NONE = 0
FULL = 1  # a table needs more room: make it, clear the row and run the stage again
NOT_FINITE = 2  # a body has a pose or a velocity that is not finite
FAST = 3  # shapes are so fast that the step needs the stage `find_impacts`


@compiled(inline=True)
def ask_for_room(world: int, table: Table, count: int) -> None:
    """Say that a table needs room for so many rows, unless something else is wrong already."""
    row = integers(world, TROUBLE)
    if row[0, KIND] == NONE:
        row[0, KIND], row[0, TABLE], row[0, WANTED] = FULL, table[0], count


@compiled(inline=True)
def report_body(world: int, body: int) -> None:
    """Say that a body is nowhere, unless something else is wrong already."""
    row = integers(world, TROUBLE)
    if row[0, KIND] == NONE:
        row[0, KIND], row[0, BODY] = NOT_FINITE, body
