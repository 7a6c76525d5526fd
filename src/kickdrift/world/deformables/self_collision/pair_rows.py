"""The rows of the table of pairs."""

from kickdrift.core.compilation import compiled
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import CLOTH_PAIR, CLOTH_PAIR_NUMBERS, room, rows, set_rows

NO_ROOM = -1


@compiled(inline=True)
def set_pairs(world: int, count: int) -> None:
    """Set the number of pairs, at most the number that there is room for."""
    set_rows(world, CLOTH_PAIR, count)
    set_rows(world, CLOTH_PAIR_NUMBERS, count)


@compiled
def add_pair(world: int) -> int:
    """Add a pair, and return its row, or `NO_ROOM`."""
    row = rows(world, CLOTH_PAIR)
    if row >= min(room(world, CLOTH_PAIR), room(world, CLOTH_PAIR_NUMBERS)):
        ask_for_room(world, CLOTH_PAIR, 2 * row + 1024)
        return NO_ROOM
    set_pairs(world, row + 1)
    return row
