"""The traversal of the trees of triangles of two cloths, or of one with itself, for pairs of triangles that may touch."""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.world.collision.broad_phase.bvh import BRANCH, ITEM, SKIP
from kickdrift.world.deformables.layout import (
    BETWEEN,
    FIRST_NODE,
    HAS_STRAYED,
    IS_CONNECTED,
    LAST_NODE,
    NEAR_NODE,
    NEAR_NODES,
)
from kickdrift.world.deformables.self_collision.face_normals import is_flat
from kickdrift.world.deformables.self_collision.face_pairs import overlap, pair_faces
from kickdrift.world.deformables.self_collision.pair_rows import add_task
from kickdrift.world.tables import CLOTH, CLOTH_TREE, CLOTH_TREE_NODE, NORMAL_TREE, TREE_NEIGHBOUR, floats, integers

_STACK = 512  # pairs of nodes: three for each level of two trees
_NUMBERS = 2 * _STACK


@compiled
def walk(world: int, a: int, b: int, m: int, n: int, largest: int) -> bool:
    """Find the pairs of two cloths, or of one with itself, in two nodes of their trees; False if there is no room.

    If `largest` is positive, pairs of nodes with at most so many rows each are added to the tasks instead, in the order in
    which they would be searched.
    """
    own = integers(world, CLOTH)
    tree, node = floats(world, CLOTH_TREE), integers(world, CLOTH_TREE_NODE)
    one, other = tree[own[a, FIRST_NODE] : own[a, LAST_NODE]], tree[own[b, FIRST_NODE] : own[b, LAST_NODE]]
    normals, begin = floats(world, NORMAL_TREE), own[a, FIRST_NODE]
    stack = carray(floats_on_stack(_NUMBERS), (_STACK, 2))
    stack[0, 0], stack[0, 1] = m, n
    top, fits = 1, True
    while top > 0 and fits:
        top -= 1
        m, n = int(stack[top, 0]), int(stack[top, 1])
        same = a == b and m == n
        at = begin + m
        if node[at, HAS_STRAYED] == 0 and node[own[b, FIRST_NODE] + n, HAS_STRAYED] == 0:
            continue
        if same and node[at, IS_CONNECTED] != 0 and is_flat(normals, at, at, at):
            continue
        if not (same or overlap(one, m, other, n)):
            continue
        if a == b and _are_one_piece(world, begin, m, n):
            continue
        left, right = one[m, ITEM] == BRANCH, other[n, ITEM] == BRANCH
        size = max(one[m, SKIP] - m, other[n, SKIP] - n)
        if largest > 0 and (size <= largest or not (left or right)):
            fits = add_task(world, m, n)
            continue
        if not left and not right:
            fits = _compare(world, a, b, one, m, other, n)
            continue
        for i in range(2 if left else 1):
            for j in range(2 if right else 1):
                k = m if not left else m + 1 if i == 1 else int(one[m + 1, SKIP])
                o = n if not right else n + 1 if j == 1 else int(other[n + 1, SKIP])
                if not same or k <= o:
                    stack[top, 0], stack[top, 1] = k, o
                    top += 1
    return fits


@compiled
def _are_one_piece(world: int, begin: int, m: int, n: int) -> bool:
    """Whether two nodes of a tree that begins in that row form one flat piece with the node that joins them."""
    node, near, normals = integers(world, CLOTH_TREE_NODE), integers(world, TREE_NEIGHBOUR), floats(world, NORMAL_TREE)
    for k in range(node[begin + m, NEAR_NODES], node[begin + m, NEAR_NODES + 1]):
        if near[k, NEAR_NODE] == n:
            flat: bool = is_flat(normals, begin + m, begin + n, begin + near[k, BETWEEN])
            return flat
    return False


@compiled
def _compare(world: int, a: int, b: int, one: Any, m: int, other: Any, n: int) -> bool:
    """Find the pairs of two twigs; False if there is no room."""
    fits, same, node = True, a == b and m == n, integers(world, CLOTH_TREE_NODE)
    begin, after = integers(world, CLOTH)[a, FIRST_NODE], integers(world, CLOTH)[b, FIRST_NODE]
    last = int(other[n, SKIP])
    for i in range(m + 1, int(one[m, SKIP])):
        if not (same or overlap(one, i, other, n)):
            continue
        strays = node[begin + i, HAS_STRAYED]
        for j in range(i + 1 if same else n + 1, last):
            if strays | node[after + j, HAS_STRAYED] != 0 and overlap(one, i, other, j):
                fits = fits and pair_faces(world, a, b, int(one[i, ITEM]), int(other[j, ITEM]))
    return fits
