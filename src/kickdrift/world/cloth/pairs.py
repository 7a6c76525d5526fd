"""Pairs of a vertex and a triangle, and of edges, of cloths that may touch.

Pairs are found where the boxes of triangles overlap, each pair only from the triangles that own the vertex or the edges. They
remain valid as long as particles follow their predicted paths, at most to the end of the step, so that steps after a snapshot
have the same bits. Until then only pairs of triangles with a corner that has left its path are sought again.
"""

import math
from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import length
from kickdrift.world.cloth.layout import (
    BETWEEN,
    CLOTH_FRICTION,
    CLOTH_RADIUS,
    CORNERS,
    CROSSINGS,
    FIRST_NODE,
    HAS_STRAYED,
    INVALID,
    IS_CONNECTED,
    IS_TANGLED,
    LAST_NODE,
    MEETS_ITSELF,
    NEIGHBOUR,
    NEIGHBOURS,
    NOT_LAID,
    OWNED,
    PAIR_APART,
    PAIR_DISTANCE,
    PAIR_FACES,
    PAIR_FRICTION,
    PAIR_KIND,
    PAIR_LAID,
    PAIR_PARTICLES,
    PAIR_SEEN,
    SEARCH_AGE,
    SEARCH_STATE,
    SKIN,
    SOUGHT,
    TRAVELLED,
    VALID,
)
from kickdrift.world.cloth.proximity import EDGE_EDGE, VERTEX_FACE, Corners, nearest
from kickdrift.world.cloth.separation import are_apart, nearing
from kickdrift.world.cloth.swept import (
    find_strays,
    foreseen,
    has_strayed,
    is_flat,
    least_cosine,
    set_frame,
    start_search,
    sweep,
)
from kickdrift.world.cloth.tangles import CROSSING, note_crossing, tangle
from kickdrift.world.collision.bvh import BRANCH, ITEM, SKIP
from kickdrift.world.columns import vector_at
from kickdrift.world.step_status import ask_for_room
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    CLOTH_PAIR,
    CLOTH_PAIR_NUMBERS,
    CLOTH_SEARCH,
    CLOTH_TREE,
    CLOTH_TREE_NODE,
    FACE,
    FACE_BOUNDS,
    NORMAL_TREE,
    PARTICLE,
    PARTICLE_BOUNDS,
    PARTICLE_REST,
    TREE_NEIGHBOUR,
    ZONE,
    floats,
    integers,
    room,
    rows,
    set_rows,
)

_MOST_STRAYS = 0.5  # of all particles: if more have left their paths, the motion of all is predicted anew
_FASTEST = 1e6  # m/s, root mean square: faster cloths are about to be lost, and everything would be pairs
_STACK = 512  # pairs of nodes: three for each level of two trees
_NUMBERS = 2 * _STACK
# Cosines between the normals of adjacent triangles above which they cannot touch: with a common edge, and with a common vertex.
# Of six triangles around a vertex the first and the last may cross, while the sixth is folded away.
_FOLDED, _BENT = 0.0, 0.62
_CLOSE = 0.5  # of the distance at rest: the distance kept between features that are closer than the thickness at rest


@compiled
def find_pairs(world: int, h: float, part: float) -> bool:
    """Find the pairs that may touch in a part of a substep, s; False if there is no room for them.

    Known pairs remain valid as long as particles follow their predicted paths, at most for the time 4 h, s. A pair counts as
    that of the two triangles from which it was found, since that of others may have been left out for how these were inclined.
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
                set_rows(world, CLOTH_PAIR, 0)
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
        zone[i, IS_TANGLED] = 0
    for row in range(rows(world, CLOTH_PAIR)):
        f, g = pair[row, PAIR_FACES], pair[row, PAIR_FACES + 1]
        if has_strayed(world, f) or has_strayed(world, g):
            continue
        if pair[row, PAIR_KIND] == CROSSING:
            tangle(world, f, g)
        for k in range(CLOTH_PAIR.width):
            pair[count, k] = pair[row, k]
        for k in range(CLOTH_PAIR_NUMBERS.width):
            numbers[count, k] = numbers[row, k]
        count += 1
    set_rows(world, CLOTH_PAIR, count)


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
    return max(min(4.0 * h, 2.0 * skin / max(speed, 1e-12)), part)


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
        if not (same or _overlap(one, m, other, n)):
            continue
        if a == b and is_flat(normals, at, begin + n, at) and _are_one_piece(world, begin, m, n):
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
    """Whether two nodes of a tree that begins in that row are one flat piece, with what joins them, as each of them is flat."""
    node, near, normals = integers(world, CLOTH_TREE_NODE), integers(world, TREE_NEIGHBOUR), floats(world, NORMAL_TREE)
    for k in range(node[begin + m, NEIGHBOURS], node[begin + m, NEIGHBOURS + 1]):
        if near[k, NEIGHBOUR] == n:
            flat: bool = is_flat(normals, begin + m, begin + n, begin + near[k, BETWEEN])
            return flat
    return False


@compiled
def _compare(world: int, a: int, b: int, one: Any, m: int, other: Any, n: int) -> bool:
    """Find the pairs of two twigs; False if there is no room."""
    fits, same, node = True, a == b and m == n, integers(world, CLOTH_TREE_NODE)
    begin, after = integers(world, CLOTH)[a, FIRST_NODE], integers(world, CLOTH)[b, FIRST_NODE]
    for i in range(m + 1, int(one[m, SKIP])):
        for j in range(i + 1 if same else n + 1, int(other[n, SKIP])):
            strays = (node[begin + i, HAS_STRAYED] | node[after + j, HAS_STRAYED]) != 0
            if strays and _overlap(one, i, other, j):
                fits = fits and _pair_faces(world, a, b, int(one[i, ITEM]), int(other[j, ITEM]))
    return fits


@compiled(inline=True)
def _overlap(a: Any, m: int, b: Any, n: int) -> bool:
    """Whether boxes in rows of two tables overlap; False for NaN."""
    meets: bool = (a[m, 0] <= b[n, 3]) & (a[m, 1] <= b[n, 4]) & (a[m, 2] <= b[n, 5])
    meets &= (a[m, 3] >= b[n, 0]) & (a[m, 4] >= b[n, 1]) & (a[m, 5] >= b[n, 2])
    return meets


@compiled
def _pair_faces(world: int, cloth: int, other: int, f: int, g: int) -> bool:
    """Find the pairs of two triangles; False if there is no room for them.

    Adjacent triangles at a small angle cannot touch.
    """
    face = integers(world, FACE)
    shared = 0
    for i in range(3):
        for j in range(3):
            shared += int(face[f, CORNERS + i] == face[g, CORNERS + j])
    if shared > 0 and least_cosine(world, f, g) > (_FOLDED if shared == 2 else _BENT):
        return True
    if shared == 0 and are_apart(world, cloth, other, f, g):
        return True
    fits, bounds = shared == 2 or note_crossing(world, f, g), floats(world, PARTICLE_BOUNDS)
    for i in range(3):
        if face[f, OWNED] >> i & 1 and _overlap(bounds, face[f, CORNERS + i], floats(world, FACE_BOUNDS), g):
            fits = fits and _add(world, cloth, other, VERTEX_FACE, _vertex_and(world, f, i, g), f, g)
        if face[g, OWNED] >> i & 1 and _overlap(bounds, face[g, CORNERS + i], floats(world, FACE_BOUNDS), f):
            fits = fits and _add(world, other, cloth, VERTEX_FACE, _vertex_and(world, g, i, f), g, f)
        for j in range(3):
            if face[f, OWNED] >> (3 + i) & 1 and face[g, OWNED] >> (3 + j) & 1:
                edges = _edges(world, f, i, g, j)
                if _edges_overlap(bounds, edges):
                    fits = fits and _add(world, cloth, other, EDGE_EDGE, edges, f, g)
    return fits


@compiled(inline=True)
def _edges_overlap(bounds: Any, at: Corners) -> bool:
    """Whether the boxes of two edges overlap."""
    p, a, b, c = at
    meets = True
    for k in range(3):
        meets &= min(bounds[p, k], bounds[a, k]) <= max(bounds[b, 3 + k], bounds[c, 3 + k])
        meets &= max(bounds[p, 3 + k], bounds[a, 3 + k]) >= min(bounds[b, k], bounds[c, k])
    return meets


@compiled(inline=True)
def _vertex_and(world: int, f: int, i: int, g: int) -> Corners:
    """Return the particles of the pair of corner i of triangle f and triangle g."""
    face = integers(world, FACE)
    return (face[f, CORNERS + i], face[g, CORNERS], face[g, CORNERS + 1], face[g, CORNERS + 2])


@compiled(inline=True)
def _edges(world: int, f: int, i: int, g: int, j: int) -> Corners:
    """Return the particles of the pair of side i of triangle f and side j of triangle g."""
    face = integers(world, FACE)
    return (face[f, CORNERS + i], face[f, CORNERS + (i + 1) % 3], face[g, CORNERS + j], face[g, CORNERS + (j + 1) % 3])


@compiled
def _add(world: int, cloth: int, other: int, kind: int, at: Corners, f: int, g: int) -> bool:
    """Add a pair that triangles f and g own, unless it shares a particle or is too far apart; False if there is no room."""
    p, a, b, c = at
    if p in (b, c) or (p == a if kind == VERTEX_FACE else a in (b, c)):
        return True
    numbers = floats(world, CLOTH_NUMBERS)
    kept = numbers[cloth, CLOTH_RADIUS] + numbers[other, CLOTH_RADIUS]
    reach = nearing(world, kind, at) + numbers[cloth, SKIN] + numbers[other, SKIN]
    apart = _predicted_distance(world, kind, at)
    if not apart <= kept + reach:
        return True
    if cloth == other:
        kept = min(kept, _CLOSE * _distance(floats(world, PARTICLE_REST), kind, at))
        if apart > kept + reach:
            return True
    row = rows(world, CLOTH_PAIR)
    if row >= min(room(world, CLOTH_PAIR), room(world, CLOTH_PAIR_NUMBERS)):
        ask_for_room(world, CLOTH_PAIR, 2 * row + 1024)
        return False
    set_rows(world, CLOTH_PAIR, row + 1)
    pair, own = integers(world, CLOTH_PAIR), floats(world, CLOTH_PAIR_NUMBERS)
    for k in range(4):
        pair[row, PAIR_PARTICLES + k] = at[k]
    pair[row, PAIR_FACES], pair[row, PAIR_FACES + 1] = f, g
    pair[row, PAIR_KIND], own[row, PAIR_DISTANCE] = kind, kept
    own[row, PAIR_APART], own[row, PAIR_LAID] = _distance(floats(world, PARTICLE), kind, at), NOT_LAID
    own[row, PAIR_SEEN] = floats(world, CLOTH_SEARCH)[0, TRAVELLED]
    own[row, PAIR_FRICTION] = math.sqrt(numbers[cloth, CLOTH_FRICTION] * numbers[other, CLOTH_FRICTION])
    return True


@compiled(inline=True)
def _distance(table: Any, kind: int, at: Corners) -> float:
    """Return the distance of a pair with the positions of a table, m."""
    p, a, b, c = (
        vector_at(table, at[0], 0),
        vector_at(table, at[1], 0),
        vector_at(table, at[2], 0),
        vector_at(table, at[3], 0),
    )
    _, apart = nearest(kind, p, a, b, c)
    return length(apart)


@compiled(inline=True)
def _predicted_distance(world: int, kind: int, at: Corners) -> float:
    """Return the distance of a pair at the present predicted positions, m."""
    age, (i, j, k, m) = floats(world, CLOTH_SEARCH)[0, SEARCH_AGE], at
    _, apart = nearest(
        kind, foreseen(world, i, age), foreseen(world, j, age), foreseen(world, k, age), foreseen(world, m, age)
    )
    return length(apart)
