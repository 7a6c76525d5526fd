"""New pairs of shapes whose fat bounds overlap: tree queries for every shape that has left its fat bounds."""

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.broad_phase.aabb import box_in_frame, boxes_overlap, fat_bounds, reaches_under
from kickdrift.world.collision.broad_phase.bvh import gather
from kickdrift.world.collision.broad_phase.fat_aabb import may_move
from kickdrift.world.collision.broad_phase.filters_and_sensors import may_touch
from kickdrift.world.collision.broad_phase.pair_hash import is_known, key_of
from kickdrift.world.collision.broad_phase.search_state import AT_HOME, FOUND, PAIRS_AT, PARTS_AT, SHAPES_AT, VISITS
from kickdrift.world.collision.broad_phase.sorting import sort
from kickdrift.world.collision.shape_properties import sort_of
from kickdrift.world.columns import Fields
from kickdrift.world.layout import BEGIN, FIRST_TREE_NODE, LAST_TREE_NODE, SEARCH_STATE, SHAPE_KIND
from kickdrift.world.shapes.kind_numbers import TRIANGLE
from kickdrift.world.shapes.record import HALF_SPACE, SURFACE
from kickdrift.world.shapes.triangle import triangle_box
from kickdrift.world.tables import (
    BOUNDS,
    GEOMETRY,
    MOVERS,
    PLANES,
    SCRATCH,
    SEARCH,
    SHAPE,
    STATIC_TREE,
    TREE,
    TRIANGLE_TREE,
    Table,
    flat,
    floats,
    integers,
    room,
    rows,
)

# Numbers of a pair that was found
_PAIR = Fields()
FIRST_SHAPE = _PAIR.field()
SECOND_SHAPE = _PAIR.field()
PART = _PAIR.field()  # triangle of the first, if it is a mesh
PAIR = _PAIR.close()


@compiled
def seek(world: int, shape: int) -> None:
    """Find the new pairs of a shape that left its fat bounds, in ascending order of the other shapes.

    If both shapes are sought, the one with the lower row finds the pair. Pairs without room are only counted.
    """
    planes, movers = integers(world, PLANES), integers(world, MOVERS)
    if sort_of(world, shape) == HALF_SPACE:
        for k in range(rows(world, MOVERS)):
            if _is_new(world, shape, movers[k, 0]):
                _add(world, shape, movers[k, 0])
        return
    if may_move(world, shape):
        for k in range(rows(world, PLANES)):
            if _is_new(world, shape, planes[k, 0]):
                _add(world, shape, planes[k, 0])
        _seek_in(world, STATIC_TREE, shape)
    _seek_in(world, TREE, shape)


@compiled
def overlap(world: int, a: int, b: int, part: int) -> bool:
    """Whether the fat bounds of two shapes overlap; the first may be a plane, or a mesh, of which triangle `part` counts."""
    sort = sort_of(world, a)
    if sort == HALF_SPACE:
        return reaches_under(world, a, fat_bounds(world, b))
    if sort == SURFACE:
        box = triangle_box(flat(world, GEOMETRY), integers(world, SHAPE)[a, BEGIN], part)
        return boxes_overlap(box, box_in_frame(world, a, fat_bounds(world, b)))
    return boxes_overlap(fat_bounds(world, a), fat_bounds(world, b))


@compiled
def _seek_in(world: int, tree: Table, shape: int) -> None:
    """Find the new pairs of a shape with the shapes of a tree."""
    search = integers(world, SEARCH)
    found = flat(world, SCRATCH)[search[0, SHAPES_AT] : search[0, PARTS_AT]]
    hits, visits = gather(floats(world, tree)[: rows(world, tree)], fat_bounds(world, shape), found)
    search[0, VISITS] += visits
    new = 0
    for k in range(hits):
        if _is_new(world, shape, int(found[k])):
            found[new] = found[k]
            new += 1
    sort(found, new)
    for k in range(new):
        _add(world, shape, int(found[k]))


@compiled
def _is_new(world: int, shape: int, other: int) -> bool:
    """Whether a shape may form a pair with another one that is not known yet, and that the other one does not find."""
    shapes = integers(world, SHAPE)
    if shape == other or (other < shape and shapes[other, SEARCH_STATE] != AT_HOME):
        return False
    if sort_of(world, shape) == SURFACE or sort_of(world, other) == SURFACE:
        return True
    return not is_known(world, key_of(world, shape, other, 0))


@compiled
def _add(world: int, shape: int, other: int) -> None:
    """Add a pair, or the pairs with the triangles of a mesh, if the shapes may touch; ordered by kind, then by row."""
    if not may_touch(world, shape, other):
        return
    rank, other_rank = _contact_kind(world, shape), _contact_kind(world, other)
    a, b = shape, other
    if other_rank < rank or (other_rank == rank and other < shape):
        a, b = other, shape
    sort = sort_of(world, a)
    if sort == SURFACE:
        _add_parts(world, a, b)
    elif sort != HALF_SPACE or reaches_under(world, a, fat_bounds(world, b)):
        _note(world, a, b, 0)


@compiled(inline=True)
def _contact_kind(world: int, shape: int) -> int:
    """Return the kind of a shape in `PAIRS`: TRIANGLE for a mesh."""
    rank: int = TRIANGLE if sort_of(world, shape) == SURFACE else integers(world, SHAPE)[shape, SHAPE_KIND]
    return rank


@compiled
def _add_parts(world: int, mesh: int, shape: int) -> None:
    """Add the pairs of a shape with the triangles of a mesh that its fat bounds overlap."""
    bounds, search = floats(world, BOUNDS), integers(world, SEARCH)
    found = flat(world, SCRATCH)[search[0, PARTS_AT] : search[0, PAIRS_AT]]
    first, last = int(bounds[mesh, FIRST_TREE_NODE]), int(bounds[mesh, LAST_TREE_NODE])
    box = box_in_frame(world, mesh, fat_bounds(world, shape))
    hits, visits = gather(floats(world, TRIANGLE_TREE)[first:last], box, found)
    search[0, VISITS] += visits
    sort(found, hits)
    for k in range(hits):
        if not is_known(world, key_of(world, mesh, shape, int(found[k]))):
            _note(world, mesh, shape, int(found[k]))


@compiled
def _note(world: int, a: int, b: int, part: int) -> None:
    """Count a pair, and write it if there is room."""
    search, pairs = integers(world, SEARCH), flat(world, SCRATCH)
    at = search[0, PAIRS_AT] + PAIR * search[0, FOUND]
    if at + PAIR <= room(world, SCRATCH):
        pairs[at + FIRST_SHAPE], pairs[at + SECOND_SHAPE], pairs[at + PART] = a, b, part
    search[0, FOUND] += 1
