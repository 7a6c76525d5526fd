"""The bending of a cloth as forces between pairs of vertices; see `kickdrift.world.deformables.forces.bending`."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables.forces.bending_curvature import Curvature
from kickdrift.world.deformables.mesh import NONE, ClothMesh

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_FLAT = 1e-9  # rad: angle below which a triangle is flat at rest
# Weights are rounded to this fraction of the largest, so that those that differ by rounding errors become equal: momentum is
# conserved to the last digit, and vertices of a grid share their couplings. The relative error of forces is 1e-12.
_ROUNDING = 2.0**-40


class Bending(NamedTuple):
    """The curvature of triangles as a linear function of the positions of six vertices, and at rest.

    Attributes
    ----------
    rows : (M, 3, 6) array
        H: derivatives of the curvature (xx, yy, sqrt 2 xy), each times the normal, by positions, 1/m^2. Of a rope (M, 1, 3).
    stencils : (M, 6) array
        The vertices; beyond the border, the first corner stands for them, with zeros in `rows`.
    rest : (M, 3) array
        c: curvature at rest along the normal, 1/m.
    """

    rows: Floats
    stencils: Integers
    rest: Floats


class Couplings(NamedTuple):
    """Forces of bending between pairs of vertices.

    Attributes
    ----------
    ranges : (N, 2) array
        First coupling of each vertex, and one after the last; vertices with equal couplings share them.
    offsets : (C,) array
        Index of the other vertex less that of the vertex.
    weights : (C,) array
        Force over distance and bending stiffness, 1/m^2.
    """

    ranges: Integers
    offsets: Integers
    weights: Floats


def bending_of(mesh: ClothMesh, curvature: Curvature) -> Bending:
    """Return the curvature as a function of positions in space, from that as a function of heights.

    For a triangle that is folded against its neighbours at rest, H x has a tangential part, a linear combination of two sides.
    The same combination of the present sides is subtracted in H.
    """
    rows: Floats = curvature.weights @ curvature.jumps
    stencils = np.where(curvature.stencils == NONE, mesh.triangles[:, :1], curvature.stencils)
    corners = mesh.vertices[stencils]
    sides = corners[:, 1:3] - corners[:, :1]
    normals = np.cross(sides[:, 0], sides[:, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    vectors = rows @ (corners - corners[:, :1])
    rest = np.einsum("msk,mk->ms", vectors, normals)
    along = vectors @ np.linalg.pinv(sides)
    rows[:, :, 0] += along.sum(axis=2)
    rows[:, :, 1:3] -= along
    sizes = np.sqrt(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1, keepdims=True))
    return Bending(rows, stencils, np.where(np.abs(rest).max(axis=1, keepdims=True) * sizes > _FLAT, rest, 0.0))


def couplings_of(bending: Bending, sizes: Floats, count: int) -> Couplings:
    """Sum the forces between pairs of `count` vertices over triangles: the off-diagonal elements of sum A H^T H.

    `sizes` are their areas A; of a rope the lengths in place of these.
    """
    from scipy.sparse import csr_array, diags_array  # takes 0.15 s, which worlds without cloth need not spend

    rows = bending.rows * np.sqrt(sizes)[:, None, None]
    starts = np.arange(0, rows.size + 1, rows.shape[2])
    columns = np.broadcast_to(bending.stencils[:, None, :], rows.shape)
    roots = csr_array((rows.ravel(), columns.ravel(), starts), shape=(len(starts) - 1, count))
    product = roots.T @ roots
    pairs = diags_array(product.diagonal()) - 0.5 * (product + product.T)  # symmetric to the last digit
    largest = np.abs(pairs.data).max(initial=0.0)
    if largest > 0.0:
        pairs.data = np.rint(pairs.data * (1.0 / _ROUNDING / largest)) * (_ROUNDING * largest)
    pairs.setdiag(0.0)
    pairs.eliminate_zeros()
    pairs.sort_indices()
    return _shared(pairs.indptr.astype(np.int64), pairs.indices.astype(np.int64), pairs.data)


def _shared(starts: Integers, columns: Integers, weights: Floats) -> Couplings:
    """Return the couplings from the rows of a sparse matrix, with rows that are equal up to a shift stored once."""
    offsets = columns - np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    found: dict[bytes, int] = {}
    ranges, kept, end = np.empty((len(starts) - 1, 2), dtype=np.int64), [], 0
    for row, (first, last) in enumerate(zip(starts[:-1].tolist(), starts[1:].tolist(), strict=True)):
        key = offsets[first:last].tobytes() + weights[first:last].tobytes()
        begin = found.setdefault(key, end)
        if begin == end:
            kept.append(slice(first, last))
            end += last - first
        ranges[row] = begin, begin + last - first
    chosen: Any = np.concatenate([np.arange(part.start, part.stop) for part in kept])
    return Couplings(ranges, offsets[chosen], weights[chosen])
