"""Contact of balls with planes, balls, capsules and boxes."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, length, minus, times, turned, turned_back
from kickdrift.world.collision.narrow_phase.manifold_points import place, put_normal, put_point, turn
from kickdrift.world.shapes.closest_points import clamped, outside_box

_UP: Vector = (0.0, 0.0, 1.0)
_TINY = 1e-140  # m, below which squares underflow: points coincide


@compiled
def plane_sphere(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact point of a half-space and a ball; see `kickdrift.world.collision.narrow_phase`."""
    centre, radius = place(pose), b[0]
    if centre[2] - radius > margin:
        return 0
    put_normal(manifold, _UP)
    put_point(manifold, 0, (centre[0], centre[1], 0.0), turned_back(turn(pose), (0.0, 0.0, -radius)), 0)
    return 1


@compiled
def sphere_sphere(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact point of two balls; see `kickdrift.world.collision.narrow_phase`."""
    centre = place(pose)
    distance = length(centre)
    if distance - a[0] - b[0] > margin:
        return 0
    normal = times(1.0 / distance, centre) if distance > _TINY else _UP
    put_normal(manifold, normal)
    put_point(manifold, 0, times(a[0], normal), turned_back(turn(pose), times(-b[0], normal)), 0)
    return 1


@compiled
def sphere_capsule(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact point of a ball and a capsule; see `kickdrift.world.collision.narrow_phase`."""
    q = turn(pose)
    centre = turned_back(q, times(-1.0, place(pose)))  # of the ball in the capsule's frame
    t = clamped(centre[2], -b[1], b[1])
    out = minus(centre, (0.0, 0.0, t))
    distance = length(out)
    if distance - a[0] - b[0] > margin:
        return 0
    normal = times(1.0 / distance, out) if distance > _TINY else (1.0, 0.0, 0.0)
    inward = turned(q, times(-1.0, normal))
    put_normal(manifold, inward)
    on_b = (b[0] * normal[0], b[0] * normal[1], b[0] * normal[2] + t)
    put_point(manifold, 0, times(a[0], inward), on_b, 0)
    return 1


@compiled
def sphere_box(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact point of a ball and a box; see `kickdrift.world.collision.narrow_phase`.

    If the centre is inside, the normal is that of the nearest face.
    """
    q = turn(pose)
    half = (b[0], b[1], b[2])
    centre = turned_back(q, times(-1.0, place(pose)))  # of the ball in the box's frame
    out = outside_box(centre, half)
    distance = length(out)
    if distance - a[0] > margin:
        return 0
    if distance > _TINY:
        normal, on_b = times(1.0 / distance, out), minus(centre, out)
    else:
        normal, on_b = _nearest_face(centre, half)
    inward = turned(q, times(-1.0, normal))
    put_normal(manifold, inward)
    put_point(manifold, 0, times(a[0], inward), on_b, 0)
    return 1


@compiled(inline=True)
def _nearest_face(p: Vector, half: Vector) -> tuple[Vector, Vector]:
    """Return the normal of the face of a box nearest to a point inside, and the nearest point of that face."""
    dx, dy, dz = half[0] - abs(p[0]), half[1] - abs(p[1]), half[2] - abs(p[2])
    if dx <= dy and dx <= dz:
        sign = math.copysign(1.0, p[0])
        return (sign, 0.0, 0.0), (sign * half[0], p[1], p[2])
    if dy <= dz:
        sign = math.copysign(1.0, p[1])
        return (0.0, sign, 0.0), (p[0], sign * half[1], p[2])
    sign = math.copysign(1.0, p[2])
    return (0.0, 0.0, sign), (p[0], p[1], sign * half[2])
