"""Distances of vertices from triangles, and of edges from each other.

Both are vectors from the second feature to the first: sums over the positions of four particles with weights that add up to
zero, 1 and minus the barycentric coordinates of the nearest point, or those of two points of edges.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.shapes.closest_points import segments

VERTEX_FACE, EDGE_EDGE = 0, 1

Weights = tuple[float, float, float, float]
Corners = tuple[int, int, int, int]
Ways = tuple[Vector, Vector, Vector, Vector]


@compiled
def nearest(kind: int, p: Vector, a: Vector, b: Vector, c: Vector) -> tuple[Weights, Vector]:
    """Return weights and distance vector of a vertex p from a triangle a b c, or of the edge p a from the edge b c."""
    if kind == VERTEX_FACE:
        u, v, w = barycentric(p, a, b, c)
        weights = (1.0, -u, -v, -w)
    else:
        middle = times(0.5, minus(plus(b, c), plus(p, a)))
        s, t = segments(middle, times(0.5, minus(a, p)), times(0.5, minus(c, b)))
        weights = (0.5 - 0.5 * s, 0.5 + 0.5 * s, 0.5 * t - 0.5, -0.5 - 0.5 * t)
    return weights, mix(weights, p, a, b, c)


@compiled(inline=True)
def mix(weights: Weights, p: Vector, a: Vector, b: Vector, c: Vector) -> Vector:
    """Return the weighted sum of four vectors."""
    return plus(plus(times(weights[0], p), times(weights[1], a)), plus(times(weights[2], b), times(weights[3], c)))


@compiled(inline=True)
def mixed(weights: Weights, table: Any, at: Corners, first: int) -> Vector:
    """Return the weighted sum of vectors in four rows of a table."""
    return mix(
        weights,
        vector_at(table, at[0], first),
        vector_at(table, at[1], first),
        vector_at(table, at[2], first),
        vector_at(table, at[3], first),
    )


@compiled(inline=True)
def less_mean(p: Vector, a: Vector, b: Vector, c: Vector) -> Ways:
    """Return the displacements of the particles of a pair less their mean."""
    mean = times(0.25, plus(plus(p, a), plus(b, c)))
    return (minus(p, mean), minus(a, mean), minus(b, mean), minus(c, mean))


@compiled(inline=True)
def closing(kind: int, ways: Ways) -> float:
    """Bound the decrease of the distance of a pair by given displacements of its particles, m."""
    p, a, b, c = dot(ways[0], ways[0]), dot(ways[1], ways[1]), dot(ways[2], ways[2]), dot(ways[3], ways[3])
    if kind == VERTEX_FACE:
        return math.sqrt(p) + math.sqrt(max(a, b, c))
    return math.sqrt(max(p, a)) + math.sqrt(max(b, c))


@compiled
def barycentric(p: Vector, a: Vector, b: Vector, c: Vector) -> Vector:
    """Return the barycentric coordinates of the point of a triangle that is nearest to p (Ericson 2005, section 5.1.5)."""
    ab, ac, ap = minus(b, a), minus(c, a), minus(p, a)
    d1, d2 = dot(ab, ap), dot(ac, ap)
    if d1 <= 0.0 and d2 <= 0.0:
        return (1.0, 0.0, 0.0)
    bp = minus(p, b)
    d3, d4 = dot(ab, bp), dot(ac, bp)
    if d3 >= 0.0 and d4 <= d3:
        return (0.0, 1.0, 0.0)
    n = cross(ab, ac)
    over_c = dot(n, cross(ab, ap))
    if over_c <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        v = d1 / (d1 - d3)
        return (1.0 - v, v, 0.0)
    cp = minus(p, c)
    d5, d6 = dot(ab, cp), dot(ac, cp)
    if d6 >= 0.0 and d5 <= d6:
        return (0.0, 0.0, 1.0)
    over_b = -dot(n, cross(ac, ap))
    if over_b <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        w = d2 / (d2 - d6)
        return (1.0 - w, 0.0, w)
    over_a = dot(n, cross(minus(c, b), bp))
    if over_a <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return (0.0, 1.0 - w, w)
    scale = 1.0 / (over_a + over_b + over_c)
    v, w = over_b * scale, over_c * scale
    return (1.0 - v - w, v, w)
