"""Candidates of a contact, from which the points of its manifold are chosen, and the manifold of those that are.

A candidate is a point of the incident face, a row of `CANDIDATE` numbers.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, minus, times
from kickdrift.world.collision.narrow_phase.clipping import CORNER, LABEL, between
from kickdrift.world.collision.narrow_phase.manifold_points import put_normal, put_point
from kickdrift.world.collision.narrow_phase.shape_frames import placed_back
from kickdrift.world.columns import Fields
from kickdrift.world.shapes.polyhedron import MOST_VERTICES, loop, loop_edge, loop_vertex

# Numbers of a candidate
_CANDIDATE = Fields()
_CANDIDATE.field(3, "m")  # the point, in the frame of the first shape
SEPARATION = _CANDIDATE.field(1, "m")  # from the reference face
FEATURES = _CANDIDATE.field()  # id of the features that meet there
CANDIDATE = _CANDIDATE.close()


@compiled(inline=True)
def crossing(edge_a: int, edge_b: int) -> int:
    """Return the feature id of two edges that touch."""
    return 256 + 512 * edge_a + edge_b


@compiled
def corner_feature(
    reference: Any, face: int, incident: Any, other: int, before: float, after: float, second_is_reference: bool
) -> int:
    """Return the feature id of a corner of a clipped face, between two labels.

    The id of a vertex of the second polyhedron is its number, that of a vertex of the first its number plus 128, and that of
    two edges their `crossing`.
    """
    first, last = loop(reference, face)
    begin, end = loop(incident, other)
    low, high = int(min(before, after)), int(max(before, after))
    if low >= 0:
        vertex = loop_vertex(incident, begin + between(int(before), int(after), end - begin))
        return vertex + MOST_VERTICES if second_is_reference else vertex
    if high < 0:
        vertex = loop_vertex(reference, first + between(-1 - int(before), -1 - int(after), last - first))
        return vertex if second_is_reference else vertex + MOST_VERTICES
    own, met = loop_edge(reference, first - 1 - low), loop_edge(incident, begin + high)
    return crossing(met, own) if second_is_reference else crossing(own, met)


@compiled(inline=True)
def put_candidate(candidates: Any, at: int, point: Vector, gap: float, feature: int) -> None:
    """Write a candidate at a given index."""
    candidates[at], candidates[at + 1], candidates[at + 2] = point
    candidates[at + SEPARATION], candidates[at + FEATURES] = gap, feature


@compiled
def put_candidates(
    polygon: Any,
    count: int,
    normal: Vector,
    offset: float,
    margin: float,
    reference: Any,
    face: int,
    incident: Any,
    other: int,
    second_is_reference: bool,
    candidates: Any,
) -> tuple[int, float]:
    """Write the corners of a clipped face that are within the margin of the reference face.

    Returns
    -------
    count : int
        Number of candidates.
    depth : float
        Their smallest separation, m.
    """
    kept, depth = 0, margin
    for k in range(count):
        at = CORNER * k
        point = (polygon[at], polygon[at + 1], polygon[at + 2])
        gap = dot(normal, point) - offset
        if gap <= margin:
            before, after = polygon[CORNER * (k - 1 if k > 0 else count - 1) + LABEL], polygon[at + LABEL]
            feature = corner_feature(reference, face, incident, other, before, after, second_is_reference)
            put_candidate(candidates, CANDIDATE * kept, point, gap, feature)
            kept, depth = kept + 1, min(depth, gap)
    return kept, depth


@compiled(inline=True)
def point_of(candidates: Any, k: int) -> Vector:
    """Return the point of a candidate."""
    at = CANDIDATE * k
    return (candidates[at], candidates[at + 1], candidates[at + 2])


@compiled
def put_manifold(
    manifold: Any, candidates: Any, chosen: Any, count: int, normal: Vector, frame: Any, second_is_reference: bool
) -> None:
    """Write the chosen candidates as the points of a manifold.

    Parameters
    ----------
    manifold : array
        See `kickdrift.world.collision.narrow_phase`.
    candidates, chosen, count
        See `choose`.
    normal : (3,) tuple
        Outward unit normal of the reference face in the frame of the first shape.
    frame : pointer to floats
        Frame of the second shape in the first's.
    second_is_reference : bool
        Whether the reference face belongs to the second shape, and the incident face to the first.
    """
    for k in range(count):
        at = CANDIDATE * int(chosen[k])
        point = (candidates[at], candidates[at + 1], candidates[at + 2])
        under = minus(point, times(candidates[at + SEPARATION], normal))
        on_a, on_b = (point, under) if second_is_reference else (under, point)
        put_point(manifold, k, on_a, placed_back(frame, on_b), int(candidates[at + FEATURES]))
    put_normal(manifold, times(-1.0 if second_is_reference else 1.0, normal))
