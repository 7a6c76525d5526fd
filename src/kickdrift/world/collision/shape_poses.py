"""Poses of shapes in the world: origin and orientation."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, conjugate, minus, plus, product, turned, turned_back
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.layout import (
    BODY_ROW,
    ORIENTATION,
    PLACE_ORIENTATION,
    PLACE_POSITION,
    PLACED_ORIENTATION,
    PLACED_POSITION,
    POSITION,
)
from kickdrift.world.tables import PLACE, PLACED, POSE, SHAPE, floats, integers

Pose = tuple[Vector, Quaternion]


@compiled(inline=True)
def relative_pose(a: Pose, b: Pose) -> Pose:
    """Return a pose in the frame of another one, the first."""
    (at_a, turn_a), (at_b, turn_b) = a, b
    return turned_back(turn_a, minus(at_b, at_a)), product(conjugate(turn_a), turn_b)


@compiled(inline=True)
def pose_on_body(world: int, shape: int, at: Vector, turn: Quaternion) -> Pose:
    """Return the pose of a shape where its body is at a given pose."""
    place = floats(world, PLACE)
    offset, own = vector_at(place, shape, PLACE_POSITION), quaternion_at(place, shape, PLACE_ORIENTATION)
    return plus(at, turned(turn, offset)), product(turn, own)


@compiled(inline=True)
def shape_pose(world: int, shape: int) -> Pose:
    """Return the present pose of a shape."""
    pose, body = floats(world, POSE), integers(world, SHAPE)[shape, BODY_ROW]
    return pose_on_body(world, shape, vector_at(pose, body, POSITION), quaternion_at(pose, body, ORIENTATION))


@compiled(inline=True)
def placed_pose(world: int, shape: int) -> Pose:
    """Return the pose of a shape at the start of the step, which is stored."""
    placed = floats(world, PLACED)
    return vector_at(placed, shape, PLACED_POSITION), quaternion_at(placed, shape, PLACED_ORIENTATION)
