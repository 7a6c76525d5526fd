"""Overlap queries: shapes of a world that overlap a shape that is not part of it."""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Quaternion, Vector, minus, turned_back
from kickdrift.world.collision.broad_phase.aabb import box_in_frame, reaches_under
from kickdrift.world.collision.broad_phase.bvh import Box, gather
from kickdrift.world.collision.narrow_phase.manifolds import collide
from kickdrift.world.collision.shape_poses import relative_pose, shape_pose
from kickdrift.world.collision.shape_properties import sort_of
from kickdrift.world.columns import point_at
from kickdrift.world.layout import BEGIN, FIRST_TREE_NODE, LAST_TREE_NODE, SHAPE_KIND, SIZE
from kickdrift.world.shapes.kind_numbers import TRIANGLE
from kickdrift.world.shapes.record import SURFACE
from kickdrift.world.shapes.triangle import TRIANGLE_SIZE, begin_of, put_facing
from kickdrift.world.tables import (
    BOUNDS,
    GEOMETRY,
    MANIFOLD,
    PLANES,
    SHAPE,
    STATIC_TREE,
    TREE,
    TRIANGLE_TREE,
    flat,
    floats,
    integers,
    rows,
)

_MANIFOLD = MANIFOLD.width


@compiled
def find_near(world: int, box: Box, found: Any) -> int:
    """Write the shapes whose boxes in the trees overlap a box, and the planes that it reaches below, into `found`."""
    planes = integers(world, PLANES)
    count = 0
    for k in range(rows(world, PLANES)):
        if reaches_under(world, planes[k, 0], box):
            found[count] = planes[k, 0]
            count += 1
    for table in (STATIC_TREE, TREE):
        hits, _ = gather(floats(world, table)[: rows(world, table)], box, found[count:])
        count += hits
    return count


@compiled
def find_triangles(world: int, shape: int, box: Box, found: Any) -> int:
    """Write the triangles of a surface whose boxes overlap a box into `found`, and return their number."""
    bounds = floats(world, BOUNDS)
    first, last = int(bounds[shape, FIRST_TREE_NODE]), int(bounds[shape, LAST_TREE_NODE])
    hits, _ = gather(floats(world, TRIANGLE_TREE)[first:last], box_in_frame(world, shape, box), found)
    return int(hits)


@compiled
def overlaps(
    world: int, shape: int, kind: int, numbers: Any, at: Vector, turn: Quaternion, box: Box, functions: Any, found: Any
) -> bool:
    """Whether a shape of the world overlaps another one, given by kind, numbers, pose and bounding box.

    `functions` are the addresses of the functions of `PAIRS` for this kind, by the kind of the shape of the world; `found` has
    room for the triangles of a mesh.
    """
    shapes = integers(world, SHAPE)
    begin, size, own_kind = shapes[shape, BEGIN], shapes[shape, SIZE], shapes[shape, SHAPE_KIND]
    geometry = flat(world, GEOMETRY)
    own_at, own_turn = shape_pose(world, shape)
    if sort_of(world, shape) != SURFACE:
        own = geometry[begin : begin + size]
        return _touch(own_kind, own, own_at, own_turn, kind, numbers, at, turn, functions[own_kind])
    hits = find_triangles(world, shape, box, found)
    towards, facing = turned_back(own_turn, minus(at, own_at)), carray(floats_on_stack(TRIANGLE_SIZE), (TRIANGLE_SIZE,))
    for k in range(hits):
        start = begin_of(begin, int(found[k]))
        put_facing(
            point_at(geometry, start), point_at(geometry, start + 3), point_at(geometry, start + 6), towards, facing
        )
        if _touch(TRIANGLE, facing, own_at, own_turn, kind, numbers, at, turn, functions[TRIANGLE]):
            return True
    return False


@compiled
def _touch(
    kind_a: int,
    a: Any,
    at_a: Vector,
    turn_a: Quaternion,
    kind_b: int,
    b: Any,
    at_b: Vector,
    turn_b: Quaternion,
    function: int,
) -> bool:
    """Whether two shapes with poses in the world have points in common."""
    if kind_b < kind_a:
        kind_a, a, at_a, turn_a, kind_b, b, at_b, turn_b = kind_b, b, at_b, turn_b, kind_a, a, at_a, turn_a
    pose = carray(floats_on_stack(7), (7,))
    manifold = carray(floats_on_stack(_MANIFOLD), (_MANIFOLD,))
    (pose[0], pose[1], pose[2]), (pose[3], pose[4], pose[5], pose[6]) = relative_pose((at_a, turn_a), (at_b, turn_b))
    for k in range(_MANIFOLD):
        manifold[k] = 0.0
    count: int = collide(function, (a, b, pose, 0.0, manifold))
    return count > 0
