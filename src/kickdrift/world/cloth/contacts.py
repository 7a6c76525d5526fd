"""Contacts between particles of cloths and shapes of bodies; each particle is a ball with the thickness as diameter.

Segments of ropes touch shapes, too: see `kickdrift.world.cloth.segment_contacts`.
"""

import math
from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, conjugate, dot, length, minus, plus, times, turned, turned_back
from kickdrift.world.cloth.contact_rows import note_contact
from kickdrift.world.cloth.layout import (
    CLOTH_RADIUS,
    DIMENSION,
    FIRST_CONTACT,
    FIRST_PARTICLE,
    IN_LANES,
    IS_ASLEEP,
    LAST_CONTACT,
    LAST_PARTICLE,
    MOVES_BODY,
    OTHER_PARTICLE,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
    ROPE,
    TOUCHING_PARTICLE,
)
from kickdrift.world.cloth.segment_contacts import find_segments
from kickdrift.world.collision.aabb import box_in_frame
from kickdrift.world.collision.bvh import Box, gather
from kickdrift.world.collision.dispatch import sort_of
from kickdrift.world.collision.narrow_phase import collide, shape_pose
from kickdrift.world.collision.overlap_query import find_near
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts.layout import NORMAL, ON_A, ON_B, POINT, WIDTH
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    BEGIN,
    BODY_ROW,
    FIRST_TREE_NODE,
    IS_SENSOR,
    LAST_TREE_NODE,
    MASK,
    RADIUS,
    SHAPE_KIND,
    SIZE,
    VELOCITY,
)
from kickdrift.world.shapes.kinds import SPHERE, TRIANGLE
from kickdrift.world.shapes.record import HALF_SPACE, SURFACE
from kickdrift.world.shapes.triangle import TRIANGLE_SIZE, begin_of
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    BOUNDS,
    CLOTH,
    CLOTH_CONTACT,
    CLOTH_NEAR,
    CLOTH_NUMBERS,
    COLLIDERS,
    GEOMETRY,
    MANIFOLD,
    MOTION,
    PARTICLE,
    PLACE,
    SHAPE,
    TRIANGLE_TREE,
    flat,
    floats,
    integers,
    room,
    rows,
    set_rows,
)

_MANIFOLD = MANIFOLD.width
_LAYER = 1  # bit of layer 0, in which all cloths are


@compiled
def find_cloth_contacts(t: float, h: float, world: int) -> None:
    """Find the particles of all cloths that may touch a shape in this substep."""
    if integers(world, CLOTH)[0, IS_ASLEEP] == 0:
        find_contacts(world, h)


@compiled
def find_contacts(world: int, h: float) -> None:
    """Find the particles of all cloths that may touch a shape within the time h, s."""
    cloths, own = integers(world, CLOTH), integers(world, SHAPE)
    set_rows(world, CLOTH_CONTACT, 0)
    near = rows(world, SHAPE) + rows(world, TRIANGLE_TREE) + 2
    if room(world, CLOTH_NEAR) < near:
        ask_for_room(world, CLOTH_NEAR, near)
        return
    for cloth in range(rows(world, CLOTH)):
        cloths[cloth, FIRST_CONTACT] = rows(world, CLOTH_CONTACT)
        shapes = flat(world, CLOTH_NEAR)
        count = find_near(world, _box(world, cloth, h), shapes)
        for k in range(count):
            shape = int(shapes[k])
            meets = own[shape, IS_SENSOR] == 0 and own[shape, MASK] & _LAYER != 0
            if meets and not _find_on_shape(world, cloth, shape, h, count):
                return
            if meets and cloths[cloth, DIMENSION] == ROPE and not find_segments(world, cloth, shape, h, count):
                return
        cloths[cloth, LAST_CONTACT] = rows(world, CLOTH_CONTACT)
        _group(world, cloths[cloth, FIRST_CONTACT], cloths[cloth, LAST_CONTACT])


@compiled
def _group(world: int, first: int, last: int) -> None:
    """Mark the contacts, from one row to another, with which eight begin that can be resolved at once."""
    contact = integers(world, CLOTH_CONTACT)
    row = first
    while row < last:
        fits = row + WIDTH <= last
        for k in range(row, row + WIDTH if fits else row):
            fits = fits and contact[k, MOVES_BODY] == 0 and contact[k, OTHER_PARTICLE] == contact[k, TOUCHING_PARTICLE]
            fits = fits and (k == row or contact[k, TOUCHING_PARTICLE] > contact[k - 1, TOUCHING_PARTICLE])
        contact[row, IN_LANES] = int(fits)
        row += WIDTH if fits else 1


@compiled
def _box(world: int, cloth: int, h: float) -> Box:
    """Return the bounds of a cloth and of its motion in a time h."""
    own, particle = integers(world, CLOTH), floats(world, PARTICLE)
    x, y, z, u, v, w, fastest = math.inf, math.inf, math.inf, -math.inf, -math.inf, -math.inf, 0.0
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        p, speed = vector_at(particle, i, 0), vector_at(particle, i, PARTICLE_VELOCITY)
        x, y, z = min(x, p[0]), min(y, p[1]), min(z, p[2])
        u, v, w = max(u, p[0]), max(v, p[1]), max(w, p[2])
        fastest = max(fastest, dot(speed, speed))
    reach = floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS] + h * math.sqrt(fastest)
    return (x - reach, y - reach, z - reach, u + reach, v + reach, w + reach)


@compiled
def _find_on_shape(world: int, cloth: int, shape: int, h: float, after: int) -> bool:
    """Find the particles of a cloth that may touch a shape; False if there is no room for them."""
    own, particle, place = integers(world, CLOTH), floats(world, PARTICLE), floats(world, PLACE)
    body, motion = integers(world, SHAPE)[shape, BODY_ROW], floats(world, MOTION)
    at, q = shape_pose(world, shape)
    speed = length(vector_at(motion, body, VELOCITY))
    around, sort = place[shape, RADIUS], sort_of(world, shape)
    speed += length(vector_at(motion, body, ANGULAR_VELOCITY)) * around
    up, radius = turned(q, (0.0, 0.0, 1.0)), floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS]
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        if particle[i, PARTICLE_INVERSE_MASS] == 0.0:
            continue
        away = minus(vector_at(particle, i, 0), at)
        margin = h * (speed + length(vector_at(particle, i, PARTICLE_VELOCITY))) + radius
        reach = margin + radius
        if sort == SURFACE:
            found = _find_on_surface(world, cloth, i, shape, margin, after, h)
        elif sort == HALF_SPACE:
            found = dot(away, up) > reach or _touch(world, cloth, i, shape, -1, margin, h)
        else:
            found = dot(away, away) > (around + reach) ** 2 or _touch(world, cloth, i, shape, -1, margin, h)
        if not found:
            return False
    return True


@compiled
def _find_on_surface(world: int, cloth: int, i: int, shape: int, margin: float, after: int, h: float) -> bool:
    """Find the contacts of a particle with the triangles of a surface; False if there is no room."""
    p, bounds, near = vector_at(floats(world, PARTICLE), i, 0), floats(world, BOUNDS), flat(world, CLOTH_NEAR)
    reach = margin + floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS]
    box = (p[0] - reach, p[1] - reach, p[2] - reach, p[0] + reach, p[1] + reach, p[2] + reach)
    first, last = int(bounds[shape, FIRST_TREE_NODE]), int(bounds[shape, LAST_TREE_NODE])
    hits, _ = gather(floats(world, TRIANGLE_TREE)[first:last], box_in_frame(world, shape, box), near[after:])
    fits = True
    for k in range(hits):
        fits = fits and _touch(world, cloth, i, shape, int(near[after + k]), margin, h)
    return fits


@compiled
def _touch(world: int, cloth: int, i: int, shape: int, triangle: int, margin: float, h: float) -> bool:
    """Add the contact of a particle with a shape, or one of its triangles, if there is one; False if there is no room."""
    shapes, geometry = integers(world, SHAPE), flat(world, GEOMETRY)
    begin, size, kind = shapes[shape, BEGIN], shapes[shape, SIZE], shapes[shape, SHAPE_KIND]
    if triangle >= 0:
        begin, size, kind = begin_of(begin, triangle), TRIANGLE_SIZE, TRIANGLE
    ball, pose = carray(floats_on_stack(1), (1,)), carray(floats_on_stack(7), (7,))
    manifold = carray(floats_on_stack(_MANIFOLD), (_MANIFOLD,))
    ball[0] = floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS]
    at, q = shape_pose(world, shape)
    p, numbers, function = (
        vector_at(floats(world, PARTICLE), i, 0),
        geometry[begin : begin + size],
        integers(world, COLLIDERS),
    )
    if kind <= SPHERE:
        pose[0], pose[1], pose[2] = turned_back(q, minus(p, at))
        pose[3], pose[4], pose[5], pose[6] = conjugate(q)
        count = collide(function[kind, SPHERE], (numbers, ball, pose, margin, manifold))
    else:
        pose[0], pose[1], pose[2] = minus(at, p)
        pose[3], pose[4], pose[5], pose[6] = q
        count = collide(function[SPHERE, kind], (ball, numbers, pose, margin, manifold))
    if count == 0:
        return True
    normal = (manifold[NORMAL], manifold[NORMAL + 1], manifold[NORMAL + 2])
    on_a, on_b = _point(manifold, POINT + ON_A), _point(manifold, POINT + ON_B)
    if kind <= SPHERE:  # the shape is the first of the pair
        normal = turned(q, normal)
        point, own_point = plus(at, turned(q, on_a)), minus(p, times(ball[0], normal))
    else:
        normal = times(-1.0, normal)
        point, own_point = plus(at, turned(q, on_b)), plus(p, on_a)
    return note_contact(world, cloth, shape, i, i, 0.0, (normal, dot(normal, minus(own_point, point)), point), h)


@compiled(inline=True)
def _point(manifold: Any, at: int) -> Vector:
    return (manifold[at], manifold[at + 1], manifold[at + 2])
