"""Contact of a capsule and a convex polyhedron."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, plus, times, turned_back
from kickdrift.world.collision.narrow_phase.capsule_manifold import (
    ASTRAY,
    CROSSED,
    FLAT,
    SHORT,
    STEEP,
    Range,
    beside,
    ends,
    foot_on_edge,
    nearer,
    put_capsule_first,
)
from kickdrift.world.collision.narrow_phase.manifold_points import place, turn
from kickdrift.world.collision.narrow_phase.sphere_polyhedron import NONE, nearest_face
from kickdrift.world.shapes.closest_points import along, segments
from kickdrift.world.shapes.polyhedron import EDGES, FACES, edge, loop, loop_vertex, plane, vertex

_UP: Vector = (0.0, 0.0, 1.0)


@compiled
def capsule_hull(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a capsule and a polyhedron; see `kickdrift.world.collision.narrow_phase`.

    If the axis passes through the polyhedron, the normal is that of the smallest penetration depth.
    """
    q, radius, half = turn(pose), a[0], a[1]
    centre = turned_back(q, times(-1.0, place(pose)))
    axis = turned_back(q, _UP)
    face, gap, inside = _planes(b, centre, axis, half)
    if gap - radius > margin:
        return 0
    side = NONE
    normal, t, y = _UP, 0.0, centre
    distance = 0.0
    if not inside:
        side, t, y = _nearest(b, centre, axis, half)
        out = minus(along(centre, t, axis), y)
        distance = length(out)
        if distance - radius > margin:
            return 0
        normal = times(1.0 / max(distance, 1e-300), out)
    if distance <= CROSSED * (half + length(centre)):
        side, normal, t, y = _penetration(b, centre, axis, half, face, gap)
    low, high, feet = t, t, (y, y)
    face, cosine = _facing(b, normal)
    if cosine > FLAT and abs(dot(normal, axis)) <= STEEP:
        low, high = _over_face(b, face, centre, axis, half)
        feet = (_foot(b, face, along(centre, low, axis)), _foot(b, face, along(centre, high, axis)))
    if not high - low > SHORT * radius and side != NONE:
        middle, direction, size = _side(b, side)
        low, high = beside(minus(middle, centre), axis, half, direction, size, normal, t, ASTRAY * radius)
        feet = (
            foot_on_edge(along(centre, low, axis), middle, direction, size),
            foot_on_edge(along(centre, high, axis), middle, direction, size),
        )
    contact = ends(centre, axis, radius, normal, t, y, (low, high), feet)
    return put_capsule_first(contact, (centre, axis, half, radius), normal, q, margin, manifold)


@compiled
def _planes(numbers: Any, centre: Vector, axis: Vector, half: float) -> tuple[int, float, bool]:
    """Return the face of largest separation from a segment, that separation, and whether the segment meets the polyhedron."""
    best, chosen = -math.inf, 0
    low, high = -half, half
    for face in range(int(numbers[FACES])):
        normal, offset = plane(numbers, face)
        height, rise = dot(normal, centre) - offset, dot(normal, axis)
        if height - half * abs(rise) > best:
            best, chosen = height - half * abs(rise), face
        if rise > 0.0:
            high = min(high, -height / rise)
        elif rise < 0.0:
            low = max(low, -height / rise)
        elif height > 0.0:
            high = -math.inf
    return chosen, best, low <= high


@compiled
def _nearest(numbers: Any, centre: Vector, axis: Vector, half: float) -> tuple[int, float, Vector]:
    """Find the closest points of a polyhedron and a segment that does not pass through it.

    Returns
    -------
    side, t, y
        Edge touched, or `NONE` for a face; the point centre + t axis; the point of the polyhedron.
    """
    best, cosine, chosen, nearest, touched = math.inf, 0.0, NONE, half, centre
    toward = (0.0, 0.0, 0.0)
    for k in range(2):
        t = half if k == 1 else -half
        x = along(centre, t, axis)
        face, height = nearest_face(numbers, x)
        if face != NONE and height * height < best:
            toward, _ = plane(numbers, face)
            best, cosine, nearest, touched = height * height, 1.0, t, along(x, -height, toward)
    extent = dot(toward, centre) - half * abs(dot(toward, axis))
    for k in range(int(numbers[EDGES])):
        begin, end, _, _ = edge(numbers, k)
        start, to = vertex(numbers, begin), vertex(numbers, end)
        apart = extent - max(dot(toward, start), dot(toward, to))  # lower bound of the distance of edge and segment
        if apart <= 0.0 or apart * apart <= best * (1.0 + 1e-9):
            middle, side = times(0.5, plus(start, to)), times(0.5, minus(to, start))
            t, s = segments(minus(middle, centre), times(half, axis), side)
            y = along(middle, s, side)
            out = minus(along(centre, t * half, axis), y)
            square = dot(out, out)
            parallel = abs(dot(axis, side)) / length(side)
            if nearer(square, parallel, best, cosine):
                best, cosine, chosen, nearest, touched = square, parallel, k, t * half, y
                if square > 0.0:
                    toward = times(1.0 / math.sqrt(square), out)
                    extent = dot(toward, centre) - half * abs(dot(toward, axis))
    return chosen, nearest, touched


@compiled
def _penetration(
    numbers: Any, centre: Vector, axis: Vector, half: float, face: int, gap: float
) -> tuple[int, Vector, float, Vector]:
    """Find the direction of smallest penetration of a segment that passes through a polyhedron.

    Parameters
    ----------
    face, gap
        Face of largest separation from the segment, and that separation, which is negative.

    Returns
    -------
    side, normal, t, y
        Edge, or `NONE` for a face; outward unit normal; touching points, centre + t axis and y.

    Notes
    -----
    The faces of the Minkowski difference are those of the polyhedron and, for each edge between a face towards one end of the
    segment and one towards the other, a face parallel to edge and segment.
    """
    best, chosen, normal = gap + 1e-12 * half, NONE, _UP  # faces win over edges
    for k in range(int(numbers[EDGES])):
        begin, end, left, right = edge(numbers, k)
        u, _ = plane(numbers, left)
        v, _ = plane(numbers, right)
        if dot(u, axis) * dot(v, axis) < 0.0:
            start = vertex(numbers, begin)
            to = minus(vertex(numbers, end), start)
            across = cross(to, axis)
            size = math.copysign(length(across), dot(across, plus(u, v)))
            if abs(size) > 1e-6 * length(to):
                depth = dot(across, minus(centre, start)) / size
                if depth > best:
                    best, chosen, normal = depth, k, times(1.0 / size, across)
    if chosen == NONE:
        normal, _ = plane(numbers, face)
        low, high = _over_face(numbers, face, centre, axis, half)
        if low > high:
            low, high = -half, half
        t = low if dot(normal, axis) > 0.0 else high
        return NONE, normal, t, _foot(numbers, face, along(centre, t, axis))
    middle, direction, size = _side(numbers, chosen)
    t, s = segments(minus(middle, centre), times(half, axis), times(size, direction))
    return chosen, normal, t * half, along(middle, s * size, direction)


@compiled
def _facing(numbers: Any, normal: Vector) -> tuple[int, float]:
    """Return the face whose normal is closest to a direction, and the cosine of the angle between them."""
    best, chosen = -math.inf, 0
    for face in range(int(numbers[FACES])):
        n, _ = plane(numbers, face)
        if dot(n, normal) > best:
            best, chosen = dot(n, normal), face
    return chosen, best


@compiled
def _over_face(numbers: Any, face: int, centre: Vector, axis: Vector, half: float) -> Range:
    """Return the range of a segment straight above or below a face; low > high if it is empty."""
    normal, _ = plane(numbers, face)
    first, last = loop(numbers, face)
    low, high = -half, half
    start = vertex(numbers, loop_vertex(numbers, last - 1))
    for entry in range(first, last):
        to = vertex(numbers, loop_vertex(numbers, entry))
        inward = cross(normal, minus(to, start))
        inside, slope = dot(inward, minus(centre, start)), dot(inward, axis)
        if slope > 0.0:
            low = max(low, -inside / slope)
        elif slope < 0.0:
            high = min(high, -inside / slope)
        elif inside < 0.0:
            high = -math.inf
        start = to
    return low, high


@compiled(inline=True)
def _foot(numbers: Any, face: int, p: Vector) -> Vector:
    """Return the projection of a point onto the plane of a face."""
    normal, offset = plane(numbers, face)
    return along(p, offset - dot(normal, p), normal)


@compiled(inline=True)
def _side(numbers: Any, k: int) -> tuple[Vector, Vector, float]:
    """Return middle, direction and half length of an edge."""
    begin, end, _, _ = edge(numbers, k)
    start, to = vertex(numbers, begin), vertex(numbers, end)
    side = times(0.5, minus(to, start))
    size = length(side)
    return times(0.5, plus(start, to)), times(1.0 / size, side), size
