"""Contacts between segments of ropes and shapes of bodies, so that thin poles do not pass between vertices.

A segment is a capsule. Where it touches with an end, the vertex there does as well, which is a ball of the same radius.
"""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import (
    Quaternion,
    Vector,
    conjugate,
    dot,
    length,
    minus,
    plus,
    product,
    times,
    turned,
    turned_back,
    unit,
)
from kickdrift.world.collision.narrow_phase.manifolds import collide
from kickdrift.world.collision.queries.overlap_query import find_triangles
from kickdrift.world.collision.shape_properties import sort_of
from kickdrift.world.columns import point_at, vector_at
from kickdrift.world.contacts.layout import NORMAL, ON_A, ON_B, POINT, POINT_SIZE
from kickdrift.world.deformables.body_contacts.contact_rows import Pose, largest_speed, note_contact, start_pose
from kickdrift.world.deformables.layout import (
    CLOTH_RADIUS,
    FIRST_PARTICLE,
    LAST_PARTICLE,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
)
from kickdrift.world.layout import BEGIN, RADIUS, SHAPE_KIND, SIZE
from kickdrift.world.shapes.kind_numbers import CAPSULE, TRIANGLE
from kickdrift.world.shapes.record import HALF_SPACE, SURFACE
from kickdrift.world.shapes.triangle import TRIANGLE_SIZE, begin_of
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NEAR,
    CLOTH_NUMBERS,
    COLLIDERS,
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
_END = 1e-6  # of a segment: what is closer to its end touches with the vertex there
_LEVER = 0.05  # likewise to a pinned end, beside which the other one would have to move 20 times as far


@compiled
def find_segments(world: int, cloth: int, shape: int, h: float, after: int) -> bool:
    """Find segments of a rope that may touch a shape within a time h, s, between their ends; False if there is no room."""
    own, particle = integers(world, CLOTH), floats(world, PARTICLE)
    around, sort = floats(world, PLACE)[shape, RADIUS], sort_of(world, shape)
    if sort == HALF_SPACE:
        return True  # ends are the lowest points
    start, speed = start_pose(world, shape, h), largest_speed(world, shape)
    radius = floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS]
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE] - 1):
        if particle[i, PARTICLE_INVERSE_MASS] == 0.0 and particle[i + 1, PARTICLE_INVERSE_MASS] == 0.0:
            continue
        fastest = max(
            length(vector_at(particle, i, PARTICLE_VELOCITY)), length(vector_at(particle, i + 1, PARTICLE_VELOCITY))
        )
        margin = h * (speed + fastest) + radius
        p, q = vector_at(particle, i, 0), vector_at(particle, i + 1, 0)
        away, reach = minus(times(0.5, plus(p, q)), start[0]), margin + radius + 0.5 * length(minus(q, p))
        if sort == SURFACE:
            found = _find_on_surface(world, cloth, i, shape, start, margin, after, h)
        else:
            found = dot(away, away) > (around + reach) ** 2 or _touch(world, cloth, i, shape, -1, start, margin, h)
        if not found:
            return False
    return True


@compiled
def _find_on_surface(
    world: int, cloth: int, i: int, shape: int, start: Pose, margin: float, after: int, h: float
) -> bool:
    """Find the contacts of a segment with the triangles of a surface; False if there is no room."""
    particle, near = floats(world, PARTICLE), flat(world, CLOTH_NEAR)[after:]
    p, q, reach = (
        vector_at(particle, i, 0),
        vector_at(particle, i + 1, 0),
        margin + floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS],
    )
    low = (min(p[0], q[0]) - reach, min(p[1], q[1]) - reach, min(p[2], q[2]) - reach)
    high = (max(p[0], q[0]) + reach, max(p[1], q[1]) + reach, max(p[2], q[2]) + reach)
    box = (low[0], low[1], low[2], high[0], high[1], high[2])
    fits = True
    for k in range(find_triangles(world, shape, box, near)):
        fits = fits and _touch(world, cloth, i, shape, int(near[k]), start, margin, h)
    return fits


@compiled
def _touch(world: int, cloth: int, i: int, shape: int, triangle: int, start: Pose, margin: float, h: float) -> bool:
    """Add the contacts of a segment with a shape, or one of its triangles; False if there is no room."""
    shapes, particle, function = integers(world, SHAPE), floats(world, PARTICLE), integers(world, COLLIDERS)
    begin, size, kind = shapes[shape, BEGIN], shapes[shape, SIZE], shapes[shape, SHAPE_KIND]
    if triangle >= 0:
        begin, size, kind = begin_of(begin, triangle), TRIANGLE_SIZE, TRIANGLE
    numbers = flat(world, GEOMETRY)[begin : begin + size]
    capsule, pose = carray(floats_on_stack(2), (2,)), carray(floats_on_stack(7), (7,))
    manifold = carray(floats_on_stack(_MANIFOLD), (_MANIFOLD,))
    p, q = vector_at(particle, i, 0), vector_at(particle, i + 1, 0)
    way = minus(q, p)
    half = 0.5 * length(way)
    if half == 0.0:
        return True
    middle, turn = times(0.5, plus(p, q)), _turn_to(times(0.5 / half, way))
    at, pose_turn = start
    capsule[0], capsule[1] = floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS], half
    is_first = kind <= CAPSULE  # the shape is the first of the pair
    if is_first:
        _put_pose(pose, at, pose_turn, middle, turn)
        count = collide(function[kind, CAPSULE], (numbers, capsule, pose, margin, manifold))
    else:
        _put_pose(pose, middle, turn, at, pose_turn)
        count = collide(function[CAPSULE, kind], (capsule, numbers, pose, margin, manifold))
    n, own, other = point_at(manifold, NORMAL), ON_B if is_first else ON_A, ON_A if is_first else ON_B
    normal = turned(pose_turn, n) if is_first else times(-1.0, turned(turn, n))
    first = _LEVER if particle[i, PARTICLE_INVERSE_MASS] == 0.0 else _END
    last = 1.0 - (_LEVER if particle[i + 1, PARTICLE_INVERSE_MASS] == 0.0 else _END)
    fits = True
    for k in range(count):
        on_segment = point_at(manifold, POINT + k * POINT_SIZE + own)
        point = plus(at, turned(pose_turn, point_at(manifold, POINT + k * POINT_SIZE + other)))
        from_middle = turned(turn, on_segment)
        along = dot(plus(from_middle, times(capsule[0], normal)), way) / (2.0 * half)
        share = 0.5 + 0.5 * along / half
        if first < share < last:
            gap = dot(normal, minus(plus(middle, from_middle), point))
            fits = fits and note_contact(
                world, cloth, shape, (i, i + 1, i), (1.0 - share, share, 0.0), (normal, gap, point), h
            )
    return fits


@compiled(inline=True)
def _put_pose(pose: Any, origin: Vector, turn: Quaternion, at: Vector, other: Quaternion) -> None:
    """Write the pose of one frame, `at` and `other`, in another one."""
    pose[0], pose[1], pose[2] = turned_back(turn, minus(at, origin))
    pose[3], pose[4], pose[5], pose[6] = product(conjugate(turn), other)


@compiled
def _turn_to(along: Vector) -> Quaternion:
    """Return a rotation that turns the z axis to a unit vector."""
    if along[2] < -0.5:  # half a turn about x first, as that from z to -z is undetermined
        return product(unit((1.0 - along[2], along[1], -along[0], 0.0)), (0.0, 1.0, 0.0, 0.0))
    return unit((1.0 + along[2], -along[1], along[0], 0.0))
