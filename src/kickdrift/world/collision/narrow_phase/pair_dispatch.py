"""The contact function of each pair of kinds of shapes: see `kickdrift.world.collision.narrow_phase`."""

from collections.abc import Callable
from itertools import combinations_with_replacement
from typing import Any

from kickdrift.core.errors import ArgumentError
from kickdrift.world.collision.narrow_phase import (
    box_box,
    capsule_box,
    capsule_polyhedron,
    capsules,
    frustum_frustum,
    frustum_polyhedron,
    frustum_round,
    plane_polyhedron,
    polyhedron_polyhedron,
    sphere_polyhedron,
    spheres,
    triangle_frustum,
    triangle_polyhedron,
    triangle_round,
)
from kickdrift.world.shapes.kind_numbers import BOX, CAPSULE, CONE, CYLINDER, HULL, PLANE, SPHERE, TRIANGLE
from kickdrift.world.shapes.shape_kinds import KINDS, may_touch

# By the kinds of two shapes, the lower one first: collide(a, b, pose, margin, manifold) -> number of points.
PAIRS: dict[tuple[int, int], Callable[..., Any]] = {
    (PLANE, SPHERE): spheres.plane_sphere,
    (PLANE, CAPSULE): capsules.plane_capsule,
    (PLANE, BOX): plane_polyhedron.plane_box,
    (PLANE, HULL): plane_polyhedron.plane_hull,
    (TRIANGLE, SPHERE): triangle_round.triangle_sphere,
    (TRIANGLE, CAPSULE): triangle_round.triangle_capsule,
    (TRIANGLE, BOX): triangle_polyhedron.triangle_box,
    (TRIANGLE, HULL): triangle_polyhedron.triangle_hull,
    (SPHERE, SPHERE): spheres.sphere_sphere,
    (SPHERE, CAPSULE): spheres.sphere_capsule,
    (SPHERE, BOX): spheres.sphere_box,
    (SPHERE, HULL): sphere_polyhedron.sphere_hull,
    (CAPSULE, CAPSULE): capsules.capsule_capsule,
    (CAPSULE, BOX): capsule_box.capsule_box,
    (CAPSULE, HULL): capsule_polyhedron.capsule_hull,
    (BOX, BOX): box_box.box_box,
    (BOX, HULL): polyhedron_polyhedron.box_hull,
    (HULL, HULL): polyhedron_polyhedron.hull_hull,
    (PLANE, CYLINDER): frustum_round.plane_frustum,
    (TRIANGLE, CYLINDER): triangle_frustum.triangle_frustum,
    (SPHERE, CYLINDER): frustum_round.sphere_frustum,
    (CAPSULE, CYLINDER): frustum_round.capsule_frustum,
    (BOX, CYLINDER): frustum_polyhedron.box_frustum,
    (HULL, CYLINDER): frustum_polyhedron.hull_frustum,
    (CYLINDER, CYLINDER): frustum_frustum.frustum_frustum,
    (PLANE, CONE): frustum_round.plane_frustum,
    (TRIANGLE, CONE): triangle_frustum.triangle_frustum,
    (SPHERE, CONE): frustum_round.sphere_frustum,
    (CAPSULE, CONE): frustum_round.capsule_frustum,
    (BOX, CONE): frustum_polyhedron.box_frustum,
    (HULL, CONE): frustum_polyhedron.hull_frustum,
    (CYLINDER, CONE): frustum_frustum.frustum_frustum,
    (CONE, CONE): frustum_frustum.frustum_frustum,
}

_WITHOUT = [pair for pair in combinations_with_replacement(sorted(KINDS), 2) if may_touch(*pair) and pair not in PAIRS]
if _WITHOUT:
    raise ArgumentError(
        f"There is no contact function for {' and '.join(KINDS[kind].name for kind in _WITHOUT[0])}; add one to PAIRS."
    )
