"""Capsules that lie on a face or along an edge: two contact points, without which they would rock from end to end.

A capsule is the segment ``centre + t axis``, -half <= t <= half, in the frame of the other shape, and a radius. The normal
points to the capsule. Its closest point is given; if the capsule lies along a face or an edge, the ends of the range of t that
does become the contact points.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, cross, dot, length, minus, normal_to, times, turned, turned_back
from kickdrift.world.collision.narrow_phase.manifold_points import put_normal, put_point
from kickdrift.world.shapes.closest_points import along, clamped

LOWER, UPPER, BETWEEN = 0, 1, 2  # features of a capsule: the end at -z, the end at +z, the side

STEEP = 0.2  # sine of the angle between capsule and face above which it does not lie on the face
FLAT = 0.98  # cosine of the angle between contact normal and face normal above which the contact is one with the face
NEARLY_PARALLEL = 0.95  # cosine of the angle between a capsule and an edge above which it may lie along the edge
ASTRAY = 0.1  # radii: sideways distance up to which a capsule lies along an edge
SHORT = 0.1  # radii: length of a range below which it is one point
CROSSED = 1e-8  # of the size of the shapes: the direction between closer points is rounding
_TIE = 1e-12

Range = tuple[float, float]
Contact = tuple[int, float, Vector, float, Vector]  # number of points; of each, its t and the point of the other shape


@compiled
def direction(out: Vector, distance: float, u: Vector, v: Vector, size: float) -> Vector:
    """Return the unit vector along `out`, or, if that is zero because two axes cross, one perpendicular to both."""
    if distance > CROSSED * size:
        return times(1.0 / distance, out)
    across = cross(u, v)
    sine = length(across)
    if sine > 1e-12:
        return times(1.0 / sine, across)
    return normal_to(u)


@compiled
def beside(
    offset: Vector, u: Vector, half: float, v: Vector, other: float, normal: Vector, t: float, reach: float
) -> Range:
    """Return the range of a segment that lies along another one; empty, (t, t), if they cross or one stands on the other.

    Parameters
    ----------
    offset : (3,) tuple
        Vector from the middle of the first to the middle of the second, m.
    u, v : (3,) tuple
        Their directions, unit vectors.
    half, other : float
        Half their lengths, m.
    normal : (3,) tuple
        Unit vector between their closest points.
    t : float
        Closest point of the first.
    reach : float
        Sideways distance within the range, m. Segments that cross at a small angle touch at one point; two points farther away
        would hold them apart where they do not touch.
    """
    cosine = dot(u, v)
    if abs(cosine) < NEARLY_PARALLEL or abs(dot(normal, u)) > STEEP or abs(dot(normal, v)) > STEEP:
        return t, t
    middle, extent = dot(offset, v) / cosine, other / abs(cosine)
    sideways = reach / abs(dot(u, cross(normal, v)))
    return max(-half, middle - extent, t - sideways), min(half, middle + extent, t + sideways)


@compiled(inline=True)
def foot_on_edge(x: Vector, middle: Vector, axis: Vector, half: float) -> Vector:
    """Return the point of an edge nearest to a point."""
    return along(middle, clamped(dot(minus(x, middle), axis), -half, half), axis)


@compiled(inline=True)
def nearer(square: float, cosine: float, best: float, best_cosine: float) -> bool:
    """Whether a feature is nearer than the best one, or as near and at a smaller angle to the capsule.

    If a capsule lies along an edge, the end of the adjacent edge is just as near.
    """
    return square < best * (1.0 - _TIE) or (square <= best * (1.0 + _TIE) and cosine > best_cosine)


@compiled
def ends(
    centre: Vector,
    axis: Vector,
    radius: float,
    normal: Vector,
    t: float,
    y: Vector,
    span: Range,
    feet: tuple[Vector, Vector],
) -> Contact:
    """Return the ends of a range as contact points, or only the closest point if the range is short.

    If neither end is as near as the closest point, as for a tilted capsule whose contact normal is not quite that of the face,
    the closest point replaces the nearer end.
    """
    low, high = span
    if not high - low > SHORT * radius:
        return 1, t, y, t, y
    gap = dot(normal, minus(along(centre, t, axis), y))
    at_low = dot(normal, minus(along(centre, low, axis), feet[0]))
    at_high = dot(normal, minus(along(centre, high, axis), feet[1]))
    if min(at_low, at_high) > gap + 1e-9 * radius:
        if t - low < high - t:
            return 2, t, y, high, feet[1]
        return 2, low, feet[0], t, y
    return 2, low, feet[0], high, feet[1]


@compiled
def put_capsule_first(
    contact: Contact,
    capsule: tuple[Vector, Vector, float, float],
    normal: Vector,
    q: Quaternion,
    margin: float,
    manifold: Any,
) -> int:
    """Write the contact points of a capsule (centre, axis, half, radius), the first shape, given in the frame of the second."""
    inward = turned(q, times(-1.0, normal))
    put_normal(manifold, inward)
    return _put_points(contact, capsule, normal, inward, True, margin, manifold)


@compiled
def put_capsule_second(
    contact: Contact,
    capsule: tuple[Vector, Vector, float, float],
    normal: Vector,
    q: Quaternion,
    margin: float,
    manifold: Any,
) -> int:
    """Write the contact points of a capsule (centre, axis, half, radius), the second shape, given in the frame of the first."""
    put_normal(manifold, normal)
    return _put_points(contact, capsule, normal, turned_back(q, times(-1.0, normal)), False, margin, manifold)


@compiled(inline=True)
def _put_points(
    contact: Contact,
    capsule: tuple[Vector, Vector, float, float],
    normal: Vector,
    inward: Vector,
    first: bool,
    margin: float,
    manifold: Any,
) -> int:
    """Write the points within the margin; `inward` is the direction to the other shape, in the frame of the capsule."""
    centre, axis, half, radius = capsule
    count = 0
    for k in range(contact[0]):
        t, y = (contact[1], contact[2]) if k == 0 else (contact[3], contact[4])
        if dot(normal, minus(along(centre, t, axis), y)) - radius <= margin:
            own = along((0.0, 0.0, t), radius, inward)
            a, b = (own, y) if first else (y, own)
            put_point(manifold, count, a, b, part(contact[0], k, t, half))
            count += 1
    return count


@compiled(inline=True)
def part(count: int, k: int, t: float, half: float) -> int:
    """Return the feature of a capsule at the k-th of `count` points."""
    if count == 2:
        return k
    return UPPER if t >= half else LOWER if t <= -half else BETWEEN
