"""Contact of round shapes with a triangle of a mesh.

Triangles are one-sided: shapes behind them do not touch, unless they have sunk in by less than half of their radius. At an edge
that is not convex, an internal edge as inside a flat floor, only the adjacent faces touch, so that there are no ghost
collisions: the normal is that of the face, which extends slightly beyond the edge, so that nothing falls between two faces.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, plus, times, turned, turned_back
from kickdrift.world.collision.narrow_phase.capsule_manifold import (
    ASTRAY,
    CROSSED,
    FLAT,
    SHORT,
    STEEP,
    Range,
    beside,
    direction,
    ends,
    foot_on_edge,
    nearer,
    put_capsule_second,
)
from kickdrift.world.collision.narrow_phase.manifold_points import place, put_normal, put_point, turn
from kickdrift.world.shapes.closest_points import COINCIDENT, along, clamped, segments
from kickdrift.world.shapes.triangle import ACTIVE_EDGES

_UP: Vector = (0.0, 0.0, 1.0)
_BEHIND = 0.5  # radii: depth up to which the middle of a round shape still touches

# Extension of a face beyond an edge that is not convex, relative to the radius or the height. In meshes, edges with an angle of
# up to five degrees count as flat, and the gap above them that no face covers is tan(5 degrees) times the height wide.
_OVERLAP = 0.1

# Cosine of the angle between contact normal and triangle normal below which the triangle across the edge is responsible.
_BACKWARDS = -0.01

_FACE = -1

Corners = tuple[Vector, Vector, Vector]


@compiled
def triangle_sphere(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact point of a triangle and a ball; see `kickdrift.world.collision.narrow_phase`."""
    centre, radius = place(pose), b[0]
    corners, up = _triangle(a)
    height = dot(minus(centre, corners[0]), up)
    if height - radius > margin or height < -_BEHIND * radius:
        return 0
    edge, t, y = _edge_beside(corners, up, centre)
    normal = up
    if edge == _FACE:
        y = along(centre, -height, up)
    else:
        out = minus(centre, y)
        distance = length(out)
        if _convex(a, edge, t):
            if height < 0.0 or distance - radius > margin:
                return 0
            if distance > COINCIDENT * (radius + length(centre)):
                normal = times(1.0 / distance, out)
        elif distance * distance - height * height > (_OVERLAP * max(radius, height)) ** 2:
            return 0
        else:
            y = along(centre, -height, up)
    put_normal(manifold, normal)
    put_point(manifold, 0, y, turned_back(turn(pose), times(-radius, normal)), 0)
    return 1


@compiled
def triangle_capsule(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a triangle and a capsule; see `kickdrift.world.collision.narrow_phase`.

    A capsule whose axis passes through the triangle is pushed out towards its front.
    """
    centre, q, radius, half = place(pose), turn(pose), b[0], b[1]
    axis = turned(q, _UP)
    corners, up = _triangle(a)
    height, rise = dot(minus(centre, corners[0]), up), dot(axis, up)
    if height - half * abs(rise) - radius > margin or height < -_BEHIND * radius:
        return 0
    overlap = _OVERLAP * max(radius, height - half * abs(rise))
    low, high = _over(a, corners, up, centre, axis, half, overlap)
    lowest = low if rise > 0.0 else high
    edge, t, y, s = _nearest(corners, up, centre, axis, half)
    sunk = low <= high and height + lowest * rise < 0.0
    if sunk and not low <= 0.0 <= high and abs(height) < half * abs(rise):  # unless it gets below beside a convex edge
        side, at, _ = _edge_beside(corners, up, along(centre, -height / rise, axis))
        sunk = side == _FACE or not _convex(a, side, at)
    if sunk or (edge != _FACE and not _convex(a, edge, s)):
        if low > high:
            return 0
        edge, t = _FACE, lowest
    normal, x = up, along(centre, t, axis)
    if edge == _FACE:
        y = along(x, -height - t * rise, up)
    else:
        start, to = _edge(corners, edge)
        out = minus(x, y)
        distance, size = length(out), length(to)
        normal = direction(out, distance, axis, times(1.0 / size, to), half + size)
        if distance <= CROSSED * (half + size) and dot(normal, up) < 0.0:
            normal = times(-1.0, normal)
    if dot(normal, up) < _BACKWARDS or dot(normal, minus(x, y)) - radius > margin:
        return 0
    if dot(normal, up) > FLAT and abs(dot(normal, axis)) <= STEEP and high - low > SHORT * radius:
        feet = (_foot(centre, axis, low, height, rise, up), _foot(centre, axis, high, height, rise, up))
    elif edge != _FACE:
        start, to = _edge(corners, edge)
        size = length(to)
        along_it, middle = times(1.0 / size, to), along(start, 0.5, to)
        low, high = beside(minus(middle, centre), axis, half, along_it, 0.5 * size, normal, t, ASTRAY * radius)
        feet = (
            foot_on_edge(along(centre, low, axis), middle, along_it, 0.5 * size),
            foot_on_edge(along(centre, high, axis), middle, along_it, 0.5 * size),
        )
    else:
        low, high, feet = t, t, (y, y)
    contact = ends(centre, axis, radius, normal, t, y, (low, high), feet)
    return put_capsule_second(contact, (centre, axis, half, radius), normal, q, margin, manifold)


@compiled
def beside_triangle(a: Any, point: Vector) -> tuple[Vector, float]:
    """Return the vector from the nearest point of a triangle to a point, and the height of the point above its plane."""
    corners, up = _triangle(a)
    height = dot(minus(point, corners[0]), up)
    edge, _, nearest = _edge_beside(corners, up, point)
    return (times(height, up) if edge == _FACE else minus(point, nearest)), height


@compiled(inline=True)
def _triangle(a: Any) -> tuple[Corners, Vector]:
    """Return corners and normal."""
    u, v, w = (a[0], a[1], a[2]), (a[3], a[4], a[5]), (a[6], a[7], a[8])
    across = cross(minus(v, u), minus(w, u))
    return (u, v, w), times(1.0 / length(across), across)


@compiled(inline=True)
def _edge(corners: Corners, k: int) -> tuple[Vector, Vector]:
    """Return where the k-th edge starts and the vector to its end."""
    if k == 0:
        return corners[0], minus(corners[1], corners[0])
    if k == 1:
        return corners[1], minus(corners[2], corners[1])
    return corners[2], minus(corners[0], corners[2])


@compiled(inline=True)
def _convex(a: Any, edge: int, t: float) -> bool:
    """Whether an edge is convex or, for a point at one of its ends, t = -1 or 1, the edge that it meets there."""
    if a[ACTIVE_EDGES + edge] != 0.0:
        return True
    if t >= 1.0:
        return bool(a[ACTIVE_EDGES + (edge + 1) % 3] != 0.0)
    return bool(t <= -1.0 and a[ACTIVE_EDGES + (edge + 2) % 3] != 0.0)


@compiled
def _edge_beside(corners: Corners, up: Vector, p: Vector) -> tuple[int, float, Vector]:
    """Return the nearest edge, the position on it from -1 to 1, and the point; `_FACE` if p is above or below the face."""
    best, chosen, place_on_it, nearest = math.inf, _FACE, 0.0, p
    for k in range(3):
        start, to = _edge(corners, k)
        offset = minus(p, start)
        if dot(cross(up, to), offset) < 0.0:
            t = clamped(dot(offset, to) / dot(to, to), 0.0, 1.0)
            y = along(start, t, to)
            out = minus(p, y)
            if dot(out, out) < best:
                best, chosen, place_on_it, nearest = dot(out, out), k, 2.0 * t - 1.0, y
    return chosen, place_on_it, nearest


@compiled
def _nearest(
    corners: Corners, up: Vector, centre: Vector, axis: Vector, half: float
) -> tuple[int, float, Vector, float]:
    """Find the closest points of a triangle and a segment that does not pass through it.

    Returns
    -------
    edge, t, y, s
        Edge or face, the point centre + t axis, the point of the triangle, and where on the edge that is, from -1 to 1.
    """
    best, cosine, chosen, nearest, touched, place_on_it = math.inf, 0.0, _FACE, half, centre, 0.0
    for k in range(2):
        t = half if k == 1 else -half
        x = along(centre, t, axis)
        if _edge_beside(corners, up, x)[0] == _FACE:
            distance = dot(minus(x, corners[0]), up)
            if distance * distance < best:
                best, cosine, nearest, touched = distance * distance, 1.0, t, along(x, -distance, up)
    for k in range(3):
        start, to = _edge(corners, k)
        side = times(0.5, to)
        middle = plus(start, side)
        t, s = segments(minus(middle, centre), times(half, axis), side)
        y = along(middle, s, side)
        out = minus(along(centre, t * half, axis), y)
        parallel = abs(dot(axis, side)) / length(side)
        if nearer(dot(out, out), parallel, best, cosine):
            best, cosine, chosen, nearest, touched, place_on_it = dot(out, out), parallel, k, t * half, y, s
    return chosen, nearest, touched, place_on_it


@compiled
def _over(a: Any, corners: Corners, up: Vector, centre: Vector, axis: Vector, half: float, overlap: float) -> Range:
    """Return the range of a segment above or below a triangle; low > high if it is empty."""
    low, high = -half, half
    for k in range(3):
        start, to = _edge(corners, k)
        inward = times(1.0 / length(to), cross(up, to))
        inside, slope = dot(inward, minus(centre, start)), dot(inward, axis)
        if a[ACTIVE_EDGES + k] == 0.0:
            inside += overlap
        if slope > 0.0:
            low = max(low, -inside / slope)
        elif slope < 0.0:
            high = min(high, -inside / slope)
        elif inside < 0.0:
            high = -math.inf
    return low, high


@compiled(inline=True)
def _foot(centre: Vector, axis: Vector, t: float, height: float, rise: float, up: Vector) -> Vector:
    """Return the projection of a point of the capsule's axis onto the plane of the face."""
    return along(along(centre, t, axis), -height - t * rise, up)
