"""The stage that begins a step of cloths, and the way back to where it began."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.deformables.body_contacts.predicted_loads import note_loads, roll_back_loads
from kickdrift.world.deformables.layout import CROSSINGS, INVALID, IS_ASLEEP, KEPT, SEARCH_STATE, SOUGHT, STIRRED, TURN
from kickdrift.world.deformables.particle_tables import roll_back_pairs
from kickdrift.world.deformables.self_collision.swept_bounds import restore_boxes
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_PAIR,
    CLOTH_PAIR_NUMBERS,
    CLOTH_SEARCH,
    GROUP_STRAIN,
    PARTICLE,
    PARTICLE_LANES,
    PARTICLE_PATH,
    PARTICLE_SHIFT,
    STARTED_PAIR,
    STARTED_PAIR_NUMBERS,
    STARTED_PARTICLE,
    STARTED_PATH,
    STARTED_SEARCH,
    Tables,
    floats,
    integers,
    room,
    rows,
    set_rows,
)


@compiled
def _note_pairs(world: int) -> bool:
    """Save the pairs of triangles that are known for a rollback; False if there is no room."""
    count = rows(world, CLOTH_PAIR)
    if min(room(world, STARTED_PAIR), room(world, STARTED_PAIR_NUMBERS)) < count:
        ask_for_room(world, STARTED_PAIR, count)
        return False
    set_rows(world, STARTED_PAIR, count)
    set_rows(world, STARTED_PAIR_NUMBERS, count)
    _copy(floats(world, CLOTH_SEARCH), floats(world, STARTED_SEARCH), 1, CLOTH_SEARCH.width)
    _copy(floats(world, PARTICLE_PATH), floats(world, STARTED_PATH), rows(world, PARTICLE), PARTICLE_PATH.width)
    _copy(integers(world, CLOTH_PAIR), integers(world, STARTED_PAIR), count, CLOTH_PAIR.width)
    _copy(floats(world, CLOTH_PAIR_NUMBERS), floats(world, STARTED_PAIR_NUMBERS), count, CLOTH_PAIR_NUMBERS.width)
    return True


@compiled
def _copy(source: Any, target: Any, count: int, width: int) -> None:
    """Copy the first rows of a table to another one."""
    for i in range(count):
        for k in range(width):
            target[i, k] = source[i, k]


@compiled
def begin_cloths(t: float, h: float, world: int) -> None:
    """Save the state of cloths for a rollback, and note whether the user has moved them while they slept."""
    search, own, moved = floats(world, CLOTH_SEARCH), integers(world, CLOTH), False
    if not note_loads(world) or not _note_pairs(world):
        return
    search[0, TURN] = 0.0
    if search[0, CROSSINGS] > 0.0 or search[0, SEARCH_STATE] == SOUGHT:  # a tangle, or a step that was interrupted
        search[0, SEARCH_STATE] = INVALID
    if search[0, SEARCH_STATE] == KEPT:
        restore_boxes(world)
    now, before = floats(world, PARTICLE), floats(world, STARTED_PARTICLE)
    for i in range(rows(world, PARTICLE)):
        for k in range(PARTICLE.width):
            moved = moved or now[i, k] != before[i, k]
            before[i, k] = now[i, k]
    if moved and own[0, IS_ASLEEP] != 0:
        own[0, IS_ASLEEP] = STIRRED


def roll_back_cloths(tables: Tables) -> None:
    """Restore the state of cloths at the start of the step."""
    roll_back_loads(tables)
    roll_back_pairs(tables)
    tables.array(PARTICLE)[:] = tables.array(STARTED_PARTICLE)
    tables.array(PARTICLE_LANES)[:] = tables.array(PARTICLE_SHIFT)[:] = 0.0
    # At the start of a substep they are multiplied by zero, which would give NaN if they were infinite.
    tables.array(GROUP_STRAIN)[:] = 0.0
