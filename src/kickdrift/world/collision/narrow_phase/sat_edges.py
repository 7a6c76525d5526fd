"""Edges of two polyhedra: as separating axes, and as closest features.

Edges are rows of `EDGE` numbers.
"""

import math
from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, times
from kickdrift.world.collision.narrow_phase.face_bias import PARALLEL
from kickdrift.world.collision.narrow_phase.manifold_candidates import crossing
from kickdrift.world.collision.narrow_phase.manifold_points import put_normal, put_point
from kickdrift.world.collision.narrow_phase.shape_frames import placed_back
from kickdrift.world.columns import Fields
from kickdrift.world.shapes.closest_points import along, segments
from kickdrift.world.shapes.polyhedron import EDGES, edge, plane, vertex

# Numbers of an edge
_EDGE = Fields()
_EDGE.field(3, "m")  # its middle
_HALF = _EDGE.field(3, "m")  # vector from there to one end
_NUMBER = _EDGE.field()
_LEFT = _EDGE.field(3)  # normals of the adjacent faces
_RIGHT = _EDGE.field(3)
EDGE = _EDGE.close()

_ROUNDING = 1e-9  # of the lengths of edges


@compiled
def edges_beyond(numbers: Any, placed: Any, normal: Vector, least: float, edges: Any) -> int:
    """Write the edges of a polyhedron that reach beyond a plane, normal . x >= least; return their number.

    ``placed`` holds the vertices and planes of the polyhedron in the frame of the plane, ``numbers`` the rest.
    """
    count = 0
    for k in range(int(numbers[EDGES])):
        begin, end, left, right = edge(numbers, k)
        p, q = vertex(placed, begin), vertex(placed, end)
        if max(dot(normal, p), dot(normal, q)) >= least:
            u, _ = plane(placed, left)
            v, _ = plane(placed, right)
            put_row(edges, count, p, q, k)
            at = EDGE * count
            edges[at + _LEFT], edges[at + _LEFT + 1], edges[at + _LEFT + 2] = u
            edges[at + _RIGHT], edges[at + _RIGHT + 1], edges[at + _RIGHT + 2] = v
            count += 1
    return count


@compiled(inline=True)
def put_row(edges: Any, row: int, begin: Vector, end: Vector, number: int) -> None:
    """Write an edge without the normals."""
    at = EDGE * row
    for i in range(3):
        edges[at + i], edges[at + _HALF + i] = 0.5 * (begin[i] + end[i]), 0.5 * (end[i] - begin[i])
    edges[at + _NUMBER] = number


@compiled(inline=True)
def _vector(edges: Any, at: int) -> Vector:
    return (edges[at], edges[at + 1], edges[at + 2])


@compiled
def count_below(edges: Any, count: int, number: int) -> int:
    """Return how many rows of edges, in ascending order of their numbers, have a number below a given one."""
    while count > 0 and edges[EDGE * (count - 1) + _NUMBER] >= number:
        count -= 1
    return count


@compiled
def separation_of_edges(
    edges_a: Any, count_a: int, pushing: int, edges_b: Any, count_b: int
) -> tuple[float, int, int, Vector, float]:
    """Find the largest separation along the cross products of edges, of which the first ``pushing`` of a allow impulses.

    Returns
    -------
    gap, row_a, row_b, normal
        The largest separation for one of the first ``pushing`` rows of a, the rows of the pair, and the unit vector from a to
        b.
    apart : float
        The largest separation for any row.

    Notes
    -----
    Only pairs of edges that form a face of the Minkowski difference count: the arcs between the normals of their adjacent
    faces, those of one negated, intersect on the unit sphere (Gregorius 2013, The Separating Axis Test between Convex
    Polyhedra).
    """
    best, best_a, best_b, normal, apart = -np.inf, count_a, count_b, (0.0, 0.0, 0.0), -np.inf
    for j in range(count_b):
        b = EDGE * j
        e_b, u_b, v_b = _vector(edges_b, b + _HALF), _vector(edges_b, b + _LEFT), _vector(edges_b, b + _RIGHT)
        square_b = dot(e_b, e_b)
        for i in range(count_a):
            a = EDGE * i
            e_a = _vector(edges_a, a + _HALF)
            u_to_a, v_to_a = dot(u_b, e_a), dot(v_b, e_a)
            if u_to_a * v_to_a >= 0.0:
                continue
            u_a, v_a = _vector(edges_a, a + _LEFT), _vector(edges_a, a + _RIGHT)
            u_to_b, v_to_b = dot(u_a, e_b), dot(v_a, e_b)
            if u_to_b * v_to_b >= 0.0 or u_to_a * v_to_b >= 0.0:
                continue
            axis = cross(e_a, e_b)
            square = dot(axis, axis)
            if square <= PARALLEL * dot(e_a, e_a) * square_b:
                continue
            outward = dot(axis, u_a) + dot(axis, v_a)
            axis = times(math.copysign(1.0 / math.sqrt(square), outward), axis)
            gap = dot(axis, minus(_vector(edges_b, b), _vector(edges_a, a)))
            apart = max(apart, gap)
            if gap > best and i < pushing:
                best, best_a, best_b, normal = gap, i, j, axis
    return best, best_a, best_b, normal, apart


@compiled
def put_edges(
    edges_a: Any, i: int, edges_b: Any, j: int, normal: Vector, astray: float, frame: Any, manifold: Any
) -> int:
    """Write the closest points of two edges as a contact point, or none if they miss each other.

    Parameters
    ----------
    edges_a, i, edges_b, j
        Two rows of edges in the frame of the first shape.
    normal : (3,) tuple
        Unit vector from the first to the second.
    astray : float
        Distance by which the closest points may miss each other perpendicular to the normal, m. If infinite, the normal is the
        direction between them, and the given one is used only if their distance is rounding.
    frame : pointer to floats
        Frame of the second shape in the first's.
    manifold : array
        See `kickdrift.world.collision.narrow_phase`.

    Returns
    -------
    int
        Number of points.
    """
    a, b = EDGE * i, EDGE * j
    middle_a, half_a = _vector(edges_a, a), _vector(edges_a, a + _HALF)
    middle_b, half_b = _vector(edges_b, b), _vector(edges_b, b + _HALF)
    s, t = segments(minus(middle_b, middle_a), half_a, half_b)
    on_a, on_b = along(middle_a, s, half_a), along(middle_b, t, half_b)
    way = minus(on_b, on_a)
    distance, rounding = length(way), _ROUNDING * (length(half_a) + length(half_b))
    if astray == np.inf:
        normal = times(1.0 / distance, way) if distance > rounding else normal
    elif length(minus(way, times(dot(way, normal), normal))) > astray + rounding:
        return 0
    put_normal(manifold, normal)
    feature = crossing(int(edges_a[a + _NUMBER]), int(edges_b[b + _NUMBER]))
    put_point(manifold, 0, on_a, placed_back(frame, on_b), feature)
    return 1


@compiled
def put_closest(
    edges_a: Any,
    count_a: int,
    pushing: int,
    edges_b: Any,
    count_b: int,
    axis: Vector,
    frame: Any,
    margin: float,
    manifold: Any,
) -> int:
    """Write the closest points of the edges of two separated polyhedra, if they are within the margin; return their number.

    The normal is the direction between the points, or the given axis if their distance is rounding. Where an edge of a that
    allows no impulse is nearer than the first ``pushing`` ones, there is no point: the normal of another separates nothing.
    """
    best, best_a, best_b = margin, count_a, count_b
    for j in range(count_b):
        middle_b, half_b = _vector(edges_b, EDGE * j), _vector(edges_b, EDGE * j + _HALF)
        length_b = length(half_b)
        for i in range(count_a):
            offset, half_a = minus(middle_b, _vector(edges_a, EDGE * i)), _vector(edges_a, EDGE * i + _HALF)
            if length(offset) - length(half_a) - length_b <= best:
                s, t = segments(offset, half_a, half_b)
                distance = length(minus(along(offset, t, half_b), times(s, half_a)))
                if distance < best:
                    best, best_a, best_b = distance, i, j
    if best_a >= pushing:
        return 0
    return put_edges(edges_a, best_a, edges_b, best_b, axis, np.inf, frame, manifold)
