"""Ray casts: trees find candidate shapes, and the functions of `kickdrift.world.shapes.rays` the hits."""

import math
from typing import Any

from numba import carray

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, minus, turned, turned_back
from kickdrift.world.collision.queries.bvh_ray_cast import NOTHING, WALK, advance, reciprocal, start
from kickdrift.world.collision.shape_poses import shape_pose
from kickdrift.world.collision.shape_properties import sort_of
from kickdrift.world.columns import Fields
from kickdrift.world.layout import BEGIN, BODY_ROW, FIRST_TREE_NODE, IS_SENSOR, LAST_TREE_NODE, LAYER, SHAPE_KIND, SIZE
from kickdrift.world.shapes.kind_numbers import TRIANGLE
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
    """Find the nearest shape that each ray hits; rows of `hits` do not change for rays that hit nothing.

    A row of `rays` is an origin (3), a unit vector (3) and a limit.
    """
    for k in range(len(rays)):
        cast(world, rays[k], functions, strays, layers, ignored, hits[k : k + 1])


@compiled
def cast(world: int, ray: Any, functions: Any, strays: Any, layers: int, ignored: Any, hits: Any) -> int:
    """Find all shapes that a ray hits, unordered, or only the nearest if `hits` has one row; return their number.

    Parameters
    ----------
    functions : array of int
        Addresses of the ray functions of shapes, by kind.
    strays : (M,) array of int
        Shapes that may have left their boxes in the trees, and may be hit twice.
    layers : int
        Bit set of the layers that can be hit. Sensors cannot.
    ignored : (K,) array of int
        Rows of bodies that the ray passes through.
    hits : (N, HIT) array
        Output.
    """
    planes = integers(world, PLANES)
    limit = ray[6]
    count = 0
    for k in range(rows(world, PLANES)):
        count, limit = _cast_at(world, planes[k, 0], ray, limit, functions, layers, ignored, hits, count)
    for k in range(len(strays)):
        count, limit = _cast_at(world, strays[k], ray, limit, functions, layers, ignored, hits, count)
    origin, inverse = (ray[0], ray[1], ray[2]), reciprocal((ray[3], ray[4], ray[5]))
    walk = carray(floats_on_stack(WALK), (WALK,))
    for table in (STATIC_TREE, TREE):
        nodes = floats(world, table)[: rows(world, table)]
        start(walk, nodes, origin, inverse)
        shape = advance(walk, nodes, origin, inverse, limit)
        while shape != NOTHING:
            count, limit = _cast_at(world, shape, ray, limit, functions, layers, ignored, hits, count)
            shape = advance(walk, nodes, origin, inverse, limit)
    return count


@compiled
def _cast_at(
    world: int, shape: int, ray: Any, limit: float, functions: Any, layers: int, ignored: Any, hits: Any, count: int
) -> tuple[int, float]:
    """Write the hit of a ray on a shape, if any; return the number of hits, and the distance up to which others count.

    Of shapes at the same distance the one with the lowest row wins, so that the result does not depend on how the trees were
    built.
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
        hit = _cast_at_mesh(world, shape, origin, direction, limit, functions)
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
def _cast_at_mesh(world: int, mesh: int, origin: Vector, direction: Vector, limit: float, functions: Any) -> Hit:
    """Return the nearest hit of a ray on the triangles of a mesh."""
    bounds, numbers = floats(world, BOUNDS), flat(world, GEOMETRY)
    nodes = floats(world, TRIANGLE_TREE)[int(bounds[mesh, FIRST_TREE_NODE]) : int(bounds[mesh, LAST_TREE_NODE])]
    inverse = reciprocal(direction)
    walk = carray(floats_on_stack(WALK), (WALK,))
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
