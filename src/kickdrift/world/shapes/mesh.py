"""Triangle meshes: immovable ground."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import reals
from kickdrift.core.errors import ArgumentError
from kickdrift.world.shapes.kind_numbers import MESH
from kickdrift.world.shapes.mass_properties import LARGEST, Array, MassProperties
from kickdrift.world.shapes.record import SURFACE, Kind
from kickdrift.world.shapes.triangle import surface_extent

# Cosine of the angle between adjacent triangles: at edges with a smaller one bodies are pushed along a triangle's normal.
_SHARP = math.cos(math.radians(5.0))

# Ratio of height to longest side below which a triangle is degenerate.
_FLAT = 1e-9


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh that collides on one side: the side from which corners are counter-clockwise.

    It has no mass and is for static bodies. Shapes behind a triangle do not touch it.

    Attributes
    ----------
    vertices : (V, 3) array
        m. Coincident vertices count as one where triangles meet.
    faces : (F, 3) array of int
        Vertices of each triangle, counted from 0.

    Raises
    ------
    ArgumentError
        If vertices are not finite, faces have indices without a vertex, a triangle has no area, or two triangles that share
        an edge face opposite sides.
    """

    vertices: Array
    faces: NDArray[np.int64]
    kind: ClassVar[int] = MESH

    def __init__(self, vertices: ArrayLike, faces: ArrayLike) -> None:
        points = _vertices(vertices)
        try:
            triangles = np.asarray(faces)
        except Exception as error:  # ragged, or not convertible to an array
            raise ArgumentError(f"faces={faces!r} must be triangles: {error}; give three vertices for each.") from None
        if triangles.ndim != 2 or triangles.shape[1:] != (3,) or not len(triangles):
            raise ArgumentError(f"faces has the shape {triangles.shape}; give (F, 3): three vertices of each triangle.")
        if not np.issubdtype(triangles.dtype, np.integer):
            raise ArgumentError(f"faces has the type {triangles.dtype}; give integers, the indices of vertices.")
        outside = (triangles < 0) | (triangles >= len(points))
        if outside.any():
            row = int(np.argmax(outside.any(axis=1)))
            raise ArgumentError(
                f"faces[{row}]={triangles[row].tolist()} has an index without a vertex; there are {len(points)}"
                " vertices, counted from 0."
            )
        object.__setattr__(self, "vertices", points)
        object.__setattr__(self, "faces", triangles.astype(np.int64))
        _check_areas(self.corners)
        self.active_edges()

    @property
    def corners(self) -> Array:
        """Corners of each triangle, (F, 3, 3), m."""
        return self.vertices[self.faces]

    @cached_property
    def numbers(self) -> Array:
        """The data for compiled code: the number of triangles, and for each nine coordinates and three flags of edges."""
        count = len(self.faces)
        rows = np.concatenate((self.corners.reshape(count, 9), self.active_edges()), axis=1)
        return np.concatenate(([count], rows.ravel()))

    def active_edges(self) -> NDArray[np.bool_]:
        """Return flags of the edges at which bodies may be pushed sideways, (F, 3); edge k begins at corner k.

        They are those where the surface ends, or is convex with an angle of more than five degrees. At other edges, bodies
        touch the adjacent triangles.
        """
        _, merged = np.unique(self.vertices, axis=0, return_inverse=True)
        begin = merged.reshape(-1)[self.faces]
        end = np.roll(begin, -1, axis=1)
        pairs = np.sort(np.stack((begin.ravel(), end.ravel()), axis=1), axis=1)
        _, edge, uses = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
        edge = edge.reshape(-1)
        order = np.argsort(edge, kind="stable")
        starts = np.cumsum(uses) - uses
        shared = uses == 2
        one, two = order[starts[shared]], order[starts[shared] + 1]
        alike = begin.ravel()[one] == begin.ravel()[two]
        if alike.any():
            k = int(np.argmax(alike))
            raise ArgumentError(
                f"faces[{one[k] // 3}]={self.faces[one[k] // 3].tolist()} and"
                f" faces[{two[k] // 3}]={self.faces[two[k] // 3].tolist()} share an edge and face opposite sides, but"
                " a mesh collides on one side only; reverse the order of the vertices of one of the two."
            )
        corners = self.corners
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        opposite = corners[two // 3, (two + 2) % 3] - corners[one // 3, one % 3]
        falls = np.einsum("ni,ni->n", normals[one // 3], opposite) < 0.0
        bends = np.einsum("ni,ni->n", normals[one // 3], normals[two // 3]) < _SHARP
        active = np.ones(3 * len(self.faces), dtype=np.bool_)
        active[one] = active[two] = falls & bends
        return active.reshape(-1, 3)

    @property
    def reach(self) -> float:
        """0.0, as for all shapes that never move."""
        return 0.0

    def mass_properties(self) -> MassProperties:
        """Refuse, since it has no mass.

        Raises
        ------
        ArgumentError
            Always: a surface has no volume.
        """
        raise ArgumentError("A mesh is a surface and has no mass; add it to a static body, or give a moving one hulls.")


def _vertices(vertices: ArrayLike) -> Array:
    try:
        points = reals(vertices)
    except TypeError as error:
        raise ArgumentError(f"vertices={vertices!r} must be numbers: {error}; give three per row, in m.") from None
    if points.ndim != 2 or points.shape[1:] != (3,):
        raise ArgumentError(f"vertices has the shape {points.shape}; give (V, 3).")
    near = (np.abs(points) <= LARGEST).all(axis=1)
    if not near.all():
        row = int(np.argmin(near))
        raise ArgumentError(
            f"vertices[{row}]={points[row].tolist()} is not finite, or beyond {LARGEST:g} m; give nearer ones, in m."
        )
    return points


def _check_areas(corners: Array) -> None:
    sides = np.roll(corners, -1, axis=1) - corners
    longest = np.sqrt(np.einsum("nki,nki->nk", sides, sides).max(axis=1))
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    thin = ~(area > _FLAT * longest**2)
    if thin.any():
        row = int(np.argmax(thin))
        raise ArgumentError(
            f"faces[{row}] has its corners {corners[row].tolist()} on one line, so it has no normal; leave it out."
        )


RECORD = Kind(number=MESH, name="mesh", sort=SURFACE, shape=Mesh, extent=surface_extent)
