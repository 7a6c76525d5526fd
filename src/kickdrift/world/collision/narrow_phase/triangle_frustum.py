"""Contact of cylinders and cones with a triangle of a mesh, which is one-sided: see `triangle_polyhedron`."""

from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import dot, length, minus, times
from kickdrift.world.collision.narrow_phase.face_bias import SHARE_OFF, tolerance_of
from kickdrift.world.collision.narrow_phase.frustum_faces import lie_on_face, touch_edge
from kickdrift.world.collision.narrow_phase.sat_faces import PLACED, lowest, place_polyhedron
from kickdrift.world.collision.narrow_phase.shape_frames import set_frame_back
from kickdrift.world.collision.narrow_phase.triangle_polyhedron import BEHIND, SIZE_OF_TRIANGLE, set_triangle
from kickdrift.world.shapes.closest_points import along
from kickdrift.world.shapes.frustum import deepest, frustum_of, highest
from kickdrift.world.shapes.polyhedron import plane, support, vertex
from kickdrift.world.shapes.triangle import ACTIVE_EDGES

# Cosine of the angle between contact normal and triangle normal below which the triangle across the edge is responsible.
_BACKWARDS = -0.01

_ROUNDING = 1e-9  # of the length of an edge


@compiled
def triangle_frustum(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a triangle and a frustum; see `kickdrift.world.collision.narrow_phase`."""
    triangle, frame, seen = floats_on_stack(SIZE_OF_TRIANGLE), floats_on_stack(12), floats_on_stack(PLACED)
    set_triangle(triangle, a)
    set_frame_back(frame, pose)
    place_polyhedron(seen, triangle, frame)
    f = frustum_of(b)
    normal, offset = plane(seen, 0)
    if -offset < -min(BEHIND, 0.5 * margin):  # height of the frustum's middle
        return 0
    gap_face = -highest(f, times(-1.0, normal)) - offset
    if gap_face > margin:
        return 0
    tolerance = tolerance_of(margin, min(f[2], max(f[0], f[1])))
    hidden = -np.inf
    side, share, outward, gap_edge, apart, above = -1, 0.0, normal, -np.inf, gap_face, np.inf
    for k in range(3):
        p, q = vertex(seen, k), vertex(seen, (k + 1) % 3)
        t, n = deepest(f, p, q)
        low, size = lowest(seen, n), length(minus(q, p))
        gap, lift = low - highest(f, n), dot(n, along(p, t, minus(q, p))) - low
        if gap > margin:
            return 0
        apart = max(apart, gap)
        if a[ACTIVE_EDGES + k] == 0.0 or -dot(n, normal) < _BACKWARDS:
            continue
        if lift > tolerance and a[ACTIVE_EDGES + (k + 1) % 3] == 0.0 and a[ACTIVE_EDGES + (k + 2) % 3] == 0.0:
            hidden = max(hidden, gap)  # the opposite corner touches, at internal edges
            continue
        # All edges have the same normal where a corner touches an end: those with the lowest point are the ones that touch.
        if gap > gap_edge + _ROUNDING * size or (gap > gap_edge - _ROUNDING * size and lift < above):
            side, share, outward, gap_edge, above = k, t, n, gap, lift
    best = max(gap_face, gap_edge, hidden)
    off = SHARE_OFF * abs(best) + tolerance
    if apart > 0.0 and best < apart - off:  # apart in a direction in which another triangle pushes, or none
        count, depth = lie_on_face(f, triangle, seen, 0, tolerance, margin, frame, manifold)
        return count if depth > 0.0 else 0  # what is above it may hit it within the step
    if gap_face >= best - off:
        count, depth = lie_on_face(f, triangle, seen, 0, tolerance, margin, frame, manifold)
        if count > 0 and (max(gap_edge, hidden) == -np.inf or abs(depth - best) <= off):
            return count
    if side < 0 or gap_edge < best - off:  # farther than the face, beside which the two touch
        return 0
    p, q = vertex(seen, side), vertex(seen, (side + 1) % 3)
    if above > tolerance:  # in deep overlap a corner of another edge may be the deepest
        p = q = vertex(seen, support(seen, times(-1.0, outward)))
    return touch_edge(f, p, q, side, share, outward, margin, frame, manifold)
