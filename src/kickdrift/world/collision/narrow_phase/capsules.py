"""Contact of capsules with planes and with capsules."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length, minus, times, turned, turned_back
from kickdrift.world.collision.narrow_phase.capsule_manifold import ASTRAY, beside, direction, ends, part
from kickdrift.world.collision.narrow_phase.manifold_points import place, put_normal, put_point, turn
from kickdrift.world.shapes.closest_points import along, clamped, segments

_UP: Vector = (0.0, 0.0, 1.0)


@compiled
def plane_capsule(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a half-space and a capsule; see `kickdrift.world.collision.narrow_phase`."""
    centre, q, radius = place(pose), turn(pose), b[0]
    axis, up = turned(q, _UP), turned_back(q, _UP)
    put_normal(manifold, _UP)
    count = 0
    for feature in range(2):
        t = b[1] if feature == 1 else -b[1]
        end = along(centre, t, axis)
        if end[2] - radius <= margin:
            put_point(manifold, count, (end[0], end[1], 0.0), along((0.0, 0.0, t), -radius, up), feature)
            count += 1
    return count


@compiled
def capsule_capsule(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of two capsules; see `kickdrift.world.collision.narrow_phase`."""
    centre, q = place(pose), turn(pose)
    axis = turned(q, _UP)
    s, t = segments(centre, (0.0, 0.0, a[1]), times(b[1], axis))
    s, y = s * a[1], along(centre, t * b[1], axis)
    out = minus((0.0, 0.0, s), y)
    distance, both = length(out), a[0] + b[0]
    if distance - both > margin:
        return 0
    normal = direction(out, distance, _UP, axis, a[1] + b[1])  # from b to a
    low, high = beside(centre, _UP, a[1], axis, b[1], normal, s, ASTRAY * min(a[0], b[0]))
    feet = (_foot(centre, axis, b[1], low), _foot(centre, axis, b[1], high))
    contact = ends((0.0, 0.0, 0.0), _UP, both, normal, s, y, (low, high), feet)
    put_normal(manifold, times(-1.0, normal))
    outward = turned_back(q, normal)
    count = 0
    for k in range(contact[0]):
        s, y = (contact[1], contact[2]) if k == 0 else (contact[3], contact[4])
        if dot(normal, minus((0.0, 0.0, s), y)) - both <= margin:
            on_a = along((0.0, 0.0, s), -a[0], normal)
            on_b = along((0.0, 0.0, dot(minus(y, centre), axis)), b[0], outward)
            put_point(manifold, count, on_a, on_b, part(contact[0], k, s, a[1]))
            count += 1
    return count


@compiled(inline=True)
def _foot(centre: Vector, axis: Vector, half: float, s: float) -> Vector:
    """Return the point of b's axis nearest to the point (0, 0, s) of a's."""
    return along(centre, clamped(dot(minus((0.0, 0.0, s), centre), axis), -half, half), axis)
