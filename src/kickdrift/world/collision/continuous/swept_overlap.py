"""Boxes that shapes have swept in a step, and whether two of them may have met."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, minus
from kickdrift.world.collision.broad_phase.aabb import box_around, box_in_frame, boxes_overlap, reaches_under
from kickdrift.world.collision.broad_phase.bvh import Box
from kickdrift.world.collision.narrow_phase.manifolds import smallest
from kickdrift.world.collision.predicted_motion import LEAST, MOST, POSITION_ERROR
from kickdrift.world.collision.shape_poses import shape_pose
from kickdrift.world.collision.shape_properties import extent_of, half_width, sort_of
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.layout import (
    BEGIN,
    BODY_KIND,
    BODY_ROW,
    PLACED_ORIENTATION,
    PLACED_POSITION,
    POSITION,
    RADIUS,
    STATIC,
)
from kickdrift.world.shapes.record import HALF_SPACE, SOLID, SURFACE
from kickdrift.world.shapes.triangle import triangle_box
from kickdrift.world.tables import BODY, GEOMETRY, PLACE, PLACED, POSE, PREDICTED, SHAPE, SWEPT, flat, floats, integers

# Of half the width of the thinner of two shapes: the depth up to which it is pushed out of the other to where it came from.
_PUSHED_OUT = 0.25


@compiled
def may_meet(world: int, a: int, part: int, b: int) -> bool:
    """Whether one shape may have come deep into another; the first may be a plane, or a part of a mesh."""
    sort, depth = sort_of(world, a), _shallow(world, a, b)
    if sort == HALF_SPACE:
        return reaches_under(world, a, swept_box(world, b, depth))
    if sort == SURFACE:
        own = triangle_box(flat(world, GEOMETRY), integers(world, SHAPE)[a, BEGIN], part)
        return boxes_overlap(own, box_in_frame(world, a, swept_box(world, b, depth)))
    place = floats(world, PLACE)
    if place[a, RADIUS] < place[b, RADIUS]:
        a, b = b, a
    return boxes_overlap(swept_box(world, a, 0.0), swept_box(world, b, depth))


@compiled(inline=True)
def _shallow(world: int, a: int, b: int) -> float:
    """Return the depth up to which a shape is pushed out of another one to where it came from, m."""
    return _PUSHED_OUT * thinner(world, a, b)


@compiled
def thinner(world: int, a: int, b: int) -> float:
    """Return half the smallest width of the thinner of two shapes, m, ignoring planes and meshes."""
    return smallest(_width_of_solid(world, a), _width_of_solid(world, b))


@compiled(inline=True)
def _width_of_solid(world: int, shape: int) -> float:
    return half_width(world, shape) if sort_of(world, shape) == SOLID else 0.0


@compiled
def swept_box(world: int, shape: int, depth: float) -> Box:
    """Return the box around all positions of a shape in the step, less an outer layer of that depth."""
    placed = floats(world, PLACED)
    body = integers(world, SHAPE)[shape, BODY_ROW]
    own = _shrunk(extent_of(world, shape, quaternion_at(placed, shape, PLACED_ORIENTATION)), depth)
    box = _moved(own, vector_at(placed, shape, PLACED_POSITION))
    if integers(world, BODY)[body, BODY_KIND] == STATIC:
        return box
    at, turn = shape_pose(world, shape)
    own = _shrunk(extent_of(world, shape, turn), depth)
    box = box_around(box, _moved(own, at))
    if floats(world, PREDICTED)[body, POSITION_ERROR] > 0.0:
        swept, about = floats(world, SWEPT), minus(at, vector_at(floats(world, POSE), body, POSITION))
        own = _moved(own, about)
        box = box_around(box, _moved(own, vector_at(swept, body, LEAST)))
        box = box_around(box, _moved(own, vector_at(swept, body, MOST)))
    return box


@compiled(inline=True)
def _shrunk(box: Box, depth: float) -> Box:
    """Take an outer layer off a box, of a quarter of each side at most."""
    x, y = min(depth, 0.25 * (box[3] - box[0])), min(depth, 0.25 * (box[4] - box[1]))
    z = min(depth, 0.25 * (box[5] - box[2]))
    return (box[0] + x, box[1] + y, box[2] + z, box[3] - x, box[4] - y, box[5] - z)


@compiled(inline=True)
def _moved(box: Box, at: Vector) -> Box:
    return (at[0] + box[0], at[1] + box[1], at[2] + box[2], at[0] + box[3], at[1] + box[4], at[2] + box[5])
