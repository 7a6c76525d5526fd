"""Tearing: cloth that is stretched too far splits perpendicular to the direction of largest strain."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.mesh_tables import mesh_in
from kickdrift.world.deformables.row_ranges import rows_of
from kickdrift.world.deformables.splitting import Split, split_at
from kickdrift.world.tables import CLOTH, CLOTH_NUMBERS, FACE, FACE_NUMBERS, PARTICLE, Tables

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def principal_strains(tables: Tables, row: int) -> tuple[Floats, Floats]:
    """Return the largest principal strain of each triangle of a cloth, (M,), and its direction in space, (M, 3)."""
    corners = rows_of(tables, row, c.FIRST_FACE, FACE)[:, c.CORNERS : c.CORNERS + 3]
    rest, x = rows_of(tables, row, c.FIRST_FACE, FACE_NUMBERS), tables.array(PARTICLE)[corners, :3]
    p, q = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    u1, u2, v1, v2 = (rest[:, c.TO_REST + k, None] for k in range(4))
    u, v = u1 * p + u2 * q, v1 * p + v2 * q
    uu, vv, uv = (u * u).sum(axis=1), (v * v).sum(axis=1), (u * v).sum(axis=1)
    half = 0.5 * (uu - vv)
    strain = np.sqrt(0.5 * (uu + vv) + np.hypot(half, uv)) - 1.0
    angle = 0.5 * np.arctan2(uv, half)[:, None]
    along = np.cos(angle) * u + np.sin(angle) * v
    return strain, along / np.maximum(1.0 + strain, 1e-300)[:, None]


def find_tears(tables: Tables, row: int) -> Split | None:
    """Return the mesh of a cloth split at the vertices where it tears, or None if there are none.

    A vertex tears if the mean strain of the triangles around it, weighted by area, exceeds `TEAR_STRAIN`. Of neighbouring
    vertices only the one with the largest strain tears, which relieves the others.
    """
    limit = float(tables.array(CLOTH_NUMBERS)[row, c.TEAR_STRAIN])
    strain, along = principal_strains(tables, row)
    if not (limit > 0.0 and strain.max() > limit):
        return None
    first = int(tables.array(CLOTH)[row, c.FIRST_PARTICLE])
    particles = rows_of(tables, row, c.FIRST_PARTICLE, PARTICLE)
    corners = rows_of(tables, row, c.FIRST_FACE, FACE)[:, c.CORNERS : c.CORNERS + 3] - first
    areas = rows_of(tables, row, c.FIRST_FACE, FACE_NUMBERS)[:, c.FACE_AREA]
    of = np.bincount(corners.ravel(), weights=np.repeat(areas * strain, 3)) / np.bincount(
        corners.ravel(), weights=np.repeat(areas, 3)
    )
    of[particles[:, c.PARTICLE_INVERSE_MASS] == 0.0] = 0.0
    chosen, faces = _apart(np.flatnonzero(of > limit), of, corners)
    if not chosen.size:
        return None
    normals = np.empty((len(chosen), 3))
    for k, around in enumerate(faces):
        pull = (areas * strain)[around, None] * along[around]
        normals[k] = np.linalg.eigh(pull.T @ along[around])[1][:, -1]
    found = split_at(mesh_in(tables, row), chosen, normals, particles[:, :3])
    return found if found.parents.size else None


def _apart(vertices: Integers, strain: Floats, corners: Integers) -> tuple[Integers, list[Integers]]:
    """Return the vertices, by decreasing strain, that share no triangle with an earlier one, and the triangles of each."""
    faces = np.argsort(corners.ravel(), kind="stable") // 3
    ends = np.cumsum(np.bincount(corners.ravel()))
    taken = np.zeros(len(strain), dtype=bool)
    chosen, around = [], []
    for vertex in vertices[np.argsort(-strain[vertices], kind="stable")].tolist():
        if not taken[vertex]:
            own = faces[ends[vertex - 1] if vertex else 0 : ends[vertex]]
            chosen.append(vertex)
            around.append(own)
            taken[corners[own]] = True
    return np.array(chosen, dtype=np.int64), around
