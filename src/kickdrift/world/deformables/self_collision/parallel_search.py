"""The search for pairs of triangles on Numba's threads, which finds the same pairs in the same order.

It is divided into tasks, pairs of nodes in the order of the traversal. Each of some workers does every so many tasks, and
writes the pairs to rows of its own; those of all tasks are then copied one after the other. A worker gets a block of tables in
which the pairs are its own rows.
"""

from numba import prange, types

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.core.memory import word
from kickdrift.world.deformables.layout import (
    FIRST_FOUND,
    FIRST_NODE,
    LAST_FOUND,
    LAST_NODE,
    PLACE_OF_FOUND,
    TASK_NODES,
)
from kickdrift.world.deformables.self_collision.pair_rows import NO_ROOM, set_pairs
from kickdrift.world.deformables.self_collision.tree_walk import walk
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_PAIR,
    CLOTH_PAIR_NUMBERS,
    FOUND_PAIR,
    FOUND_PAIR_NUMBERS,
    SEARCH_TASK,
    VIEW,
    address,
    floats,
    integers,
    replace,
    room,
    rows,
    set_rows,
)

WORKERS = 32
# Between the first tasks of workers, modulo their number: folds are many tasks in a row, and threads get workers in a row
_APART = 5
_PARTS = 256  # the nodes of a task have at most this fraction of the rows of a tree

SIGNATURE = types.boolean(types.intp, types.intp, types.intp)
call_search = caller(SIGNATURE)


@compiled(parallel=True)
def search_threaded(world: int, a: int, b: int) -> bool:
    """Find the pairs of two cloths, or of one with itself, in parallel; False if there is no room."""
    if not _divide(world, a, b):
        return False
    for worker in prange(WORKERS):
        _work(world, a, b, worker)
    if not _make_places(world):
        return False
    for k in prange(rows(world, SEARCH_TASK)):
        _copy(world, k)
    return True


@compiled
def _divide(world: int, a: int, b: int) -> bool:
    """Write the tasks; False if there is no room for them."""
    own, size = integers(world, CLOTH), 1
    for cloth in (a, b):
        size = max(size, (own[cloth, LAST_NODE] - own[cloth, FIRST_NODE]) // _PARTS)
    set_rows(world, SEARCH_TASK, 0)
    return walk(world, a, b, 0, 0, size)


@compiled
def _work(world: int, a: int, b: int, worker: int) -> None:
    """Do the tasks of a worker."""
    block, task, size = _enter(world, worker), integers(world, SEARCH_TASK), room(world, FOUND_PAIR) // WORKERS
    for k in range(_APART * worker % WORKERS, rows(world, SEARCH_TASK), WORKERS):
        task[k, FIRST_FOUND] = worker * size + rows(block, CLOTH_PAIR)
        fits = walk(block, a, b, task[k, TASK_NODES], task[k, TASK_NODES + 1], 0)
        task[k, LAST_FOUND] = worker * size + rows(block, CLOTH_PAIR) if fits else NO_ROOM


@compiled
def _enter(world: int, worker: int) -> int:
    """Return the address of a block of tables in which the pairs are the empty rows of a worker."""
    view, size = integers(world, VIEW), room(world, FOUND_PAIR) // WORKERS
    for k in range(VIEW.width):
        view[worker, k] = word(world, k)
    block = address(world, VIEW) + 8 * VIEW.width * worker
    replace(block, CLOTH_PAIR, FOUND_PAIR, worker * size, size)
    replace(block, CLOTH_PAIR_NUMBERS, FOUND_PAIR_NUMBERS, worker * size, size)
    return block


@compiled
def _make_places(world: int) -> bool:
    """Make places for the pairs of all tasks after those that are known; False if there is no room for them."""
    task, count, fits = integers(world, SEARCH_TASK), rows(world, CLOTH_PAIR), True
    for k in range(rows(world, SEARCH_TASK)):
        fits = fits and task[k, LAST_FOUND] != NO_ROOM
        task[k, PLACE_OF_FOUND] = count
        count += task[k, LAST_FOUND] - task[k, FIRST_FOUND]
    if not fits:
        ask_for_room(world, FOUND_PAIR, 2 * room(world, FOUND_PAIR) + 256 * WORKERS)
        return False
    if count > min(room(world, CLOTH_PAIR), room(world, CLOTH_PAIR_NUMBERS)):
        ask_for_room(world, CLOTH_PAIR, count)
        return False
    set_pairs(world, count)
    return True


@compiled
def _copy(world: int, k: int) -> None:
    """Copy the pairs of a task to their places."""
    pair, found = integers(world, CLOTH_PAIR), integers(world, FOUND_PAIR)
    numbers, found_numbers = floats(world, CLOTH_PAIR_NUMBERS), floats(world, FOUND_PAIR_NUMBERS)
    task = integers(world, SEARCH_TASK)
    shift = task[k, PLACE_OF_FOUND] - task[k, FIRST_FOUND]
    for row in range(task[k, FIRST_FOUND], task[k, LAST_FOUND]):
        for j in range(CLOTH_PAIR.width):
            pair[row + shift, j] = found[row, j]
        for j in range(CLOTH_PAIR_NUMBERS.width):
            numbers[row + shift, j] = found_numbers[row, j]
