"""Closest points of segments and boxes."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, minus, plus, times

COINCIDENT = 1e-11  # of the size of the shapes: the direction between closer points is rounding


@compiled(inline=True)
def clamped(x: float, low: float, high: float) -> float:
    """Return x clamped to two bounds; the lower bound for NaN."""
    return max(low, min(x, high))


@compiled(inline=True)
def along(start: Vector, t: float, direction: Vector) -> Vector:
    """Return start + t direction."""
    return (start[0] + t * direction[0], start[1] + t * direction[1], start[2] + t * direction[2])


@compiled
def segments(offset: Vector, u: Vector, v: Vector) -> tuple[float, float]:
    """Find the closest points of two segments.

    Parameters
    ----------
    offset : (3,) tuple
        Vector from the middle of the first to the middle of the second, m.
    u, v : (3,) tuple
        Vectors from the middle of each to its upper end, m; not zero.

    Returns
    -------
    s, t : float
        Parameters in [-1, 1] of the closest points: s u of the first, and offset + t v of the second. Of many closest pairs,
        one.

    Notes
    -----
    Ericson, Real-Time Collision Detection (2005), section 5.1.9. The determinant is taken as the square of a cross
    product: as the difference of two products it would lose all digits at angles of 1e-8.
    """
    uu, vv = dot(u, u), dot(v, v)
    across = cross(u, v)
    square = dot(across, across)
    if square > 1e-30 * uu * vv:
        s = clamped(dot(cross(offset, v), across) / square, -1.0, 1.0)
    else:
        s = clamped(dot(offset, u) / uu, -1.0, 1.0)
    t = clamped(dot(minus(times(s, u), offset), v) / vv, -1.0, 1.0)
    s = clamped(dot(plus(offset, times(t, v)), u) / uu, -1.0, 1.0)
    return s, t


@compiled(inline=True)
def beyond(x: float, half: float) -> float:
    """Return the signed distance of a coordinate from [-half, half]; 0 inside."""
    return x - clamped(x, -half, half)


@compiled(inline=True)
def outside_box(p: Vector, half: Vector) -> Vector:
    """Return the vector from the nearest point of a box to a point; zero inside."""
    return (beyond(p[0], half[0]), beyond(p[1], half[1]), beyond(p[2], half[2]))


@compiled
def segment_box(centre: Vector, axis: Vector, length: float, half: Vector) -> float:
    """Find the point of a segment that is nearest to a box about the origin.

    Parameters
    ----------
    centre, axis : (3,) tuple
        Middle of the segment and its direction, a unit vector.
    length : float
        Half the length of the segment, m.
    half : (3,) tuple
        Half extents of the box.

    Returns
    -------
    t : float
        The point is centre + t axis; if the segment passes through the box, one of its points inside.

    Notes
    -----
    Half the squared distance is a convex function of t. Its derivative is continuous, and linear between the six values of t
    where the line crosses the planes of the faces, so that bisection over these leaves one linear equation.
    """
    low, high = -length, length
    if _slope(centre, axis, low, half) >= 0.0:
        return low
    if _slope(centre, axis, high, half) <= 0.0:
        return high
    for i in range(3):
        if axis[i] != 0.0:
            for k in range(2):
                t = ((2 * k - 1) * half[i] - centre[i]) / axis[i]
                if low < t < high:
                    if _slope(centre, axis, t, half) < 0.0:
                        low = t
                    else:
                        high = t
    out = outside_box(along(centre, 0.5 * (low + high), axis), half)
    numerator = 0.0
    denominator = 0.0
    for i in range(3):
        if out[i] != 0.0:
            side = half[i] if out[i] > 0.0 else -half[i]
            numerator += axis[i] * (side - centre[i])
            denominator += axis[i] * axis[i]
    if denominator > 0.0:
        return clamped(numerator / denominator, low, high)
    return 0.5 * (low + high)


@compiled(inline=True)
def _slope(centre: Vector, axis: Vector, t: float, half: Vector) -> float:
    """Return the derivative of half the squared distance by t."""
    return dot(axis, outside_box(along(centre, t, axis), half))
