"""Contacts between triangles of cloths and solid shapes, so that corners, edges and small balls do not pass between vertices.

Where a triangle touches with a corner, the vertex there does as well, which is a ball of half the thickness.
"""

import math

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, cross, dot, length, minus, plus, times, turned, turned_back
from kickdrift.world.collision.narrow_phase.manifold_points import put_no_load
from kickdrift.world.collision.narrow_phase.manifolds import collide, radius
from kickdrift.world.collision.shape_properties import sort_of
from kickdrift.world.columns import point_at, vector_at
from kickdrift.world.contacts.layout import NORMAL, ON_A, ON_B, POINT, POINT_SIZE, REACHABLE
from kickdrift.world.deformables.body_contacts.ball_contact import touch_of_ball
from kickdrift.world.deformables.body_contacts.contact_rows import (
    Pose,
    Touch,
    largest_speed,
    moves_body,
    note_contact,
    start_pose,
    velocity_at,
)
from kickdrift.world.deformables.body_contacts.pinned_corners import Corners, holds_off, is_pinned_to
from kickdrift.world.deformables.layout import (
    CLOTH_RADIUS,
    CORNERS,
    FACE_AREA,
    FIRST_FACE,
    LAST_FACE,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
)
from kickdrift.world.deformables.self_collision.closest_features import barycentric
from kickdrift.world.layout import BEGIN, BODY_ROW, RADIUS, SHAPE_KIND, SIZE
from kickdrift.world.shapes.kind_numbers import CYLINDER, TRIANGLE
from kickdrift.world.shapes.record import SOLID
from kickdrift.world.shapes.triangle import TRIANGLE_SIZE, put_facing
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    COLLIDERS,
    FACE,
    FACE_NUMBERS,
    GEOMETRY,
    MANIFOLD,
    PARTICLE,
    PLACE,
    SHAPE,
    flat,
    floats,
    integers,
)

_MANIFOLD = MANIFOLD.width
_CORNER = 1e-6  # of the share of a corner: a point closer to it touches with the vertex there
# Area at rest of covered triangles, of the square of the size up to which they are: unless they are slivers, they stretch to
# twice their length before they exceed it.
_SMALL = 0.25
_LEVER = 0.05  # share of pinned corners from which on the others would have to move 20 times as far as the point
_EDGE_ON = 0.1  # cosine of the angle between triangle and shape below which its corners touch first
_SIDEWAYS = 1e-6  # cosine between a normal and the axis of a cylinder, with rounding errors
_FLAT = 1.0 - 1e-12  # cosine between the normals of one face, with rounding errors

Triangle = tuple[Vector, Vector, Vector]


@compiled
def find_faces(world: int, cloth: int, shape: int, h: float) -> bool:
    """Find triangles of a cloth that may touch a solid within a time h, s, between their corners; False if there is no room.

    A round side of radius R reaches between the corners of a triangle by less than s^2 / 2 R, where s is the distance of a
    corner from the middle. Where that is below the thickness, corners alone touch it.
    """
    if sort_of(world, shape) != SOLID:
        return True
    own, face, particle = integers(world, CLOTH), integers(world, FACE), floats(world, PARTICLE)
    around, start, speed = floats(world, PLACE)[shape, RADIUS], start_pose(world, shape, h), largest_speed(world, shape)
    half = floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS]
    covered = _covered(radius(world, shape), half)
    for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
        i, j, k = face[f, CORNERS], face[f, CORNERS + 1], face[f, CORNERS + 2]
        corners = (vector_at(particle, i, 0), vector_at(particle, j, 0), vector_at(particle, k, 0))
        middle = times(1.0 / 3.0, plus(plus(corners[0], corners[1]), corners[2]))
        size, fastest = 0.0, 0.0
        for corner in (i, j, k):
            out, v = minus(vector_at(particle, corner, 0), middle), vector_at(particle, corner, PARTICLE_VELOCITY)
            size, fastest = max(size, dot(out, out)), max(fastest, dot(v, v))
        if _is_covered(world, f, size, covered):
            continue
        size, margin = math.sqrt(size), h * (speed + math.sqrt(fastest)) + half
        away, reach = minus(middle, start[0]), around + size + margin + half
        if dot(away, away) <= reach * reach and not _touch(
            world, cloth, f, (i, j, k), corners, size, shape, start, margin, h
        ):
            return False
    return True


@compiled
def _touch(
    world: int,
    cloth: int,
    f: int,
    particles: Corners,
    corners: Triangle,
    size: float,
    shape: int,
    start: Pose,
    margin: float,
    h: float,
) -> bool:
    """Add the contacts of a triangle with a solid, except with a body to which it is pinned; False if there is no room.

    The front of the triangle is the side from which the shape comes closest to the point that is nearest to its middle. Pins
    may lie inside their body, where contacts would push against them forever.
    """
    if is_pinned_to(world, cloth, particles, integers(world, SHAPE)[shape, BODY_ROW]):
        return True
    half, (u, v, w) = floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS], corners
    near = barycentric(start[0], u, v, w)
    p = plus(plus(times(near[0], u), times(near[1], v)), times(near[2], w))
    touches, (normal, _, _) = touch_of_ball(world, shape, -1, start, p, half, margin + 2.0 * size)
    across = cross(minus(v, u), minus(w, u))
    if not touches or abs(dot(normal, across)) <= _EDGE_ON * length(across):
        return True
    if _is_covered(world, f, size * size, _covered(_radius_of_side(world, shape, start, normal), half)):
        return True
    if _is_above_face(world, shape, start, corners, normal, half, margin + 4.0 * size):
        return True
    shapes, (at, q) = integers(world, SHAPE), start
    begin, kind = shapes[shape, BEGIN], shapes[shape, SHAPE_KIND]
    numbers = flat(world, GEOMETRY)[begin : begin + shapes[shape, SIZE]]
    triangle, pose = carray(floats_on_stack(TRIANGLE_SIZE), (TRIANGLE_SIZE,)), carray(floats_on_stack(7), (7,))
    manifold = carray(floats_on_stack(_MANIFOLD), (_MANIFOLD,))
    u, v, w = turned_back(q, minus(u, at)), turned_back(q, minus(v, at)), turned_back(q, minus(w, at))
    put_facing(u, v, w, turned_back(q, minus(minus(p, normal), at)), triangle)
    pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], pose[6] = 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0
    manifold[REACHABLE] = margin + half
    put_no_load(manifold)
    count = collide(integers(world, COLLIDERS)[TRIANGLE, kind], (triangle, numbers, pose, margin + half, manifold))
    inward, fits = point_at(manifold, NORMAL), True
    for k in range(count):
        on_triangle = point_at(manifold, POINT + k * POINT_SIZE + ON_A)
        on_shape = point_at(manifold, POINT + k * POINT_SIZE + ON_B)
        shares, gap = barycentric(on_triangle, u, v, w), dot(inward, minus(on_shape, on_triangle)) - half
        touch = (times(-1.0, turned(q, inward)), gap, plus(at, turned(q, on_shape)))
        shares = _movable(world, cloth, particles, shares, integers(world, SHAPE)[shape, BODY_ROW])
        inside = 0.0 < max(shares[0], shares[1], shares[2]) < 1.0 - _CORNER
        if inside and _may_close(world, particles, shares, shape, touch, half, h):
            fits = fits and note_contact(world, cloth, shape, particles, shares, touch, h)
    return fits


@compiled(inline=True)
def _covered(around: float, half: float) -> float:
    """Return the square of the size of triangles whose corners alone touch a round side, m^2."""
    return 4.0 * around * half


@compiled(inline=True)
def _is_covered(world: int, f: int, size: float, covered: float) -> bool:
    """Whether the corners of a triangle alone touch a round side, by the squares of its present size and that of `_covered`.

    A triangle that begins to touch as a ball stretches it is pushed out at once, against the tension. With all triangles up to
    that size covered, a ball on a trampoline gained 91 % of its energy.
    """
    return bool(size <= covered and floats(world, FACE_NUMBERS)[f, FACE_AREA] <= _SMALL * covered)


@compiled(inline=True)
def _radius_of_side(world: int, shape: int, start: Pose, normal: Vector) -> float:
    """Return the radius of a cylinder where a normal points away from its side, m; otherwise zero."""
    own = integers(world, SHAPE)
    if own[shape, SHAPE_KIND] != CYLINDER or abs(dot(normal, turned(start[1], (0.0, 0.0, 1.0)))) > _SIDEWAYS:
        return 0.0
    side: float = flat(world, GEOMETRY)[own[shape, BEGIN]]
    return side


@compiled
def _is_above_face(
    world: int, shape: int, start: Pose, corners: Triangle, normal: Vector, half: float, reach: float
) -> bool:
    """Whether the closest points of a solid to all corners lie on one flat face, so that a corner is the closest point of all.

    The points that are closest to one face of a convex shape form a convex set.
    """
    above = True
    for k in range(3):
        p = corners[0] if k == 0 else corners[1] if k == 1 else corners[2]
        touches, touch = touch_of_ball(world, shape, -1, start, p, half, reach)
        above = above and touches and dot(touch[0], normal) >= _FLAT
    return above


@compiled
def _may_close(world: int, particles: Corners, shares: Vector, shape: int, touch: Touch, half: float, h: float) -> bool:
    """Whether the gap of a point comes below `half` within h, s, at present velocities."""
    particle = floats(world, PARTICLE)
    normal, gap, point = touch
    v = times(-1.0, velocity_at(world, shape, point, h))
    for k in range(3):
        row = particles[0] if k == 0 else particles[1] if k == 1 else particles[2]
        v = plus(v, times(shares[k], vector_at(particle, row, PARTICLE_VELOCITY)))
    closes: bool = gap + h * min(dot(normal, v), 0.0) < half
    return closes


@compiled
def _movable(world: int, cloth: int, particles: Corners, shares: Vector, body: int) -> Vector:
    """Return the shares of the corners in a point: beside pinned ones those of these alone, zeros if they stop nothing."""
    particle = floats(world, PARTICLE)
    a, b, c = (
        int(particle[particles[0], PARTICLE_INVERSE_MASS] == 0.0) * shares[0],
        int(particle[particles[1], PARTICLE_INVERSE_MASS] == 0.0) * shares[1],
        int(particle[particles[2], PARTICLE_INVERSE_MASS] == 0.0) * shares[2],
    )
    held = a + b + c
    if held < 1.0 - _LEVER:
        return shares
    for k in range(3):
        i = particles[0] if k == 0 else particles[1] if k == 1 else particles[2]
        if particle[i, PARTICLE_INVERSE_MASS] == 0.0 and not (
            moves_body(world, i, body) and holds_off(world, cloth, i, body)
        ):
            return (0.0, 0.0, 0.0)
    return times(1.0 / held, (a, b, c))
