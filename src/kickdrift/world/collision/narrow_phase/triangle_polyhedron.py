"""Contact of boxes and hulls with a triangle of a mesh, whose corners are counter-clockwise as seen from outside.

The triangle is part of the surface of a solid: it pushes along its normal, and sideways only at convex edges. At other,
internal edges the surface continues with the adjacent triangle, on which a body rests that seems to touch the edge from the
side. Otherwise a box that slides over a flat floor of many triangles would catch on their edges: ghost collisions.
"""

import math
from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, cross, dot, length, minus, times
from kickdrift.world.collision.narrow_phase.box_as_polyhedron import SIZE_OF_BOX, set_box
from kickdrift.world.collision.narrow_phase.polyhedron_polyhedron import touching
from kickdrift.world.collision.narrow_phase.sat_faces import PLACED, lowest, place_polyhedron
from kickdrift.world.collision.narrow_phase.shape_frames import placed, set_frame
from kickdrift.world.shapes.polyhedron import (
    CENTRE,
    EDGES,
    EDGES_AT,
    FACES,
    HEADER,
    LOOP_EDGES_AT,
    LOOP_VERTICES_AT,
    LOOPS_AT,
    PLANES_AT,
    PUSHING,
    THICKNESS,
    VERTICES,
    plane,
    pointer_to,
    support,
    vertex,
)
from kickdrift.world.shapes.triangle import ACTIVE_EDGES

# A body whose centre is deeper than this, or than half of the margin, is behind the triangle and does not touch it. Thin plates
# may sink in as deep as the slop, and must be lifted out.
BEHIND = 0.01  # m, twice the slop of a world by default

# Sine of the largest angle by which a triangle may push downwards at an edge, so that rounding at vertical sides does not
# decide.
_DOWN = 0.25

# One face; planes for it, for the sides that stand on its edges, and for its back; six edges
_BELOW = 4
_PLANES = HEADER + 9
_LOOPS = _PLANES + 20
_EDGES = _LOOPS + 2 + 3 + 3
SIZE_OF_TRIANGLE = _EDGES + 24


@compiled
def triangle_box(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a triangle of a mesh and a box; see `kickdrift.world.collision.narrow_phase`."""
    box = floats_on_stack(SIZE_OF_BOX)
    set_box(box, b)
    return triangle_polyhedron(a, box, pose, margin, manifold)


@compiled
def triangle_hull(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a triangle of a mesh and a hull; see `kickdrift.world.collision.narrow_phase`."""
    return triangle_polyhedron(a, pointer_to(b), pose, margin, manifold)


@compiled
def triangle_polyhedron(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a triangle and a polyhedron, the second given by a pointer to its numbers."""
    triangle, frame, seen = floats_on_stack(SIZE_OF_TRIANGLE), floats_on_stack(12), floats_on_stack(PLACED)
    set_triangle(triangle, a)
    face_a = int(triangle[FACES]) - 1
    normal, offset = plane(triangle, face_a)
    set_frame(frame, pose)
    behind = min(BEHIND, 0.5 * margin)
    if dot(normal, placed(frame, (b[CENTRE], b[CENTRE + 1], b[CENTRE + 2]))) < offset - behind:
        return 0
    place_polyhedron(seen, b, frame)
    gap_a = lowest(seen, normal) - offset
    if gap_a > margin:
        return 0
    gap_b, face_b, apart = _separation_of_faces(triangle, a, seen, margin)
    if apart > margin:
        return 0
    apart = max(apart, gap_a)
    return touching(triangle, b, seen, frame, gap_a, face_a, gap_b, face_b, apart, behind, margin, manifold)


@compiled
def _separation_of_faces(triangle: Any, a: Any, b: Any, margin: float) -> tuple[float, int, float]:
    """Find the largest separation along faces of a polyhedron that the triangle may push, the face, and that of any face."""
    best, best_face, apart = -np.inf, -1, -np.inf
    for k in range(int(b[FACES])):
        outward, height = plane(b, k)
        gap = lowest(triangle, outward) - height
        apart = max(apart, gap)
        if gap > margin:
            break
        if gap > best and _pushes(triangle, a, times(-1.0, outward)):
            best, best_face = gap, k
    return best, best_face, apart


@compiled
def _pushes(triangle: Any, a: Any, direction: Vector) -> bool:
    """Whether the triangle may push in a direction: at that edge of its foremost corner whose side is closest to it."""
    corner = support(triangle, direction)
    before = (corner + 2) % 3
    outward, _ = plane(triangle, 1 + corner)
    other, _ = plane(triangle, 1 + before)
    best = corner if dot(outward, direction) > dot(other, direction) else before
    up, _ = plane(triangle, 0)
    return a[ACTIVE_EDGES + best] != 0.0 and dot(up, direction) > -_DOWN


@compiled
def set_triangle(triangle: Any, a: Any) -> None:
    """Write a triangle as a polyhedron with one face, in which each edge occurs twice: as an upper and as a lower edge.

    Each edge has a side plane that slants below the triangle. The adjacent normals of an upper edge are those of the triangle
    and of the side, those of a lower edge those of the side and of the back. Only upper edges push, and only where the surface
    is convex.
    """
    for k in range(SIZE_OF_TRIANGLE):
        triangle[k] = 0.0
    triangle[VERTICES], triangle[FACES], triangle[EDGES] = 3, 1, 6
    triangle[PLANES_AT], triangle[LOOPS_AT], triangle[EDGES_AT] = _PLANES, _LOOPS, _EDGES
    triangle[LOOP_VERTICES_AT], triangle[LOOP_EDGES_AT] = _LOOPS + 2, _LOOPS + 5
    triangle[THICKNESS] = np.inf
    for k in range(9):
        triangle[HEADER + k] = a[k]
    p, q, r = (a[0], a[1], a[2]), (a[3], a[4], a[5]), (a[6], a[7], a[8])
    normal = cross(minus(q, p), minus(r, p))
    normal = times(1.0 / length(normal), normal)
    _put_plane(triangle, _PLANES, normal, p)
    _put_plane(triangle, _PLANES + 4 * _BELOW, times(-1.0, normal), p)
    triangle[_LOOPS + 1] = 3.0
    pushing, other = 0, 6
    for k in range(3):
        triangle[_LOOPS + 2 + k], triangle[_LOOPS + 5 + k] = k, k
        begin = vertex(triangle, k)
        side = cross(minus(vertex(triangle, (k + 1) % 3), begin), normal)
        side = times(math.sqrt(1.0 - _DOWN * _DOWN) / length(side), side)
        _put_plane(triangle, _PLANES + 4 + 4 * k, minus(side, times(_DOWN, normal)), begin)
        other -= 1
        _put_edge(triangle, _EDGES + 4 * other, k, 1 + k, _BELOW)
        if a[ACTIVE_EDGES + k] != 0.0:
            at = _EDGES + 4 * pushing
            pushing += 1
        else:
            other -= 1
            at = _EDGES + 4 * other
        _put_edge(triangle, at, k, 0, 1 + k)
    triangle[PUSHING] = pushing


@compiled(inline=True)
def _put_edge(triangle: Any, at: int, begin: int, left: int, right: int) -> None:
    triangle[at], triangle[at + 1], triangle[at + 2], triangle[at + 3] = begin, (begin + 1) % 3, left, right


@compiled(inline=True)
def _put_plane(triangle: Any, at: int, normal: Vector, point: Vector) -> None:
    triangle[at], triangle[at + 1], triangle[at + 2] = normal
    triangle[at + 3] = dot(normal, point)
