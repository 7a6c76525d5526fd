"""The mesh of a cloth in the tables of a world."""

import numpy as np

from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.building import Built
from kickdrift.world.deformables.mesh import ClothMesh, cloth_mesh
from kickdrift.world.deformables.rope_mesh import segments
from kickdrift.world.deformables.row_ranges import replace_rows, rows_of
from kickdrift.world.deformables.self_collision.face_bvh import owned
from kickdrift.world.deformables.tetrahedra import surface_mesh
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    FACE,
    FACE_NUMBERS,
    PARTICLE,
    PARTICLE_COUPLINGS,
    PARTICLE_REST,
    TETRAHEDRON,
    TETRAHEDRON_NUMBERS,
    Tables,
)


def put_mesh(tables: Tables, row: int, built: Built) -> None:
    """Write the mesh and numbers of a cloth or a rope to its row, which is empty."""
    mesh, masses, count = built.mesh, built.masses, len(built.masses)
    tables.array(CLOTH)[row, c.DIMENSION], tables.array(CLOTH_NUMBERS)[row] = built.dimension, built.numbers
    particles, rest = np.zeros((count, PARTICLE.width)), np.zeros((count, PARTICLE_REST.width))
    rest[:, :3] = particles[:, :3] = mesh.vertices
    particles[:, c.PARTICLE_MASS], particles[:, c.PARTICLE_INVERSE_MASS] = masses, 1.0 / masses
    couplings = np.zeros((count, PARTICLE_COUPLINGS.width), dtype=np.int64)
    of_particles = {PARTICLE: particles, PARTICLE_REST: rest, PARTICLE_COUPLINGS: couplings}
    replace_rows(tables, row, c.FIRST_PARTICLE, of_particles)
    faces = np.zeros((len(built.at_rest), FACE.width), np.int64)
    replace_rows(tables, row, c.FIRST_FACE, {FACE: faces, FACE_NUMBERS: built.at_rest})
    put_triangles(tables, row, mesh)
    cells = built.tetrahedra + tables.array(CLOTH)[row, c.FIRST_PARTICLE]
    rows = {TETRAHEDRON: cells, TETRAHEDRON_NUMBERS: built.cells_at_rest}
    replace_rows(tables, row, c.FIRST_TETRAHEDRON, rows)


def put_triangles(tables: Tables, row: int, mesh: ClothMesh) -> None:
    """Write the vertices of the triangles of a cloth, whose number does not change."""
    faces = rows_of(tables, row, c.FIRST_FACE, FACE)
    faces[:, c.CORNERS : c.CORNERS + 3] = mesh.triangles + tables.array(CLOTH)[row, c.FIRST_PARTICLE]
    faces[:, c.OWNED] = owned(mesh.triangles)


def mesh_in(tables: Tables, row: int) -> ClothMesh:
    """Return the mesh of a cloth at rest."""
    rest = rows_of(tables, row, c.FIRST_PARTICLE, PARTICLE_REST)[:, :3].copy()
    dimension, first = tables.array(CLOTH)[row, [c.DIMENSION, c.FIRST_PARTICLE]].tolist()
    if dimension == c.ROPE:
        return segments(rest)
    triangles = rows_of(tables, row, c.FIRST_FACE, FACE)[:, c.CORNERS : c.CORNERS + 3] - first
    return surface_mesh(rest, triangles) if dimension == c.VOLUME else cloth_mesh(rest, triangles)
