"""Contact of two cylinders or cones: at one point, unless ends or sides lie on each other.

Those have the contact points of a polyhedron, which approximates one of the two and has a corner where they touch.
"""

import math
from typing import Any

import numpy as np
from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, dot, length, minus, times
from kickdrift.world.collision.narrow_phase.capsule_manifold import NEARLY_PARALLEL, STEEP
from kickdrift.world.collision.narrow_phase.epa import DEEP, is_off, overlap_of_frusta, put_overlap
from kickdrift.world.collision.narrow_phase.face_bias import SHARE_OFF, tolerance_of
from kickdrift.world.collision.narrow_phase.frustum_faces import COS_BETWEEN, SIDES, SIN_BETWEEN
from kickdrift.world.collision.narrow_phase.frustum_polyhedron import polyhedron_frustum
from kickdrift.world.collision.narrow_phase.frustum_round import FLAT_ON, line_of, lowest_direction
from kickdrift.world.collision.narrow_phase.manifold_points import put_no_load, put_normal, put_point
from kickdrift.world.collision.narrow_phase.sat_frustum import gap_along, separation
from kickdrift.world.collision.narrow_phase.shape_frames import (
    directed,
    directed_back,
    placed,
    placed_back,
    set_frame,
    set_frame_back,
)
from kickdrift.world.contacts.layout import FEATURE, LEFT_OUT, NORMAL, ON_A, ON_B, POINT, POINT_SIZE, REACHABLE
from kickdrift.world.shapes.closest_points import along, segments
from kickdrift.world.shapes.frustum import Frustum, farthest, frustum_of, radial
from kickdrift.world.shapes.polyhedron import HEADER, PLANES_AT, THICKNESS, VERTICES, polyhedron_numbers, vertex
from kickdrift.world.tables import MANIFOLD

_LEVEL = 1e-7  # sine of the angle below which an end, or the line between both rims, touches as a whole
_LOWER, _UPPER = tuple(range(SIDES)), tuple(range(SIDES, 2 * SIDES))
_STEPS = tuple((k, (k + 1) % SIDES) for k in range(SIDES))


def _unit_ring(z: float) -> Any:
    angle = np.arange(SIDES) * (2.0 * math.pi / SIDES)
    return np.column_stack((np.cos(angle), np.sin(angle), np.full(SIDES, z)))


# The flat ends come first; the other faces approximate the side.
_PRISM = polyhedron_numbers(
    np.vstack((_unit_ring(-1.0), _unit_ring(1.0))),
    [_LOWER[::-1], _UPPER, *((k, n, SIDES + n, SIDES + k) for k, n in _STEPS)],
)
_PYRAMID = polyhedron_numbers(
    np.vstack((_unit_ring(-1.0), [(0.0, 0.0, 1.0)])), [_LOWER[::-1], *((k, n, SIDES) for k, n in _STEPS)]
)

_SIZE = len(_PRISM)
_MANIFOLD = MANIFOLD.width
_ONE, _OTHER_WAY = 1 << 22, 1 << 24  # added to features of a single point, and if the second frustum is the polyhedron


@compiled
def frustum_frustum(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of two frusta; see `kickdrift.world.collision.narrow_phase`."""
    f, g = frustum_of(a), frustum_of(b)
    frame, back = floats_on_stack(12), floats_on_stack(12)
    set_frame(frame, pose)
    set_frame_back(back, pose)
    size = length((pose[0], pose[1], pose[2]))
    if size > 0.0 and gap_along(f, g, frame, (pose[0] / size, pose[1] / size, pose[2] / size)) > margin:
        return 0
    normal, gap = separation(f, g, frame, back, margin)
    if gap > margin:
        return 0
    tolerance = tolerance_of(margin, min(_thickness(f), _thickness(g)))
    off = SHARE_OFF * abs(gap) + tolerance
    if gap < -DEEP * tolerance:
        depth, way, x = overlap_of_frusta(f, back, g)
        if depth > 0.0 and -depth > gap + off:
            return put_overlap(depth, way, x, back, manifold)
    if _may_lie(f, g, frame, normal):
        count = _as_polyhedron(f, g, back, normal, margin, manifold)
        if _fits(f, g, frame, manifold, count, gap - off, tolerance):
            return count
        count = _as_other_polyhedron(f, g, frame, normal, margin, manifold)
        if _fits(f, g, frame, manifold, count, gap - off, tolerance):
            return count
    _put_one(f, g, frame, normal, gap, manifold)
    if gap < 0.0 and _is_off(f, g, manifold, tolerance):
        depth, way, x = overlap_of_frusta(f, back, g)
        if depth > 0.0:
            return put_overlap(depth, way, x, back, manifold)
    return 1


@compiled(inline=True)
def _fits(f: Frustum, g: Frustum, frame: Any, manifold: Any, count: int, least: float, tolerance: float) -> bool:
    """Whether a manifold separates the two along its normal by more than `least`, with a point that is on both."""
    if count == 0 or (count == 1 and _is_off(f, g, manifold, tolerance)):
        return False
    fits: bool = gap_along(f, g, frame, _normal(manifold)) > least
    return fits


@compiled(inline=True)
def _is_off(f: Frustum, g: Frustum, manifold: Any, tolerance: float) -> bool:
    """Whether the contact point of a manifold is outside one of the two."""
    off: bool = is_off(f, manifold, ON_A, tolerance) or is_off(g, manifold, ON_B, tolerance)
    return off


@compiled(inline=True)
def _thickness(f: Frustum) -> float:
    return min(f[2], max(f[0], f[1]))


@compiled(inline=True)
def _normal(manifold: Any) -> Vector:
    return (manifold[NORMAL], manifold[NORMAL + 1], manifold[NORMAL + 2])


@compiled
def _may_lie(f: Frustum, g: Frustum, frame: Any, normal: Vector) -> bool:
    """Whether an end or a side of one may lie on an end of the other, or both sides along each other."""
    n = directed_back(frame, times(-1.0, normal))
    (_, along_f, _), (_, along_g, _) = line_of(f, normal), line_of(g, n)
    end_f, end_g = _faces(f, normal), _faces(g, n)
    side_f, side_g = abs(dot(normal, along_f)) < STEEP, abs(dot(n, along_g)) < STEEP
    if end_f or end_g:
        return (end_f or side_f) and (end_g or side_g)
    return side_f and side_g and abs(dot(along_f, directed(frame, along_g))) > NEARLY_PARALLEL


@compiled(inline=True)
def _faces(f: Frustum, normal: Vector) -> bool:
    """Whether an end of a frustum is nearly perpendicular to a direction."""
    faces: bool = radial(normal[0], normal[1])[0] < STEEP and f[1 if normal[2] > 0.0 else 0] > 0.0
    return faces


@compiled
def _put_one(f: Frustum, g: Frustum, frame: Any, normal: Vector, gap: float, manifold: Any) -> None:
    """Write the one contact point along a normal: of a rim, or where the lines of two sides cross."""
    n = directed_back(frame, times(-1.0, normal))
    x, rim, feature = farthest(f, normal), farthest(g, n), 0
    y = placed(frame, rim)
    if _has_one(f, normal):
        y = along(x, gap, normal)
        feature = 1 + (x[2] > 0.0)
    elif _has_one(g, n):
        x = along(y, -gap, normal)
        feature = 3 + (rim[2] > 0.0)
    else:
        middle, way, half = line_of(f, normal)
        other, turned_way, reach = line_of(g, n)
        s, t = segments(
            minus(placed(frame, other), middle), times(half, way), times(reach, directed(frame, turned_way))
        )
        x, y = along(middle, s * half, way), placed(frame, along(other, t * reach, turned_way))
    put_normal(manifold, normal)
    put_point(manifold, 0, x, placed_back(frame, y), _ONE + feature)


@compiled(inline=True)
def _has_one(f: Frustum, normal: Vector) -> bool:
    """Whether one point of a frustum is highest along a direction, and not an end or the line between its rims."""
    sine = radial(normal[0], normal[1])[0]
    rise = abs((f[1] - f[0]) * sine + 2.0 * f[2] * normal[2])
    one: bool = rise > _LEVEL * max(f[0], f[1], f[2]) and (sine > _LEVEL or f[1 if normal[2] > 0.0 else 0] == 0.0)
    return one


@compiled
def _as_polyhedron(f: Frustum, g: Frustum, frame: Any, normal: Vector, margin: float, manifold: Any) -> int:
    """Find the contact points of two frusta, the first approximated by a polyhedron with corners towards the other one.

    Its frame is that in the second's, and the normal that in its own.
    """
    body = floats_on_stack(_SIZE)
    sine, x, y = lowest_direction(normal, FLAT_ON)
    _set_frustum(body, f, x, y)
    # On flat ends the corners stay where they are in the body, near or not
    near = SIDES if sine >= FLAT_ON else 0
    return polyhedron_frustum(body, 2 if f[1] > 0.0 else 1, near, g, frame, margin, manifold)


@compiled
def _as_other_polyhedron(f: Frustum, g: Frustum, frame: Any, normal: Vector, margin: float, manifold: Any) -> int:
    """Find the same with the second approximated; `frame` is that of the second in the first's."""
    other = carray(floats_on_stack(_MANIFOLD), (_MANIFOLD,))
    other[REACHABLE], other[LEFT_OUT] = manifold[REACHABLE], math.inf
    put_no_load(other)
    found = _as_polyhedron(g, f, frame, directed_back(frame, times(-1.0, normal)), margin, other)
    if found == 0:
        return 0
    put_normal(manifold, times(-1.0, directed(frame, _normal(other))))
    manifold[LEFT_OUT] = other[LEFT_OUT]
    for k in range(found):
        p = POINT + POINT_SIZE * k
        on_b = (other[p + ON_A], other[p + ON_A + 1], other[p + ON_A + 2])
        on_a = (other[p + ON_B], other[p + ON_B + 1], other[p + ON_B + 2])
        put_point(manifold, k, on_a, on_b, int(other[p + FEATURE]) + _OTHER_WAY)
    return found


@compiled
def _set_frustum(body: Any, g: Frustum, x: float, y: float) -> None:
    """Write a frustum as a polyhedron, with corners in the direction (x, y) from its axis."""
    lower, upper, half = g
    template = _PRISM if upper > 0.0 else _PYRAMID
    for k in range(len(template)):
        body[k] = template[k]
    for k in range(int(body[VERTICES])):
        at = HEADER + 3 * k
        u, v, w = vertex(template, k)
        radius = upper if w > 0.0 else lower
        body[at], body[at + 1], body[at + 2] = radius * (x * u - y * v), radius * (y * u + x * v), half * w
    # Normals of the sides, which are inclined as the middle lines of the sides
    flat = math.cos(math.pi / SIDES) * (lower - upper)
    size = math.sqrt(4.0 * half * half + flat * flat)
    first = int(body[PLANES_AT])
    ends = 2 if upper > 0.0 else 1
    for k in range(ends):
        body[first + 4 * k + 3] = half
    for k in range(SIDES):
        at = first + 4 * (ends + k)
        u, v = COS_BETWEEN[k], SIN_BETWEEN[k]
        normal = (2.0 * half * (x * u - y * v) / size, 2.0 * half * (y * u + x * v) / size, flat / size)
        body[at], body[at + 1], body[at + 2] = normal
        body[at + 3] = dot(normal, vertex(body, k))
    body[THICKNESS] = _thickness(g)
