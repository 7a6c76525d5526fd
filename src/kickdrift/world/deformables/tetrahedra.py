"""Tetrahedral meshes of soft bodies: validation, their surface, and boxes of them."""

from itertools import permutations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.deformables.mesh import ClothMesh, cells_of, shared_edges, vertices_of

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_THIN = (
    1e-6  # ratio of the volume of the parallelepiped to the cube of the longest edge below which a tetrahedron is flat
)
_SIDES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])  # counter-clockwise as seen from outside


class TetrahedralMesh(NamedTuple):
    """A valid tetrahedral mesh.

    Attributes
    ----------
    surface : ClothMesh
        All vertices, and the triangles that only one tetrahedron has, counter-clockwise as seen from outside.
    tetrahedra : (M, 4) array
    to_rest : (M, 3, 3) array
        Inverse matrices of the edges from the first corner, which are columns, 1/m.
    volumes : (M,) array
        m^3.
    """

    surface: ClothMesh
    tetrahedra: Integers
    to_rest: Floats
    volumes: Floats


def tetrahedral_mesh(vertices: ArrayLike, tetrahedra: ArrayLike) -> TetrahedralMesh:
    """Check vertices and tetrahedra, and find the surface.

    Raises
    ------
    ArgumentError
        For numbers that are not finite, indices out of range, vertices without tetrahedra, tetrahedra that are flat, inverted
        or overlap others at a triangle, and edges of the surface with more than two triangles; the message names them.
    """
    points = vertices_of(vertices)
    cells = cells_of(points, tetrahedra, 4, ("tetrahedron", "tetrahedra"))
    corners = points[cells]
    edges = (corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)
    signed = np.linalg.det(edges)
    _check_volumes(corners, signed)
    to_rest: Any = np.linalg.inv(edges)
    return TetrahedralMesh(surface_mesh(points, _surface(cells)), cells, to_rest, signed / 6.0)


def surface_mesh(points: Floats, triangles: Integers) -> ClothMesh:
    """Return the surface of a soft body as a mesh, of whose vertices only some are in its triangles."""
    return ClothMesh(points, triangles, *shared_edges(triangles))


def box_mesh(size: Floats, cells: tuple[int, int, int]) -> tuple[Floats, Integers]:
    """Return the vertices and tetrahedra of a box around the origin, cut into cells, each of them into six along its diagonal.

    Vertex (i * (ny + 1) + j) * (nz + 1) + k is at (i / nx, j / ny, k / nz) of the size.
    """
    axes = [np.linspace(-0.5 * side, 0.5 * side, count + 1) for side, count in zip(size, cells, strict=True)]
    points = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    index = np.arange(len(points)).reshape([count + 1 for count in cells])
    corner = index[:-1, :-1, :-1].ravel()
    steps = np.array([index[1, 0, 0], index[0, 1, 0], index[0, 0, 1]])
    found = []
    for order in permutations(range(3)):
        way = np.cumsum(steps[list(order)])
        turns = np.linalg.det(np.eye(3)[list(order)]) > 0.0
        second, third = (way[0], way[1]) if turns else (way[1], way[0])
        found.append(np.stack((corner, corner + second, corner + third, corner + way[2]), axis=1))
    return points, np.concatenate(found)


def _check_volumes(corners: Floats, signed: Floats) -> None:
    longest = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=3).max(axis=(1, 2))
    flat = np.flatnonzero(~(np.abs(signed) > _THIN * longest**3))
    if flat.size:
        raise ArgumentError(
            f"tetrahedron {flat[0]} has no volume: its corners {corners[flat[0]].tolist()} are in a plane; leave it out."
        )
    inverted = np.flatnonzero(signed < 0.0)
    if inverted.size:
        raise ArgumentError(
            f"tetrahedron {inverted[0]} is inverted: seen from its last vertex, the first three are clockwise; exchange "
            "two of them."
        )


def _surface(cells: Integers) -> Integers:
    """Return the triangles that only one tetrahedron has, counter-clockwise as seen from outside."""
    sides = cells[:, _SIDES].reshape(-1, 3)
    in_order = np.sort(sides, axis=1)
    order = np.lexsort(in_order.T[::-1])
    same = (in_order[order][1:] == in_order[order][:-1]).all(axis=1)
    thrice = np.flatnonzero(same[1:] & same[:-1])
    if thrice.size:
        a, b, c = (int(k) // 4 for k in order[thrice[0] : thrice[0] + 3])
        raise ArgumentError(f"tetrahedra {a}, {b} and {c} share one triangle, so that they overlap; leave one out.")
    first, second = order[:-1][same], order[1:][same]
    even = (_turned(sides[first]) == _turned(sides[second])).all(axis=1)
    if even.any():
        k = int(np.flatnonzero(even)[0])
        raise ArgumentError(
            f"tetrahedra {first[k] // 4} and {second[k] // 4} are on one side of the triangle that they share; leave one out."
        )
    outer = np.ones(len(sides), dtype=np.bool_)
    outer[first] = outer[second] = False
    triangles: Integers = sides[outer]
    ends = np.sort(np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2).reshape(-1, 2), axis=1)
    edges, counts = np.unique(ends, axis=0, return_counts=True)
    crowded = np.flatnonzero(counts > 2)
    if crowded.size:
        a, b = edges[crowded[0]]
        raise ArgumentError(
            f"the surface has {counts[crowded[0]]} triangles at the edge of vertices {a} and {b}, along which two parts touch; "
            "join them by tetrahedra there, or give each part vertices of its own."
        )
    return triangles


def _turned(triangles: Integers) -> Integers:
    """Return triangles with the smallest vertex first, in the same sense."""
    first = np.argmin(triangles, axis=1)[:, None]
    return np.take_along_axis(triangles, (first + np.arange(3)) % 3, axis=1)
