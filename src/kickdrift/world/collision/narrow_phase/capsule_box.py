"""Contact of a capsule and a box."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length, minus, times, turned_back
from kickdrift.world.collision.narrow_phase.capsule_manifold import (
    ASTRAY,
    CROSSED,
    FLAT,
    SHORT,
    STEEP,
    Range,
    beside,
    ends,
    put_capsule_first,
)
from kickdrift.world.collision.narrow_phase.manifold_points import place, turn
from kickdrift.world.shapes.closest_points import along, clamped, outside_box, segment_box, segments

_UP: Vector = (0.0, 0.0, 1.0)


@compiled
def capsule_box(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a capsule and a box; see `kickdrift.world.collision.narrow_phase`.

    If the axis passes through the box, the normal is that of the smallest penetration depth.
    """
    q, radius, half, box = turn(pose), a[0], a[1], (b[0], b[1], b[2])
    centre = turned_back(q, times(-1.0, place(pose)))
    axis = turned_back(q, _UP)
    t = segment_box(centre, axis, half, box)
    x = along(centre, t, axis)
    out = outside_box(x, box)
    distance = length(out)
    if distance - radius > margin:
        return 0
    if distance > CROSSED * (half + box[0] + box[1] + box[2]):
        normal, y = times(1.0 / distance, out), minus(x, out)
    else:
        normal, t, y = _penetration(centre, axis, half, box)
    span, feet = _lying(centre, axis, half, radius, box, normal, t, y)
    contact = ends(centre, axis, radius, normal, t, y, span, feet)
    return put_capsule_first(contact, (centre, axis, half, radius), normal, q, margin, manifold)


@compiled
def _penetration(centre: Vector, axis: Vector, half: float, box: Vector) -> tuple[Vector, float, Vector]:
    """Find the direction of smallest penetration of a segment that passes through a box.

    Returns
    -------
    normal, t, y
        Outward unit normal, the touching point centre + t axis of the segment, and that of the box.

    Notes
    -----
    The Minkowski difference is a polyhedron, whose faces are perpendicular to an axis of the box, or to an axis and the
    segment: the nearest of these six pairs of faces gives the direction.
    """
    best, chosen = -math.inf, 0
    for i in range(3):
        gap = abs(centre[i]) - half * abs(axis[i]) - box[i]
        if gap > best:
            best, chosen = gap, i
    tie = 1e-12 * (half + box[0] + box[1] + box[2])  # faces win over edges
    for i in range(3):
        n, sine = _across(axis, i)
        if sine > 1e-6:
            gap = abs(dot(n, centre)) - abs(n[0]) * box[0] - abs(n[1]) * box[1] - abs(n[2]) * box[2]
            if gap > best + tie:
                best, chosen = gap, 3 + i
    if chosen < 3:
        normal = _unit(chosen, math.copysign(1.0, centre[chosen]))
        low, high = _over_face(centre, axis, half, box, chosen)
        if low > high:
            low, high = -half, half
        t = low if dot(normal, axis) > 0.0 else high
        return normal, t, _on_face(along(centre, t, axis), box, normal)
    i = chosen - 3
    n, _ = _across(axis, i)
    normal = times(math.copysign(1.0, dot(n, centre)), n)
    edge = _edge(
        (math.copysign(box[0], normal[0]), math.copysign(box[1], normal[1]), math.copysign(box[2], normal[2])), i
    )
    s, t = segments(minus(edge, centre), times(half, axis), _unit(i, box[i]))
    return normal, s * half, along(edge, t, _unit(i, box[i]))


@compiled
def _lying(
    centre: Vector, axis: Vector, half: float, radius: float, box: Vector, normal: Vector, t: float, y: Vector
) -> tuple[Range, tuple[Vector, Vector]]:
    """Return the range of a capsule's axis that lies on a face or along an edge of a box, and the box's points at its ends."""
    face = _longest(normal)
    if abs(normal[face]) > FLAT and abs(dot(normal, axis)) <= STEEP:
        low, high = _over_face(centre, axis, half, box, face)
        if high - low > SHORT * radius:
            out = _unit(face, math.copysign(1.0, normal[face]))
            return (low, high), (
                _on_face(along(centre, low, axis), box, out),
                _on_face(along(centre, high, axis), box, out),
            )
    i = _longest(axis)
    edge = _edge(y, i)
    low, high = beside(minus(edge, centre), axis, half, _unit(i, 1.0), box[i], normal, t, ASTRAY * radius)
    at_low = clamped(centre[i] + low * axis[i], -box[i], box[i])
    at_high = clamped(centre[i] + high * axis[i], -box[i], box[i])
    return (low, high), (along(edge, at_low, _unit(i, 1.0)), along(edge, at_high, _unit(i, 1.0)))


@compiled(inline=True)
def _over_face(centre: Vector, axis: Vector, half: float, box: Vector, face: int) -> Range:
    """Return the range of a segment above or below the faces perpendicular to axis `face`; low > high if it is empty."""
    low, high = -half, half
    for i in range(3):
        if i != face:
            if axis[i] != 0.0:
                t, s = (-box[i] - centre[i]) / axis[i], (box[i] - centre[i]) / axis[i]
                low, high = max(low, min(s, t)), min(high, max(s, t))
            elif abs(centre[i]) > box[i]:
                high = -math.inf
    return low, high


@compiled(inline=True)
def _on_face(p: Vector, box: Vector, out: Vector) -> Vector:
    """Return the point nearest to p on the face of a box with the outward normal `out`, along an axis."""
    return (
        out[0] * box[0] if out[0] != 0.0 else clamped(p[0], -box[0], box[0]),
        out[1] * box[1] if out[1] != 0.0 else clamped(p[1], -box[1], box[1]),
        out[2] * box[2] if out[2] != 0.0 else clamped(p[2], -box[2], box[2]),
    )


@compiled(inline=True)
def _longest(a: Vector) -> int:
    """Return the axis of the largest component of a vector."""
    x, y, z = abs(a[0]), abs(a[1]), abs(a[2])
    return 0 if x >= y and x >= z else 1 if y >= z else 2


@compiled(inline=True)
def _unit(i: int, size: float) -> Vector:
    """Return a vector along axis i."""
    return (size if i == 0 else 0.0, size if i == 1 else 0.0, size if i == 2 else 0.0)


@compiled(inline=True)
def _edge(p: Vector, i: int) -> Vector:
    """Return the middle of the edge through a point, along axis i."""
    return (0.0 if i == 0 else p[0], 0.0 if i == 1 else p[1], 0.0 if i == 2 else p[2])


@compiled(inline=True)
def _across(axis: Vector, i: int) -> tuple[Vector, float]:
    """Return a unit vector perpendicular to a direction and to axis i, and the sine of the angle between these."""
    x, y, z = axis
    n = (0.0, -z, y) if i == 0 else (z, 0.0, -x) if i == 1 else (-y, x, 0.0)
    sine = length(n)
    return times(1.0 / max(sine, 1e-300), n), sine
