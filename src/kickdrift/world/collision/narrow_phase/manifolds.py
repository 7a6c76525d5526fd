"""The narrow phase: poses of shapes, and manifolds from the contact functions of their kinds."""

import math
from typing import Any

from numba import carray, types

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Quaternion, Vector, cross, dot, minus, normal_to, plus, times, turned, turned_back
from kickdrift.world.collision.narrow_phase.impulse_matching import (
    OLD_SIZE,
    keep_points,
    lose_points,
    take_over_impulses,
)
from kickdrift.world.collision.narrow_phase.manifold_points import put_load
from kickdrift.world.collision.shape_poses import placed_pose, shape_pose
from kickdrift.world.collision.shape_properties import core_of, sort_of
from kickdrift.world.columns import point_at, quaternion_at, vector_at
from kickdrift.world.contacts.layout import (
    BODY_A,
    BODY_B,
    CONTACT_STATE,
    FOUND_POSE,
    LEFT_OUT,
    MOVING,
    NORMAL,
    ON_A,
    ON_B,
    POINT,
    POINT_SIZE,
    POINTS,
    SHAPE_A,
    SHAPE_B,
    TRIANGLE_INDEX,
    WIDTH_OF_FACE,
)
from kickdrift.world.layout import (
    BEGIN,
    INVERSE_LINEAR_MASS,
    LAST_LOST,
    PLACE_ORIENTATION,
    PLACE_POSITION,
    PLACED_ORIENTATION,
    PLACED_POSITION,
    POSITION,
    RADIUS,
    SHAPE_KIND,
    SIZE,
)
from kickdrift.world.settings import GRAVITY
from kickdrift.world.shapes.kind_numbers import TRIANGLE
from kickdrift.world.shapes.record import CENTRE, SURFACE
from kickdrift.world.shapes.triangle import TRIANGLE_SIZE, begin_of
from kickdrift.world.tables import (
    COLLIDERS,
    CONTACT,
    GEOMETRY,
    INVERSE_MASS,
    LOST_POINT,
    MANIFOLD,
    PLACE,
    PLACED,
    POSE,
    SETTINGS,
    SHAPE,
    flat,
    floats,
    integers,
    rows,
    set_rows,
)

_ARRAY = types.Array(types.float64, 1, "C")
COLLIDE = types.int64(_ARRAY, _ARRAY, _ARRAY, types.float64, _ARRAY)

collide = caller(COLLIDE)

_STEEP = 0.2  # cosine between gravity and a normal below which no weight is carried

_NEAR = 0.2  # of the smaller shape: distance within which a point takes over the impulse of another one


@compiled
def place_shapes(t: float, h: float, world: int) -> None:
    """Store the poses of all shapes in the world at the start of the step, when none has lost a point."""
    set_rows(world, LOST_POINT, 0)
    placed = floats(world, PLACED)
    for shape in range(rows(world, SHAPE)):
        at, turn = shape_pose(world, shape)
        for k in range(3):
            placed[shape, PLACED_POSITION + k] = at[k]
        for k in range(4):
            placed[shape, PLACED_ORIENTATION + k] = turn[k]
        placed[shape, LAST_LOST] = 0.0


@compiled
def find_manifold(world: int, row: int, at: Vector, turn: Quaternion, margin: float) -> None:
    """Find the manifold of a contact, for a pose of the second shape in the first's frame, and keep impulses."""
    contact, manifold = integers(world, CONTACT), flat(world, MANIFOLD)
    a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
    own = manifold[MANIFOLD.width * row : MANIFOLD.width * (row + 1)]
    moved = minus(at, point_at(own, FOUND_POSE))
    before = contact[row, POINTS]
    old = carray(floats_on_stack(OLD_SIZE), (OLD_SIZE,))
    keep_points(own, before, old)
    put_load(own, _load(world, row, own, at, turn))
    count = write_points(world, row, at, turn, margin, own)
    contact[row, POINTS] = count
    if before == 0:
        contact[row, CONTACT_STATE] |= MOVING
    place = floats(world, PLACE)
    near, on_surface = _NEAR * smallest(place[a, RADIUS], place[b, RADIUS]), sort_of(world, a) == SURFACE
    take_over_impulses(own, old, before, count, 0.0 if on_surface else near)
    if on_surface:  # the nearest one may be on another triangle
        lose_points(world, row, old, before, moved, near)
    own[WIDTH_OF_FACE] = _width(own, count)


@compiled(inline=True)
def _load(world: int, row: int, own: Any, at: Vector, turn: Quaternion) -> Vector:
    """Return where gravity acts through the centre of mass of the body that is carried, in the frame of the first shape.

    That body is the one that moves, or of two that move the upper one; the place is on the face that touched before. NaN if
    none did, or if it is steep.
    """
    contact, settings, nothing = integers(world, CONTACT), floats(world, SETTINGS), (math.nan, math.nan, math.nan)
    mass, pose, place = floats(world, INVERSE_MASS), floats(world, POSE), floats(world, PLACE)
    a, b, body_a, body_b = contact[row, SHAPE_A], contact[row, SHAPE_B], contact[row, BODY_A], contact[row, BODY_B]
    gravity = vector_at(settings, 0, GRAVITY)
    apart = minus(vector_at(pose, body_b, POSITION), vector_at(pose, body_a, POSITION))
    fixed_a, fixed_b = mass[body_a, INVERSE_LINEAR_MASS] == 0.0, mass[body_b, INVERSE_LINEAR_MASS] == 0.0
    shape = a if fixed_b or (dot(apart, gravity) > 0.0 and not fixed_a) else b
    centre = turned_back(
        quaternion_at(place, shape, PLACE_ORIENTATION), times(-1.0, vector_at(place, shape, PLACE_POSITION))
    )
    centre = centre if shape == a else plus(at, turned(turn, centre))
    way, normal = turned_back(placed_pose(world, a)[1], gravity), point_at(own, NORMAL)
    along = dot(normal, way)
    if contact[row, POINTS] == 0 or along * along <= _STEEP * _STEEP * dot(way, way):
        return nothing
    return plus(centre, times(dot(normal, minus(point_at(own, POINT + ON_A), centre)) / along, way))


@compiled
def _width(own: Any, count: int) -> float:
    """Return half the smallest width of the face that points span, m; zero for an edge or a point.

    It is that of the rectangle whose corners have the same second moments.
    """
    if count < 3:
        return 0.0
    along = point_at(own, NORMAL)
    first = normal_to(along)
    second = cross(along, first)
    x, y, xx, yy, xy = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        p = POINT + POINT_SIZE * k
        at = point_at(own, p + ON_A)
        u, v = dot(first, at), dot(second, at)
        x, y, xx, yy, xy = x + u, y + v, xx + u * u, yy + v * v, xy + u * v
    xx, yy, xy = xx / count - (x / count) ** 2, yy / count - (y / count) ** 2, xy / count - x * y / count**2
    least = 0.5 * (xx + yy) - math.sqrt(0.25 * (xx - yy) ** 2 + xy * xy)
    return math.sqrt(max(least, 0.0))


@compiled
def write_points(world: int, row: int, at: Vector, turn: Quaternion, margin: float, own: Any) -> int:
    """Write pose, normal and points of a contact, for a pose of the second shape in the first's frame; return their number."""
    contact, shape, numbers = integers(world, CONTACT), integers(world, SHAPE), flat(world, GEOMETRY)
    a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
    begin_a, size_a, kind_a = shape[a, BEGIN], shape[a, SIZE], shape[a, SHAPE_KIND]
    if sort_of(world, a) == SURFACE:
        begin_a, size_a, kind_a = begin_of(begin_a, contact[row, TRIANGLE_INDEX]), TRIANGLE_SIZE, TRIANGLE
    begin_b, size_b = shape[b, BEGIN], shape[b, SIZE]
    found = own[FOUND_POSE : FOUND_POSE + 7]
    found[0], found[1], found[2] = at
    found[3], found[4], found[5], found[6] = turn
    own[LEFT_OUT] = math.inf
    count: int = collide(
        integers(world, COLLIDERS)[kind_a, shape[b, SHAPE_KIND]],
        (numbers[begin_a : begin_a + size_a], numbers[begin_b : begin_b + size_b], found, margin, own),
    )
    return count


@compiled
def deepest(manifold: Any, row: int, count: int, at: Vector, turn: Quaternion) -> tuple[float, Vector]:
    """Return the smallest gap of the points, m, for a pose of the second shape in the first's frame; its normal."""
    normal, gap = vector_at(manifold, row, NORMAL), math.inf
    for k in range(count):
        p = POINT + POINT_SIZE * k
        on_b = plus(at, turned(turn, vector_at(manifold, row, p + ON_B)))
        gap = min(gap, dot(normal, minus(on_b, vector_at(manifold, row, p + ON_A))))
    return gap, normal


@compiled(inline=True)
def smallest(reach_a: float, reach_b: float) -> float:
    """Return the smaller of two bounding radii, ignoring 0.0, which planes and meshes have."""
    if reach_a == 0.0:
        return reach_b
    return reach_a if reach_b == 0.0 else min(reach_a, reach_b)


@compiled(inline=True)
def radius(world: int, shape: int) -> float:
    """Return the radius of a shape about its core if that is a point or a segment, m; 0.0 for other shapes."""
    begin = integers(world, SHAPE)[shape, BEGIN]
    return flat(world, GEOMETRY)[begin] if core_of(world, shape) == CENTRE else 0.0
