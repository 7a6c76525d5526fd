"""Contact points of a frustum and a polyhedron: on a face, on an end of the frustum, or at an edge.

Positions are in the frame of the frustum, the second shape. The polyhedron is given twice: by its numbers, and by its vertices
and planes in that frame (`kickdrift.world.collision.narrow_phase.sat_faces`).
"""

import math
from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, cross, dot, length, minus, plus, times
from kickdrift.world.collision.narrow_phase.capsule_manifold import FLAT, STEEP
from kickdrift.world.collision.narrow_phase.clipping import CORNER, LABEL, clip
from kickdrift.world.collision.narrow_phase.face_bias import SLACK
from kickdrift.world.collision.narrow_phase.frustum_round import FLAT_ON, along_frustum, lowest_direction
from kickdrift.world.collision.narrow_phase.manifold_candidates import CANDIDATE, FEATURES, SEPARATION, put_candidate
from kickdrift.world.collision.narrow_phase.manifold_points import put_normal, put_point
from kickdrift.world.collision.narrow_phase.manifold_reduction import choose
from kickdrift.world.collision.narrow_phase.sat_faces import incident_face
from kickdrift.world.collision.narrow_phase.shape_frames import directed_back, placed, placed_back
from kickdrift.world.columns import point_at
from kickdrift.world.contacts.layout import LOAD
from kickdrift.world.shapes.closest_points import along
from kickdrift.world.shapes.frustum import Frustum, highest, side_normal
from kickdrift.world.shapes.polyhedron import MOST_VERTICES, loop, loop_vertex, plane, vertex

SIDES = 24  # of the polygon that approximates a rim
_ANGLES = np.arange(SIDES) * (2.0 * math.pi / SIDES)
_COS, _SIN = np.cos(_ANGLES), np.sin(_ANGLES)
COS_BETWEEN, SIN_BETWEEN = np.cos(_ANGLES + math.pi / SIDES), np.sin(_ANGLES + math.pi / SIDES)
_INNER = math.cos(math.pi / SIDES)  # radius of its incircle

_CORNERS = SIDES + MOST_VERTICES
_POLYGON, _SPARE, _CANDIDATES = CORNER * _CORNERS, (CORNER + 1) * _CORNERS + CORNER, CANDIDATE * _CORNERS
_BALANCED = 2e-4  # of the radius: differences in depth of the points of a leaning rim below this do not count
_OF_LABELS, _OF_EDGES, _ENDS = 512, 1 << 20, 256


@compiled
def lie_on_face(
    f: Frustum, body: Any, seen: Any, face: int, tolerance: float, margin: float, frame: Any, manifold: Any
) -> tuple[int, float]:
    """Write the contact points of a frustum on a face; return their number, and the smallest separation."""
    normal, offset = plane(seen, face)
    sine, x, y = lowest_direction(times(-1.0, normal), FLAT_ON)
    upper = normal[2] < 0.0
    radius, z = (f[1], f[2]) if upper else (f[0], -f[2])
    polygon, spare, candidates = floats_on_stack(_POLYGON), floats_on_stack(_SPARE), floats_on_stack(_CANDIDATES)
    slack = SLACK * tolerance
    c, s = side_normal(f)
    lies = -(normal[0] * x + normal[1] * y) * c - normal[2] * s > FLAT
    if sine < STEEP and radius > 0.0:
        for k in range(SIDES):
            u, v = x * _COS[k] - y * _SIN[k], x * _SIN[k] + y * _COS[k]
            _put_corner(polygon, k, (radius * u, radius * v, z), k)
        count = _clip_by_face(polygon, SIDES, spare, body, seen, face, slack)
    elif lies:
        count = _clip_line(polygon, (f[0] * x, f[0] * y, -f[2]), (f[1] * x, f[1] * y, f[2]), body, seen, face, slack)
    else:
        at = 1.0 if f[1] * sine - f[2] * normal[2] >= f[0] * sine + f[2] * normal[2] else -1.0
        r = f[1] if at > 0.0 else f[0]
        p = (r * x, r * y, at * f[2])
        count = _clip_line(polygon, p, p, body, seen, face, slack)
    kept, depth = 0, margin
    for k in range(count):
        p = (polygon[CORNER * k], polygon[CORNER * k + 1], polygon[CORNER * k + 2])
        gap = dot(normal, p) - offset
        if gap <= margin:
            before = polygon[CORNER * (k - 1 if k > 0 else count - 1) + LABEL]
            feature = int(before + _ENDS) * _OF_LABELS + int(polygon[CORNER * k + LABEL] + _ENDS)
            put_candidate(candidates, CANDIDATE * kept, p, gap, feature)
            kept, depth = kept + 1, min(depth, gap)
    chosen = floats_on_stack(4)
    tolerance = tolerance if sine < FLAT_ON else _BALANCED * radius
    kept = choose(candidates, kept, normal, tolerance, placed(frame, point_at(manifold, LOAD)), manifold, chosen)
    for k in range(kept):
        i = CANDIDATE * int(chosen[k])
        p = (candidates[i], candidates[i + 1], candidates[i + 2])
        gap, feature = candidates[i + SEPARATION], int(candidates[i + FEATURES])
        put_point(manifold, k, placed_back(frame, along(p, -gap, normal)), p, feature)
    put_normal(manifold, directed_back(frame, normal))
    return kept, depth


@compiled
def stand_on_end(
    f: Frustum, upper: bool, body: Any, seen: Any, tolerance: float, margin: float, frame: Any, manifold: Any
) -> tuple[int, float]:
    """Write the contact points of a polyhedron on an end of a frustum; return as `lie_on_face`."""
    normal = (0.0, 0.0, 1.0 if upper else -1.0)
    radius = f[1] if upper else f[0]
    polygon, spare, candidates = floats_on_stack(_POLYGON), floats_on_stack(_SPARE), floats_on_stack(_CANDIDATES)
    begin, end = loop(body, incident_face(body, seen, normal))
    count = end - begin
    for k in range(count):
        number = loop_vertex(body, begin + k)
        _put_corner(polygon, k, vertex(seen, number), number)
    for k in range(SIDES):
        out = (COS_BETWEEN[k], SIN_BETWEEN[k], 0.0)
        count = clip(polygon, count, spare, out, radius * _INNER, 0.0, -1.0 - k)
    kept, depth = 0, margin
    for k in range(count):
        p = (polygon[CORNER * k], polygon[CORNER * k + 1], polygon[CORNER * k + 2])
        gap = dot(normal, p) - f[2]
        if gap <= margin:
            before = polygon[CORNER * (k - 1 if k > 0 else count - 1) + LABEL]
            feature = int(before + _ENDS) * _OF_LABELS + int(polygon[CORNER * k + LABEL] + _ENDS)
            put_candidate(candidates, CANDIDATE * kept, p, gap, feature)
            kept, depth = kept + 1, min(depth, gap)
    chosen = floats_on_stack(4)
    kept = choose(candidates, kept, normal, tolerance, placed(frame, point_at(manifold, LOAD)), manifold, chosen)
    for k in range(kept):
        i = CANDIDATE * int(chosen[k])
        p = (candidates[i], candidates[i + 1], candidates[i + 2])
        gap, feature = candidates[i + SEPARATION], int(candidates[i + FEATURES])
        put_point(manifold, k, placed_back(frame, p), along(p, -gap, normal), feature)
    put_normal(manifold, directed_back(frame, times(-1.0, normal)))
    return kept, depth


@compiled
def touch_edge(
    f: Frustum,
    start: Vector,
    end: Vector,
    number: int,
    t: float,
    normal: Vector,
    margin: float,
    frame: Any,
    manifold: Any,
) -> int:
    """Write the contact points of an edge and a frustum, along a normal from the frustum to the edge; return their number.

    The point is the deepest one, at the fraction t of the edge; if the edge lies on an end or along a line of the side, the
    points are both ends of the range that does.
    """
    middle, way = times(0.5, plus(start, end)), times(0.5, minus(end, start))
    half = length(way)
    axis = times(1.0 / max(half, 1e-300), way)
    at = (2.0 * t - 1.0) * half
    x = along(middle, at, axis)
    y = along(x, highest(f, normal) - dot(normal, x), normal)
    contact = along_frustum(f, (middle, axis, half), max(f[0], f[1]), normal, at, y)
    count = 0
    for k in range(contact[0]):
        at, y = (contact[1], contact[2]) if k == 0 else (contact[3], contact[4])
        x = along(middle, at, axis)
        if dot(normal, minus(x, y)) <= margin:
            feature = _OF_EDGES + 4 * number + (k if contact[0] == 2 else 2)
            put_point(manifold, count, placed_back(frame, x), y, feature)
            count += 1
    put_normal(manifold, directed_back(frame, times(-1.0, normal)))
    return count


@compiled(inline=True)
def _put_corner(polygon: Any, k: int, point: Vector, label: float) -> None:
    at = CORNER * k
    polygon[at], polygon[at + 1], polygon[at + 2] = point
    polygon[at + LABEL] = label


@compiled(inline=True)
def _side_of(body: Any, seen: Any, entry: int, begin: int, end: int, normal: Vector) -> tuple[Vector, float]:
    """Return the plane of a side of a face: its outward unit normal and offset."""
    p = vertex(seen, loop_vertex(body, entry))
    q = vertex(seen, loop_vertex(body, entry + 1 if entry + 1 < end else begin))
    side = minus(q, p)
    outward = times(1.0 / length(side), cross(side, normal))
    return outward, dot(outward, p)


@compiled
def _clip_by_face(polygon: Any, count: int, spare: Any, body: Any, seen: Any, face: int, slack: float) -> int:
    """Clip a polygon to the part above a face; return the number of corners."""
    normal, _ = plane(seen, face)
    begin, end = loop(body, face)
    for entry in range(begin, end):
        outward, offset = _side_of(body, seen, entry, begin, end, normal)
        count = clip(polygon, count, spare, outward, offset, slack, float(begin - entry - 1))
    return count


@compiled
def _clip_line(polygon: Any, p: Vector, q: Vector, body: Any, seen: Any, face: int, slack: float) -> int:
    """Write the ends of the part of a segment above a face, or one if the segment is a point; return their number."""
    normal, _ = plane(seen, face)
    begin, end = loop(body, face)
    low, high, first, last = 0.0, 1.0, float(SIDES), float(SIDES + 1)
    for entry in range(begin, end):
        outward, offset = _side_of(body, seen, entry, begin, end, normal)
        here, there = dot(outward, p) - offset, dot(outward, q) - offset
        if here > slack and there > slack:
            return 0
        if here > slack and here / (here - there) > low:
            low, first = here / (here - there), float(begin - entry - 1)
        if there > slack and here / (here - there) < high:
            high, last = here / (here - there), float(begin - entry - 1)
    if low > high:
        return 0
    way = minus(q, p)
    _put_corner(polygon, 0, along(p, low, way), first)
    if dot(way, way) == 0.0:
        return 1
    _put_corner(polygon, 1, along(p, high, way), last)
    return 2
