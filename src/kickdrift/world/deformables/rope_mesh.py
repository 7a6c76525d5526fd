"""Ropes: their points, segments and bending, in the terms of cloths.

A segment is a triangle whose second and third corners coincide: the search for pairs of vertices and triangles, and of edges,
also finds those of ropes. The curvature at an inner vertex is the difference of the tangents of both segments over the length
l that belongs to the vertex, half of each. It is a linear function H x of the positions x, as each tangent is an edge over
its length at rest, and the energy of bending is E I l |H x|^2 / 2, as that of cloth (`forces.bending`): a turn by theta counts
as 2 sin(theta / 2).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.deformables.forces.bending_couplings import Bending
from kickdrift.world.deformables.forces.highest_frequency import highest
from kickdrift.world.deformables.mesh import NONE, ClothMesh, vertices_of

Floats = NDArray[np.float64]

_SHORT = 1e-6  # ratio of a segment's length to the longest one below which it counts as zero


def rope_mesh(points: ArrayLike) -> ClothMesh:
    """Check the points of a rope, and return its segments as a mesh.

    Raises
    ------
    ArgumentError
        For numbers that are not finite, fewer than two points, and consecutive points that coincide; the message names the
        point.
    """
    places = vertices_of(points, "points", "point")
    if len(places) < 2:
        raise ArgumentError(f"points has {len(places)} row{'s' * (len(places) != 1)}; a rope needs two or more.")
    lengths = lengths_of(places)
    short = np.flatnonzero(~(lengths > _SHORT * lengths.max()))
    if short.size:
        raise ArgumentError(
            f"points {short[0]} and {short[0] + 1} are in one place, {places[short[0]]}; leave one out."
        )
    return segments(places)


def segments(places: Floats) -> ClothMesh:
    """Return the segments between consecutive points as a mesh."""
    first = np.arange(len(places) - 1)
    triangles = np.stack((first, first + 1, first + 1), axis=1)
    return ClothMesh(places, triangles, np.zeros((0, 4), dtype=np.int64), np.full((len(first), 3), NONE))


def lengths_of(places: Floats) -> Floats:
    """Return the lengths of the segments, m."""
    lengths: Floats = np.linalg.norm(np.diff(places, axis=0), axis=1)
    return lengths


def rope_bending(mesh: ClothMesh, pinned: NDArray[np.bool_]) -> tuple[Bending, Floats]:
    """Return the curvature at the inner vertices as a function of positions, and the lengths that belong to them, m.

    A segment whose ends are both pinned is clamped: it does not bend, and no half of it belongs to its ends. A beam of n
    segments, clamped at its end, then sags by 1 / (2 n^2) too much, and otherwise by 3 / (2 n).
    """
    lengths = lengths_of(mesh.vertices)
    bends = np.where(pinned[1:] & pinned[:-1], 0.0, lengths)
    own = 0.5 * (bends[1:] + bends[:-1])
    over = np.divide(1.0, own, where=own > 0.0, out=np.zeros_like(own))
    before, after = over / lengths[:-1], over / lengths[1:]
    rows = np.stack((before, -before - after, after), axis=1)[:, None]
    inner = np.arange(len(own))
    stencils = np.stack((inner, inner + 1, inner + 2), axis=1)
    return Bending(rows, stencils, np.zeros((len(own), 1))), own


def stretch_rate(lengths: Floats, stiffness: float, masses: Floats) -> float:
    """Return the highest angular frequency of a rope without tension, rad/s: that of a straight one, if it is bent lower."""
    rows = np.sqrt(stiffness / lengths)[:, None, None] * np.array([[-1.0, 1.0]])
    columns = np.stack((np.arange(len(lengths)), np.arange(1, len(masses))), axis=1)
    return highest(rows, columns, masses)


def rope_masses(lengths: Floats, density: float) -> Floats:
    """Return the masses of vertices, (N,), kg: half of those of their segments."""
    halves = 0.5 * density * lengths
    total: Floats = np.append(halves, 0.0) + np.append(0.0, halves)
    return total
