"""Where shapes touch: contacts whose shapes have moved are looked at again, the others keep their points."""

import math
from typing import Any

from numba import types

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, conjugate, dot, minus, plus, product, turned, turned_back
from kickdrift.world.contacts.layout import (
    BODY_A,
    BODY_B,
    FEATURE,
    FOUND_POSE,
    PART,
    POINT,
    POINT_SIZE,
    POINTS,
    RECYCLED,
    SHAPE_A,
    SHAPE_B,
)
from kickdrift.world.flight import AWAKE
from kickdrift.world.settings import MARGIN, RECYCLE_DISTANCE, STEP
from kickdrift.world.shapes.kinds import MESH, TRIANGLE
from kickdrift.world.tables import (
    BODY,
    COLLIDERS,
    CONTACT,
    GEOMETRY,
    MANIFOLD,
    MOTION,
    PLACE,
    PLACED,
    POSE,
    SETTINGS,
    SHAPE,
    flat,
    floats,
    integers,
    rows,
)

# Columns of PLACE besides the pose of the shape in its body
FRICTION, RESTITUTION, ROLLING, SURFACE_VELOCITY, RADIUS = 7, 8, 9, 10, 13

_ARRAY = types.Array(types.float64, 1, "C")
COLLIDE = types.int64(_ARRAY, _ARRAY, _ARRAY, types.float64, _ARRAY)

collide = caller(COLLIDE)


@compiled
def find_points(t: float, h: float, world: int) -> None:
    """Find the points of all contacts whose shapes have moved against each other."""
    contact, manifold = integers(world, CONTACT), floats(world, MANIFOLD)
    place, settings = floats(world, PLACE), floats(world, SETTINGS)
    awake = integers(world, BODY)
    for row in range(rows(world, CONTACT)):
        a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
        if awake[contact[row, BODY_A], AWAKE] == 0 and awake[contact[row, BODY_B], AWAKE] == 0:
            continue
        at_a, turn_a = placed_pose(world, a)
        at_b, turn_b = placed_pose(world, b)
        at = turned_back(turn_a, minus(at_b, at_a))
        turn = product(conjugate(turn_a), turn_b)
        way = settings[0, STEP] * _closing_speed(world, row)
        moved = _moved(manifold, row, at, turn, place[b, RADIUS])
        if moved + way < manifold[row, RECYCLED] and (
            contact[row, POINTS] == 0 or moved <= _tolerance(settings, place, a, b)
        ):
            continue
        margin = settings[0, MARGIN] + way
        _look_again(world, row, at, turn, margin)
        manifold[row, RECYCLED] = margin


@compiled
def place_shapes(t: float, h: float, world: int) -> None:
    """Say where in the world the shapes are."""
    placed = floats(world, PLACED)
    for shape in range(rows(world, SHAPE)):
        at, turn = shape_pose(world, shape)
        for k in range(3):
            placed[shape, k] = at[k]
        for k in range(4):
            placed[shape, 3 + k] = turn[k]


@compiled(inline=True)
def shape_pose(world: int, shape: int) -> tuple[Vector, Quaternion]:
    """Return where a shape is in the world: its origin and its orientation."""
    pose, place = floats(world, POSE), floats(world, PLACE)
    body = integers(world, SHAPE)[shape, 1]
    q = (pose[body, 3], pose[body, 4], pose[body, 5], pose[body, 6])
    local = (place[shape, 3], place[shape, 4], place[shape, 5], place[shape, 6])
    at = (place[shape, 0], place[shape, 1], place[shape, 2])
    return plus((pose[body, 0], pose[body, 1], pose[body, 2]), turned(q, at)), product(q, local)


@compiled(inline=True)
def placed_pose(world: int, shape: int) -> tuple[Vector, Quaternion]:
    """Return the same as it was when the step began, which costs nothing."""
    p = floats(world, PLACED)
    return (p[shape, 0], p[shape, 1], p[shape, 2]), (p[shape, 3], p[shape, 4], p[shape, 5], p[shape, 6])


@compiled(inline=True)
def _closing_speed(world: int, row: int) -> float:
    """Bound how fast the shapes of a contact can come nearer to each other."""
    contact, motion, place = integers(world, CONTACT), floats(world, MOTION), floats(world, PLACE)
    a, b = contact[row, BODY_A], contact[row, BODY_B]
    relative = 0.0
    turn_a = 0.0
    turn_b = 0.0
    for k in range(3):
        relative += (motion[b, k] - motion[a, k]) ** 2
        turn_a += motion[a, 3 + k] ** 2
        turn_b += motion[b, 3 + k] ** 2
    reach_a, reach_b = place[contact[row, SHAPE_A], RADIUS], place[contact[row, SHAPE_B], RADIUS]
    speed = math.sqrt(relative)
    if turn_a > 0.0:
        speed += math.sqrt(turn_a) * reach_a
    if turn_b > 0.0:
        speed += math.sqrt(turn_b) * reach_b
    return speed


@compiled(inline=True)
def _moved(manifold: Any, row: int, at: Vector, turn: Quaternion, radius: float) -> float:
    """Bound how far any point of the second shape has moved in the first's frame since its points were found."""
    f = FOUND_POSE
    then = (manifold[row, f], manifold[row, f + 1], manifold[row, f + 2])
    q = (manifold[row, f + 3], manifold[row, f + 4], manifold[row, f + 5], manifold[row, f + 6])
    way = minus(at, then)
    d = product(conjugate(q), turn)
    angle = 2.0 * math.sqrt(d[1] * d[1] + d[2] * d[2] + d[3] * d[3])
    return math.sqrt(dot(way, way)) + angle * radius


@compiled(inline=True)
def _tolerance(settings: Any, place: Any, a: int, b: int) -> float:
    """By how much touching shapes may move before their points are found again."""
    return min(settings[0, RECYCLE_DISTANCE], 0.05 * place[a, RADIUS], 0.05 * place[b, RADIUS])


@compiled
def _look_again(world: int, row: int, at: Vector, turn: Quaternion, margin: float) -> None:
    contact, manifold, numbers = integers(world, CONTACT), flat(world, MANIFOLD), flat(world, GEOMETRY)
    shape = integers(world, SHAPE)
    a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
    begin_a, size_a, kind_a = shape[a, 2], shape[a, 3], shape[a, 0]
    if kind_a == MESH:
        begin_a, size_a, kind_a = begin_a + 1 + 12 * contact[row, PART], 12, TRIANGLE
    begin_b, size_b = shape[b, 2], shape[b, 3]
    own = manifold[64 * row : 64 * row + 64]
    found = own[FOUND_POSE : FOUND_POSE + 7]
    found[0], found[1], found[2] = at
    found[3], found[4], found[5], found[6] = turn
    before = contact[row, POINTS]
    ids = (own[_id(0)], own[_id(1)], own[_id(2)], own[_id(3)])
    impulses = (own[_id(0) + 1], own[_id(1) + 1], own[_id(2) + 1], own[_id(3) + 1])
    count = collide(
        integers(world, COLLIDERS)[kind_a, shape[b, 0]],
        (numbers[begin_a : begin_a + size_a], numbers[begin_b : begin_b + size_b], found, margin, own),
    )
    contact[row, POINTS] = count
    for new in range(count):
        own[_id(new) + 1] = 0.0
        for old in range(before):
            if ids[old] == own[_id(new)]:
                own[_id(new) + 1] = impulses[old]
                break


@compiled(inline=True)
def _id(point: int) -> int:
    return POINT + POINT_SIZE * point + FEATURE
