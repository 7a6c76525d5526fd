"""The stage that begins a step of cloths, and the way back to where it began."""

from kickdrift.core.compilation import compiled
from kickdrift.world.deformables.body_contacts.predicted_loads import note_loads, roll_back_loads
from kickdrift.world.deformables.layout import CROSSINGS, INVALID, IS_ASLEEP, KEPT, SEARCH_STATE, SOUGHT, STIRRED, TURN
from kickdrift.world.deformables.particle_tables import forget_pairs
from kickdrift.world.deformables.self_collision.swept_bounds import restore_boxes
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_SEARCH,
    GROUP_STRAIN,
    PARTICLE,
    PARTICLE_LANES,
    PARTICLE_SHIFT,
    STARTED_PARTICLE,
    Tables,
    floats,
    integers,
    rows,
)


@compiled
def begin_cloths(t: float, h: float, world: int) -> None:
    """Save the state of cloths for a rollback, and note whether the user has moved them while they slept."""
    search, own, moved = floats(world, CLOTH_SEARCH), integers(world, CLOTH), False
    if not note_loads(world):
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
    """Restore the state of cloths at the start of the step; pairs are sought anew."""
    roll_back_loads(tables)
    forget_pairs(tables)
    tables.array(PARTICLE)[:] = tables.array(STARTED_PARTICLE)
    tables.array(PARTICLE_LANES)[:] = tables.array(PARTICLE_SHIFT)[:] = 0.0
    # At the start of a substep they are multiplied by zero, which would give NaN if they were infinite.
    tables.array(GROUP_STRAIN)[:] = 0.0
