"""Pairs of a vertex and a triangle, and of edges, that two triangles own and that may touch."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import length
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.layout import (
    CLOTH_FRICTION,
    CLOTH_RADIUS,
    CORNERS,
    NEXT_HELD,
    NONE_HELD,
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
    SKIN,
    TRAVELLED,
)
from kickdrift.world.deformables.self_collision.closest_features import EDGE_EDGE, VERTEX_FACE, Corners, nearest
from kickdrift.world.deformables.self_collision.face_normals import is_flat_around, least_cosine
from kickdrift.world.deformables.self_collision.pair_culling import are_apart, nearing
from kickdrift.world.deformables.self_collision.pair_rows import NO_ROOM, add_pair
from kickdrift.world.deformables.self_collision.swept_bounds import predicted
from kickdrift.world.deformables.self_collision.untangling import note_crossing
from kickdrift.world.material_mixing import mixed_friction
from kickdrift.world.tables import (
    CLOTH_NUMBERS,
    CLOTH_PAIR,
    CLOTH_PAIR_NUMBERS,
    CLOTH_SEARCH,
    FACE,
    FACE_BOUNDS,
    PARTICLE,
    PARTICLE_BOUNDS,
    PARTICLE_REST,
    floats,
    integers,
)

_FOLDED = 0.0  # cosine between the normals of triangles with a common edge, above which they cannot touch
_CLOSE = 0.5  # of the distance at rest: the distance kept between features that are closer than the thickness at rest


@compiled
def pair_faces(world: int, cloth: int, other: int, f: int, g: int) -> bool:
    """Find the pairs of two triangles; False if there is no room for them.

    Triangles with a common edge cannot touch unless folded, those with a common vertex unless any triangle around it is.
    """
    face = integers(world, FACE)
    shared = common = 0
    for i in range(3):
        for j in range(3):
            if face[f, CORNERS + i] == face[g, CORNERS + j]:
                shared, common = shared + 1, i
    if shared == 2 and least_cosine(world, f, g) > _FOLDED:
        return True
    if shared == 1 and is_flat_around(world, f, common):
        return True
    if shared == 0 and are_apart(world, cloth, other, f, g):
        return True
    fits, bounds = shared == 2 or note_crossing(world, f, g), floats(world, PARTICLE_BOUNDS)
    for i in range(3):
        if face[f, OWNED] >> i & 1 and overlap(bounds, face[f, CORNERS + i], floats(world, FACE_BOUNDS), g):
            fits = fits and _add(world, cloth, other, VERTEX_FACE, _vertex_and(world, f, i, g), f, g)
        if face[g, OWNED] >> i & 1 and overlap(bounds, face[g, CORNERS + i], floats(world, FACE_BOUNDS), f):
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
    row = add_pair(world)
    if row == NO_ROOM:
        return False
    pair, own = integers(world, CLOTH_PAIR), floats(world, CLOTH_PAIR_NUMBERS)
    for k in range(4):
        pair[row, PAIR_PARTICLES + k] = at[k]
    pair[row, PAIR_FACES], pair[row, PAIR_FACES + 1] = f, g
    pair[row, PAIR_KIND], pair[row, NEXT_HELD], own[row, PAIR_DISTANCE] = kind, NONE_HELD, kept
    own[row, PAIR_APART], own[row, PAIR_LAID] = _distance(floats(world, PARTICLE), kind, at), NOT_LAID
    own[row, PAIR_SEEN] = floats(world, CLOTH_SEARCH)[0, TRAVELLED]
    own[row, PAIR_FRICTION] = mixed_friction(numbers[cloth, CLOTH_FRICTION], numbers[other, CLOTH_FRICTION])
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
        kind, predicted(world, i, age), predicted(world, j, age), predicted(world, k, age), predicted(world, m, age)
    )
    return length(apart)


@compiled(inline=True)
def overlap(a: Any, m: int, b: Any, n: int) -> bool:
    """Whether boxes in rows of two tables overlap; False for NaN."""
    meets: bool = (a[m, 0] <= b[n, 3]) & (a[m, 1] <= b[n, 4]) & (a[m, 2] <= b[n, 5])
    meets &= (a[m, 3] >= b[n, 0]) & (a[m, 4] >= b[n, 1]) & (a[m, 5] >= b[n, 2])
    return meets
