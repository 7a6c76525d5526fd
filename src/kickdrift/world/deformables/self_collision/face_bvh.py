"""Trees over the triangles of cloths, built on the mesh at rest, so that nodes are patches.

A connected patch whose normals are close to one direction does not touch itself, so the search for pairs skips its node
(Volino and Magnenat Thalmann, Efficient self-collision detection on smoothly discretized surface animations using geometrical
shape regularity, Eurographics 1994).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.collision.broad_phase.bvh import BRANCH, TWIG
from kickdrift.world.deformables.mesh import NONE, ClothMesh

Integers = NDArray[np.int64]

_BUNCH = 8  # largest number of triangles of a twig; with 4, a draped sheet of 100 x 100 takes a twentieth longer


class FaceTree(NamedTuple):
    """A tree as in `kickdrift.world.collision.broad_phase.bvh`.

    Attributes
    ----------
    items, skips : (K,) array
        Triangle, `TWIG` or `BRANCH` of each node; the node after its last descendant.
    connected : (K,) array
        Whether the triangles of a node are connected.
    neighbours : (P, 3) array
        Sorted pairs of nodes of one level, the earlier one first, and a node of that level which shares edges with both, so
        that the triangles of the three are connected: the second itself where the pair shares an edge.
    """

    items: Integers
    skips: Integers
    connected: Integers
    neighbours: Integers


def face_tree(mesh: ClothMesh) -> FaceTree:
    """Build a tree over the triangles of a mesh."""
    centres = mesh.vertices[mesh.triangles].mean(axis=1)
    items: list[int] = []
    skips: list[int] = []
    patches: list[tuple[int, Integers]] = []  # nodes of twigs and branches
    levels: list[int] = []
    waiting = [(np.arange(len(centres)), 0)]
    while waiting:
        faces, depth = waiting.pop()
        node = len(items)
        patches.append((node, faces))
        levels.append(depth)
        if len(faces) <= _BUNCH:
            items += [int(TWIG), *faces.tolist()]
            skips += [node + 1 + len(faces), *range(node + 2, node + 2 + len(faces))]
            continue
        items.append(int(BRANCH))
        skips.append(0)  # set by `fit`
        axis = int(np.argmax(np.ptp(centres[faces], axis=0)))
        order = faces[np.argsort(centres[faces, axis], kind="stable")]
        waiting += [(order[len(order) // 2 :], depth + 1), (order[: len(order) // 2], depth + 1)]
    connected = np.ones(len(items), dtype=np.int64)
    neighbours = _mark_pieces(mesh, patches, np.array(levels), connected)
    return FaceTree(np.array(items), np.array(skips), connected, neighbours)


def _mark_pieces(
    mesh: ClothMesh, patches: list[tuple[int, Integers]], levels: Integers, connected: Integers
) -> Integers:
    """Write which nodes have connected triangles, level by level, and return `FaceTree.neighbours` of those that have."""
    from scipy.sparse import csr_array  # takes 0.15 s, which worlds without cloth need not spend
    from scipy.sparse.csgraph import connected_components

    count, neighbours = len(mesh.triangles), [np.empty((0, 2), dtype=np.int64)]
    face, side = np.nonzero(mesh.sides != NONE)
    order = np.argsort(mesh.sides[face, side], kind="stable")
    pairs = face[order].reshape(-1, 2)
    for level in range(int(levels.max()) + 1):
        own = [patches[k] for k in np.flatnonzero(levels == level)]
        of = np.full(count, -1)
        for node, faces in own:
            of[faces] = node
        inside = pairs[(of[pairs[:, 0]] == of[pairs[:, 1]]) & (of[pairs[:, 0]] >= 0)]
        graph = csr_array((np.ones(len(inside)), (inside[:, 0], inside[:, 1])), shape=(count, count))
        pieces = connected_components(graph, directed=False)[1]
        for node, faces in own:
            connected[node] = int((pieces[faces] == pieces[faces[0]]).all())
        beside = np.sort(of[pairs[(of[pairs] >= 0).all(axis=1)]], axis=1)
        neighbours.append(beside[(beside[:, 0] != beside[:, 1]) & connected[beside].all(axis=1)])
    return _joined(np.unique(np.concatenate(neighbours), axis=0), len(connected))


def _joined(pairs: Integers, count: int) -> Integers:
    """Return `FaceTree.neighbours` of `count` nodes, from the pairs that share edges, (P, 2)."""
    both = np.concatenate((pairs, pairs[:, ::-1]))
    both = both[np.lexsort((both[:, 1], both[:, 0]))]
    starts = np.searchsorted(both[:, 0], np.arange(count + 1))
    counts = np.diff(starts)[both[:, 1]]
    first = np.repeat(starts[both[:, 1]], counts)
    within = np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
    over = np.stack((np.repeat(both[:, 0], counts), both[first + within, 1], np.repeat(both[:, 1], counts)), axis=1)
    direct = np.concatenate((pairs, pairs[:, 1:]), axis=1)
    triples = np.concatenate((direct, over[over[:, 0] < over[:, 1]]))
    _, kept = np.unique(triples[:, :2], axis=0, return_index=True)  # the first of each pair, which is direct if one is
    return triples[kept]


def stars(triangles: Integers) -> Integers:
    """Return for each corner the next one at the same vertex, cyclically, as in the column `NEXT_AROUND`, (M, 3)."""
    corners = triangles.ravel()
    order = np.argsort(corners, kind="stable")
    begins = np.flatnonzero(np.diff(corners[order], prepend=-1))
    following = np.roll(order, -1)
    following[np.append(begins[1:], len(order)) - 1] = order[begins]
    after = np.empty_like(order)
    after[order] = following
    return after.reshape(-1, 3)


def owned(triangles: Integers) -> Integers:
    """Return the sets of corners and sides that each triangle is the first to have, (M,), as in the column `OWNED`."""
    corners, count = triangles.ravel(), len(triangles)
    sets = np.zeros(3 * count, dtype=np.int64)
    sets[np.unique(corners, return_index=True)[1]] = 1
    ends = np.sort(np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2).reshape(-1, 2), axis=1)
    sides = np.zeros(3 * count, dtype=np.int64)
    sides[np.unique(ends, axis=0, return_index=True)[1]] = 1
    sides[ends[:, 0] == ends[:, 1]] = 0  # of segments of ropes
    bits = np.array([1, 2, 4])
    total: Integers = sets.reshape(-1, 3) @ bits + 8 * (sides.reshape(-1, 3) @ bits)
    return total
