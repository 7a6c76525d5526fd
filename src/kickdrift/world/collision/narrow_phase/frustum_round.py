"""Contact of cylinders and cones with planes, balls and capsules."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, minus, plus, times, turned, turned_back
from kickdrift.world.collision.narrow_phase.capsule_manifold import (
    ASTRAY,
    FLAT,
    SHORT,
    STEEP,
    Contact,
    beside,
    ends,
    foot_on_edge,
    put_capsule_first,
)
from kickdrift.world.collision.narrow_phase.manifold_points import place, put_normal, put_point, turn
from kickdrift.world.columns import point_at
from kickdrift.world.contacts.layout import LOAD, REACHABLE
from kickdrift.world.shapes.closest_points import along
from kickdrift.world.shapes.frustum import Frustum, deepest, frustum_of, highest, radial, side_normal, signed_distance

_UP: Vector = (0.0, 0.0, 1.0)

# Points of the rims, in the order in which up to four are chosen: which of the directions `_AROUND` the axis, from the lowest
# one, and 0 for the end with the lowest point, 1 for the other one. A frustum that may move by its own size in the step may
# turn onto any part of its rims.
_AROUND = ((1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (-1.0, 0.0), (-0.5, math.sqrt(0.75)), (-0.5, -math.sqrt(0.75)))
_UPRIGHT = ((0, 0), (1, 0), (2, 0), (3, 0), (0, 1), (4, 1), (5, 1))
_LYING = ((0, 0), (0, 1), (4, 0), (5, 0), (4, 1), (5, 1), (3, 0))
_TUMBLING = ((0, 0), (3, 0), (1, 1), (2, 1), (0, 1), (1, 0), (2, 0))

# Sine of the angle between a disc and the plane below it, under which the points of its rim are fixed in the body: the lowest
# one is determined by rounding then.
STANDING = 1e-4
FLAT_ON = 5e-3  # the same on a face, where the choice among many points must not change from step to step
_OFF_CENTRE = 1e-3  # of the radius: distance of a load from the axis that is noticed


@compiled(inline=True)
def lowest_direction(down: Vector, least: float) -> tuple[float, float, float]:
    """Return the sine of the angle between a direction and the axis, and the direction (x, y) of the lowest point of a rim.

    If the sine is less than `least`, this is always (1, 0).
    """
    sine, x, y = radial(down[0], down[1])
    if sine < least:
        return sine, 1.0, 0.0
    return sine, x, y


@compiled
def plane_frustum(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a half-space and a frustum; see `kickdrift.world.collision.narrow_phase`.

    The first point is the lowest one. If a side is nearly parallel to the plane, the second is the other end of its lowest
    line; if an end is, three more are on its rim. The others are those of the rims onto which the frustum may turn in the step:
    not more, since all near points share in carrying the friction.
    """
    centre, q = place(pose), turn(pose)
    lower, upper, half = frustum_of(b)
    down = turned_back(q, (0.0, 0.0, -1.0))
    sine, x, y = lowest_direction(down, STANDING)
    if sine < STANDING:  # the rim towards the load carries the most
        load = turned_back(q, minus(point_at(manifold, LOAD), centre))
        off, u, v = radial(load[0], load[1])
        x, y = (u, v) if off > _OFF_CENTRE * max(lower, upper) else (x, y)
    c, s = side_normal((lower, upper, half))
    sideways = down[0] * x + down[1] * y
    lies = sideways * c + down[2] * s > FLAT
    put_normal(manifold, _UP)
    tumbles = sine >= STEEP and margin > max(lower, upper, half)
    lowest = 0 if sideways * lower - half * down[2] >= sideways * upper + half * down[2] else 1
    tip = (lower if lowest == 0 else upper) == 0.0
    order = _LYING if lies or (tumbles and min(lower, upper) == 0.0) else _TUMBLING if tumbles else _UPRIGHT
    count = 0
    for k, other in order:
        end = 1 - lowest if other else lowest
        radius, z = (lower, -half) if end == 0 else (upper, half)
        u, v = _AROUND[k]
        on_b = (radius * (u * x - v * y), radius * (v * x + u * y), z)
        at = plus(centre, turned(q, on_b))
        if (other and not (lies or tumbles or tip)) or (k > 0 and radius == 0.0) or count == 4:
            continue
        near = k == 0 or tumbles or (not other and sine < STEEP)
        if at[2] <= (margin if near else min(margin, manifold[REACHABLE])):
            put_point(manifold, count, (at[0], at[1], 0.0), on_b, 6 * end + k)
            count += 1
    return count


@compiled
def sphere_frustum(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact point of a ball and a frustum; see `kickdrift.world.collision.narrow_phase`."""
    q = turn(pose)
    centre = turned_back(q, times(-1.0, place(pose)))  # of the ball in the frustum's frame
    distance, normal = signed_distance(frustum_of(b), centre)
    if distance - a[0] > margin:
        return 0
    inward = turned(q, times(-1.0, normal))
    put_normal(manifold, inward)
    put_point(manifold, 0, times(a[0], inward), along(centre, -distance, normal), 0)
    return 1


@compiled
def capsule_frustum(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a capsule and a frustum; see `kickdrift.world.collision.narrow_phase`.

    If the axis passes through the frustum, the normal is that of the smallest penetration depth of its deepest point.
    """
    q, radius, half, f = turn(pose), a[0], a[1], frustum_of(b)
    centre, axis = turned_back(q, times(-1.0, place(pose))), turned_back(q, _UP)
    share, normal = deepest(f, along(centre, -half, axis), along(centre, half, axis))
    t = (2.0 * share - 1.0) * half
    x = along(centre, t, axis)
    gap = dot(normal, x) - highest(f, normal)
    if gap - radius > margin:
        return 0
    y = along(x, -gap, normal)
    contact = along_frustum(f, (centre, axis, half), radius, normal, t, y)
    return put_capsule_first(contact, (centre, axis, half, radius), normal, q, margin, manifold)


@compiled
def along_frustum(
    f: Frustum, segment: tuple[Vector, Vector, float], radius: float, normal: Vector, t: float, y: Vector
) -> Contact:
    """Return the contact points of a segment (middle, axis, half) that may lie on an end or along a line of a frustum.

    Parameters
    ----------
    f, segment
        The two, in the frame of the frustum.
    radius : float
        Length by which a range is judged short and a line sideways, m.
    normal : (3,) tuple
        Unit vector from the frustum to the segment.
    t, y
        Closest point of the segment, and that of the frustum.
    """
    middle, axis, half = segment
    low, high, feet = t, t, (y, y)
    if abs(normal[2]) > FLAT and abs(dot(normal, axis)) <= STEEP:
        low, high = over_end(f, normal[2] > 0.0, middle, axis, -half, half)
        z = f[2] if normal[2] > 0.0 else -f[2]
        p, r = along(middle, low, axis), along(middle, high, axis)
        feet = ((p[0], p[1], z), (r[0], r[1], z))
    if not high - low > SHORT * radius:
        centre, line, size = line_of(f, normal)
        low, high = beside(minus(centre, middle), axis, half, line, size, normal, t, ASTRAY * radius)
        feet = (
            foot_on_edge(along(middle, low, axis), centre, line, size),
            foot_on_edge(along(middle, high, axis), centre, line, size),
        )
    return ends(middle, axis, radius, normal, t, y, (low, high), feet)


@compiled(inline=True)
def line_of(frustum: Frustum, normal: Vector) -> tuple[Vector, Vector, float]:
    """Return the line on the side of a frustum that faces a direction: middle, unit direction and half length."""
    lower, upper, half = frustum
    _, x, y = radial(normal[0], normal[1])
    c, s = side_normal(frustum)
    mean = 0.5 * (lower + upper)
    return (mean * x, mean * y, 0.0), (-s * x, -s * y, c), half / c


@compiled(inline=True)
def over_end(
    frustum: Frustum, is_upper: bool, start: Vector, way: Vector, low: float, high: float
) -> tuple[float, float]:
    """Return the part of a line's range from `low` to `high` that is above or below an end; low > high if it is empty."""
    radius = frustum[1] if is_upper else frustum[0]
    square = way[0] * way[0] + way[1] * way[1]
    if square < 1e-300:
        return (low, high) if start[0] * start[0] + start[1] * start[1] <= radius * radius else (1.0, -1.0)
    middle = -(start[0] * way[0] + start[1] * way[1]) / square
    across = start[0] * way[1] - start[1] * way[0]
    rest = radius * radius - across * across / square
    if rest < 0.0:
        return 1.0, -1.0
    reach = math.sqrt(rest / square)
    return max(low, middle - reach), min(high, middle + reach)
