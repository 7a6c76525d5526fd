"""Frusta of cones about the z axis, which include cylinders and cones.

Their numbers are the radii of the lower and the upper disc, at z = -half and z = half, and half the length.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, dot, minus, turned_back
from kickdrift.world.shapes.closest_points import along
from kickdrift.world.shapes.extents import Extent
from kickdrift.world.shapes.rays import MISS, NO_CHORD, Chord, Hit, ahead

Frustum = tuple[float, float, float]


@compiled(inline=True)
def frustum_of(numbers: Any) -> Frustum:
    """Return radii and half length from the numbers of a shape."""
    return (numbers[0], numbers[1], numbers[2])


@compiled(inline=True)
def radial(x: float, y: float) -> tuple[float, float, float]:
    """Return the distance from the axis and the unit vector away from it; the latter is along x on the axis."""
    size = math.sqrt(x * x + y * y)
    if size > 1e-150:
        return size, x / size, y / size
    return 0.0, 1.0, 0.0


@compiled(inline=True)
def side_normal(frustum: Frustum) -> tuple[float, float]:
    """Return the radial and axial components of the outward unit normal of the side."""
    lower, upper, half = frustum
    size = math.sqrt(4.0 * half * half + (lower - upper) ** 2)
    return 2.0 * half / size, (lower - upper) / size


@compiled(inline=True)
def highest(frustum: Frustum, n: Vector) -> float:
    """Return the support function: the largest n . x of its points x."""
    lower, upper, half = frustum
    across = math.sqrt(n[0] * n[0] + n[1] * n[1])
    return max(upper * across + half * n[2], lower * across - half * n[2])


@compiled(inline=True)
def farthest(frustum: Frustum, n: Vector) -> Vector:
    """Return the support point: a point with the largest n . x, on the upper rim if both rims have one."""
    lower, upper, half = frustum
    sine, x, y = radial(n[0], n[1])
    if upper * sine + half * n[2] >= lower * sine - half * n[2]:
        return (upper * x, upper * y, half)
    return (lower * x, lower * y, -half)


@compiled
def signed_distance(frustum: Frustum, p: Vector) -> tuple[float, Vector]:
    """Return the distance of a point from the surface, negative inside, and the outward normal at the nearest point.

    It is a convex function of the point, and the normal its gradient, or one of its subgradients.
    """
    lower, upper, half = frustum
    out, x, y = radial(p[0], p[1])
    c, s = side_normal(frustum)
    side = (out - lower) * c + (p[2] + half) * s
    up, down = p[2] - half, -half - p[2]
    if side <= 0.0 and up <= 0.0 and down <= 0.0:
        if side >= up and side >= down:
            return side, (c * x, c * y, s)
        return (up, (0.0, 0.0, 1.0)) if up >= down else (down, (0.0, 0.0, -1.0))
    if up >= 0.0 and out <= upper:
        return up, (0.0, 0.0, 1.0)
    if down >= 0.0 and out <= lower:
        return down, (0.0, 0.0, -1.0)
    place = (out - lower) * -s + (p[2] + half) * c  # along the side, from the lower rim on
    if 0.0 < place < 2.0 * half / c:
        return side, (c * x, c * y, s)
    rim, z = (lower, -half) if place <= 0.0 else (upper, half)
    away, rise = out - rim, p[2] - z
    distance = math.sqrt(away * away + rise * rise)
    if distance < 1e-150:
        return 0.0, (c * x, c * y, s)
    return distance, (away / distance * x, away / distance * y, rise / distance)


@compiled
def deepest(frustum: Frustum, start: Vector, end: Vector) -> tuple[float, Vector]:
    """Find the point of a segment with the smallest signed distance.

    Returns
    -------
    t : float
        From 0 at the start to 1 at the end.
    normal : (3,) tuple
        Outward unit normal of the frustum along which the two are separated.

    Notes
    -----
    The derivative of a convex function increases along the segment: its zero is found by false position (Illinois), with every
    third step a bisection. If it jumps, at a rim, the normals on both sides are combined into one perpendicular to the segment.
    """
    way = minus(end, start)
    low, high = 0.0, 1.0
    _, n_low = signed_distance(frustum, start)
    _, n_high = signed_distance(frustum, end)
    down, up = dot(n_low, way), dot(n_high, way)
    if down >= 0.0:
        return 0.0, n_low
    if up <= 0.0:
        return 1.0, n_high
    below, above = down, up
    for turn in range(60):
        t = low + (high - low) * below / (below - above) if turn % 3 != 2 else 0.5 * (low + high)
        _, n = signed_distance(frustum, along(start, t, way))
        slope = dot(n, way)
        if slope == 0.0:
            return t, n
        if slope < 0.0:
            low, n_low, down, below = t, n, slope, slope
            above *= 0.5
        else:
            high, n_high, up, above = t, n, slope, slope
            below *= 0.5
        if high - low < 1e-14:
            break
    share = up / (up - down)
    x = share * n_low[0] + (1.0 - share) * n_high[0]
    y = share * n_low[1] + (1.0 - share) * n_high[1]
    z = share * n_low[2] + (1.0 - share) * n_high[2]
    size = math.sqrt(x * x + y * y + z * z)
    if size < 1e-9:  # through the centre of a disc: any direction will do
        return low, n_low
    return 0.5 * (low + high), (x / size, y / size, z / size)


@compiled
def frustum_extent(numbers: Any, q: Quaternion) -> Extent:
    """Return the bounds of a frustum; see `kickdrift.world.shapes.record`."""
    f = frustum_of(numbers)
    x, y, z = turned_back(q, (1.0, 0.0, 0.0)), turned_back(q, (0.0, 1.0, 0.0)), turned_back(q, (0.0, 0.0, 1.0))
    return (
        -highest(f, (-x[0], -x[1], -x[2])),
        -highest(f, (-y[0], -y[1], -y[2])),
        -highest(f, (-z[0], -z[1], -z[2])),
        highest(f, x),
        highest(f, y),
        highest(f, z),
    )


@compiled
def ray_frustum(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Cast a ray at a frustum; see `kickdrift.world.shapes.rays`."""
    f = frustum_of(numbers)
    half = f[2]
    # Parameters count from the point of the line nearest to the origin, which loses no digits
    start = -dot(origin, direction)
    o = along(origin, start, direction)
    first, last = -math.inf, math.inf
    if direction[2] != 0.0:
        a, b = (-half - o[2]) / direction[2], (half - o[2]) / direction[2]
        first, last = min(a, b), max(a, b)
    elif abs(o[2]) > half:
        return MISS
    enters, leaves = _through_side(f, o, direction, first, last)
    distance = ahead((start + enters, start + leaves), limit)
    if distance == math.inf:
        return MISS
    entering = distance == start + enters
    if (enters == first) if entering else (leaves == last):
        way = math.copysign(1.0, direction[2])
        return (distance, 0.0, 0.0, -way if entering else way)
    p = along(o, enters if entering else leaves, direction)
    c, s = side_normal(f)
    _, x, y = radial(p[0], p[1])
    return (distance, c * x, c * y, s)


@compiled
def _through_side(frustum: Frustum, o: Vector, d: Vector, first: float, last: float) -> Chord:
    """Return the chord of a line in the infinite cone of the side, within its part between the planes of the discs."""
    lower, upper, half = frustum
    growth = (upper - lower) / (2.0 * half)
    a, b = 0.5 * (lower + upper) + growth * o[2], growth * d[2]  # radius along the line: a + b t
    # Inside, x^2 + y^2 - (a + b t)^2 = square t^2 + 2 linear t + constant is negative.
    square = d[0] * d[0] + d[1] * d[1] - b * b
    linear = o[0] * d[0] + o[1] * d[1] - a * b
    out = math.sqrt(o[0] * o[0] + o[1] * o[1])
    constant = (out - a) * (out + a)
    if square == 0.0:
        if linear == 0.0:
            return (first, last) if constant <= 0.0 else NO_CHORD
        root = -0.5 * constant / linear
        return (first, min(last, root)) if linear > 0.0 else (max(first, root), last)
    # The discriminant linear^2 - square constant, without cancellation of large products
    across = o[0] * d[1] - o[1] * d[0]
    mixed_x, mixed_y = a * d[0] - b * o[0], a * d[1] - b * o[1]
    rest = mixed_x * mixed_x + mixed_y * mixed_y - across * across
    if rest < 0.0:
        return NO_CHORD if square > 0.0 else (first, last)
    far = -linear - math.copysign(math.sqrt(rest), linear)
    one, other = far / square, (constant / far if far != 0.0 else 0.0)
    low, high = min(one, other), max(one, other)
    if square > 0.0:
        return max(first, low), min(last, high)
    # Steeper than the side: inside before one root or after the other, of which one belongs to this side of the tip.
    return (first, min(last, low)) if min(last, low) - first >= last - max(first, high) else (max(first, high), last)
