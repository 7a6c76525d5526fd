"""Contacts between particles of cloths and shapes of bodies; each particle is a ball with the thickness as diameter.

Segments of ropes and triangles touch solids between their ends, too: see `segment_contacts` and `face_contacts`.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot, length, minus, turned
from kickdrift.world.collision.broad_phase.bvh import Box
from kickdrift.world.collision.queries.overlap_query import find_near, find_triangles
from kickdrift.world.collision.shape_properties import sort_of
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.body_contacts.ball_contact import touch_of_ball
from kickdrift.world.deformables.body_contacts.contact_lanes import fill_contact_lanes
from kickdrift.world.deformables.body_contacts.contact_rows import (
    AT_FIRST,
    Pose,
    largest_speed,
    moves_body,
    note_contact,
    start_pose,
)
from kickdrift.world.deformables.body_contacts.face_contacts import find_faces
from kickdrift.world.deformables.body_contacts.load_path import find_load_paths
from kickdrift.world.deformables.body_contacts.pinned_corners import holds_off
from kickdrift.world.deformables.body_contacts.segment_contacts import find_segments
from kickdrift.world.deformables.layout import (
    CLOTH_RADIUS,
    DIMENSION,
    FIRST_CONTACT,
    FIRST_PARTICLE,
    IS_ASLEEP,
    LAST_CONTACT,
    LAST_PARTICLE,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
    ROPE,
)
from kickdrift.world.layout import BODY_ROW, IS_SENSOR, MASK, RADIUS
from kickdrift.world.shapes.record import HALF_SPACE, SURFACE
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_CONTACT,
    CLOTH_NEAR,
    CLOTH_NUMBERS,
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
            if meets and not _find_between(world, cloth, shape, h, count):
                return
        cloths[cloth, LAST_CONTACT] = rows(world, CLOTH_CONTACT)
        find_load_paths(world, cloth, cloths[cloth, FIRST_CONTACT], cloths[cloth, LAST_CONTACT])
        if not fill_contact_lanes(world, cloths[cloth, FIRST_CONTACT], cloths[cloth, LAST_CONTACT]):
            return


@compiled
def _find_between(world: int, cloth: int, shape: int, h: float, after: int) -> bool:
    """Find contacts between vertices, of the segments of a rope or the triangles of others; False if there is no room."""
    if integers(world, CLOTH)[cloth, DIMENSION] == ROPE:
        return bool(find_segments(world, cloth, shape, h, after))
    return bool(find_faces(world, cloth, shape, h))


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
    own, particle, around = integers(world, CLOTH), floats(world, PARTICLE), floats(world, PLACE)[shape, RADIUS]
    start, speed, sort = start_pose(world, shape, h), largest_speed(world, shape), sort_of(world, shape)
    (at, q), body = start, integers(world, SHAPE)[shape, BODY_ROW]
    up, radius = turned(q, (0.0, 0.0, 1.0)), floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS]
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        if particle[i, PARTICLE_INVERSE_MASS] == 0.0 and not moves_body(world, i, body):
            continue
        away = minus(vector_at(particle, i, 0), at)
        margin = h * (speed + length(vector_at(particle, i, PARTICLE_VELOCITY))) + radius
        reach = margin + radius
        if sort == SURFACE:
            found = _find_on_surface(world, cloth, i, shape, start, margin, after, h)
        elif sort == HALF_SPACE:
            found = dot(away, up) > reach or _touch(world, cloth, i, shape, -1, start, margin, h)
        else:
            found = dot(away, away) > (around + reach) ** 2 or _touch(world, cloth, i, shape, -1, start, margin, h)
        if not found:
            return False
    return True


@compiled
def _find_on_surface(
    world: int, cloth: int, i: int, shape: int, start: Pose, margin: float, after: int, h: float
) -> bool:
    """Find the contacts of a particle with the triangles of a surface; False if there is no room."""
    p, near = vector_at(floats(world, PARTICLE), i, 0), flat(world, CLOTH_NEAR)[after:]
    reach = margin + floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS]
    box = (p[0] - reach, p[1] - reach, p[2] - reach, p[0] + reach, p[1] + reach, p[2] + reach)
    fits = True
    for k in range(find_triangles(world, shape, box, near)):
        fits = fits and _touch(world, cloth, i, shape, int(near[k]), start, margin, h)
    return fits


@compiled
def _touch(world: int, cloth: int, i: int, shape: int, triangle: int, start: Pose, margin: float, h: float) -> bool:
    """Add the contact of a particle with a shape, or one of its triangles, if there is one; False if there is no room."""
    particle, radius = floats(world, PARTICLE), floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS]
    p, body = vector_at(particle, i, 0), integers(world, SHAPE)[shape, BODY_ROW]
    if particle[i, PARTICLE_INVERSE_MASS] == 0.0 and not holds_off(world, cloth, i, body):
        return True
    touches, touch = touch_of_ball(world, shape, triangle, start, p, radius, margin)
    return not touches or note_contact(world, cloth, shape, (i, i, i), AT_FIRST, touch, h)
