"""Updating the trees of a world: over movable shapes, over immovable ones, and over the triangles of each mesh."""

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import shaped
from kickdrift.world.collision.broad_phase.bvh import NODES_PER_ITEM, SEED, SEED_ITEM, build, fit
from kickdrift.world.collision.broad_phase.search_state import (
    CHANGED,
    FITTED,
    LEFT,
    MOVERS_CHANGED,
    PARTS_CHANGED,
    SEEN,
    STATIC_CHANGED,
    UNSEEN,
)
from kickdrift.world.collision.broad_phase.shape_lists import enlist
from kickdrift.world.collision.shape_properties import sort_of
from kickdrift.world.layout import BEGIN, FIRST_TREE_NODE, LAST_TREE_NODE, LOWER, SHAPE_KIND, SIZE, UPPER
from kickdrift.world.shapes.record import SURFACE
from kickdrift.world.shapes.triangle import triangle_box, triangles_of
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    BOUNDS,
    FIXTURES,
    GEOMETRY,
    MOVERS,
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
    set_rows,
)

_BOX = 6  # numbers


@compiled
def update_trees(world: int) -> bool:
    """Update all trees; False if a table has no room.

    A refitted tree is correct, but slower: after as many changes as there are shapes it is rebuilt. With 1000 shapes refitting
    takes 10 us, rebuilding 30 us.
    """
    search = integers(world, SEARCH)
    if search[0, PARTS_CHANGED] != 0:
        if not _build_part_trees(world):
            return False
        search[0, PARTS_CHANGED] = 0
    if search[0, STATIC_CHANGED] != 0:
        if not _build_tree(world, FIXTURES, STATIC_TREE):
            return False
        search[0, STATIC_CHANGED] = 0
    if search[0, MOVERS_CHANGED] != 0 or search[0, LEFT] > rows(world, MOVERS):
        if not _build_tree(world, MOVERS, TREE):
            return False
        search[0, MOVERS_CHANGED] = search[0, LEFT] = 0
    elif search[0, LEFT] > search[0, FITTED]:
        fit(floats(world, TREE)[: rows(world, TREE)], floats(world, BOUNDS))
    search[0, FITTED] = search[0, LEFT]
    return True


@compiled
def update_for_queries(world: int) -> bool:
    """Update the trees to the present shapes; False on an error.

    New shapes remain new, and find their pairs in the next step as without a query.
    """
    search = integers(world, SEARCH)
    if search[0, CHANGED] != UNSEEN:
        return True
    done = enlist(world, 0.0) and update_trees(world)
    search[0, CHANGED] = SEEN if done else UNSEEN
    return done


@compiled
def _build_tree(world: int, items: Table, tree: Table) -> bool:
    """Build the tree over the fat bounds of the shapes on a list."""
    count = rows(world, items)
    if not _has_room(world, tree, NODES_PER_ITEM * count, SEED * count):
        return False
    listed, bounds = integers(world, items), floats(world, BOUNDS)
    seeds = shaped(flat(world, SCRATCH), (count, SEED))
    for k in range(count):
        shape = listed[k, 0]
        for axis in range(3):
            seeds[k, axis] = 0.5 * bounds[shape, LOWER + axis] + 0.5 * bounds[shape, UPPER + axis]
        seeds[k, SEED_ITEM] = shape
    nodes = floats(world, tree)
    last = build(seeds, nodes)
    fit(nodes[:last], bounds)
    set_rows(world, tree, last)
    return True


@compiled
def _build_part_trees(world: int) -> bool:
    """Build the tree over the triangles of every mesh, in the frame of the mesh."""
    shapes, bounds = integers(world, SHAPE), floats(world, BOUNDS)
    numbers, scratch = flat(world, GEOMETRY), flat(world, SCRATCH)
    total = 0
    most = 0
    for shape in range(rows(world, SHAPE)):
        if shapes[shape, SHAPE_KIND] >= 0 and sort_of(world, shape) == SURFACE:
            total += triangles_of(shapes[shape, SIZE])
            most = max(most, triangles_of(shapes[shape, SIZE]))
    if not _has_room(world, TRIANGLE_TREE, NODES_PER_ITEM * total, (SEED + _BOX) * most):
        return False
    nodes = floats(world, TRIANGLE_TREE)
    last = 0
    for shape in range(rows(world, SHAPE)):
        if shapes[shape, SHAPE_KIND] < 0 or sort_of(world, shape) != SURFACE:
            continue
        count = triangles_of(shapes[shape, SIZE])
        seeds, boxes = shaped(scratch, (count, SEED)), shaped(scratch[SEED * count :], (count, _BOX))
        for part in range(count):
            box = triangle_box(numbers, shapes[shape, BEGIN], part)
            for axis in range(3):
                seeds[part, axis] = 0.5 * box[axis] + 0.5 * box[3 + axis]
            seeds[part, SEED_ITEM] = part
            for k in range(6):
                boxes[part, k] = box[k]
        first = last
        last += build(seeds, nodes[first:])
        fit(nodes[first:last], boxes)
        bounds[shape, FIRST_TREE_NODE], bounds[shape, LAST_TREE_NODE] = first, last
    set_rows(world, TRIANGLE_TREE, last)
    return True


@compiled(inline=True)
def _has_room(world: int, tree: Table, nodes: int, scratch: int) -> bool:
    """Whether a tree and SCRATCH have room for a number of rows; requests it if not."""
    if room(world, tree) < nodes:
        ask_for_room(world, tree, nodes)
        return False
    if room(world, SCRATCH) < scratch:
        ask_for_room(world, SCRATCH, scratch)
        return False
    return True
