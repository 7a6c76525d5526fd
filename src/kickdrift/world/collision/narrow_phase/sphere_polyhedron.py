"""Contact of a ball and a convex polyhedron."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, times, turned, turned_back
from kickdrift.world.collision.narrow_phase.manifold_points import place, put_normal, put_point, turn
from kickdrift.world.shapes.closest_points import COINCIDENT, along, clamped
from kickdrift.world.shapes.polyhedron import EDGES, FACES, edge, loop, loop_vertex, plane, vertex

NONE = -1


@compiled
def sphere_hull(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact point of a ball and a polyhedron; see `kickdrift.world.collision.narrow_phase`.

    If the centre is inside, the normal is that of the nearest face.
    """
    q, radius = turn(pose), a[0]
    centre = turned_back(q, times(-1.0, place(pose)))  # of the ball in the polyhedron's frame
    face, height = _highest(b, centre)
    if height - radius > margin:
        return 0
    normal, _ = plane(b, face)
    y = along(centre, -height, normal)
    if height > 0.0 and not over_face(b, face, centre):
        face, height = nearest_face(b, centre)
        at_edge, distance = _nearest_on_edges(b, centre)
        if face != NONE and height <= distance:
            normal, _ = plane(b, face)
            y = along(centre, -height, normal)
        elif distance - radius > margin:
            return 0
        elif distance > COINCIDENT * (radius + length(centre)):
            normal, y = times(1.0 / distance, minus(centre, at_edge)), at_edge
    inward = turned(q, times(-1.0, normal))
    put_normal(manifold, inward)
    put_point(manifold, 0, times(radius, inward), y, 0)
    return 1


@compiled(inline=True)
def height_over(numbers: Any, face: int, p: Vector) -> float:
    """Return the signed distance of a point from the plane of a face."""
    normal, offset = plane(numbers, face)
    return dot(normal, p) - offset


@compiled
def _highest(numbers: Any, p: Vector) -> tuple[int, float]:
    """Return the face whose plane a point is farthest above, and its signed distance."""
    best, chosen = -math.inf, 0
    for face in range(int(numbers[FACES])):
        height = height_over(numbers, face, p)
        if height > best:
            best, chosen = height, face
    return chosen, best


@compiled
def over_face(numbers: Any, face: int, p: Vector) -> bool:
    """Whether a point is straight above or below a face."""
    normal, _ = plane(numbers, face)
    first, last = loop(numbers, face)
    start = vertex(numbers, loop_vertex(numbers, last - 1))
    for entry in range(first, last):
        to = vertex(numbers, loop_vertex(numbers, entry))
        if dot(cross(normal, minus(to, start)), minus(p, start)) < 0.0:
            return False
        start = to
    return True


@compiled
def nearest_face(numbers: Any, p: Vector) -> tuple[int, float]:
    """Return the nearest face that an outside point is straight above, and its height; `NONE` and infinity without any."""
    best, chosen = math.inf, NONE
    for face in range(int(numbers[FACES])):
        height = height_over(numbers, face, p)
        if 0.0 < height < best and over_face(numbers, face, p):
            best, chosen = height, face
    return chosen, best


@compiled
def _nearest_on_edges(numbers: Any, p: Vector) -> tuple[Vector, float]:
    """Return the nearest point on the edges of a polyhedron, and its distance."""
    best, nearest = math.inf, p
    for k in range(int(numbers[EDGES])):
        begin, end, _, _ = edge(numbers, k)
        start = vertex(numbers, begin)
        to = minus(vertex(numbers, end), start)
        y = along(start, clamped(dot(minus(p, start), to) / dot(to, to), 0.0, 1.0), to)
        out = minus(p, y)
        if dot(out, out) < best:
            best, nearest = dot(out, out), y
    return nearest, math.sqrt(best)
