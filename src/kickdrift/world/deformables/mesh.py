"""Triangle meshes of cloths: validation, shared edges, and plane coordinates of the triangles."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import reals
from kickdrift.core.errors import ArgumentError

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

NONE = -1
MOST_VERTICES = 10_000_000  # of a grid or a box
_FAR = 1e15  # m
_THIN = 1e-6  # ratio of height to longest side below which a triangle is degenerate


class ClothMesh(NamedTuple):
    """A valid triangle mesh of a cloth.

    Attributes
    ----------
    vertices : (N, 3) array
        m.
    triangles : (M, 3) array
        Indices of vertices, with consistent orientation.
    folds : (K, 4) array
        Vertices of each edge that two triangles share: its ends, then those across it. The edge has the direction that it has
        in the triangle of the first of those.
    sides : (M, 3) array
        Folds of the sides of each triangle, the k-th of which begins at its k-th corner; `NONE` on the border.
    """

    vertices: Floats
    triangles: Integers
    folds: Integers
    sides: Integers


def cloth_mesh(vertices: ArrayLike, triangles: ArrayLike) -> ClothMesh:
    """Check vertices and triangles, and find shared edges.

    Raises
    ------
    ArgumentError
        For numbers that are not finite, indices out of range, vertices without triangles, triangles without area, with
        repeated corners or with the same vertices, edges of three triangles, and adjacent triangles of opposite orientation;
        the message names the vertex or the triangle.
    """
    points = vertices_of(vertices)
    faces = cells_of(points, triangles, 3, ("triangle", "triangles"))
    _check_areas(points, faces)
    return ClothMesh(points, faces, *shared_edges(faces))


def grid(nx: int, ny: int, size: tuple[float, float]) -> tuple[Floats, Integers]:
    """Return the vertices and triangles of a rectangle of nx times ny vertices, with parallel diagonals.

    Vertex i * ny + j is at (i / (nx - 1), j / (ny - 1)) of the size. With alternating diagonals a clamped strip sags by 40 %
    too much, however fine the mesh; with parallel ones by 1 % with 10 segments, and by 0.2 % with 20.
    """
    x, y = np.meshgrid(np.linspace(0.0, size[0], nx), np.linspace(0.0, size[1], ny), indexing="ij")
    index = np.arange(nx * ny).reshape(nx, ny)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
    triangles = np.stack((a, b, c, a, c, d), axis=1).reshape(-1, 3)
    return np.stack((x.ravel(), y.ravel(), np.zeros(nx * ny)), axis=1), triangles


def flattened(mesh: ClothMesh, warp: Floats) -> tuple[Floats, Floats]:
    """Return plane coordinates of each triangle.

    Parameters
    ----------
    mesh : ClothMesh
    warp : (3,) array
        Direction, not zero, whose projection onto each triangle is its first axis; for triangles perpendicular to it, that of
        the coordinate axis at the largest angle to it.

    Returns
    -------
    flat : (M, 3, 2) array
        Corners relative to the first one, along warp and weft, m.
    axes : (M, 2, 3) array
        Unit vectors of warp and weft.
    """
    corners = mesh.vertices[mesh.triangles]
    p, q = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(p, q)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    u = warp - (normal @ warp)[:, None] * normal
    size = np.linalg.norm(u, axis=1, keepdims=True)
    across = size[:, 0] < 1e-6 * np.linalg.norm(warp)
    other = np.eye(3)[np.argmin(np.abs(warp))]
    u = np.where(across[:, None], other - (normal @ other)[:, None] * normal, u)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(normal, u)
    flat = np.zeros((len(p), 3, 2))
    for k, side in enumerate((p, q), start=1):
        flat[:, k, 0], flat[:, k, 1] = (side * u).sum(axis=1), (side * v).sum(axis=1)
    return flat, np.stack((u, v), axis=1)


def masses_of(mesh: ClothMesh, weights: Floats) -> Floats:
    """Return the masses of vertices, (N,), kg: a third of the masses of their triangles, `weights`, (M,)."""
    thirds = np.repeat(weights / 3.0, 3)
    return np.asarray(np.bincount(mesh.triangles.ravel(), weights=thirds), dtype=np.float64)


def vertices_of(vertices: ArrayLike, name: str = "vertices", each: str = "vertex") -> Floats:
    """Check positions of vertices, which messages call by these names, and return them as an array.

    Raises
    ------
    ArgumentError
        If they are not an (N, 3) array of numbers that are finite and not too large.
    """
    try:
        points = reals(vertices)
    except TypeError:
        raise ArgumentError(f"{name} must be an (N, 3) array of numbers, in m.") from None
    if points.ndim != 2 or points.shape[1] != 3:
        raise ArgumentError(f"{name} has the shape {points.shape}; give an (N, 3) array, in m.")
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if wrong.size:
        raise ArgumentError(f"{each} {wrong[0]} is at {points[wrong[0]]}, which is not finite.")
    far = np.flatnonzero((np.abs(points) > _FAR).any(axis=1))
    if far.size:
        raise ArgumentError(f"{each} {far[0]} is at {points[far[0]]}, farther than {_FAR:g} m; give smaller numbers.")
    return points


def cells_of(points: Floats, cells: ArrayLike, corners: int, names: tuple[str, str]) -> Integers:
    """Check triangles or tetrahedra, named for messages in the singular and the plural, and return them as an array.

    Raises
    ------
    ArgumentError
        For another shape than (M, corners), indices out of range, repeated corners, and vertices without any.
    """
    each, all_ = names
    try:
        found = np.asarray(cells)
    except ValueError:  # rows of several lengths
        found = np.empty(0)
    if found.ndim != 2 or found.shape[1:] != (corners,) or len(found) == 0 or found.dtype.kind not in "iu":
        raise ArgumentError(
            f"{all_} of shape {found.shape} and type {found.dtype} must be an (M, {corners}) array of whole numbers, indices"
            " of vertices, with at least one row."
        )
    wrong = np.flatnonzero(((found < 0) | (found >= len(points))).any(axis=1))
    if wrong.size:
        raise ArgumentError(
            f"{each} {wrong[0]} has the vertices {found[wrong[0]]}; indices go from 0 to {len(points) - 1}."
        )
    in_order = np.sort(found, axis=1)
    twice = np.flatnonzero((in_order[:, 1:] == in_order[:, :-1]).any(axis=1))
    if twice.size:
        raise ArgumentError(f"{each} {twice[0]} has a vertex twice: {found[twice[0]]}.")
    unused = np.setdiff1d(np.arange(len(points)), found)
    if unused.size:
        raise ArgumentError(f"vertex {unused[0]} is in no {each}, so that it has no mass; leave it out.")
    return found.astype(np.int64)


def _check_areas(points: Floats, faces: Integers) -> None:
    corners = points[faces]
    sides = corners - np.roll(corners, 1, axis=1)
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    doubled = np.linalg.norm(np.cross(sides[:, 1], sides[:, 2]), axis=1)
    thin = np.flatnonzero(~(doubled > _THIN * longest**2))
    if thin.size:
        raise ArgumentError(
            f"triangle {thin[0]} has no area: its corners {points[faces[thin[0]]].tolist()} are on one line."
        )


def shared_edges(faces: Integers) -> tuple[Integers, Integers]:
    """Return folds and sides; see `ClothMesh`."""
    count = len(faces)
    start, end, across = faces.T.ravel(), np.roll(faces, -1, axis=1).T.ravel(), np.roll(faces, -2, axis=1).T.ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.lexsort((high, low))
    same = (low[order][1:] == low[order][:-1]) & (high[order][1:] == high[order][:-1])
    thrice = np.flatnonzero(same[1:] & same[:-1])
    if thrice.size:
        of = [int(k) % count for k in order[thrice[0] : thrice[0] + 3]]
        raise ArgumentError(
            f"triangles {of[0]}, {of[1]} and {of[2]} share one edge, that of vertices {low[order[thrice[0]]]} and "
            f"{high[order[thrice[0]]]}; cut the mesh there, since an edge of a cloth has at most two triangles."
        )
    first, second = order[:-1][same], order[1:][same]
    twins = np.flatnonzero(across[first] == across[second])
    if twins.size:
        k = twins[0]
        raise ArgumentError(
            f"triangles {first[k] % count} and {second[k] % count} have the same vertices; leave one of them out."
        )
    turned = np.flatnonzero(start[first] == start[second])
    if turned.size:
        k = turned[0]
        raise ArgumentError(
            f"triangles {first[k] % count} and {second[k] % count} have opposite orientations at their edge of vertices "
            f"{start[first[k]]} and {end[first[k]]}; make all of them counter-clockwise as seen from the same side, or cut "
            "a mesh that has only one, as a Moebius strip."
        )
    folds = np.stack((start[first], end[first], across[first], across[second]), axis=1)
    sides = np.full(3 * count, NONE, dtype=np.int64)
    sides[first] = sides[second] = np.arange(len(first))
    return folds, sides.reshape(3, count).T
