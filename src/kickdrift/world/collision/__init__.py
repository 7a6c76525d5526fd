"""Collision detection: the broad phase finds pairs of shapes, the narrow phase their contact points.

A contact function of a pair of kinds, ``collide(a, b, pose, margin, manifold)``, gets the numbers of two shapes, the pose of
the second in the frame of the first (7) and the largest separation of points, m, zero or positive. It writes the unit normal
from the first shape to the second, in the first's frame, and for up to four points their positions on the first shape in its
frame and on the second in its own, and an id that persists while the same features touch (`kickdrift.world.contacts.layout`).
It returns the number of points. Separations are normal . (point on b - point on a), negative if the shapes overlap.
"""

from collections.abc import Callable
from itertools import combinations_with_replacement
from typing import Any

from kickdrift.core.errors import ArgumentError
from kickdrift.world.collision import (
    box_box,
    capsule_box,
    capsule_hull,
    capsules,
    frustum_frustum,
    frustum_polyhedra,
    frustum_round,
    plane_polyhedra,
    polyhedra,
    sphere_hull,
    spheres,
    triangle_frustum,
    triangle_polyhedra,
    triangle_round,
)
from kickdrift.world.shapes.catalogue import KINDS, may_touch
from kickdrift.world.shapes.kinds import BOX, CAPSULE, CONE, CYLINDER, HULL, PLANE, SPHERE, TRIANGLE

# By the kinds of two shapes, the lower one first: collide(a, b, pose, margin, manifold) -> number of points.
PAIRS: dict[tuple[int, int], Callable[..., Any]] = {
    (PLANE, SPHERE): spheres.plane_sphere,
    (PLANE, CAPSULE): capsules.plane_capsule,
    (PLANE, BOX): plane_polyhedra.plane_box,
    (PLANE, HULL): plane_polyhedra.plane_hull,
    (TRIANGLE, SPHERE): triangle_round.triangle_sphere,
    (TRIANGLE, CAPSULE): triangle_round.triangle_capsule,
    (TRIANGLE, BOX): triangle_polyhedra.triangle_box,
    (TRIANGLE, HULL): triangle_polyhedra.triangle_hull,
    (SPHERE, SPHERE): spheres.sphere_sphere,
    (SPHERE, CAPSULE): spheres.sphere_capsule,
    (SPHERE, BOX): spheres.sphere_box,
    (SPHERE, HULL): sphere_hull.sphere_hull,
    (CAPSULE, CAPSULE): capsules.capsule_capsule,
    (CAPSULE, BOX): capsule_box.capsule_box,
    (CAPSULE, HULL): capsule_hull.capsule_hull,
    (BOX, BOX): box_box.box_box,
    (BOX, HULL): polyhedra.box_hull,
    (HULL, HULL): polyhedra.hull_hull,
    (PLANE, CYLINDER): frustum_round.plane_frustum,
    (TRIANGLE, CYLINDER): triangle_frustum.triangle_frustum,
    (SPHERE, CYLINDER): frustum_round.sphere_frustum,
    (CAPSULE, CYLINDER): frustum_round.capsule_frustum,
    (BOX, CYLINDER): frustum_polyhedra.box_frustum,
    (HULL, CYLINDER): frustum_polyhedra.hull_frustum,
    (CYLINDER, CYLINDER): frustum_frustum.frustum_frustum,
    (PLANE, CONE): frustum_round.plane_frustum,
    (TRIANGLE, CONE): triangle_frustum.triangle_frustum,
    (SPHERE, CONE): frustum_round.sphere_frustum,
    (CAPSULE, CONE): frustum_round.capsule_frustum,
    (BOX, CONE): frustum_polyhedra.box_frustum,
    (HULL, CONE): frustum_polyhedra.hull_frustum,
    (CYLINDER, CONE): frustum_frustum.frustum_frustum,
    (CONE, CONE): frustum_frustum.frustum_frustum,
}

_WITHOUT = [pair for pair in combinations_with_replacement(sorted(KINDS), 2) if may_touch(*pair) and pair not in PAIRS]
if _WITHOUT:
    raise ArgumentError(
        f"There is no contact function for {' and '.join(KINDS[kind].name for kind in _WITHOUT[0])}; add one to PAIRS."
    )
