"""Vertices, edges and faces of boxes, numbered as in the polyhedron of a box."""

from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, times
from kickdrift.world.collision.narrow_phase.clipping import CORNER, LABEL
from kickdrift.world.collision.narrow_phase.shape_frames import placed
from kickdrift.world.shapes.polyhedron import (
    EDGES_AT,
    HEADER,
    PLANES_AT,
    THICKNESS,
    loop,
    loop_vertex,
    polyhedron_numbers,
    vertex,
)

# Vertex m is on the upper side of axis k if bit k of m is set; face 2 k is the lower side of axis k, 2 k + 1 the upper.
_CORNERS = np.array([[2.0 * (m >> k & 1) - 1.0 for k in range(3)] for m in range(8)])
_LOOPS = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))

UNIT_BOX = polyhedron_numbers(_CORNERS, _LOOPS)
SIZE_OF_BOX = len(UNIT_BOX)

_ENDS = [{int(row[0]), int(row[1])} for row in UNIT_BOX[int(UNIT_BOX[EDGES_AT]) :].reshape(12, 4)]

# The edge along an axis that ends at a vertex
EDGE_ALONG = np.array(
    [[next(k for k in range(12) if _ENDS[k] == {m, m ^ 1 << axis}) for m in range(8)] for axis in range(3)]
)

_PLANES = int(UNIT_BOX[PLANES_AT])


@compiled
def set_box(numbers: Any, half: Any) -> None:
    """Write the polyhedron of a box with the given half extents."""
    for k in range(SIZE_OF_BOX):
        numbers[k] = UNIT_BOX[k]
    for m in range(8):
        for k in range(3):
            numbers[HEADER + 3 * m + k] *= half[k]
    for face in range(6):
        numbers[_PLANES + 4 * face + 3] = half[face // 2]
    numbers[THICKNESS] = min(half[0], half[1], half[2])


@compiled(inline=True)
def axis_of(frame: Any, k: int) -> Vector:
    """Return the k-th axis of a frame."""
    return (frame[k], frame[3 + k], frame[6 + k])


@compiled(inline=True)
def normal_of(frame: Any, face: int) -> Vector:
    """Return the outward normal of a face of a box."""
    return times(1.0 if face % 2 == 1 else -1.0, axis_of(frame, face // 2))


@compiled(inline=True)
def corner_of(half: Any, frame: Any, number: int) -> Vector:
    """Return a vertex of a box."""
    x, y, z = vertex(UNIT_BOX, number)
    return placed(frame, (x * half[0], y * half[1], z * half[2]))


@compiled
def facing(frame: Any, normal: Vector) -> int:
    """Return the face of a box whose outward normal is closest to the opposite of a direction."""
    face, most = 0, -1.0
    for k in range(3):
        along = dot(normal, axis_of(frame, k))
        if abs(along) > most:
            face, most = 2 * k if along > 0.0 else 2 * k + 1, abs(along)
    return face


@compiled
def put_face(half: Any, frame: Any, face: int, polygon: Any) -> int:
    """Write the corners of a face of a box as a polygon for `clip`; return their number."""
    begin, end = loop(UNIT_BOX, face)
    for k in range(end - begin):
        at = CORNER * k
        polygon[at], polygon[at + 1], polygon[at + 2] = corner_of(half, frame, loop_vertex(UNIT_BOX, begin + k))
        polygon[at + LABEL] = k
    return end - begin
