"""Lengths of the shortest ways along a mesh: how far its vertices can be from each other without any strain.

Vertices are joined by the straight lines that cross a few triangles, unfolded into one plane, and Dijkstra's method finds the
shortest ways along these. Such a way is never shorter than the geodesic, which may cross more triangles: on a square grid it is
up to 1.3 % longer, on triangles of random points 4 %, on a grid with cells twice as wide as high 5 %, three times 8 %, and ten
times 22 %. Along edges alone it would be 41 % longer.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables.mesh import NONE, ClothMesh

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Of triangles that a line crosses at most. On a grid of 100 x 100 this takes 0.7 s, and with 4, half of it for twice the error.
_SIDES = 6


class Lines(NamedTuple):
    """Straight lines between vertices of a mesh, each in both directions.

    Attributes
    ----------
    begin, end : (K,) array
        Vertices.
    length : (K,) array
        m.
    """

    begin: Integers
    end: Integers
    length: Floats


class _Windows(NamedTuple):
    """Sides of triangles that are seen from a vertex, in a plane whose origin it is.

    Attributes
    ----------
    source : (K,) array
        The vertex.
    side : (K,) array
        Three times the triangle behind, plus its corner where this side begins.
    left, right : (K, 2) array
        Where the side begins and ends, as seen from the source, m.
    leftmost, rightmost : (K, 2) array
        Directions between which it is seen.
    """

    source: Integers
    side: Integers
    left: Floats
    right: Floats
    leftmost: Floats
    rightmost: Floats

    def some(self, chosen: NDArray[np.bool_]) -> "_Windows":
        """Return some of them."""
        return _Windows._make(column[chosen] for column in self)


def shortest_ways(lines: Lines, count: int, sources: Integers) -> tuple[Floats, Integers]:
    """Return the lengths of the shortest ways from vertices to the nearest of others, and these.

    Parameters
    ----------
    lines : Lines
        As `lines_on` returns them.
    count : int
        Number of vertices, N.
    sources : (K,) array
        Vertices, at least one.

    Returns
    -------
    lengths : (N,) array
        m; infinite where there is no way.
    nearest : (N,) array
        One of the sources; negative where there is no way.
    """
    from scipy.sparse import csr_array  # takes 0.15 s, which worlds without tethers need not spend
    from scipy.sparse.csgraph import dijkstra

    graph = csr_array((lines.length, (lines.begin, lines.end)), shape=(count, count))
    lengths, _, nearest = dijkstra(graph, indices=sources, min_only=True, return_predecessors=True)
    return lengths, nearest.astype(np.int64)


def lines_on(mesh: ClothMesh) -> Lines:
    """Return the edges of a mesh, and the straight lines that cross up to `_SIDES` of its sides."""
    begins, ends = mesh.triangles, np.roll(mesh.triangles, -1, axis=1)
    edges = np.stack((begins.ravel(), ends.ravel()), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]  # a segment of a rope is a triangle, two of whose corners coincide
    lengths = np.linalg.norm(mesh.vertices[edges[:, 1]] - mesh.vertices[edges[:, 0]], axis=1)
    found = [Lines(edges[:, 0], edges[:, 1], lengths)]
    twins = _twins(mesh)
    windows = _opposite_sides(mesh, twins)
    for _ in range(_SIDES):
        lines, windows = _beyond(mesh, windows._replace(side=twins[windows.side]))
        found.append(lines)
        windows = windows.some(twins[windows.side] != NONE)
    whole = Lines._make(np.concatenate(column) for column in zip(*found, strict=True))
    return _shortest(whole, len(mesh.vertices))


def _shortest(lines: Lines, count: int) -> Lines:
    """Return the shortest line between each two vertices, of which there are `count`, in both directions."""
    low, high = np.minimum(lines.begin, lines.end), np.maximum(lines.begin, lines.end)
    pairs, of = np.unique(low * count + high, return_inverse=True)
    lengths = np.full(len(pairs), np.inf)
    np.minimum.at(lengths, of, lines.length)
    low, high = np.divmod(pairs, count)
    return Lines(np.concatenate((low, high)), np.concatenate((high, low)), np.tile(lengths, 2))


def _twins(mesh: ClothMesh) -> Integers:
    """Return, for each side of a triangle, that of the triangle behind it, or `NONE`."""
    folds = mesh.sides.ravel()
    order = np.argsort(folds, kind="stable")
    order = order[folds[order] != NONE].reshape(-1, 2)
    twins = np.full(len(folds), NONE)
    twins[order[:, 0]], twins[order[:, 1]] = order[:, 1], order[:, 0]
    return twins


def _opposite_sides(mesh: ClothMesh, twins: Integers) -> _Windows:
    """Return the sides of triangles that are seen from their corners and have another one behind; `side` is of the first."""
    triangle, k = np.divmod(np.flatnonzero(np.roll(twins.reshape(-1, 3), -1, axis=1).ravel() != NONE), 3)
    source, right, left = (mesh.triangles[triangle, (k + step) % 3] for step in range(3))
    p, q = mesh.vertices[right] - mesh.vertices[source], mesh.vertices[left] - mesh.vertices[source]
    along = np.linalg.norm(p, axis=1)
    ahead = (p * q).sum(axis=1) / along
    aside = np.linalg.norm(np.cross(p, q), axis=1) / along
    first, second = np.stack((along, np.zeros(len(along))), axis=1), np.stack((ahead, aside), axis=1)
    return _Windows(source, 3 * triangle + (k + 1) % 3, second, first, second, first)


def _beyond(mesh: ClothMesh, windows: _Windows) -> tuple[Lines, _Windows]:
    """Return the lines to the vertices behind windows, and the other sides behind that are seen through them."""
    triangle, k = np.divmod(windows.side, 3)
    a, b, c = (mesh.triangles[triangle, (k + step) % 3] for step in range(3))
    edge, way = mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]
    squared = (edge * edge).sum(axis=1)[:, None]
    ahead = (edge * way).sum(axis=1)[:, None] / squared
    aside = np.linalg.norm(np.cross(edge, way), axis=1)[:, None] / squared
    along = windows.right - windows.left
    apex = windows.left + ahead * along + aside * np.stack((-along[:, 1], along[:, 0]), axis=1)
    past_right, past_left = _cross(windows.rightmost, apex) >= 0.0, _cross(apex, windows.leftmost) >= 0.0
    seen = past_right & past_left
    lines = Lines(windows.source[seen], c[seen], np.linalg.norm(apex[seen], axis=1))
    # From b to c its triangle lies on the left, as seen from the source the part right of the apex.
    on_right = windows._replace(
        side=3 * triangle + (k + 1) % 3, left=apex, leftmost=np.where(past_left[:, None], apex, windows.leftmost)
    )
    on_left = windows._replace(
        side=3 * triangle + (k + 2) % 3, right=apex, rightmost=np.where(past_right[:, None], apex, windows.rightmost)
    )
    both = _Windows._make(np.concatenate(column) for column in zip(on_right, on_left, strict=True))
    return lines, both.some(_cross(both.rightmost, both.leftmost) > 0.0)


def _cross(a: Floats, b: Floats) -> Floats:
    crossed: Floats = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return crossed
