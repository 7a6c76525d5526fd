"""Where rays meet shapes.

``ray(numbers, origin, direction, limit)`` works in the frame of the shape: `origin` is a point, `direction` a unit
vector, and what is farther than `limit` is not met. It returns the distance and the outward unit normal there: four
floats, or infinity and zeros if the ray meets nothing. A ray that starts inside meets the surface where it leaves; its
direction and the normal then point to the same side. Triangles are met from both sides.
"""

import math
from collections.abc import Callable
from typing import Any

from numba import types

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, times
from kickdrift.world.collision.closest import along, clamped
from kickdrift.world.shapes.kinds import BOX, CAPSULE, HULL, PLANE, SPHERE, TRIANGLE
from kickdrift.world.shapes.polyhedron import FACES, plane

Hit = tuple[float, float, float, float]
Chord = tuple[float, float]  # where a line enters a convex set and where it leaves; empty if the first is the greater

MISS: Hit = (math.inf, 0.0, 0.0, 0.0)
NO_CHORD: Chord = (math.inf, -math.inf)

_VECTOR = types.UniTuple(types.float64, 3)
SIGNATURE = types.UniTuple(types.float64, 4)(types.Array(types.float64, 1, "C"), _VECTOR, _VECTOR, types.float64)


@compiled(inline=True)
def ahead(chord: Chord, limit: float) -> float:
    """Return where a ray meets a convex set that its line passes through: ahead of it and not beyond the limit."""
    enters, leaves = chord
    if enters > leaves:
        return math.inf
    distance = enters if enters >= 0.0 else leaves
    if distance > limit or (distance <= 0.0 and enters < 0.0):
        return math.inf
    return distance


@compiled
def ray_plane(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Meet a half-space; see this module."""
    height, rise = origin[2], direction[2]
    if rise < 0.0:
        distance = ahead((-height / rise, math.inf), limit) if height >= 0.0 else math.inf
    elif rise > 0.0:
        distance = ahead((-math.inf, -height / rise), limit)
    else:
        distance = math.inf
    return (distance, 0.0, 0.0, 1.0) if distance < math.inf else MISS


@compiled
def ray_triangle(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Meet a triangle from either side; see this module.

    Notes
    -----
    Woop, Benthin, Wald 2013, Watertight Ray/Triangle Intersection: corners are seen along the ray, in a plane across.
    Whichever of the triangles around an edge or a corner asks, the same numbers answer, so that no ray slips through.
    """
    u = minus((numbers[0], numbers[1], numbers[2]), origin)
    v = minus((numbers[3], numbers[4], numbers[5]), origin)
    w = minus((numbers[6], numbers[7], numbers[8]), origin)
    ux, uy = _along_ray(u, direction)
    vx, vy = _along_ray(v, direction)
    wx, wy = _along_ray(w, direction)
    a, b, c = wx * vy - wy * vx, ux * wy - uy * wx, vx * uy - vy * ux
    if (a < 0.0 or b < 0.0 or c < 0.0) and (a > 0.0 or b > 0.0 or c > 0.0):
        return MISS
    across = cross(minus(v, u), minus(w, u))
    rise = dot(across, direction)
    if rise == 0.0:
        return MISS
    distance = dot(across, u) / rise
    if not 0.0 <= distance <= limit:
        return MISS
    normal = times(1.0 / length(across), across)
    return (distance, normal[0], normal[1], normal[2])


@compiled(inline=True)
def _along_ray(p: Vector, direction: Vector) -> tuple[float, float]:
    """Project a point along a ray onto the plane of the two axes that the ray is least along."""
    x, y, z = abs(direction[0]), abs(direction[1]), abs(direction[2])
    if x >= y and x >= z:
        return p[1] - direction[1] / direction[0] * p[0], p[2] - direction[2] / direction[0] * p[0]
    if y >= z:
        return p[2] - direction[2] / direction[1] * p[1], p[0] - direction[0] / direction[1] * p[1]
    return p[0] - direction[0] / direction[2] * p[2], p[1] - direction[1] / direction[2] * p[2]


@compiled
def ray_sphere(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Meet a ball; see this module."""
    distance = ahead(_through_ball(origin, direction, numbers[0]), limit)
    if distance == math.inf:
        return MISS
    normal = times(1.0 / numbers[0], along(origin, distance, direction))
    return (distance, normal[0], normal[1], normal[2])


@compiled
def ray_capsule(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Meet a capsule; see this module.

    Notes
    -----
    It is the union of a cylinder and two balls, and convex: a line enters it where it first enters one of these.
    """
    radius, half = numbers[0], numbers[1]
    enters, leaves = _through_cylinder(origin, direction, radius, half)
    for side in range(2):
        z = origin[2] - half if side == 1 else origin[2] + half
        first, last = _through_ball((origin[0], origin[1], z), direction, radius)
        enters, leaves = min(enters, first), max(leaves, last)
    distance = ahead((enters, leaves), limit)
    if distance == math.inf:
        return MISS
    x = along(origin, distance, direction)
    out = minus(x, (0.0, 0.0, clamped(x[2], -half, half)))
    normal = times(1.0 / length(out), out)
    return (distance, normal[0], normal[1], normal[2])


@compiled
def ray_box(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Meet a box; see this module."""
    enters, leaves, face_in, face_out = -math.inf, math.inf, 0, 0
    for i in range(3):
        if direction[i] != 0.0:
            low, high = (-numbers[i] - origin[i]) / direction[i], (numbers[i] - origin[i]) / direction[i]
            if min(low, high) > enters:
                enters, face_in = min(low, high), i
            if max(low, high) < leaves:
                leaves, face_out = max(low, high), i
        elif abs(origin[i]) > numbers[i]:
            return MISS
    distance = ahead((enters, leaves), limit)
    if distance == math.inf:
        return MISS
    face = face_in if distance == enters else face_out
    side = math.copysign(1.0, direction[face])
    if distance == enters:
        side = -side
    return (distance, side if face == 0 else 0.0, side if face == 1 else 0.0, side if face == 2 else 0.0)


@compiled
def ray_hull(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Meet a convex polyhedron; see this module (Cyrus and Beck 1978)."""
    enters, leaves, face_in, face_out = -math.inf, math.inf, 0, 0
    for face in range(int(numbers[FACES])):
        normal, offset = plane(numbers, face)
        height, rise = dot(normal, origin) - offset, dot(normal, direction)
        if rise < 0.0:
            if -height / rise > enters:
                enters, face_in = -height / rise, face
        elif rise > 0.0:
            if -height / rise < leaves:
                leaves, face_out = -height / rise, face
        elif height > 0.0:
            return MISS
    distance = ahead((enters, leaves), limit)
    if distance == math.inf:
        return MISS
    normal, _ = plane(numbers, face_in if distance == enters else face_out)
    return (distance, normal[0], normal[1], normal[2])


@compiled(inline=True)
def _through_ball(origin: Vector, direction: Vector, radius: float) -> Chord:
    """Chord of a line in a ball about the origin of coordinates."""
    middle = -dot(origin, direction)
    miss = length(along(origin, middle, direction))
    if miss > radius:
        return NO_CHORD
    half = math.sqrt((radius - miss) * (radius + miss))
    return middle - half, middle + half


@compiled(inline=True)
def _through_cylinder(origin: Vector, direction: Vector, radius: float, half: float) -> Chord:
    """Chord of a line in a cylinder about the z axis, between -half and half."""
    enters, leaves = -math.inf, math.inf
    slant = math.sqrt(direction[0] * direction[0] + direction[1] * direction[1])
    if slant > 0.0:
        x, y = direction[0] / slant, direction[1] / slant
        miss = abs(origin[0] * y - origin[1] * x)
        if miss > radius:
            return NO_CHORD
        middle, chord = -(origin[0] * x + origin[1] * y), math.sqrt((radius - miss) * (radius + miss))
        enters, leaves = (middle - chord) / slant, (middle + chord) / slant
    elif origin[0] * origin[0] + origin[1] * origin[1] > radius * radius:
        return NO_CHORD
    if direction[2] != 0.0:
        low, high = (-half - origin[2]) / direction[2], (half - origin[2]) / direction[2]
        enters, leaves = max(enters, min(low, high)), min(leaves, max(low, high))
    elif abs(origin[2]) > half:
        return NO_CHORD
    if enters > leaves:
        return NO_CHORD
    return enters, leaves


# By the kind of shape; meshes are met one triangle at a time.
RAYS: dict[int, Callable[..., Any]] = {
    PLANE: ray_plane,
    TRIANGLE: ray_triangle,
    SPHERE: ray_sphere,
    CAPSULE: ray_capsule,
    BOX: ray_box,
    HULL: ray_hull,
}
