"""Traversal of a tree along a ray, nearest boxes first.

The state of a traversal is an array: the size of its stack, and for each entry a node and the distance at which the ray enters
its box.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector
from kickdrift.world.collision.broad_phase.bvh import BRANCH, ITEM, SKIP

NOTHING = -1
WALK = 512  # numbers of a traversal, for 255 nodes: a tree is at most 64 + log2 n deep, and a twig has 8 leaves

_ROUNDING = 1.0 + 1e-15  # so that flat boxes are not missed by rounding of the distances of entry and exit


@compiled(inline=True)
def reciprocal(direction: Vector) -> Vector:
    """Return the reciprocals of the components of a direction, with zero for components too small to invert."""
    x, y, z = direction
    return (
        1.0 / x if abs(x) > 1e-300 else 0.0,
        1.0 / y if abs(y) > 1e-300 else 0.0,
        1.0 / z if abs(z) > 1e-300 else 0.0,
    )


@compiled
def start(walk: Any, nodes: Any, origin: Vector, inverse: Vector) -> None:
    """Begin a traversal of a tree."""
    walk[0] = 0.0
    for root in range(min(len(nodes), 1)):
        _push(walk, root, _enters(nodes, root, origin, inverse))


@compiled
def advance(walk: Any, nodes: Any, origin: Vector, inverse: Vector, limit: float) -> int:
    """Return the next item whose box the ray enters within the limit, or `NOTHING`."""
    while walk[0] > 0.0:
        top = int(walk[0])
        walk[0] = top - 1
        node, distance = int(walk[2 * top]), walk[2 * top + 1]
        if not distance <= limit:
            continue
        item = int(nodes[node, ITEM])
        if item >= 0:
            return item
        child, after = node + 1, int(nodes[node, SKIP])
        if nodes[node, ITEM] == BRANCH:
            other = int(nodes[child, SKIP])
            near, far = _enters(nodes, child, origin, inverse), _enters(nodes, other, origin, inverse)
            if near <= far:
                _push(walk, other, far)
                _push(walk, child, near)
            else:
                _push(walk, child, near)
                _push(walk, other, far)
        else:
            for leaf in range(child, after):
                _push(walk, leaf, _enters(nodes, leaf, origin, inverse))
    return NOTHING


@compiled(inline=True)
def _push(walk: Any, node: int, distance: float) -> None:
    """Push a node onto the stack, unless the ray misses its box."""
    if distance < math.inf:
        top = int(walk[0]) + 1
        walk[0], walk[2 * top], walk[2 * top + 1] = top, node, distance


@compiled
def _enters(nodes: Any, node: int, origin: Vector, inverse: Vector) -> float:
    """Return the distance at which a ray enters a box, zero inside it and infinity if it misses it."""
    enters, leaves = 0.0, math.inf
    for k in range(3):
        if inverse[k] == 0.0:
            if origin[k] < nodes[node, k] or origin[k] > nodes[node, 3 + k]:
                return math.inf
            continue
        one, two = (nodes[node, k] - origin[k]) * inverse[k], (nodes[node, 3 + k] - origin[k]) * inverse[k]
        enters, leaves = max(enters, min(one, two)), min(leaves, max(one, two))
    return enters if enters <= leaves * _ROUNDING else math.inf
