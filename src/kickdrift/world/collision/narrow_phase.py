"""Where shapes are, and where two of them touch: the function for their kinds is asked, and impulses follow their features."""

from numba import types

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, plus, product, turned
from kickdrift.world.collision.dispatch import sort_of
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.contacts.layout import (
    FEATURE,
    FOUND_POSE,
    NORMAL_IMPULSE,
    PART,
    POINT,
    POINT_SIZE,
    POINTS,
    SHAPE_A,
    SHAPE_B,
)
from kickdrift.world.layout import (
    BEGIN,
    BODY_ROW,
    ORIENTATION,
    PLACE_ORIENTATION,
    PLACE_POSITION,
    PLACED_ORIENTATION,
    PLACED_POSITION,
    POSITION,
    SHAPE_KIND,
    SIZE,
)
from kickdrift.world.shapes.kinds import TRIANGLE
from kickdrift.world.shapes.record import SURFACE
from kickdrift.world.shapes.triangle import TRIANGLE_SIZE, begin_of
from kickdrift.world.tables import (
    COLLIDERS,
    CONTACT,
    GEOMETRY,
    MANIFOLD,
    PLACE,
    PLACED,
    POSE,
    SHAPE,
    flat,
    floats,
    integers,
    rows,
)

_ARRAY = types.Array(types.float64, 1, "C")
COLLIDE = types.int64(_ARRAY, _ARRAY, _ARRAY, types.float64, _ARRAY)

collide = caller(COLLIDE)


@compiled
def place_shapes(t: float, h: float, world: int) -> None:
    """Say where in the world the shapes are."""
    placed = floats(world, PLACED)
    for shape in range(rows(world, SHAPE)):
        at, turn = shape_pose(world, shape)
        for k in range(3):
            placed[shape, PLACED_POSITION + k] = at[k]
        for k in range(4):
            placed[shape, PLACED_ORIENTATION + k] = turn[k]


@compiled(inline=True)
def shape_pose(world: int, shape: int) -> tuple[Vector, Quaternion]:
    """Return where a shape is in the world: its origin and its orientation."""
    pose, place = floats(world, POSE), floats(world, PLACE)
    body = integers(world, SHAPE)[shape, BODY_ROW]
    q = quaternion_at(pose, body, ORIENTATION)
    local = quaternion_at(place, shape, PLACE_ORIENTATION)
    at = vector_at(place, shape, PLACE_POSITION)
    return plus(vector_at(pose, body, POSITION), turned(q, at)), product(q, local)


@compiled(inline=True)
def placed_pose(world: int, shape: int) -> tuple[Vector, Quaternion]:
    """Return the same as it was when the step began, which costs nothing."""
    p = floats(world, PLACED)
    return vector_at(p, shape, PLACED_POSITION), quaternion_at(p, shape, PLACED_ORIENTATION)


@compiled
def look_again(world: int, row: int, at: Vector, turn: Quaternion, margin: float) -> None:
    """Find the points of a contact anew, for a pose of the second shape in the first's frame."""
    contact, manifold, numbers = integers(world, CONTACT), flat(world, MANIFOLD), flat(world, GEOMETRY)
    shape = integers(world, SHAPE)
    a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
    begin_a, size_a, kind_a = shape[a, BEGIN], shape[a, SIZE], shape[a, SHAPE_KIND]
    if sort_of(world, a) == SURFACE:
        begin_a, size_a, kind_a = begin_of(begin_a, contact[row, PART]), TRIANGLE_SIZE, TRIANGLE
    begin_b, size_b = shape[b, BEGIN], shape[b, SIZE]
    own = manifold[MANIFOLD.width * row : MANIFOLD.width * (row + 1)]
    found = own[FOUND_POSE : FOUND_POSE + 7]
    found[0], found[1], found[2] = at
    found[3], found[4], found[5], found[6] = turn
    before = contact[row, POINTS]
    ids = (own[_id(0)], own[_id(1)], own[_id(2)], own[_id(3)])
    impulses = (own[NORMAL_IMPULSE], own[NORMAL_IMPULSE + 1], own[NORMAL_IMPULSE + 2], own[NORMAL_IMPULSE + 3])
    count = collide(
        integers(world, COLLIDERS)[kind_a, shape[b, SHAPE_KIND]],
        (numbers[begin_a : begin_a + size_a], numbers[begin_b : begin_b + size_b], found, margin, own),
    )
    contact[row, POINTS] = count
    for new in range(count):
        own[NORMAL_IMPULSE + new] = 0.0
        for old in range(before):
            if ids[old] == own[_id(new)]:
                own[NORMAL_IMPULSE + new] = impulses[old]
                break


@compiled(inline=True)
def _id(point: int) -> int:
    return POINT + POINT_SIZE * point + FEATURE


@compiled(inline=True)
def smallest(reach_a: float, reach_b: float) -> float:
    """Return the smaller reach of two shapes; that of planes and meshes, which is 0.0, does not count."""
    if reach_a == 0.0:
        return reach_b
    return reach_a if reach_b == 0.0 else min(reach_a, reach_b)
