"""Splitting of vertices of a cloth, where it is cut or tears, so that triangles separate."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.forces.bending_coupling_rows import put_couplings
from kickdrift.world.deformables.forces.highest_frequency import put_membrane_rate
from kickdrift.world.deformables.mesh import ClothMesh, cloth_mesh, masses_of
from kickdrift.world.deformables.mesh_tables import mesh_in, put_triangles
from kickdrift.world.deformables.pin_rows import copy_pins
from kickdrift.world.deformables.row_ranges import replace_rows, rows_of
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    FACE_NUMBERS,
    PARTICLE,
    PARTICLE_COUPLINGS,
    PARTICLE_REST,
    Tables,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


class Split(NamedTuple):
    """The triangles of a mesh after vertices were split, (M, 3), and the original of each additional vertex, (K,)."""

    triangles: Integers
    parents: Integers


def split_between(mesh: ClothMesh, sides: Integers) -> Split:
    """Separate triangles on different sides, (M,), of a cut: an edge that two of them share is duplicated."""
    folds = mesh.sides.ravel() >= 0
    of = np.repeat(sides, 3)[folds][np.argsort(mesh.sides.ravel()[folds], kind="stable")].reshape(-1, 2)
    return _split(mesh, np.repeat((of[:, :1] != of[:, 1:]), 2, axis=1))


def split_at(mesh: ClothMesh, vertices: Integers, normals: Floats, places: Floats) -> Split:
    """Separate the triangles around each of some vertices that lie on different sides of a plane through it.

    Parameters
    ----------
    mesh : ClothMesh
    vertices : (K,) array
        No two of them belong to the same triangle.
    normals : (K, 3) array
        Normals of the planes.
    places : (N, 3) array
        Positions of all vertices, m.
    """
    of = np.full(len(mesh.vertices), -1)
    of[vertices] = np.arange(len(vertices))
    middles = places[mesh.triangles].mean(axis=1)
    plane = of[mesh.triangles]  # of each corner
    off = middles[:, None] - places[mesh.triangles]
    ahead = (np.einsum("mkj,mkj->mk", off, normals[plane]) > 0.0) & (plane >= 0)
    pairs = _corner_pairs(mesh)
    split = _split(mesh, ahead.ravel()[pairs[:, :, 0]] != ahead.ravel()[pairs[:, :, 1]])
    # Triangles that are connected by a vertex only are separated, too.
    rest = mesh.vertices[np.concatenate((np.arange(len(mesh.vertices)), split.parents))]
    after = cloth_mesh(rest, split.triangles)
    touched = np.isin(split.triangles, np.concatenate((vertices, np.arange(len(mesh.vertices), len(rest))))).any(axis=1)
    more = _split(after, np.zeros((len(after.folds), 2), dtype=bool), np.unique(split.triangles[touched]))
    parents = np.concatenate((np.arange(len(mesh.vertices)), split.parents))[more.parents]
    return Split(more.triangles, np.concatenate((split.parents, parents)))


def _corner_pairs(mesh: ClothMesh) -> Integers:
    """Return the corners of the two triangles of each fold, (K, 2, 2): at its first end, and at its second."""
    face, side = np.nonzero(mesh.sides >= 0)
    start, end = 3 * face + side, 3 * face + (side + 1) % 3
    fold = mesh.sides[face, side]
    first = mesh.triangles[face, side] == mesh.folds[fold, 0]
    order = np.argsort(fold, kind="stable")
    ends = np.stack((np.where(first, start, end), np.where(first, end, start)), axis=1)[order]
    return ends.reshape(-1, 2, 2).transpose(0, 2, 1)


def _split(mesh: ClothMesh, cut: Flags, vertices: Integers | None = None) -> Split:
    """Give the corners at a vertex that no fold connects different vertices.

    `cut`, (K, 2), says which folds no longer connect corners at their two ends. Only the vertices at such ends are split, or
    the given ones.
    """
    from scipy.sparse import coo_array  # takes 0.15 s, which worlds without cloth need not spend
    from scipy.sparse.csgraph import connected_components

    pairs, corners = _corner_pairs(mesh), mesh.triangles.ravel()
    held = pairs[~cut]
    count = len(corners)
    graph = coo_array((np.ones(len(held)), (held[:, 0], held[:, 1])), shape=(count, count))
    piece = connected_components(graph, directed=False)[1]
    open_ = np.unique(corners[pairs[cut]]) if vertices is None else vertices
    at = np.flatnonzero(np.isin(corners, open_))
    pieces, first = np.unique(np.stack((corners[at], piece[at]), axis=1), axis=0, return_index=True)
    order = np.lexsort((first, pieces[:, 0]))  # the first piece of each vertex keeps it
    pieces = pieces[order]
    new = np.flatnonzero(pieces[1:, 0] == pieces[:-1, 0]) + 1
    numbers = pieces[:, 0].copy()
    numbers[new] = len(mesh.vertices) + np.arange(len(new))
    by_piece = np.full(int(piece.max(initial=-1)) + 1, -1)
    by_piece[pieces[:, 1]] = numbers
    triangles = corners.copy()
    triangles[at] = by_piece[piece[at]]
    return Split(triangles.reshape(-1, 3), pieces[new, 0])


def put_split(tables: Tables, row: int, split: Split) -> None:
    """Replace the mesh of a cloth by a split one; new particles have the velocities of their originals and share their mass."""
    before = rows_of(tables, row, c.FIRST_PARTICLE, PARTICLE)
    count, first = len(before), int(tables.array(CLOTH)[row, c.FIRST_PARTICLE])
    sources = np.concatenate((np.arange(count), split.parents))
    copied = (PARTICLE, PARTICLE_REST, PARTICLE_COUPLINGS)
    rows = {table: rows_of(tables, row, c.FIRST_PARTICLE, table)[sources] for table in copied}
    rows[PARTICLE_REST][count:, c.SPLIT_FROM] = split.parents
    mesh = cloth_mesh(rows[PARTICLE_REST][:, :3], split.triangles)
    areas = rows_of(tables, row, c.FIRST_FACE, FACE_NUMBERS)[:, c.FACE_AREA]
    masses = masses_of(mesh, float(tables.array(CLOTH_NUMBERS)[row, c.AREA_DENSITY]) * areas)
    particles = rows[PARTICLE]
    particles[:, c.PARTICLE_MASS] = masses
    particles[:, c.PARTICLE_INVERSE_MASS] = np.where(particles[:, c.PARTICLE_INVERSE_MASS] > 0.0, 1.0 / masses, 0.0)
    replace_rows(tables, row, c.FIRST_PARTICLE, rows)
    put_triangles(tables, row, mesh)
    copy_pins(tables, first + split.parents, first + count + np.arange(len(split.parents)))
    put_membrane_rate(tables, row, mesh)
    put_couplings(tables, row, mesh)


def cut_by_plane(tables: Tables, row: int, point: Floats, normal: Floats) -> Split:
    """Separate the triangles of a cloth whose centroids are on different sides of a plane."""
    mesh, places = mesh_in(tables, row), rows_of(tables, row, c.FIRST_PARTICLE, PARTICLE)[:, :3]
    middles = places[mesh.triangles].mean(axis=1)
    return split_between(mesh, ((middles - point) @ normal > 0.0).astype(np.int64))
