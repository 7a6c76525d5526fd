"""Convex hulls of points."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.arguments import reals
from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.core.vectors import Quaternion, Vector, dot
from kickdrift.world.shapes.extents import Extent, around
from kickdrift.world.shapes.kind_numbers import HULL
from kickdrift.world.shapes.mass_properties import Array, MassProperties, extent
from kickdrift.world.shapes.polyhedron import FACES, HEADER, MOST_VERTICES, VERTICES, plane, polyhedron_numbers
from kickdrift.world.shapes.rays import MISS, Hit, ahead
from kickdrift.world.shapes.record import SOLID, Kind

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull

# Fraction of the largest extent within which points count as one, or as points of a plane, and below which a set of points is
# flat.
_FLAT = 1e-6


@compiled
def _extent(numbers: Any, q: Quaternion) -> Extent:
    """Return the bounds of a hull; see `kickdrift.world.shapes.record`."""
    return around(numbers, HEADER, 3, int(numbers[VERTICES]), 1, q)


@compiled
def _ray(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Cast a ray at a convex polyhedron; see `kickdrift.world.shapes.rays` (Cyrus and Beck 1978)."""
    enters, leaves, face_in, face_out = -math.inf, math.inf, 0, 0
    for face in range(int(numbers[FACES])):
        normal, offset = plane(numbers, face)
        height, rise = dot(normal, origin) - offset, dot(normal, direction)
        if rise < 0.0:
            if -height / rise > enters:
                enters, face_in = -height / rise, face
        elif rise > 0.0:
            if -height / rise < leaves:
                leaves, face_out = -height / rise, face
        elif height > 0.0:
            return MISS
    distance = ahead((enters, leaves), limit)
    if distance == math.inf:
        return MISS
    normal, _ = plane(numbers, face_in if distance == enters else face_out)
    return (distance, normal[0], normal[1], normal[2])


@dataclass(frozen=True, eq=False)
class Hull:
    """The convex hull of some points, with at most 128 corners.

    Facets in one plane are one face.

    Attributes
    ----------
    points : (N, 3) array
        Points of the body, m; points inside, or within a millionth of its extent of others, have no effect.
    vertices : (V, 3) array
        Its corners.
    faces : tuple of tuples of int
        Corners of each face, counter-clockwise as seen from outside.

    Raises
    ------
    ArgumentError
        If the points are not finite, fewer than four, all in one plane, or have a hull of more than 128 corners.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    >>> tetrahedron = world.add_body(kd.Hull(corners), density=600.0)
    >>> round(tetrahedron.mass, 6)
    100.0
    """

    points: Array
    vertices: Array = field(init=False, repr=False)
    faces: tuple[tuple[int, ...], ...] = field(init=False, repr=False)
    kind: ClassVar[int] = HULL

    def __init__(self, points: ArrayLike) -> None:
        try:
            array = reals(points)
        except TypeError as error:
            raise ArgumentError(f"points={points!r} must be numbers: {error}; give three per row, in m.") from None
        _check(array)
        centre = 0.5 * (array.min(axis=0) + array.max(axis=0))
        size = extent("the extent of points", float(np.ptp(array, axis=0).max()))
        corners, faces = _corners_and_faces((array - centre) / size)
        if len(corners) > MOST_VERTICES:
            raise ArgumentError(
                f"points has {len(array)} rows, whose hull has {len(corners)} corners, but contacts support at most"
                f" {MOST_VERTICES}; give fewer points on its surface, or several hulls."
            )
        object.__setattr__(self, "points", array)
        object.__setattr__(self, "vertices", centre + size * corners)
        object.__setattr__(self, "faces", faces)

    @cached_property
    def numbers(self) -> Array:
        """The data for compiled code, laid out as in `kickdrift.world.shapes.polyhedron`."""
        return polyhedron_numbers(self.vertices, self.faces)

    @property
    def reach(self) -> float:
        """Radius of its bounding sphere about the origin of its frame, m."""
        return float(np.sqrt((self.vertices**2).sum(axis=1).max()))

    def mass_properties(self) -> MassProperties:
        """Return the mass properties at unit density.

        Returns
        -------
        MassProperties
            Volume, centre of mass and inertia.

        Notes
        -----
        The sum over tetrahedra between the mean of the corners and the triangles of the faces. The second moments of a
        tetrahedron of volume V with one corner at the origin are V/20 (S S^T + sum of x x^T), where S is the sum of the
        other corners x.

        Examples
        --------
        >>> import kickdrift as kd
        >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        >>> round(float(kd.Hull(corners).mass_properties().volume), 6)
        0.166667
        """
        middle = self.vertices.mean(axis=0)
        triangles = np.array([(face[0], *pair) for face in self.faces for pair in pairwise(face[1:])])
        x = self.vertices[triangles] - middle
        volumes = np.linalg.det(x) / 6.0
        sums = x.sum(axis=1)
        volume = volumes.sum()
        centre = volumes @ sums / (4.0 * volume)
        outer = sums[:, :, None] * sums[:, None, :] + np.einsum("nki,nkj->nij", x, x)
        moments = np.einsum("n,nij->ij", volumes, outer) / 20.0 - volume * np.outer(centre, centre)
        return MassProperties(float(volume), middle + centre, np.trace(moments) * np.eye(3) - moments)


def _check(points: Array) -> None:
    if points.ndim != 2 or points.shape[1:] != (3,):
        raise ArgumentError(f"points has the shape {points.shape}; give (N, 3).")
    if not np.isfinite(points).all():
        row = int(np.argmin(np.isfinite(points).all(axis=1)))
        raise ArgumentError(f"points[{row}]={points[row].tolist()} is not finite; give finite coordinates, in m.")
    if len(points) < 4:
        raise ArgumentError(f"points has {len(points)} rows; a body needs four or more that are not in one plane.")
    centred = points - points.mean(axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    extents = np.ptp(centred @ axes.T, axis=0)
    if not extents.min() > _FLAT * extents.max():
        raise ArgumentError(
            f"points lie in one plane: their largest extent is {extents.max():.6g} m, but their smallest is"
            f" {extents.min():.3g} m; a hull needs at least a millionth of its extent in every direction."
        )


def _corners_and_faces(points: Array) -> tuple[Array, tuple[tuple[int, ...], ...]]:
    """Return corners and faces of the hull of points of extent 1."""
    from scipy.spatial import ConvexHull  # takes 0.2 s, which worlds without hulls need not spend

    corners = _distinct(points[ConvexHull(points).vertices])
    while True:
        faces = _merged(corners, ConvexHull(corners))
        ends = np.bincount([index for face in faces for index in face], minlength=len(corners))
        if ends.min() >= 3:
            return corners, faces
        corners = corners[ends >= 3]  # the others are on an edge or in a face


def _distinct(points: Array) -> Array:
    """Return the points without those that coincide with an earlier one."""
    kept = np.ones(len(points), dtype=np.bool_)
    for k in range(1, len(points)):
        ways = points[:k][kept[:k]] - points[k]
        kept[k] = np.einsum("ni,ni->n", ways, ways).min() > _FLAT**2
    return points[kept]


def _merged(corners: Array, hull: ConvexHull) -> tuple[tuple[int, ...], ...]:
    """Merge facets in one plane into faces; return the loop of each."""
    facets = [
        facet if np.linalg.det(np.vstack((corners[facet[1:]] - corners[facet[0]], equation[:3]))) > 0.0 else facet[::-1]
        for facet, equation in zip(hull.simplices.tolist(), hull.equations, strict=True)
    ]
    face_of = np.full(len(facets), -1)
    faces: list[tuple[int, ...]] = []
    for first in range(len(facets)):
        if face_of[first] >= 0:
            continue
        heights = corners @ hull.equations[first, :3] + hull.equations[first, 3]
        level = np.abs(heights) <= _FLAT
        face_of[first] = len(faces)
        members = [first]
        for member in members:
            for neighbour in hull.neighbors[member]:
                if face_of[neighbour] < 0 and level[facets[neighbour]].all():
                    face_of[neighbour] = len(faces)
                    members.append(int(neighbour))
        faces.append(_outline([facets[member] for member in members]))
    return tuple(faces)


def _outline(triangles: list[list[int]]) -> tuple[int, ...]:
    """Return the boundary of triangles that form a polygon, in their orientation."""
    steps = {(t[k], t[(k + 1) % 3]) for t in triangles for k in range(3)}
    following = {begin: end for begin, end in steps if (end, begin) not in steps}
    loop = [min(following)]
    while following[loop[-1]] != loop[0]:
        loop.append(following[loop[-1]])
    return tuple(loop)


RECORD = Kind(number=HULL, name="hull", sort=SOLID, shape=Hull, extent=_extent, ray=_ray)
