"""Pairs of a vertex and a triangle, and of edges, of cloths that may touch.

Pairs are found where the boxes of triangles overlap (`face_pairs`), each pair only from the triangles that own the vertex or
the edges. They remain valid as long as particles follow their predicted paths, at most for some steps; snapshots contain them.
Until then only pairs of triangles with a corner that has left its path are sought again.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts.layout import THREADED_SEARCH
from kickdrift.world.deformables.layout import (
    CROSSING_COUNT,
    CROSSINGS,
    FIRST_NODE,
    INVALID,
    LAST_NODE,
    MEETS_ITSELF,
    PAIR_FACES,
    PAIR_KIND,
    SEARCH_STATE,
    SKIN,
    SOUGHT,
    VALID,
)
from kickdrift.world.deformables.self_collision.pair_rows import set_pairs
from kickdrift.world.deformables.self_collision.parallel_search import call_search
from kickdrift.world.deformables.self_collision.swept_bounds import (
    find_strays,
    has_strayed,
    set_frame,
    start_search,
    sweep,
)
from kickdrift.world.deformables.self_collision.tree_walk import walk
from kickdrift.world.deformables.self_collision.untangling import CROSSING, tangle
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    CLOTH_PAIR,
    CLOTH_PAIR_NUMBERS,
    CLOTH_SEARCH,
    KERNEL_ADDRESSES,
    PARTICLE,
    ZONE,
    floats,
    integers,
    rows,
)

_MOST_STRAYS = 0.5  # of all particles: if more have left their paths, the motion of all is predicted anew
_LONGEST, _REACH = 64.0, 2.5  # longest time of a search in substeps, and mean way of particles in it in skins
_FEWEST = 1024  # nodes of the larger tree from which on threads search
_FASTEST = 1e6  # m/s, root mean square: faster cloths are about to be lost, and everything would be pairs


@compiled
def find_cloth_pairs(world: int, h: float, part: float) -> bool:
    """Find the pairs that may touch in a part of a substep, s; False if there is no room for them.

    Known pairs remain valid as long as particles follow their predicted paths, up to the horizon. A pair counts as that of the
    two triangles from which it was found, since other triangles may have left it out for their inclination.
    """
    search, own = floats(world, CLOTH_SEARCH), integers(world, CLOTH)
    if not meets(world):
        return True
    if search[0, SEARCH_STATE] != SOUGHT:  # otherwise there was no room
        strays = find_strays(world, part) if search[0, SEARCH_STATE] == VALID else rows(world, PARTICLE)
        if strays == 0:
            return True
        if strays > _MOST_STRAYS * rows(world, PARTICLE):
            speed = set_frame(world)
            if not speed < _FASTEST:
                set_pairs(world, 0)
                search[0, SEARCH_STATE] = INVALID
                return True
            start_search(world, _horizon(world, h, part, speed))
        sweep(world, part)
        search[0, SEARCH_STATE] = SOUGHT
    _drop_pairs(world)
    for a in range(rows(world, CLOTH)):
        for b in range(a, rows(world, CLOTH)):
            if (a != b or own[a, MEETS_ITSELF] != 0) and not _search(world, a, b):
                ask_for_room(world, CLOTH_PAIR, 2 * rows(world, CLOTH_PAIR) + 1024)
                return False
    _tangle(world)
    search[0, SEARCH_STATE] = VALID
    return True


@compiled
def _search(world: int, a: int, b: int) -> bool:
    """Find the pairs of two cloths, or of one with itself; False if there is no room."""
    threaded, own = integers(world, KERNEL_ADDRESSES)[0, THREADED_SEARCH], integers(world, CLOTH)
    nodes = max(own[a, LAST_NODE] - own[a, FIRST_NODE], own[b, LAST_NODE] - own[b, FIRST_NODE])
    if threaded != 0 and nodes > _FEWEST:
        fits: bool = call_search(threaded, (world, a, b))
        return fits
    return walk(world, a, b, 0, 0, 0)


@compiled
def _drop_pairs(world: int) -> None:
    """Remove the pairs of triangles with stray corners; nothing is tangled."""
    pair, numbers, zone, count = (
        integers(world, CLOTH_PAIR),
        floats(world, CLOTH_PAIR_NUMBERS),
        integers(world, ZONE),
        0,
    )
    for i in range(rows(world, PARTICLE)):
        zone[i, CROSSING_COUNT] = 0
    for row in range(rows(world, CLOTH_PAIR)):
        if has_strayed(world, pair[row, PAIR_FACES]) or has_strayed(world, pair[row, PAIR_FACES + 1]):
            continue
        if count < row:
            for k in range(CLOTH_PAIR.width):
                pair[count, k] = pair[row, k]
            for k in range(CLOTH_PAIR_NUMBERS.width):
                numbers[count, k] = numbers[row, k]
        count += 1
    set_pairs(world, count)


@compiled
def _tangle(world: int) -> None:
    """Count the crossings of triangles at their corners."""
    pair, crossings = integers(world, CLOTH_PAIR), 0.0
    for row in range(rows(world, CLOTH_PAIR)):
        if pair[row, PAIR_KIND] == CROSSING:
            tangle(world, pair[row, PAIR_FACES], pair[row, PAIR_FACES + 1])
            crossings += 1.0
    floats(world, CLOTH_SEARCH)[0, CROSSINGS] = crossings


@compiled
def meets(world: int) -> bool:
    """Whether there are several cloths, or one that collides with itself."""
    count: int = rows(world, CLOTH)
    return count > 1 or (count == 1 and integers(world, CLOTH)[0, MEETS_ITSELF] != 0)


@compiled
def _horizon(world: int, h: float, part: float, speed: float) -> float:
    """Return the time for which pairs are sought, s: long for slow cloths, short for fast ones, which would form many pairs."""
    numbers, skin = floats(world, CLOTH_NUMBERS), math.inf
    for cloth in range(rows(world, CLOTH)):
        skin = min(skin, numbers[cloth, SKIN])
    return max(min(_LONGEST * h, _REACH * skin / speed if speed > 0.0 else math.inf), part)
