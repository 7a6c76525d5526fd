"""Pairs of a vertex and a triangle, and of edges, of cloths that may touch.

Pairs are found where the boxes of triangles overlap (`face_pairs`), each pair only from the triangles that own the vertex or
the edges. They remain valid as long as particles follow their predicted paths, at most for some steps; snapshots contain them.
Until then only pairs of triangles with a corner that has left its path are sought again.
"""

import math
from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.world.collision.broad_phase.bvh import BRANCH, ITEM, SKIP
from kickdrift.world.deformables.layout import (
    BETWEEN,
    CROSSING_COUNT,
    CROSSINGS,
    FIRST_NODE,
    HAS_STRAYED,
    INVALID,
    IS_CONNECTED,
    LAST_NODE,
    MEETS_ITSELF,
    NEAR_NODE,
    NEAR_NODES,
    PAIR_FACES,
    PAIR_KIND,
    SEARCH_STATE,
    SKIN,
    SOUGHT,
    VALID,
)
from kickdrift.world.deformables.self_collision.face_normals import is_flat
from kickdrift.world.deformables.self_collision.face_pairs import overlap, pair_faces
from kickdrift.world.deformables.self_collision.pair_rows import set_pairs
from kickdrift.world.deformables.self_collision.swept_bounds import (
    find_strays,
    has_strayed,
    set_frame,
    start_search,
    sweep,
)
from kickdrift.world.deformables.self_collision.untangling import CROSSING, tangle
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    CLOTH_PAIR,
    CLOTH_PAIR_NUMBERS,
    CLOTH_SEARCH,
    CLOTH_TREE,
    CLOTH_TREE_NODE,
    NORMAL_TREE,
    PARTICLE,
    TREE_NEIGHBOUR,
    ZONE,
    floats,
    integers,
    rows,
)

_MOST_STRAYS = 0.5  # of all particles: if more have left their paths, the motion of all is predicted anew
_LONGEST, _REACH = 64.0, 2.5  # longest time of a search in substeps, and mean way of particles in it in skins
_FASTEST = 1e6  # m/s, root mean square: faster cloths are about to be lost, and everything would be pairs
_STACK = 512  # pairs of nodes: three for each level of two trees
_NUMBERS = 2 * _STACK


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
            if (a != b or own[a, MEETS_ITSELF] != 0) and not _walk(world, a, b):
                return False
    search[0, SEARCH_STATE] = VALID
    return True


@compiled
def _drop_pairs(world: int) -> None:
    """Remove the pairs of triangles with stray corners, and note what the crossings that remain tangle."""
    pair, numbers, zone = integers(world, CLOTH_PAIR), floats(world, CLOTH_PAIR_NUMBERS), integers(world, ZONE)
    floats(world, CLOTH_SEARCH)[0, CROSSINGS], count = 0.0, 0
    for i in range(rows(world, PARTICLE)):
        zone[i, CROSSING_COUNT] = 0
    for row in range(rows(world, CLOTH_PAIR)):
        f, g = pair[row, PAIR_FACES], pair[row, PAIR_FACES + 1]
        if has_strayed(world, f) or has_strayed(world, g):
            continue
        if pair[row, PAIR_KIND] == CROSSING:
            tangle(world, f, g)
        if count < row:
            for k in range(CLOTH_PAIR.width):
                pair[count, k] = pair[row, k]
            for k in range(CLOTH_PAIR_NUMBERS.width):
                numbers[count, k] = numbers[row, k]
        count += 1
    set_pairs(world, count)


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


@compiled
def _walk(world: int, a: int, b: int) -> bool:
    """Find the pairs of two cloths, or of one with itself, by traversing both trees together; False if there is no room."""
    own = integers(world, CLOTH)
    tree, node = floats(world, CLOTH_TREE), integers(world, CLOTH_TREE_NODE)
    one, other = tree[own[a, FIRST_NODE] : own[a, LAST_NODE]], tree[own[b, FIRST_NODE] : own[b, LAST_NODE]]
    normals, begin = floats(world, NORMAL_TREE), own[a, FIRST_NODE]
    stack = carray(floats_on_stack(_NUMBERS), (_STACK, 2))
    stack[0, 0] = stack[0, 1] = 0.0
    top, fits = 1, True
    while top > 0 and fits:
        top -= 1
        m, n = int(stack[top, 0]), int(stack[top, 1])
        same = a == b and m == n
        at = begin + m
        if node[at, HAS_STRAYED] == 0 and node[own[b, FIRST_NODE] + n, HAS_STRAYED] == 0:
            continue
        if same and node[at, IS_CONNECTED] != 0 and is_flat(normals, at, at, at):
            continue
        if not (same or overlap(one, m, other, n)):
            continue
        if a == b and _are_one_piece(world, begin, m, n):
            continue
        left, right = one[m, ITEM] == BRANCH, other[n, ITEM] == BRANCH
        if not left and not right:
            fits = _compare(world, a, b, one, m, other, n)
            continue
        for i in range(2 if left else 1):
            for j in range(2 if right else 1):
                k = m if not left else m + 1 if i == 1 else int(one[m + 1, SKIP])
                o = n if not right else n + 1 if j == 1 else int(other[n + 1, SKIP])
                if not same or k <= o:
                    stack[top, 0], stack[top, 1] = k, o
                    top += 1
    return fits


@compiled
def _are_one_piece(world: int, begin: int, m: int, n: int) -> bool:
    """Whether two nodes of a tree that begins in that row form one flat piece with the node that joins them."""
    node, near, normals = integers(world, CLOTH_TREE_NODE), integers(world, TREE_NEIGHBOUR), floats(world, NORMAL_TREE)
    for k in range(node[begin + m, NEAR_NODES], node[begin + m, NEAR_NODES + 1]):
        if near[k, NEAR_NODE] == n:
            flat: bool = is_flat(normals, begin + m, begin + n, begin + near[k, BETWEEN])
            return flat
    return False


@compiled
def _compare(world: int, a: int, b: int, one: Any, m: int, other: Any, n: int) -> bool:
    """Find the pairs of two twigs; False if there is no room."""
    fits, same, node = True, a == b and m == n, integers(world, CLOTH_TREE_NODE)
    begin, after = integers(world, CLOTH)[a, FIRST_NODE], integers(world, CLOTH)[b, FIRST_NODE]
    last = int(other[n, SKIP])
    for i in range(m + 1, int(one[m, SKIP])):
        if not (same or overlap(one, i, other, n)):
            continue
        strays = node[begin + i, HAS_STRAYED]
        for j in range(i + 1 if same else n + 1, last):
            if strays | node[after + j, HAS_STRAYED] != 0 and overlap(one, i, other, j):
                fits = fits and pair_faces(world, a, b, int(one[i, ITEM]), int(other[j, ITEM]))
    return fits
