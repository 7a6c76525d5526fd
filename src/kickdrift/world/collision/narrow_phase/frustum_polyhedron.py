"""Contact of boxes and hulls with cylinders and cones.

The direction of largest separation is the normal of a face of the polyhedron, the axis of the frustum, or the normal of the
frustum at the deepest point of an edge of the polyhedron, which is found exactly: the signed distance is convex along an edge.
This holds for shapes that are apart; where they overlap deeply, `epa` finds the direction.
"""

from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, cross, dot, length, minus, times
from kickdrift.world.collision.narrow_phase.box_as_polyhedron import SIZE_OF_BOX, set_box
from kickdrift.world.collision.narrow_phase.epa import DEEP, is_off, overlap_of_polyhedron, put_overlap
from kickdrift.world.collision.narrow_phase.face_bias import SHARE_OFF, tolerance_of
from kickdrift.world.collision.narrow_phase.frustum_faces import lie_on_face, stand_on_end, touch_edge
from kickdrift.world.collision.narrow_phase.sat_faces import PLACED, lowest, place_polyhedron
from kickdrift.world.collision.narrow_phase.shape_frames import set_frame_back
from kickdrift.world.contacts.layout import ON_B
from kickdrift.world.shapes.closest_points import along
from kickdrift.world.shapes.frustum import Frustum, deepest, farthest, frustum_of, highest, signed_distance
from kickdrift.world.shapes.polyhedron import (
    EDGES,
    FACES,
    THICKNESS,
    edge,
    loop,
    loop_vertex,
    plane,
    pointer_to,
    support,
    vertex,
)

_NONE = -1
_ROUNDING = 1e-9


@compiled
def box_frustum(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a box and a frustum; see `kickdrift.world.collision.narrow_phase`."""
    box, frame = floats_on_stack(SIZE_OF_BOX), floats_on_stack(12)
    set_box(box, a)
    set_frame_back(frame, pose)
    return polyhedron_frustum(box, 6, 0, frustum_of(b), frame, margin, manifold)


@compiled
def hull_frustum(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a hull and a frustum; see `kickdrift.world.collision.narrow_phase`."""
    hull, frame = pointer_to(a), floats_on_stack(12)
    set_frame_back(frame, pose)
    return polyhedron_frustum(hull, int(hull[FACES]), 0, frustum_of(b), frame, margin, manifold)


@compiled
def polyhedron_frustum(body: Any, faces: int, near: int, f: Frustum, frame: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a polyhedron and a frustum.

    Parameters
    ----------
    body : pointer to floats
        Numbers of the polyhedron.
    faces : int
        Number of its faces that count, the first ones: the others approximate a curved surface.
    near : int
        0 for an exact polyhedron. If it approximates a frustum, the number of corners of each end, of which only edges between
        the last and the second corner are considered.
    f : (3,) tuple
        The frustum.
    frame : pointer to floats
        Frame of the polyhedron in the frustum's.
    margin, manifold
        See `kickdrift.world.collision.narrow_phase`.
    """
    seen = floats_on_stack(PLACED)
    place_polyhedron(seen, body, frame)
    face, gap_face = _best_face(f, seen, faces, margin)
    if gap_face > margin:
        return 0
    upper, gap_end = _best_end(f, seen)
    if gap_end > margin:
        return 0
    flat = max(gap_face, gap_end)
    below = (0.0, 0.0, -1.0 if upper else 1.0)
    corner = vertex(seen, support(seen, below))
    number, t, normal, gap_edge = _NONE, 0.0, below, -np.inf
    if not (_is_end_best(f, upper, corner, gap_end) if gap_end > gap_face else _is_face_best(f, body, seen, face)):
        number, t, normal, gap_edge = _edge_farthest(f, body, seen, near, margin)
        if gap_edge > margin or (number == _NONE and not _meets_face(f, seen, face, flat < 0.0)):
            return 0
    best = max(flat, gap_edge)
    tolerance = tolerance_of(margin, min(body[THICKNESS], min(f[2], max(f[0], f[1]))))
    depth, way, x = 0.0, normal, corner
    if near == 0 and best < -DEEP * tolerance:
        depth, way, x = overlap_of_polyhedron(seen, frame, f)
        best = max(best, -depth)
    off = SHARE_OFF * abs(best) + tolerance
    for attempt in range(2):
        on_face = (gap_face + tolerance >= gap_end) != (attempt == 1)
        if (gap_face if on_face else gap_end) < best - off:
            continue
        if on_face:
            count, lowest_gap = lie_on_face(f, body, seen, face, tolerance, margin, frame, manifold)
        else:
            count, lowest_gap = stand_on_end(f, upper, body, seen, tolerance, margin, frame, manifold)
        if count > 0 and abs(lowest_gap - best) <= off:
            return count
    if number == _NONE and depth == 0.0:
        number, t, normal, gap_edge = _edge_farthest(f, body, seen, near, margin)
    if depth > 0.0 and gap_edge < best - off:
        return put_overlap(depth, way, x, frame, manifold)
    if number == _NONE:
        return 0
    p, q = _ends(body, seen, number, t, normal, tolerance)
    count = touch_edge(f, p, q, number, t, normal, margin, frame, manifold)
    if near != 0 or count > 1 or (count == 1 and not is_off(f, manifold, ON_B, tolerance)):
        return count
    if depth == 0.0:  # a point of another edge touches
        depth, way, x = overlap_of_polyhedron(seen, frame, f)
    return put_overlap(depth, way, x, frame, manifold) if depth > 0.0 else count


@compiled
def _best_face(f: Frustum, seen: Any, faces: int, margin: float) -> tuple[int, float]:
    """Find the face that separates the two most, or one that does by more than the margin, and its gap, m."""
    face, best = _NONE, -np.inf
    for k in range(faces):
        normal, offset = plane(seen, k)
        gap = -highest(f, times(-1.0, normal)) - offset
        if gap > best:
            face, best = k, gap
            if gap > margin:
                break
    return face, best


@compiled
def _best_end(f: Frustum, seen: Any) -> tuple[bool, float]:
    """Find the end of the frustum that separates the two more, unless it is a point: whether the upper one, and its gap, m."""
    upper, best = False, -np.inf
    for end in range(2):
        if f[end] > 0.0:
            gap = lowest(seen, (0.0, 0.0, 1.0 if end == 1 else -1.0)) - f[2]
            if gap > best:
                upper, best = end == 1, gap
    return upper, best


@compiled
def _ends(body: Any, seen: Any, number: int, t: float, normal: Vector, tolerance: float) -> tuple[Vector, Vector]:
    """Return the ends of an edge, or twice the lowest vertex if that is deeper than the edge at t."""
    begin, last, _, _ = edge(body, number)
    p, q, lower = vertex(seen, begin), vertex(seen, last), vertex(seen, support(seen, times(-1.0, normal)))
    if dot(normal, along(p, t, minus(q, p))) > dot(normal, lower) + tolerance:
        return lower, lower
    return p, q


@compiled
def _edge_farthest(f: Frustum, body: Any, seen: Any, near: int, margin: float) -> tuple[int, float, Vector, float]:
    """Find the edge whose normal, at its deepest point, gives the largest separation.

    Returns
    -------
    number, t, normal, gap
        The edge, or `_NONE`; the deepest point as a fraction of it; the normal of the frustum there; the separation, m.
    """
    number, share, normal, best, nearest = _edge_among(f, body, seen, near, margin, False)
    if nearest <= 0.0:
        number, share, normal, best, _ = _edge_among(f, body, seen, near, margin, True)
    return number, share, normal, best


@compiled
def _edge_among(
    f: Frustum, body: Any, seen: Any, near: int, limit: float, all_edges: bool
) -> tuple[int, float, Vector, float, float]:
    """Find the same among edges nearer than a limit; return also the distance of the nearest edge, 0.0 inside.

    Unless `all_edges` count, only those do that are as near as any before them.
    """
    number, share, normal, best, nearest = _NONE, 0.0, (0.0, 0.0, 1.0), -np.inf, limit
    above, slope = np.inf, 1.0
    for k in range(int(body[EDGES])):
        begin, end, _, _ = edge(body, k)
        if near > 0 and ((begin + 1) % near > 2 or (end + 1) % near > 2):
            continue
        p, q = vertex(seen, begin), vertex(seen, end)
        way = minus(q, p)
        # A convex function is above its tangents, which bounds the distance. If the two are apart, only the nearest edge
        # counts.
        middle, n = signed_distance(f, along(p, 0.5, way))
        if middle - 0.5 * abs(dot(n, way)) > min(limit, nearest + _ROUNDING * length(way)):
            continue
        t, n = deepest(f, p, q)
        distance, _ = signed_distance(f, along(p, t, way))
        if distance > limit:
            continue
        if not all_edges:
            nearest = min(nearest, max(distance, 0.0))
        low, size = lowest(seen, n), length(way)
        gap, lift, rise = low - highest(f, n), dot(n, along(p, t, way)) - low, abs(dot(n, way)) / size
        # Parallel edges tie: the lowest wins. So do edges that meet at the deepest corner: the one most parallel to the surface
        # wins.
        ties, even = gap > best - _ROUNDING * size, lift < above + _ROUNDING * size
        if gap > best + _ROUNDING * size or (ties and (lift < above - _ROUNDING * size or (even and rise < slope))):
            number, share, normal, best, above, slope = k, t, n, max(gap, best), lift, rise
    return number, share, normal, best, nearest


@compiled
def _meets_face(f: Frustum, seen: Any, face: int, in_any: bool) -> bool:
    """Whether a frustum that no edge touches is above or in a face of a polyhedron: the best one, or any of them if `in_any`.

    A frustum that is wholly inside counts. Its section with the plane of a face, or what of it is nearest to the plane, is
    inside the face then or beside it.
    """
    first, last = (0, int(seen[FACES])) if in_any else (face, face + 1)
    for k in range(first, last):
        normal, offset = plane(seen, k)
        # Beyond the plane, seen from the middle, if any point is.
        p = farthest(f, normal if offset > 0.0 else times(-1.0, normal))
        height = dot(normal, p) - offset
        if height * -offset < 0.0:
            p = times(offset / (height + offset), p)
        elif height > 0.0:
            p = along(p, -height, normal)
        if _is_inside(seen, p):
            return True
    return False


@compiled
def _is_inside(seen: Any, p: Vector) -> bool:
    """Whether a point is in a polyhedron."""
    for k in range(int(seen[FACES])):
        normal, offset = plane(seen, k)
        if dot(normal, p) > offset + _ROUNDING * length(p):
            return False
    return True


@compiled
def _is_face_best(f: Frustum, body: Any, seen: Any, face: int) -> bool:
    """Whether no direction separates the two more than the normal of a face.

    Sufficient: the support point of the frustum is above the face or, inside the polyhedron, closer to it than to other faces.
    """
    normal, offset = plane(seen, face)
    p = farthest(f, times(-1.0, normal))
    height = dot(normal, p) - offset
    if height <= 0.0:
        for k in range(int(body[FACES])):
            other, level = plane(seen, k)
            if dot(other, p) - level > height and k != face:
                return False
        return True
    first, last = loop(body, face)
    start = vertex(seen, loop_vertex(body, last - 1))
    for entry in range(first, last):
        to = vertex(seen, loop_vertex(body, entry))
        if dot(cross(normal, minus(to, start)), minus(p, start)) < 0.0:
            return False
        start = to
    return True


@compiled
def _is_end_best(f: Frustum, upper: bool, corner: Vector, gap: float) -> bool:
    """Return the same for an end of the frustum, from the deepest corner of the polyhedron."""
    if gap <= 0.0:
        _, normal = signed_distance(f, corner)
        return normal[2] == (1.0 if upper else -1.0)
    radius = f[1] if upper else f[0]
    return corner[0] * corner[0] + corner[1] * corner[1] <= radius * radius
