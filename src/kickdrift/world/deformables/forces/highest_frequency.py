"""The highest vibration frequency of a cloth, which determines the number of parts of a substep."""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.forces.bending_couplings import Bending
from kickdrift.world.deformables.mesh import ClothMesh
from kickdrift.world.deformables.row_ranges import rows_of
from kickdrift.world.deformables.tetrahedra import TetrahedralMesh
from kickdrift.world.tables import CLOTH_NUMBERS, FACE_NUMBERS, PARTICLE, Tables

Floats = NDArray[np.float64]

_FEW = 300  # number of unknowns below which all eigenvalues are computed
_TOLERANCE = 1e-3  # relative tolerance of the largest eigenvalue, by which it is raised


def membrane_rate(mesh: ClothMesh, axes: Floats, to_rest: Floats, stiffness: Floats, masses: Floats) -> float:
    """Return the highest angular frequency of a membrane without tension, rad/s.

    Parameters
    ----------
    mesh : ClothMesh
    axes : (M, 2, 3) array
        Warp and weft of each triangle.
    to_rest : (M, 4) array
        From `kickdrift.world.deformables.forces.membrane.inverse_edges`.
    stiffness : (M, 2) array
        Stretching and shear stiffness times the area of each triangle, N m.
    masses : (N,) array
        kg.
    """
    weights = np.concatenate((-to_rest[:, ::2] - to_rest[:, 1::2], to_rest[:, ::2], to_rest[:, 1::2]), axis=1)
    along_u, along_v = weights[:, ::2], weights[:, 1::2]  # (M, 3): derivatives of F_u and F_v over the corners
    u, v = axes[:, None, 0], axes[:, None, 1]
    rows = np.stack(
        (along_u[..., None] * u, along_v[..., None] * v, along_v[..., None] * u + along_u[..., None] * v), axis=1
    )
    scale = np.sqrt(stiffness[:, [0, 0, 1]])
    columns = 3 * mesh.triangles[:, :, None] + np.arange(3)
    return highest(rows.reshape(-1, 3, 9) * scale[..., None], columns.reshape(-1, 9), np.repeat(masses, 3))


def put_membrane_rate(tables: Tables, row: int, mesh: ClothMesh) -> None:
    """Write the highest angular frequency of the membrane of a cloth with its nominal stiffness, rad/s."""
    rest, numbers = rows_of(tables, row, c.FIRST_FACE, FACE_NUMBERS), tables.array(CLOTH_NUMBERS)[row]
    to_rest, areas = rest[:, c.TO_REST : c.TO_REST + 4], rest[:, c.FACE_AREA]
    corners = mesh.vertices[mesh.triangles]
    p, q = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    axes = np.stack([to_rest[:, k, None] * p + to_rest[:, k + 1, None] * q for k in (0, 2)], axis=1)
    stiffness = areas[:, None] * numbers[[c.ASKED, c.ASKED + 1]]
    masses = rows_of(tables, row, c.FIRST_PARTICLE, PARTICLE)[:, c.PARTICLE_MASS]
    numbers[c.MEMBRANE_RATE] = membrane_rate(mesh, axes, to_rest, stiffness, masses)


def bending_rate(mesh: ClothMesh, bending: Bending, areas: Floats, masses: Floats) -> float:
    """Bound the angular frequency of bending with a bending stiffness of 1 N m, rad/s; for flat cloths it is the highest one.

    Parameters
    ----------
    mesh : ClothMesh
    bending : Bending
    areas : (M,) array
        Of the triangles, m^2; of a rope lengths, m.
    masses : (N,) array
        kg.

    Notes
    -----
    Curvature changes by H dx - c dn. The first term is that of a flat cloth; the change of the normal is bounded by the
    gradient of the displacement, n x (opposite side) / (2 A) for each corner.
    """
    roots = np.sqrt(areas)[:, None, None]
    flat = highest(bending.rows * roots, bending.stencils, masses)
    if not bending.rest.any():
        return flat
    corners = mesh.vertices[mesh.triangles]
    sides = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    normals = np.cross(sides[:, 0], sides[:, 1])
    gradients = np.cross(normals[:, None, :], sides) / (normals**2).sum(axis=1)[:, None, None]
    curved = np.linalg.norm(bending.rest, axis=1)[:, None, None] * roots
    return flat + highest(curved * gradients.transpose(0, 2, 1), mesh.triangles, masses)


def elastic_rate(mesh: TetrahedralMesh, bulk: float, shear: float, masses: Floats) -> float:
    """Return the highest angular frequency of a soft body at rest with these Lame parameters, Pa, in rad/s.

    Its energy is half the sum of squares of strains, whose rows are the roots of their moduli times derivatives by positions.
    """
    slopes = np.concatenate((-mesh.to_rest.sum(axis=1)[:, None], mesh.to_rest), axis=1)  # (M, 4, 3)
    rows = np.zeros((len(slopes), 6, 4, 3))
    pulls = math.sqrt(2.0 * shear) * (np.eye(3) - 1.0 / 3.0) + math.sqrt(3.0 * bulk + 2.0 * shear) / 3.0
    for k in range(3):
        rows[:, :3, :, k] = pulls[:, k, None] * slopes[:, None, :, k]
        i, j = (k + 1) % 3, (k + 2) % 3
        rows[:, 3 + k, :, i], rows[:, 3 + k, :, j] = (
            math.sqrt(shear) * slopes[..., j],
            math.sqrt(shear) * slopes[..., i],
        )
    columns = (3 * mesh.tetrahedra[:, :, None] + np.arange(3)).reshape(-1, 12)
    roots = np.sqrt(mesh.volumes)[:, None, None]
    return highest(rows.reshape(-1, 6, 12) * roots, columns, np.repeat(masses, 3))


def highest(rows: Floats, columns: NDArray[np.int64], masses: Floats) -> float:
    """Return the square root of the largest eigenvalue of M^-1/2 R^T R M^-1/2 for rows (M, J, K) in columns (M, K)."""
    from scipy.sparse import csr_array, diags_array  # takes 0.15 s, which worlds without cloth need not spend

    if not rows.any():
        return 0.0  # nothing resists
    where, starts = np.broadcast_to(columns[:, None, :], rows.shape), np.arange(0, rows.size + 1, rows.shape[2])
    matrix = csr_array((rows.ravel(), where.ravel(), starts), shape=(len(starts) - 1, len(masses)))
    scaled = matrix @ diags_array(1.0 / np.sqrt(masses))
    products = scaled.T @ scaled
    if len(masses) < _FEW:
        return math.sqrt(float(np.linalg.eigvalsh(products.toarray())[-1]))  # a fifth of the time of singular values
    from scipy.sparse.linalg import eigsh  # another 0.1 s

    start = np.random.default_rng(0).normal(size=len(masses))  # the same for the same cloth
    largest = eigsh(products, k=1, tol=_TOLERANCE, v0=start, return_eigenvectors=False)[0]
    return math.sqrt((1.0 + _TOLERANCE) * float(largest))
