"""Contact of two cylinders or cones: one is approximated by a polyhedron with a corner at the contact."""

import math
from typing import Any

import numpy as np
from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, dot, length, times
from kickdrift.world.collision.epa import DEEP, is_off, overlap_of_frusta, put_overlap
from kickdrift.world.collision.face_bias import SHARE_OFF, tolerance_of
from kickdrift.world.collision.frustum_faces import COS_BETWEEN, SIDES, SIN_BETWEEN
from kickdrift.world.collision.frustum_polyhedra import polyhedron_frustum
from kickdrift.world.collision.frustum_round import FLAT_ON, lowest_direction
from kickdrift.world.collision.manifold_points import put_normal, put_point
from kickdrift.world.collision.shape_frames import directed, set_frame, set_frame_back
from kickdrift.world.contacts.layout import FEATURE, LEFT_OUT, NORMAL, ON_A, ON_B, POINT, POINT_SIZE, REACHABLE
from kickdrift.world.shapes.frustum import Frustum, frustum_of, highest, radial, signed_distance
from kickdrift.world.shapes.polyhedron import HEADER, PLANES_AT, THICKNESS, VERTICES, polyhedron_numbers, vertex
from kickdrift.world.tables import MANIFOLD

_ROUNDS = 7  # bisections, which leave 0.1 degrees: two millionths of a radius
_SAME = 1e-6  # rad: tolerance of the angle of the contact about the axis
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
_OTHER_WAY = 1 << 24  # added to features if the second frustum is the polyhedron


@compiled
def frustum_frustum(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of two frusta; see `kickdrift.world.collision`."""
    f, g = frustum_of(a), frustum_of(b)
    frame, back = floats_on_stack(12), floats_on_stack(12)
    set_frame(frame, pose)
    set_frame_back(back, pose)
    size = length((pose[0], pose[1], pose[2]))
    if size > 0.0 and _gap(f, g, back, (pose[0] / size, pose[1] / size, pose[2] / size)) > margin:
        return 0
    count = _touching(f, g, frame, back, margin, manifold)
    if count == 0:
        return 0
    gap, tolerance = _gap(f, g, back, _normal(manifold)), tolerance_of(margin, min(_thickness(f), _thickness(g)))
    misses = count == 1 and (is_off(f, manifold, ON_A, tolerance) or is_off(g, manifold, ON_B, tolerance))
    if gap < -DEEP * tolerance or (misses and gap < 0.0):
        depth, normal, x = overlap_of_frusta(f, back, g)
        if depth > 0.0 and (misses or -depth > gap + SHARE_OFF * abs(gap) + tolerance):
            return put_overlap(depth, normal, x, back, manifold)
    return count


@compiled(inline=True)
def _thickness(f: Frustum) -> float:
    return min(f[2], max(f[0], f[1]))


@compiled
def _touching(f: Frustum, g: Frustum, frame: Any, back: Any, margin: float, manifold: Any) -> int:
    """Find the contact points by the features that touch.

    The first is approximated by a polyhedron. If they overlap at a rim of the second, the direction of smallest penetration may
    be a normal of the first: then, and where the point is not on the second, the second is approximated as well, and the better
    of both contacts is used.
    """
    count = _as_polyhedron(f, g, back, margin, manifold)
    if count > 1 or (count == 1 and not _is_doubtful(g, manifold, _gap(f, g, back, _normal(manifold)))):
        return count
    other = carray(floats_on_stack(_MANIFOLD), (_MANIFOLD,))
    other[REACHABLE], other[LEFT_OUT] = manifold[REACHABLE], math.inf
    found = _as_polyhedron(g, f, frame, margin, other)
    if found == 0:
        return count
    normal = times(-1.0, directed(frame, _normal(other)))
    best = _gap(f, g, back, _normal(manifold))
    if count > 0 and _gap(f, g, back, normal) <= best + SHARE_OFF * abs(best):
        return count
    put_normal(manifold, normal)
    manifold[LEFT_OUT] = other[LEFT_OUT]
    for k in range(found):
        p = POINT + POINT_SIZE * k
        on_b = (other[p + ON_A], other[p + ON_A + 1], other[p + ON_A + 2])
        on_a = (other[p + ON_B], other[p + ON_B + 1], other[p + ON_B + 2])
        put_point(manifold, k, on_a, on_b, int(other[p + FEATURE]) + _OTHER_WAY)
    return found


@compiled(inline=True)
def _normal(manifold: Any) -> Vector:
    return (manifold[NORMAL], manifold[NORMAL + 1], manifold[NORMAL + 2])


@compiled(inline=True)
def _is_doubtful(g: Frustum, manifold: Any, gap: float) -> bool:
    """Whether the first contact point is not on the second frustum, or is about as close to a rim as the overlap is deep.

    A rim or an apex of the second may be beside the corner of the first by more than they overlap, as bisection leaves it.
    """
    p, slack = POINT + ON_B, 1e-3 * max(g[0], g[1], g[2])
    z = manifold[p + 2]
    off, _ = signed_distance(g, (manifold[p], manifold[p + 1], z))
    if off > slack or gap > 0.0:
        return off > slack
    away = abs((g[1] if z > 0.0 else g[0]) - math.sqrt(manifold[p] ** 2 + manifold[p + 1] ** 2))
    near: bool = max(away, g[2] - abs(z)) < 4.0 * abs(gap) + slack
    return near


@compiled(inline=True)
def _gap(f: Frustum, g: Frustum, back: Any, normal: Vector) -> float:
    """Return the separation of two frusta along a direction in the first's frame; `back` is this frame in the second's."""
    n = directed(back, normal)
    return dot(n, (-back[9], -back[10], -back[11])) - highest(f, normal) - highest(g, times(-1.0, n))


@compiled
def _as_polyhedron(f: Frustum, g: Frustum, frame: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of two frusta, the first approximated by a polyhedron; `frame` is its frame in the second's."""
    body = floats_on_stack(_SIZE)
    flat = 2 if f[1] > 0.0 else 1
    wide = margin + (1.0 - math.cos(math.pi / SIDES)) * max(f[0], f[1])
    _, x, y = radial(
        frame[0] * -frame[9] + frame[3] * -frame[10] + frame[6] * -frame[11],
        frame[1] * -frame[9] + frame[4] * -frame[10] + frame[7] * -frame[11],
    )
    angle, step, near = math.atan2(y, x), 2.0 * math.pi / SIDES, SIDES
    for turn in range(_ROUNDS):
        x, y = math.cos(angle), math.sin(angle)
        _set_frustum(body, f, x, y)
        if polyhedron_frustum(body, flat + SIDES, -1, g, frame, wide, manifold) == 0:
            return 0
        # The normal at a point of a round surface is in the half-plane of the axis and that point. The contact normal of the
        # polygon tells on which side of the present corner the true contact is, and its angle is found by bisection.
        sine, u, v = lowest_direction(_normal(manifold), FLAT_ON)
        off = math.atan2(x * v - y * u, x * u + y * v)
        near = SIDES if sine >= FLAT_ON else 0  # on flat ends the corners stay where they are in the body, near or not
        if turn == 0 or sine < FLAT_ON:
            angle += off
        else:
            step *= 0.5
            angle += max(-step, min(off, step))
        if turn > 0 and (abs(off) < _SAME or sine < FLAT_ON):
            break
    x, y = math.cos(angle), math.sin(angle)
    _set_frustum(body, f, x, y)
    return polyhedron_frustum(body, flat, near, g, frame, margin, manifold)


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
