"""The vertex beside the incident face on which a body that rocks lands next.

Faces of a hull may be nearly parallel, and a body that rocks from one to the next turns farther in a step than the angle
between them. With the corners of one face alone the next would sink in and be pushed out again, for ever.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, minus
from kickdrift.world.collision.narrow_phase.manifold_candidates import CANDIDATE, SEPARATION
from kickdrift.world.shapes.polyhedron import FACES, loop, loop_vertex, plane, vertex

_NEARLY_PARALLEL = math.cos(0.1)


@compiled
def vertex_beside(
    incident: Any, seen: Any, other: int, reference: Any, reference_seen: Any, face: int, normal: Vector, offset: float
) -> tuple[int, float]:
    """Find the nearest vertex of the faces that are nearly parallel to the reference face, and between its sides.

    Parameters
    ----------
    incident, seen, other
        Numbers of the polyhedron, these in the frame of the first shape, and its incident face, whose corners do not count.
    reference, reference_seen, face
        The same of the polyhedron with the reference face; the face is -1 for a half-space.
    normal, offset
        Plane of the reference face.

    Returns
    -------
    number : int
        -1 if there is none.
    separation : float
        m.
    """
    nearest, least = -1, math.inf
    for k in range(int(seen[FACES])):
        outward, _ = plane(seen, k)
        if k == other or dot(outward, normal) > -_NEARLY_PARALLEL:
            continue
        begin, end = loop(incident, k)
        for entry in range(begin, end):
            number = loop_vertex(incident, entry)
            point = vertex(seen, number)
            gap = dot(normal, point) - offset
            if gap >= least or _is_corner(incident, other, number):
                continue
            if _is_over(reference, reference_seen, face, normal, point):
                nearest, least = number, gap
    return nearest, least


@compiled
def add_to_chosen(candidates: Any, new: int, chosen: Any, count: int) -> int:
    """Add a candidate to those chosen; of four it replaces the one farthest away, if that is farther.

    Returns
    -------
    int
        Number of candidates chosen.
    """
    if count < 4:
        chosen[count] = new
        return count + 1
    farthest = 0
    for k in range(1, 4):
        if _separation(candidates, int(chosen[k])) > _separation(candidates, int(chosen[farthest])):
            farthest = k
    if _separation(candidates, new) < _separation(candidates, int(chosen[farthest])):
        chosen[farthest] = new
    return 4


@compiled(inline=True)
def _separation(candidates: Any, k: int) -> float:
    separation: float = candidates[CANDIDATE * k + SEPARATION]
    return separation


@compiled(inline=True)
def _is_corner(numbers: Any, face: int, number: int) -> bool:
    begin, end = loop(numbers, face)
    found = False
    for k in range(begin, end):
        found |= loop_vertex(numbers, k) == number
    return found


@compiled
def _is_over(numbers: Any, seen: Any, face: int, normal: Vector, point: Vector) -> bool:
    """Whether a point is between the sides that stand on the edges of a face."""
    if face < 0:
        return True
    begin, end = loop(numbers, face)
    p = vertex(seen, loop_vertex(numbers, end - 1))
    for k in range(begin, end):
        q = vertex(seen, loop_vertex(numbers, k))
        if dot(cross(minus(q, p), normal), minus(point, p)) > 0.0:
            return False
        p = q
    return True
