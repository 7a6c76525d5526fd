"""The mesh of a cloth in the tables of a world."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.cloth import layout as c
from kickdrift.world.cloth.face_tree import owned
from kickdrift.world.cloth.mesh import ClothMesh, cloth_mesh
from kickdrift.world.cloth.ranges import replace_rows, rows_of
from kickdrift.world.tables import CLOTH, FACE, FACE_NUMBERS, PARTICLE, PARTICLE_COUPLINGS, PARTICLE_REST, Tables

Floats = NDArray[np.float64]


def put_mesh(tables: Tables, row: int, mesh: ClothMesh, masses: Floats, at_rest: Floats) -> None:
    """Give a cloth the vertices of a mesh, at their positions, and its triangles.

    Parameters
    ----------
    tables : Tables
    row : int
        Of the cloth.
    mesh : ClothMesh
    masses : (N,) array
        Of the vertices, kg.
    at_rest : (M, 5) array
        `TO_REST` and `FACE_AREA` of the triangles.
    """
    count = len(masses)
    particles, rest = np.zeros((count, PARTICLE.width)), np.zeros((count, PARTICLE_REST.width))
    rest[:, :3] = particles[:, :3] = mesh.vertices
    particles[:, c.PARTICLE_MASS], particles[:, c.PARTICLE_INVERSE_MASS] = masses, 1.0 / masses
    couplings = np.zeros((count, PARTICLE_COUPLINGS.width), dtype=np.int64)
    of_particles = {PARTICLE: particles, PARTICLE_REST: rest, PARTICLE_COUPLINGS: couplings}
    replace_rows(tables, row, c.FIRST_PARTICLE, of_particles)
    faces, numbers = np.zeros((len(at_rest), FACE.width), np.int64), np.zeros((len(at_rest), FACE_NUMBERS.width))
    numbers[:, c.TO_REST : c.FACE_AREA + 1] = at_rest
    replace_rows(tables, row, c.FIRST_FACE, {FACE: faces, FACE_NUMBERS: numbers})
    put_triangles(tables, row, mesh)


def put_triangles(tables: Tables, row: int, mesh: ClothMesh) -> None:
    """Write the vertices of the triangles of a cloth, whose number does not change."""
    faces = rows_of(tables, row, c.FIRST_FACE, FACE)
    faces[:, c.CORNERS : c.CORNERS + 3] = mesh.triangles + tables.array(CLOTH)[row, c.FIRST_PARTICLE]
    faces[:, c.OWNED] = owned(mesh.triangles)


def mesh_in(tables: Tables, row: int) -> ClothMesh:
    """Return the mesh of a cloth at rest."""
    rest = rows_of(tables, row, c.FIRST_PARTICLE, PARTICLE_REST)[:, :3].copy()
    corners = rows_of(tables, row, c.FIRST_FACE, FACE)[:, c.CORNERS : c.CORNERS + 3]
    return cloth_mesh(rest, corners - tables.array(CLOTH)[row, c.FIRST_PARTICLE])
