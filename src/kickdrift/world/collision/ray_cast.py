"""Ray casts: trees find the candidate shapes, and `kickdrift.world.shapes.rays` where the rays hit them."""

import math
from typing import Any

from numba import carray

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, minus, turned, turned_back
from kickdrift.world.collision.bvh_walk import NOTHING, advance, reciprocal, start
from kickdrift.world.collision.dispatch import sort_of
from kickdrift.world.collision.narrow_phase import shape_pose
from kickdrift.world.columns import Fields
from kickdrift.world.layout import BEGIN, BODY_ROW, FIRST_TREE_NODE, IS_SENSOR, LAST_TREE_NODE, LAYER, SHAPE_KIND, SIZE
from kickdrift.world.shapes.kinds import TRIANGLE
from kickdrift.world.shapes.rays import MISS, Hit
from kickdrift.world.shapes.record import RAY, SURFACE
from kickdrift.world.shapes.triangle import TRIANGLE_SIZE, begin_of
from kickdrift.world.tables import (
    BOUNDS,
    GEOMETRY,
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

# Numbers of a hit
_HIT = Fields()
SHAPE_HIT = _HIT.field()
DISTANCE = _HIT.field(1, "m")
NORMAL = _HIT.field(3)
HIT = _HIT.close()

_ray = caller(RAY)


@compiled
def cast_many(world: int, rays: Any, functions: Any, strays: Any, layers: int, ignored: Any, hits: Any) -> None:
    """Find the nearest shape that each ray meets; rows of `hits` stay as they are for rays that meet nothing.

    A row of `rays` is an origin (3), a unit vector (3) and a limit.
    """
    for k in range(len(rays)):
        cast(world, rays[k], functions, strays, layers, ignored, hits[k : k + 1])


@compiled
def cast(world: int, ray: Any, functions: Any, strays: Any, layers: int, ignored: Any, hits: Any) -> int:
    """Find all shapes that a ray meets, in no order, or where there is room for one the nearest; return how many.

    Parameters
    ----------
    functions : array of int
        Addresses of the functions by which rays meet shapes, by their kind.
    strays : (M,) array of int
        Shapes that may have left their boxes in the trees; of all of them, some can be met twice.
    layers : int
        Bits of the layers that are met. Sensors are not.
    ignored : (K,) array of int
        Rows of bodies that are not met.
    """
    planes = integers(world, PLANES)
    limit = ray[6]
    count = 0
    for k in range(rows(world, PLANES)):
        count, limit = _meet(world, planes[k, 0], ray, limit, functions, layers, ignored, hits, count)
    for k in range(len(strays)):
        count, limit = _meet(world, strays[k], ray, limit, functions, layers, ignored, hits, count)
    origin, inverse = (ray[0], ray[1], ray[2]), reciprocal((ray[3], ray[4], ray[5]))
    walk = carray(floats_on_stack(512), (512,))
    for table in (STATIC_TREE, TREE):
        nodes = floats(world, table)[: rows(world, table)]
        start(walk, nodes, origin, inverse)
        shape = advance(walk, nodes, origin, inverse, limit)
        while shape != NOTHING:
            count, limit = _meet(world, shape, ray, limit, functions, layers, ignored, hits, count)
            shape = advance(walk, nodes, origin, inverse, limit)
    return count


@compiled
def _meet(
    world: int, shape: int, ray: Any, limit: float, functions: Any, layers: int, ignored: Any, hits: Any, count: int
) -> tuple[int, float]:
    """Note where a ray meets a shape; return the number of hits, and how far away others may be.

    Of shapes at the same distance the lowest is the nearest, so that it does not depend on how the trees were built.
    """
    shapes = integers(world, SHAPE)
    if shapes[shape, SHAPE_KIND] < 0 or shapes[shape, IS_SENSOR] != 0 or shapes[shape, LAYER] & layers == 0:
        return count, limit
    for k in range(len(ignored)):
        if shapes[shape, BODY_ROW] == ignored[k]:
            return count, limit
    at, q = shape_pose(world, shape)
    origin = turned_back(q, minus((ray[0], ray[1], ray[2]), at))
    direction = turned_back(q, (ray[3], ray[4], ray[5]))
    if sort_of(world, shape) == SURFACE:
        hit = _meet_mesh(world, shape, origin, direction, limit, functions)
    else:
        begin = shapes[shape, BEGIN]
        numbers = flat(world, GEOMETRY)[begin : begin + shapes[shape, SIZE]]
        hit = _ray(functions[shapes[shape, SHAPE_KIND]], (numbers, origin, direction, limit))
    if hit[0] > limit or hit[0] == math.inf:
        return count, limit
    nearest = len(hits) == 1
    row = 0 if nearest else count
    if nearest and count > 0 and hit[0] == limit and shape >= hits[0, SHAPE_HIT]:
        return count, limit
    normal = turned(q, (hit[1], hit[2], hit[3]))
    hits[row, SHAPE_HIT], hits[row, DISTANCE] = shape, hit[0]
    hits[row, NORMAL], hits[row, NORMAL + 1], hits[row, NORMAL + 2] = normal
    return row + 1, hit[0] if nearest else limit


@compiled
def _meet_mesh(world: int, mesh: int, origin: Vector, direction: Vector, limit: float, functions: Any) -> Hit:
    """Return where a ray meets the first triangle of a mesh."""
    bounds, numbers = floats(world, BOUNDS), flat(world, GEOMETRY)
    nodes = floats(world, TRIANGLE_TREE)[int(bounds[mesh, FIRST_TREE_NODE]) : int(bounds[mesh, LAST_TREE_NODE])]
    inverse = reciprocal(direction)
    walk = carray(floats_on_stack(512), (512,))
    start(walk, nodes, origin, inverse)
    first = integers(world, SHAPE)[mesh, BEGIN]
    nearest = MISS
    lowest = NOTHING
    part = advance(walk, nodes, origin, inverse, limit)
    while part != NOTHING:
        begin = begin_of(first, part)
        hit = _ray(functions[TRIANGLE], (numbers[begin : begin + TRIANGLE_SIZE], origin, direction, limit))
        if hit[0] < nearest[0] or (hit[0] == nearest[0] and part < lowest):
            nearest, lowest, limit = hit, part, hit[0]
        part = advance(walk, nodes, origin, inverse, limit)
    return nearest
