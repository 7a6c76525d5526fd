"""Faces of two polyhedra: as separating axes, and clipped by each other.

A polyhedron is given twice: by its numbers (`kickdrift.world.shapes.polyhedron`), and by header, vertices and planes in the
frame of the first shape of the contact (`seen`).
"""

from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, cross, dot, length, minus, times
from kickdrift.world.collision.narrow_phase.clipping import CORNER, LABEL, clip
from kickdrift.world.collision.narrow_phase.manifold_candidates import CANDIDATE, put_candidates
from kickdrift.world.collision.narrow_phase.shape_frames import directed, placed
from kickdrift.world.shapes.polyhedron import (
    EDGES,
    FACES,
    HEADER,
    MOST_VERTICES,
    PLANES_AT,
    VERTICES,
    edge,
    loop,
    loop_vertex,
    plane,
    support,
    vertex,
)

# Room for header, vertices and planes, and for candidates: a face of n sides clipped by one of m has up to n + m corners.
PLACED = HEADER + 3 * MOST_VERTICES + 4 * (2 * MOST_VERTICES - 4)
CANDIDATES = CANDIDATE * 2 * MOST_VERTICES

_POLYGON, _SPARE = CORNER * 2 * MOST_VERTICES, (CORNER + 1) * 2 * MOST_VERTICES + CORNER


@compiled
def place_polyhedron(seen: Any, numbers: Any, frame: Any) -> None:
    """Write header, vertices and planes of a polyhedron in the parent of its frame."""
    for k in range(HEADER):
        seen[k] = numbers[k]
    for k in range(int(numbers[VERTICES])):
        at = HEADER + 3 * k
        seen[at], seen[at + 1], seen[at + 2] = placed(frame, vertex(numbers, k))
    origin = (frame[9], frame[10], frame[11])
    for k in range(int(numbers[FACES])):
        at = int(numbers[PLANES_AT]) + 4 * k
        normal, offset = plane(numbers, k)
        normal = directed(frame, normal)
        seen[at], seen[at + 1], seen[at + 2] = normal
        seen[at + 3] = offset + dot(normal, origin)


@compiled
def separation_of_faces(a: Any, b: Any, margin: float) -> tuple[float, int]:
    """Find the largest separation along the face normals of a, and the face; stops at the first larger than the margin."""
    best, best_face = -np.inf, -1
    for k in range(int(a[FACES])):
        normal, offset = plane(a, k)
        gap = lowest(b, normal) - offset
        if gap > best:
            best, best_face = gap, k
            if gap > margin:
                break
    return best, best_face


@compiled(inline=True)
def lowest(numbers: Any, normal: Vector) -> float:
    """Return the smallest normal . x of all vertices."""
    least = np.inf
    for k in range(int(numbers[VERTICES])):
        least = min(least, dot(normal, vertex(numbers, k)))
    return least


@compiled
def incident_face(numbers: Any, seen: Any, normal: Vector) -> int:
    """Return the incident face for a reference face with a given normal.

    At the support vertex against the normal, take the edge that is most perpendicular to the normal, and of its two faces the
    one whose normal is most opposed.
    """
    if int(numbers[FACES]) == 1:
        return 0
    nearest = support(seen, times(-1.0, normal))
    flattest, face = np.inf, 0
    for k in range(int(numbers[EDGES])):
        begin, end, left, right = edge(numbers, k)
        if begin == nearest or end == nearest:
            way = minus(vertex(seen, end), vertex(seen, begin))
            rise = dot(way, normal)
            slope = rise * rise / dot(way, way)
            if slope < flattest:
                u, _ = plane(seen, left)
                v, _ = plane(seen, right)
                flattest, face = slope, left if dot(u, normal) < dot(v, normal) else right
    return face


@compiled
def clipped_face(
    reference: Any,
    reference_seen: Any,
    face: int,
    incident: Any,
    incident_seen: Any,
    other: int,
    second_is_reference: bool,
    margin: float,
    slack: float,
    candidates: Any,
) -> tuple[int, float]:
    """Clip a face of one polyhedron by the sides of a face of another; return as `put_candidates`."""
    normal, offset = plane(reference_seen, face)
    polygon, spare = floats_on_stack(_POLYGON), floats_on_stack(_SPARE)
    begin, end = loop(incident, other)
    count = end - begin
    for k in range(count):
        at = CORNER * k
        polygon[at], polygon[at + 1], polygon[at + 2] = vertex(incident_seen, loop_vertex(incident, begin + k))
        polygon[at + LABEL] = k
    begin, end = loop(reference, face)
    p = vertex(reference_seen, loop_vertex(reference, end - 1))
    for k in range(begin, end):
        q = vertex(reference_seen, loop_vertex(reference, k))
        side = minus(q, p)
        outward = times(1.0 / length(side), cross(side, normal))
        label = float(begin - k) if k > begin else float(begin - end)
        count = clip(polygon, count, spare, outward, dot(outward, p), slack, label)
        p = q
    return put_candidates(
        polygon, count, normal, offset, margin, reference, face, incident, other, second_is_reference, candidates
    )
