"""The rows of the table of pairs, and of that of the tasks into which a search for pairs is divided."""

from kickdrift.core.compilation import compiled
from kickdrift.world.deformables.layout import TASK_NODES
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import CLOTH_PAIR, CLOTH_PAIR_NUMBERS, SEARCH_TASK, floats, integers, room, rows, set_rows

NO_ROOM = -1


@compiled(inline=True)
def set_pairs(world: int, count: int) -> None:
    """Set the number of pairs, at most the number that there is room for."""
    set_rows(world, CLOTH_PAIR, count)
    set_rows(world, CLOTH_PAIR_NUMBERS, count)


@compiled
def add_pair(world: int) -> int:
    """Add a pair of zeros, and return its row, or `NO_ROOM`."""
    row = rows(world, CLOTH_PAIR)
    if row >= min(room(world, CLOTH_PAIR), room(world, CLOTH_PAIR_NUMBERS)):
        return NO_ROOM
    set_pairs(world, row + 1)
    pair, numbers = integers(world, CLOTH_PAIR), floats(world, CLOTH_PAIR_NUMBERS)
    for k in range(CLOTH_PAIR.width):
        pair[row, k] = 0
    for k in range(CLOTH_PAIR_NUMBERS.width):
        numbers[row, k] = 0.0
    return row


@compiled
def add_task(world: int, m: int, n: int) -> bool:
    """Add a pair of nodes to the tasks; False if there is no room."""
    row, task = rows(world, SEARCH_TASK), integers(world, SEARCH_TASK)
    if row >= room(world, SEARCH_TASK):
        ask_for_room(world, SEARCH_TASK, 2 * row + 256)
        return False
    task[row, TASK_NODES], task[row, TASK_NODES + 1] = m, n
    set_rows(world, SEARCH_TASK, row + 1)
    return True
