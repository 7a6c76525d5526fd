"""The curvature of triangles from the angles at their sides; see `kickdrift.world.deformables.forces.bending`."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables.mesh import NONE, ClothMesh

Floats = NDArray[np.float64]

# Fraction of the largest singular value below which a curvature is undetermined: the six corners are nearly on a conic.
_UNKNOWN = 1e-3


class Curvature(NamedTuple):
    """The curvature of triangles.

    Attributes
    ----------
    weights : (M, 3, 3) array
        Derivatives of the curvature (xx, yy, sqrt 2 xy) by the angle at each side, 1/m; zeros for sides on the border.
    jumps : (M, 3, 6) array
        Derivatives of the angles at the sides by the heights of the corners and of the vertices across the sides, 1/m.
    stencils : (M, 6) array
        These vertices; `NONE` beyond the border.
    """

    weights: Floats
    jumps: Floats
    stencils: NDArray[np.int64]


def curvature_of(mesh: ClothMesh, flat: Floats, pinned: NDArray[np.bool_]) -> Curvature:
    """Return the curvature as a function of angles and heights that is exact for every quadratic surface.

    A triangle whose corners are all pinned is clamped: it does not bend, and of the angle to its neighbour only the half that
    belongs to the neighbour counts. A strip of n segments, clamped at its end, then sags by 1 / (2 n^2) too much, and otherwise
    by 3 / (2 n).

    Parameters
    ----------
    mesh : ClothMesh
    flat : (M, 3, 2) array
        From `kickdrift.world.deformables.mesh.flattened`.
    pinned : (N,) array of bool
        Which vertices are pinned.
    """
    clamped: NDArray[np.bool_] = np.logical_and.reduce(pinned[mesh.triangles], axis=1)
    neighbours = _neighbours(mesh)
    count = len(flat)
    points = np.zeros((count, 6, 2))
    points[:, :3] = flat
    jumps, stencils = np.zeros((count, 3, 6)), np.full((count, 6), NONE, dtype=np.int64)
    stencils[:, :3] = mesh.triangles
    to_weights = np.linalg.inv(np.concatenate((flat, np.ones((count, 3, 1))), axis=2))  # of corners, from (x, y, 1)
    for k in range(3):
        inner = np.flatnonzero(mesh.sides[:, k] != NONE)
        across = _across(mesh, inner, k)
        start, edge = flat[inner, k], flat[inner, (k + 1) % 3] - flat[inner, k]
        along, height = _place(mesh, inner, k, across)
        outward = np.stack((edge[:, 1], -edge[:, 0]), axis=1) / np.linalg.norm(edge, axis=1, keepdims=True)
        at = start + along[:, None] * edge + height[:, None] * outward
        points[inner, 3 + k], stencils[inner, 3 + k] = at, across
        shares = np.einsum("mj,mjk->mk", np.concatenate((at, np.ones((len(at), 1))), axis=1), to_weights[inner])
        jumps[inner, k, :3] = -shares / height[:, None]
        jumps[inner, k, 3 + k] = 1.0 / height
    x, y = points[..., 0], points[..., 1]
    quadratics = np.stack((0.5 * x**2, 0.5 * y**2, x * y / math.sqrt(2.0)), axis=2)
    halves = np.where((neighbours != NONE) & clamped[neighbours], 0.5, 1.0)[:, :, None]
    weights = np.asarray(np.linalg.pinv(halves * jumps @ quadratics, rcond=_UNKNOWN), dtype=np.float64)
    weights[clamped] = 0.0
    return Curvature(weights, jumps, stencils)


def _neighbours(mesh: ClothMesh) -> NDArray[np.int64]:
    """Return the triangles beyond each side, (M, 3); `NONE` beyond the border."""
    triangles = np.broadcast_to(np.arange(len(mesh.sides))[:, None], mesh.sides.shape)
    inner = mesh.sides != NONE
    sums = np.bincount(mesh.sides[inner], weights=triangles[inner], minlength=len(mesh.folds)).astype(np.int64)
    found = np.full(mesh.sides.shape, NONE, dtype=np.int64)
    found[inner] = sums[mesh.sides[inner]] - triangles[inner]
    return found


def _across(mesh: ClothMesh, inner: NDArray[np.intp], k: int) -> NDArray[np.int64]:
    """Return the vertices across the k-th sides of some triangles."""
    folds = mesh.folds[mesh.sides[inner, k]]
    own = mesh.triangles[inner, (k + 2) % 3]
    across: NDArray[np.int64] = np.where(folds[:, 2] == own, folds[:, 3], folds[:, 2])
    return across


def _place(mesh: ClothMesh, inner: NDArray[np.intp], k: int, across: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Return positions of vertices across sides: along the sides, as a fraction of these, and the distance from them, m."""
    start = mesh.vertices[mesh.triangles[inner, k]]
    edge = mesh.vertices[mesh.triangles[inner, (k + 1) % 3]] - start
    way = mesh.vertices[across] - start
    along = (way * edge).sum(axis=1) / (edge * edge).sum(axis=1)
    return along, np.linalg.norm(way - along[:, None] * edge, axis=1)
