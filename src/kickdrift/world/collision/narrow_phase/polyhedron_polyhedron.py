"""Contact of two convex polyhedra: the separating axis test, then face against face or edge against edge.

Gregorius, The Separating Axis Test between Convex Polyhedra (Game Developers Conference 2013).
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, times
from kickdrift.world.collision.narrow_phase.box_as_polyhedron import SIZE_OF_BOX, set_box
from kickdrift.world.collision.narrow_phase.face_bias import SHARE_OFF, SLACK, tolerance_of
from kickdrift.world.collision.narrow_phase.manifold_candidates import CANDIDATE, put_candidate, put_manifold
from kickdrift.world.collision.narrow_phase.manifold_reduction import choose
from kickdrift.world.collision.narrow_phase.rocking_vertex import add_to_chosen, vertex_beside
from kickdrift.world.collision.narrow_phase.sat_edges import (
    EDGE,
    count_below,
    edges_beyond,
    put_closest,
    put_edges,
    separation_of_edges,
)
from kickdrift.world.collision.narrow_phase.sat_faces import (
    CANDIDATES,
    PLACED,
    clipped_face,
    incident_face,
    place_polyhedron,
    separation_of_faces,
)
from kickdrift.world.collision.narrow_phase.shape_frames import set_frame
from kickdrift.world.columns import point_at
from kickdrift.world.contacts.layout import LOAD
from kickdrift.world.shapes.polyhedron import MOST_EDGES, MOST_VERTICES, PUSHING, THICKNESS, plane, pointer_to, vertex

_EDGES = EDGE * MOST_EDGES


@compiled
def hull_hull(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of two hulls; see `kickdrift.world.collision.narrow_phase`."""
    return polyhedron_polyhedron(pointer_to(a), pointer_to(b), pose, margin, manifold)


@compiled
def box_hull(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a box and a hull; see `kickdrift.world.collision.narrow_phase`."""
    box = floats_on_stack(SIZE_OF_BOX)
    set_box(box, a)
    return polyhedron_polyhedron(box, pointer_to(b), pose, margin, manifold)


@compiled
def polyhedron_polyhedron(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of two polyhedra, given by pointers to their numbers."""
    frame, b_seen = floats_on_stack(12), floats_on_stack(PLACED)
    set_frame(frame, pose)
    place_polyhedron(b_seen, b, frame)
    gap_a, face_a = separation_of_faces(a, b_seen, margin)
    if gap_a > margin:
        return 0
    gap_b, face_b = separation_of_faces(b_seen, a, margin)
    if gap_b > margin:
        return 0
    return touching(a, b, b_seen, frame, gap_a, face_a, gap_b, face_b, max(gap_a, gap_b), 0.0, margin, manifold)


@compiled
def touching(
    a: Any,
    b: Any,
    b_seen: Any,
    frame: Any,
    gap_a: float,
    face_a: int,
    gap_b: float,
    face_b: int,
    apart: float,
    behind: float,
    margin: float,
    manifold: Any,
) -> int:
    """Find the contact points of two polyhedra that no face separates by more than the margin.

    Parameters
    ----------
    a, b : pointers to floats
        Numbers of the polyhedra.
    b_seen, frame : pointers to floats
        Vertices and planes of the second in the first's frame, and its frame.
    gap_a, face_a, gap_b, face_b
        Largest separation along the face normals of each, and the face; -1 if no face counts.
    apart : float
        Largest separation along any face normal, including those along which no impulse is allowed, m.
    behind : float
        Depth that points may have although the two are separated, as for a body just behind a triangle, m.
    margin, manifold
        See `kickdrift.world.collision.narrow_phase`.
    """
    edges_a, edges_b = floats_on_stack(_EDGES), floats_on_stack(_EDGES)
    face_normal, above_a, below_b = _slab(a, b_seen, gap_a, face_a, gap_b, face_b)
    # A contact with separation g has |g| <= `reach`, and the two are no farther apart than |g|. So the edges of the pair with
    # the largest separation, which touch within |g|, are this close to the plane of the best face.
    gap_faces = max(gap_a, gap_b)
    reach = max(margin, -gap_faces)
    count_a = edges_beyond(a, a, face_normal, below_b - reach, edges_a)
    count_b = edges_beyond(b, b_seen, times(-1.0, face_normal), -above_a - reach, edges_b)
    pushing = count_below(edges_a, count_a, int(a[PUSHING]))
    gap_edges, edge_a, edge_b, edge_normal, edges_apart = separation_of_edges(
        edges_a, count_a, pushing, edges_b, count_b
    )
    gap = max(gap_faces, gap_edges)
    apart = max(apart, edges_apart)
    if apart > margin:
        return 0
    tolerance = tolerance_of(margin, min(a[THICKNESS], b[THICKNESS]))
    off = SHARE_OFF * abs(gap) + tolerance
    b_first = gap_b > gap_a + off
    least = -max(tolerance, behind) if apart > 0.0 else -reach - off
    nearest = margin
    candidates, chosen = floats_on_stack(CANDIDATES), floats_on_stack(4)
    for attempt in range(4):
        if attempt == 2:
            count = 0
            if gap_edges > gap - off and (apart <= 0.0 or gap_edges > 0.0):
                astray = 0.0 if apart > 0.0 else tolerance
                count = put_edges(edges_a, edge_a, edges_b, edge_b, edge_normal, astray, frame, manifold)
            if count == 0 and apart > 0.0:
                axis = edge_normal if gap_edges > gap_faces else face_normal
                count = put_closest(edges_a, count_a, pushing, edges_b, count_b, axis, frame, nearest, manifold)
            if count > 0:
                return count
        by_b = b_first != (attempt % 2 == 1)
        own, own_seen, face, other, other_seen = (b, b_seen, face_b, a, a) if by_b else (a, a, face_a, b, b_seen)
        gap_own = gap_b if by_b else gap_a
        # Any face, at last, but none from which the other one would have to come out sideways, as from that at a far border.
        if face < 0 or gap_own < (gap - off if attempt < 2 else 2.0 * min(gap, 0.0) - margin):
            continue
        normal, offset = plane(own_seen, face)
        met = incident_face(other, other_seen, normal)
        count, depth = clipped_face(
            own, own_seen, face, other, other_seen, met, by_b, margin, SLACK * tolerance, candidates
        )
        beside, height = vertex_beside(other, other_seen, met, own, own_seen, face, normal, offset)
        if count == 0:
            depth = height
        if depth > margin or depth < least:
            continue
        if attempt >= 2 or abs(depth - gap) <= off:
            kept = choose(candidates, count, normal, tolerance, point_at(manifold, LOAD), manifold, chosen)
            if least <= height <= margin:
                ids = beside + (MOST_VERTICES if by_b else 0)
                put_candidate(candidates, CANDIDATE * count, vertex(other_seen, beside), height, ids)
                kept = add_to_chosen(candidates, count, chosen, kept)
            put_manifold(manifold, candidates, chosen, kept, normal, frame, by_b)
            return kept
        nearest = min(nearest, depth)
    return 0


@compiled
def _slab(a: Any, b_seen: Any, gap_a: float, face_a: int, gap_b: float, face_b: int) -> tuple[Vector, float, float]:
    """Return the normal of the face that separates two polyhedra most, from a to b, and where along it a ends and b begins."""
    if gap_a >= gap_b:
        normal, above_a = plane(a, face_a)
        return normal, above_a, above_a + gap_a
    outward, below = plane(b_seen, face_b)
    return times(-1.0, outward), -below - gap_b, -below
