"""Contact of two boxes: separating axis test with fifteen axes, then face against face or edge against edge.

The axes are the face normals of both boxes and the products of their edges (Gottschalk, Lin and Manocha 1996, section
5). Vertices, faces and edges are numbered as in `kickdrift.world.collision.narrow_phase.box_as_polyhedron`.
"""

import math
from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, cross, dot, length, times
from kickdrift.world.collision.narrow_phase.box_as_polyhedron import (
    EDGE_ALONG,
    UNIT_BOX,
    axis_of,
    corner_of,
    facing,
    normal_of,
    put_face,
)
from kickdrift.world.collision.narrow_phase.clipping import CORNER, clip
from kickdrift.world.collision.narrow_phase.face_bias import PARALLEL, SHARE_OFF, SLACK, tolerance_of
from kickdrift.world.collision.narrow_phase.manifold_candidates import CANDIDATE, put_candidates, put_manifold
from kickdrift.world.collision.narrow_phase.manifold_reduction import choose
from kickdrift.world.collision.narrow_phase.sat_edges import EDGE, put_closest, put_edges, put_row
from kickdrift.world.collision.narrow_phase.shape_frames import set_at_rest, set_frame
from kickdrift.world.columns import point_at
from kickdrift.world.contacts.layout import LOAD
from kickdrift.world.shapes.polyhedron import EDGES, edge, loop_edge

# Room for a face clipped by another, and for all edges
_POLYGON, _SPARE, _CANDIDATES, _EDGES = 8 * CORNER, 7 + 9 * CORNER, 8 * CANDIDATE, 12 * EDGE

Separations = tuple[float, int, float, int, float, int]


@compiled
def box_box(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of two boxes; see `kickdrift.world.collision.narrow_phase`."""
    frame = floats_on_stack(12)
    set_frame(frame, pose)
    gap_a, face_a, gap_b, face_b, gap_edges, pair = _separations(a, b, frame, margin)
    gap = max(gap_a, gap_b, gap_edges)
    if gap > margin:
        return 0
    rest, candidates, chosen = floats_on_stack(12), floats_on_stack(_CANDIDATES), floats_on_stack(4)
    set_at_rest(rest)
    tolerance = tolerance_of(margin, min(a[0], a[1], a[2], b[0], b[1], b[2]))
    off = SHARE_OFF * abs(gap) + tolerance
    b_first = gap_b > gap_a + off
    for attempt in range(4):
        if attempt == 2:
            crossed = pair if gap_edges > gap - off else -1
            axis = normal_of(rest, face_a) if gap_a >= gap_b else times(-1.0, normal_of(frame, face_b))
            count = _edge_contact(a, b, rest, frame, crossed, axis, gap > 0.0, tolerance, margin, manifold)
            if count > 0 or gap > 0.0:
                return count
        by_b = b_first != (attempt % 2 == 1)
        if attempt < 2 and (gap_b if by_b else gap_a) < gap - off:
            continue
        own, own_frame, face, other, other_frame = (b, frame, face_b, a, rest) if by_b else (a, rest, face_a, b, frame)
        count, depth = _clipped(own, own_frame, face, other, other_frame, by_b, margin, SLACK * tolerance, candidates)
        if count > 0 and (attempt >= 2 or abs(depth - gap) <= off):
            normal = normal_of(own_frame, face)
            count = choose(candidates, count, normal, tolerance, point_at(manifold, LOAD), manifold, chosen)
            put_manifold(manifold, candidates, chosen, count, normal, frame, by_b)
            return count
    return 0


@compiled
def _separations(a: Any, b: Any, frame: Any, margin: float) -> Separations:
    """Find the largest separation along the normals of each box and along the products of edges.

    Each is followed by its feature: the face of the box towards the other one, or, for edges, three times the axis of a plus
    that of b. Stops at the first separation that is larger than the margin.
    """
    gap_a, face_a, gap_b, face_b, gap_edges, pair = -np.inf, 0, -np.inf, 0, -np.inf, -1
    for i in range(3):
        at = 3 * i
        reach = a[i] + abs(frame[at]) * b[0] + abs(frame[at + 1]) * b[1] + abs(frame[at + 2]) * b[2]
        gap = abs(frame[9 + i]) - reach
        if gap > gap_a:
            gap_a, face_a = gap, 2 * i + 1 if frame[9 + i] >= 0.0 else 2 * i
            if gap > margin:
                return gap_a, face_a, gap_b, face_b, gap_edges, pair
    for j in range(3):
        x, y, z = frame[j], frame[3 + j], frame[6 + j]
        way = frame[9] * x + frame[10] * y + frame[11] * z
        gap = abs(way) - (abs(x) * a[0] + abs(y) * a[1] + abs(z) * a[2] + b[j])
        if gap > gap_b:
            gap_b, face_b = gap, 2 * j if way >= 0.0 else 2 * j + 1
            if gap > margin:
                return gap_a, face_a, gap_b, face_b, gap_edges, pair
    for i in range(3):
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            j1, j2 = (j + 1) % 3, (j + 2) % 3
            p, q = frame[3 * i1 + j], frame[3 * i2 + j]  # the product of the edges is (0, -q, p) on the axes i, i1, i2
            square = p * p + q * q
            if square > PARALLEL:
                reach_a = abs(q) * a[i1] + abs(p) * a[i2]
                reach_b = abs(frame[3 * i + j2]) * b[j1] + abs(frame[3 * i + j1]) * b[j2]
                gap = (abs(frame[9 + i2] * p - frame[9 + i1] * q) - reach_a - reach_b) / math.sqrt(square)
                if gap > gap_edges:
                    gap_edges, pair = gap, 3 * i + j
                    if gap > margin:
                        return gap_a, face_a, gap_b, face_b, gap_edges, pair
    return gap_a, face_a, gap_b, face_b, gap_edges, pair


@compiled
def _clipped(
    reference: Any,
    reference_frame: Any,
    face: int,
    incident: Any,
    incident_frame: Any,
    second_is_reference: bool,
    margin: float,
    slack: float,
    candidates: Any,
) -> tuple[int, float]:
    """Clip the incident face of one box by a face of the other; return as `put_candidates`."""
    normal = normal_of(reference_frame, face)
    other = facing(incident_frame, normal)
    polygon, spare = floats_on_stack(_POLYGON), floats_on_stack(_SPARE)
    count = put_face(incident, incident_frame, other, polygon)
    origin = (reference_frame[9], reference_frame[10], reference_frame[11])
    for k in range(4):
        _, _, left, right = edge(UNIT_BOX, loop_edge(UNIT_BOX, 4 * face + k))
        side = left + right - face
        outward = normal_of(reference_frame, side)
        count = clip(polygon, count, spare, outward, dot(outward, origin) + reference[side // 2], slack, -1.0 - k)
    offset = dot(normal, origin) + reference[face // 2]
    return put_candidates(
        polygon, count, normal, offset, margin, UNIT_BOX, face, UNIT_BOX, other, second_is_reference, candidates
    )


@compiled
def _put_all_edges(half: Any, frame: Any, edges: Any) -> int:
    """Write all edges of a box as rows for `sat_edges`, without normals; return how many."""
    count = int(UNIT_BOX[EDGES])
    for k in range(count):
        begin, end, _, _ = edge(UNIT_BOX, k)
        put_row(edges, k, corner_of(half, frame, begin), corner_of(half, frame, end), k)
    return count


@compiled
def _edge_contact(
    a: Any,
    b: Any,
    rest: Any,
    frame: Any,
    pair: int,
    axis: Vector,
    apart: bool,
    tolerance: float,
    margin: float,
    manifold: Any,
) -> int:
    """Write the contact point of the edges along a pair of axes, or else, if the boxes are apart, of their closest edges.

    `axis` is the face normal of largest separation, from a to b. Returns the number of points.
    """
    edges_a, edges_b = floats_on_stack(_EDGES), floats_on_stack(_EDGES)
    count_a, count_b = _put_all_edges(a, rest, edges_a), _put_all_edges(b, frame, edges_b)
    if pair >= 0:
        i, j = pair // 3, pair % 3
        product = cross(axis_of(rest, i), axis_of(frame, j))
        towards = dot(product, (frame[9], frame[10], frame[11]))
        axis = times(math.copysign(1.0 / length(product), towards), product)
        own = EDGE_ALONG[i, _farthest(rest, axis)]
        other = EDGE_ALONG[j, _farthest(frame, times(-1.0, axis))]
        count = put_edges(edges_a, own, edges_b, other, axis, 0.0 if apart else tolerance, frame, manifold)
        if count > 0:
            return count
    if apart:
        return put_closest(edges_a, count_a, count_a, edges_b, count_b, axis, frame, margin, manifold)
    return 0


@compiled(inline=True)
def _farthest(frame: Any, direction: Vector) -> int:
    """Return the support vertex of a box in a direction."""
    number = 0
    for k in range(3):
        if dot(direction, axis_of(frame, k)) > 0.0:
            number += 1 << k
    return number
