"""Contact of boxes and hulls with a plane, at the corners of their lowest face."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector
from kickdrift.world.collision.narrow_phase.box_as_polyhedron import UNIT_BOX, corner_of, facing
from kickdrift.world.collision.narrow_phase.face_bias import tolerance_of
from kickdrift.world.collision.narrow_phase.manifold_candidates import CANDIDATE, put_candidate, put_manifold
from kickdrift.world.collision.narrow_phase.manifold_points import put_normal, put_point
from kickdrift.world.collision.narrow_phase.manifold_reduction import choose
from kickdrift.world.collision.narrow_phase.rocking_vertex import add_to_chosen, vertex_beside
from kickdrift.world.collision.narrow_phase.sat_faces import CANDIDATES, PLACED, incident_face, place_polyhedron
from kickdrift.world.collision.narrow_phase.shape_frames import set_frame
from kickdrift.world.columns import point_at
from kickdrift.world.contacts.layout import LOAD
from kickdrift.world.shapes.polyhedron import THICKNESS, loop, loop_vertex, pointer_to, vertex

_UP: Vector = (0.0, 0.0, 1.0)


@compiled
def plane_box(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a half-space and a box; see `kickdrift.world.collision.narrow_phase`."""
    frame = floats_on_stack(12)
    set_frame(frame, pose)
    face = facing(frame, _UP)
    begin, end = loop(UNIT_BOX, face)
    count = 0
    for k in range(begin, end):
        number = loop_vertex(UNIT_BOX, k)
        x, y, z = corner_of(b, frame, number)
        if z <= margin:
            u, v, w = vertex(UNIT_BOX, number)
            put_point(manifold, count, (x, y, 0.0), (u * b[0], v * b[1], w * b[2]), number)
            count += 1
    put_normal(manifold, _UP)
    return count


@compiled
def plane_hull(a: Any, b: Any, pose: Any, margin: float, manifold: Any) -> int:
    """Find the contact points of a half-space and a hull; see `kickdrift.world.collision.narrow_phase`."""
    frame, seen = floats_on_stack(12), floats_on_stack(PLACED)
    candidates, chosen = floats_on_stack(CANDIDATES), floats_on_stack(4)
    hull = pointer_to(b)
    set_frame(frame, pose)
    place_polyhedron(seen, hull, frame)
    face = incident_face(hull, seen, _UP)
    begin, end = loop(hull, face)
    count = 0
    for k in range(begin, end):
        number = loop_vertex(hull, k)
        corner = vertex(seen, number)
        if corner[2] <= margin:
            put_candidate(candidates, CANDIDATE * count, corner, corner[2], number)
            count += 1
    kept = choose(
        candidates, count, _UP, tolerance_of(margin, hull[THICKNESS]), point_at(manifold, LOAD), manifold, chosen
    )
    beside, gap = vertex_beside(hull, seen, face, hull, seen, -1, _UP, 0.0)
    if gap <= margin:
        put_candidate(candidates, CANDIDATE * count, vertex(seen, beside), gap, beside)
        kept = add_to_chosen(candidates, count, chosen, kept)
    put_manifold(manifold, candidates, chosen, kept, _UP, frame, False)
    return kept
