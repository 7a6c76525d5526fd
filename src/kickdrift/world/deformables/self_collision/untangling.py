"""Untangling of cloths that already cross: from the start, or because pins and bodies have forced it.

Impulses and the detection of crossings ignore vertices of crossing triangles until these are apart. The intersection contour of
the surfaces is shortened, which needs no history: an edge that crosses a triangle is shifted along the gradient of the
contour's length (Volino and Magnenat Thalmann, Resolving surface collisions through intersection contour minimization, SIGGRAPH
2006). A corner that sticks through comes out; a sheet that cuts another one in two halves stays, and gains no energy.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.layout import (
    CORNERS,
    CROSSING_COUNT,
    NEXT_HELD,
    NONE_HELD,
    PAIR_FACES,
    PAIR_KIND,
    PARTICLE_INVERSE_MASS,
)
from kickdrift.world.deformables.self_collision.closest_features import barycentric
from kickdrift.world.deformables.self_collision.pair_rows import NO_ROOM, add_pair
from kickdrift.world.tables import CLOTH_PAIR, FACE, PARTICLE, PARTICLE_SHIFT, ZONE, floats, integers

CROSSING = 2  # kind of a pair of triangles
# Of the speed at which triangles are pushed apart: for each edge, and for all crossings of a particle together, so that a
# crumpled sheet with a thousand crossings gains no energy. Impulses in place of shifts throw sheets about.
_SHARE, _SHARE_OF_ALL = 0.25, 0.5
_MISSES = -1.0
# Of the size of a triangle: heights above its plane that are rounding errors. By these, one in a hundred flat sheets that hung
# at an angle crossed itself, and was lost.
_ROUNDING = 1e-9


@compiled
def note_crossing(world: int, f: int, g: int) -> bool:
    """Add a row for two triangles, if they cross; False if there is no room."""
    if not _cross(world, f, g):
        return True
    row = add_pair(world)
    if row == NO_ROOM:
        return False
    pair = integers(world, CLOTH_PAIR)
    pair[row, PAIR_FACES], pair[row, PAIR_FACES + 1], pair[row, PAIR_KIND] = f, g, CROSSING
    pair[row, NEXT_HELD] = NONE_HELD
    return True


@compiled
def tangle(world: int, f: int, g: int) -> None:
    """Count a crossing of two triangles at their corners, which are tangled."""
    face, zone = integers(world, FACE), integers(world, ZONE)
    for k in range(3):
        zone[face[f, CORNERS + k], CROSSING_COUNT] += 1
        zone[face[g, CORNERS + k], CROSSING_COUNT] += 1


@compiled
def _cross(world: int, f: int, g: int) -> bool:
    """Whether a side of one of two triangles crosses the other one."""
    if _on_one_side(world, f, g) or _on_one_side(world, g, f):
        return False
    found = False
    for k in range(3):
        found = found or _crossed_at(world, f, k, g) != _MISSES or _crossed_at(world, g, k, f) != _MISSES
    return found


@compiled
def _on_one_side(world: int, f: int, g: int) -> bool:
    """Whether a triangle is entirely on one side of the plane of another one."""
    face, particle = integers(world, FACE), floats(world, PARTICLE)
    origin = vector_at(particle, face[g, CORNERS], 0)
    p, q = (
        minus(vector_at(particle, face[g, CORNERS + 1], 0), origin),
        minus(vector_at(particle, face[g, CORNERS + 2], 0), origin),
    )
    n = cross(p, q)
    least, above, below = _least_height(n, p, q), 0, 0
    for k in range(3):
        height = dot(n, minus(vector_at(particle, face[f, CORNERS + k], 0), origin))
        above, below = above + int(height > least), below + int(height < -least)
    return above == 0 or below == 0


@compiled(inline=True)
def _least_height(n: Vector, p: Vector, q: Vector) -> float:
    """Return the height above a triangle with sides p and q, times its normal n = p x q, below which it is rounding."""
    return _ROUNDING * length(n) * (length(p) + length(q))


@compiled
def _crossed_at(world: int, f: int, k: int, g: int) -> float:
    """Return the position from 0 to 1 at which side k of triangle f crosses triangle g, or `_MISSES`."""
    face, particle = integers(world, FACE), floats(world, PARTICLE)
    i, j = face[f, CORNERS + k], face[f, CORNERS + (k + 1) % 3]
    ia, ib, ic = face[g, CORNERS], face[g, CORNERS + 1], face[g, CORNERS + 2]
    if i in (ia, ib, ic) or j in (ia, ib, ic):
        return _MISSES
    p, q = vector_at(particle, i, 0), vector_at(particle, j, 0)
    a, b, c = vector_at(particle, ia, 0), vector_at(particle, ib, 0), vector_at(particle, ic, 0)
    way = minus(q, p)
    u, v, w = minus(a, p), minus(b, p), minus(c, p)
    over_a, over_b, over_c = dot(way, cross(v, w)), dot(way, cross(w, u)), dot(way, cross(u, v))
    inside = (over_a > 0.0 and over_b > 0.0 and over_c > 0.0) or (over_a < 0.0 and over_b < 0.0 and over_c < 0.0)
    ab, ac = minus(b, a), minus(c, a)
    n = cross(ab, ac)
    start, end, least = dot(n, minus(p, a)), dot(n, minus(q, a)), _least_height(n, ab, ac)
    if not inside or not (min(start, -end) > least or min(-start, end) > least):
        return _MISSES
    return start / (start - end)


@compiled
def untangle(world: int, row: int, distance: float) -> None:
    """Shift two triangles that cross by a part of a distance for each crossing edge, m, to shorten their contour."""
    pair = integers(world, CLOTH_PAIR)
    f, g = pair[row, PAIR_FACES], pair[row, PAIR_FACES + 1]
    face, zone, most = integers(world, FACE), integers(world, ZONE), 1
    for k in range(3):
        most = max(most, zone[face[f, CORNERS + k], CROSSING_COUNT], zone[face[g, CORNERS + k], CROSSING_COUNT])
    share = min(_SHARE, _SHARE_OF_ALL / most)
    for k in range(3):
        for first, second in ((f, g), (g, f)):
            s = _crossed_at(world, first, k, second)
            if s != _MISSES:
                _pull_out(world, first, k, s, second, share * distance)


@compiled
def _pull_out(world: int, f: int, k: int, s: float, g: int, distance: float) -> None:
    """Shift side k of triangle f, which crosses triangle g at s, relative to g by a distance, m.

    With the directions E of the side and R of the contour from there into f, and the normal N of g, the gradient of the
    contour's length is R - 2 (E . R) / (E . N) N.
    """
    face, particle, shift = integers(world, FACE), floats(world, PARTICLE), floats(world, PARTICLE_SHIFT)
    i, j, o = face[f, CORNERS + k], face[f, CORNERS + (k + 1) % 3], face[f, CORNERS + (k + 2) % 3]
    p, q, third = vector_at(particle, i, 0), vector_at(particle, j, 0), vector_at(particle, o, 0)
    ia, ib, ic = face[g, CORNERS], face[g, CORNERS + 1], face[g, CORNERS + 2]
    a, b, c = vector_at(particle, ia, 0), vector_at(particle, ib, 0), vector_at(particle, ic, 0)
    way, at = minus(q, p), plus(times(1.0 - s, p), times(s, q))
    e, n = _unit(way), _unit(cross(minus(b, a), minus(c, a)))
    r = _unit(cross(cross(way, minus(third, p)), n))
    r = times(math.copysign(1.0, dot(r, minus(third, at))), r)
    slope = minus(r, times(2.0 * dot(e, r) / dot(e, n), n))
    u, v, w = barycentric(at, a, b, c)
    weights, of = (1.0 - s, s, -u, -v, -w), (i, j, ia, ib, ic)
    gives = 0.0
    for m in range(5):
        gives += weights[m] * weights[m] * particle[of[m], PARTICLE_INVERSE_MASS]
    if not gives > 0.0:
        return
    way = times(distance / gives, _unit(slope))
    for m in range(5):
        share = weights[m] * particle[of[m], PARTICLE_INVERSE_MASS]
        for axis in range(3):
            shift[of[m], axis] += share * way[axis]


@compiled(inline=True)
def _unit(a: Vector) -> Vector:
    """Return a vector divided by its length; zero for zero."""
    size = length(a)
    return times(1.0 / size, a) if size > 0.0 else a
