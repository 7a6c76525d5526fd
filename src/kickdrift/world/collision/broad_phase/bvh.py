"""Bounding volume hierarchies with nodes in depth-first order: boxes that overlap a given one are found in about log n steps.

A node is a row of `TREE`, or of another table like it. Its descendants follow it directly, so that a traversal needs no stack:
if the box of a node overlaps, it continues with the next row, and otherwise skips the descendants. Skip pointers: Smits,
Efficiency issues for ray tracing, J. Graphics Tools 3 (1998).
"""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.world.columns import Fields, column
from kickdrift.world.tables import TREE

# Columns of TREE, STATIC_TREE and TRIANGLE_TREE
column(TREE, 6, "m")  # corners of its box
SKIP = column(TREE)  # the node that follows its last descendant
ITEM = column(TREE)  # item of a leaf; `TWIG` for a node whose children are leaves, `BRANCH` for others

# Numbers of a seed: an item from which the tree is built
_SEED = Fields()
_SEED.field(3, "m")  # centre of the box
SEED_ITEM = _SEED.field()
SEED = _SEED.close()

NODES_PER_ITEM = 3  # at most: a leaf, a twig and a branch

TWIG = -1.0
BRANCH = -2.0

Box = tuple[float, float, float, float, float, float]

# Leaves of a twig, whose boxes are tested without branches, which the processor could mispredict: with 8 a query among
# 10,000 boxes takes 380 ns, with 2 it takes 500 ns.
_BUNCH = 8
_DEEP = 64  # depth beyond which items are split by count: no tree gets deeper than 64 + log2 n


@compiled
def build(seeds: Any, nodes: Any) -> int:
    """Build the topology of a tree by splitting the bounds of centres in the middle of the longest side; `fit` sets the boxes.

    The rows of `seeds` are permuted. Returns the number of nodes.
    """
    stack = carray(floats_on_stack(768), (256, 3))
    stack[0, 0], stack[0, 1], stack[0, 2] = 0, len(seeds), 0
    top = min(len(seeds), 1)
    last = 0
    while top > 0:
        top -= 1
        first, end, depth = int(stack[top, 0]), int(stack[top, 1]), int(stack[top, 2])
        if end - first > _BUNCH:
            middle = _halve(seeds, first, end, depth)
            stack[top, 0], stack[top, 1], stack[top, 2] = middle, end, depth + 1
            stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = first, middle, depth + 1
            top += 2
            nodes[last, ITEM] = BRANCH
            last += 1
            continue
        nodes[last, ITEM] = TWIG
        nodes[last, SKIP] = last + 1 + end - first
        last += 1
        for k in range(first, end):
            nodes[last, ITEM] = seeds[k, SEED_ITEM]
            nodes[last, SKIP] = last + 1
            last += 1
    return last


@compiled
def _halve(seeds: Any, first: int, end: int, depth: int) -> int:
    """Partition items by their centres along the longest side, and return where the upper half begins."""
    axis = 0
    least = middle = 0.0
    widest = -1.0
    for k in range(3):
        lower = upper = seeds[first, k]
        for row in range(first + 1, end):
            lower = min(lower, seeds[row, k])
            upper = max(upper, seeds[row, k])
        if upper - lower > widest:
            axis, widest, least, middle = k, upper - lower, lower, 0.5 * lower + 0.5 * upper
    if middle <= least or depth >= _DEEP:  # all at one point, or at adjacent floating-point numbers
        return (first + end) // 2
    left, right = first, end - 1
    while True:
        while seeds[left, axis] < middle:
            left += 1
        while seeds[right, axis] >= middle:
            right -= 1
        if left > right:
            break
        for k in range(SEED):
            seeds[left, k], seeds[right, k] = seeds[right, k], seeds[left, k]
    return left


@compiled
def fit(nodes: Any, boxes: Any) -> None:
    """Set the boxes of a tree, bottom up, from those of its items: rows that begin with six numbers."""
    for node in range(len(nodes) - 1, -1, -1):
        fit_node(nodes, node, boxes)


@compiled(inline=True)
def fit_node(nodes: Any, node: int, boxes: Any) -> None:
    """Set the box of a node from those of its children, or of its item."""
    item = int(nodes[node, ITEM])
    if item >= 0:
        for k in range(6):
            nodes[node, k] = boxes[item, k]
        return
    child = node + 1
    if item == BRANCH:
        nodes[node, SKIP] = nodes[int(nodes[child, SKIP]), SKIP]  # of its second child
    after = int(nodes[node, SKIP])
    x, y, z, u, v, w = _box(nodes, child)
    child = int(nodes[child, SKIP])
    while child < after:
        box = _box(nodes, child)
        x, y, z = min(x, box[0]), min(y, box[1]), min(z, box[2])
        u, v, w = max(u, box[3]), max(v, box[4]), max(w, box[5])
        child = int(nodes[child, SKIP])
    nodes[node, 0], nodes[node, 1], nodes[node, 2] = x, y, z
    nodes[node, 3], nodes[node, 4], nodes[node, 5] = u, v, w


@compiled
def gather(nodes: Any, box: Box, found: Any) -> tuple[int, int]:
    """Write the items whose boxes overlap a box into `found`; return their number, and that of the nodes visited.

    `found` must have room for one more item than there are in the tree.
    """
    node = 0
    hits = 0
    visits = 0
    while node < len(nodes):
        visits += 1
        after = int(nodes[node, SKIP])
        if not _overlap(nodes, node, box):
            node = after
        elif nodes[node, ITEM] == BRANCH:
            node += 1
        else:
            visits += after - node - 1
            for leaf in range(node + 1, after):
                found[hits] = nodes[leaf, ITEM]
                hits += 1 if _overlap(nodes, leaf, box) else 0
            node = after
    return hits, visits


@compiled(inline=True)
def _overlap(nodes: Any, node: int, box: Box) -> bool:
    """Whether the box of a node overlaps a box, without branches."""
    apart = (nodes[node, 0] > box[3]) | (nodes[node, 1] > box[4]) | (nodes[node, 2] > box[5])
    return not (apart | (nodes[node, 3] < box[0]) | (nodes[node, 4] < box[1]) | (nodes[node, 5] < box[2]))


@compiled(inline=True)
def _box(nodes: Any, node: int) -> Box:
    return (nodes[node, 0], nodes[node, 1], nodes[node, 2], nodes[node, 3], nodes[node, 4], nodes[node, 5])
