"""Rows of contacts between particles, segments or triangles of cloths and shapes of bodies."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import (
    Quaternion,
    Vector,
    cross,
    dot,
    exponential,
    length,
    minus,
    plus,
    product,
    times,
    turned,
)
from kickdrift.world.collision.shape_poses import pose_on_body
from kickdrift.world.collision.shape_properties import core_of
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.deformables.body_contacts.pinned_corners import Corners, pin_of
from kickdrift.world.deformables.layout import (
    CLOTH_FRICTION,
    CLOTH_NORMAL,
    CLOTH_OFFSET,
    CONTACT_AXIS,
    CONTACT_FRICTION,
    CONTACT_IMPULSE,
    CONTACT_RADIUS,
    GROUND_VELOCITY,
    HELD_BY,
    MOVES_BODY,
    OTHER_PARTICLE,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
    PASSED_FRICTION,
    SHARES,
    THIRD_PARTICLE,
    TOUCHED_BODY,
    TOUCHED_POINT,
    TOUCHING_PARTICLE,
)
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    AWAKE,
    BEGIN,
    BODY_KIND,
    BODY_ROW,
    DYNAMIC,
    FRICTION,
    ORIENTATION,
    POSITION,
    RADIUS,
    SHAPE_KIND,
    SURFACE_VELOCITY,
    VELOCITY,
)
from kickdrift.world.material_mixing import mixed_friction
from kickdrift.world.settings import SLEEP_SPEED
from kickdrift.world.shapes.kind_numbers import CAPSULE
from kickdrift.world.shapes.record import CENTRE, NO_CORE
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    BODY,
    CLOTH_CONTACT,
    CLOTH_CONTACT_NUMBERS,
    CLOTH_NUMBERS,
    GEOMETRY,
    MOTION,
    PARTICLE,
    PLACE,
    POSE,
    SETTINGS,
    SHAPE,
    flat,
    floats,
    integers,
    room,
    rows,
    set_rows,
)

Pose = tuple[Vector, Quaternion]
Touch = tuple[Vector, float, Vector]
Shares = tuple[Corners, Vector, Vector, float]

_LEVEL = 1e-6  # cosine between the normal and the axis of a capsule, below which the point is on its side
_STEEPEST = 0.1  # sine between the normal and the axis of a round shape, below which the shape counts as flat
AT_FIRST: Vector = (1.0, 0.0, 0.0)  # barycentric coordinates of a particle alone


@compiled
def start_pose(world: int, shape: int, h: float) -> Pose:
    """Return the pose of a shape at the start of a substep, h s ago: bodies have drifted already, cloths have not."""
    motion, body = floats(world, MOTION), integers(world, SHAPE)[shape, BODY_ROW]
    q = quaternion_at(floats(world, POSE), body, ORIENTATION)
    spin = vector_at(motion, body, ANGULAR_VELOCITY)
    if dot(spin, spin) > 0.0:
        q = product(exponential(times(-h, spin)), q)
    return pose_on_body(world, shape, _start_of_body(world, body, h), q)


@compiled(inline=True)
def _start_of_body(world: int, body: int, h: float) -> Vector:
    v = vector_at(floats(world, MOTION), body, VELOCITY)
    return minus(vector_at(floats(world, POSE), body, POSITION), times(h, v))


@compiled
def largest_speed(world: int, shape: int) -> float:
    """Return a bound on the speed of all points of a shape, m/s."""
    motion, body = floats(world, MOTION), integers(world, SHAPE)[shape, BODY_ROW]
    spin = length(vector_at(motion, body, ANGULAR_VELOCITY))
    bound: float = length(vector_at(motion, body, VELOCITY)) + spin * floats(world, PLACE)[shape, RADIUS]
    return bound


@compiled(inline=True)
def velocity_at(world: int, shape: int, point: Vector, h: float) -> Vector:
    """Return the velocity of a shape at a point where it was h s ago."""
    motion, body = floats(world, MOTION), integers(world, SHAPE)[shape, BODY_ROW]
    arm = minus(point, _start_of_body(world, body, h))
    return plus(vector_at(motion, body, VELOCITY), cross(vector_at(motion, body, ANGULAR_VELOCITY), arm))


@compiled
def note_contact(world: int, cloth: int, shape: int, corners: Corners, shares: Vector, touch: Touch, h: float) -> bool:
    """Add a row for a point of a triangle of particles that may touch a shape; False if there is no room.

    `shares` are its barycentric coordinates; a segment is a triangle whose last corner has none, a particle alone is all three.
    `touch` is the normal from the shape, the gap and the point of the shape, at the start of the substep of h s.
    """
    normal, gap, point = touch
    row = rows(world, CLOTH_CONTACT)
    if row >= min(room(world, CLOTH_CONTACT), room(world, CLOTH_CONTACT_NUMBERS)):
        ask_for_room(world, CLOTH_CONTACT, 2 * row + 64)
        return False
    set_rows(world, CLOTH_CONTACT, row + 1)
    contact, numbers, place = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS), floats(world, PLACE)
    shapes, pose = integers(world, SHAPE), floats(world, POSE)
    body = shapes[shape, BODY_ROW]
    contact[row, TOUCHING_PARTICLE], contact[row, OTHER_PARTICLE], contact[row, THIRD_PARTICLE] = corners
    contact[row, TOUCHED_BODY] = body
    moves = False
    for k in range(3):
        contact[row, HELD_BY + k] = pin_of(world, cloth, corners[k])
        moves = moves or moves_body(world, corners[k], body)
    contact[row, MOVES_BODY] = int(moves)
    arm = minus(point, _start_of_body(world, body, h))
    runs = turned(quaternion_at(pose, body, ORIENTATION), vector_at(place, shape, SURFACE_VELOCITY))
    friction = mixed_friction(floats(world, CLOTH_NUMBERS)[cloth, CLOTH_FRICTION], place[shape, FRICTION])
    if not moves:
        runs = plus(runs, velocity_at(world, shape, point, h))
    numbers[row, CONTACT_FRICTION] = friction
    numbers[row, CONTACT_RADIUS], axis = _curvature(world, shape, normal, point, h)
    for k in range(3):
        numbers[row, CONTACT_AXIS + k] = axis[k]
        numbers[row, CLOTH_NORMAL + k], numbers[row, TOUCHED_POINT + k] = normal[k], arm[k]
        numbers[row, GROUND_VELOCITY + k], numbers[row, SHARES + k] = runs[k], shares[k]
    numbers[row, CLOTH_OFFSET] = 0.0
    numbers[row, CLOTH_OFFSET] = gap_of(world, row) - gap
    for k in range(4):
        numbers[row, CONTACT_IMPULSE + k] = 0.0
    for k in range(3):
        numbers[row, PASSED_FRICTION + k] = 0.0
    return True


@compiled
def _curvature(world: int, shape: int, normal: Vector, point: Vector, h: float) -> tuple[float, Vector]:
    """Return the radius of curvature of a shape at a point, m, and the axis along which it is straight, both zero if flat.

    The normal at the side of a cylinder or cone leads to the axis, along which the centre of curvature lies.
    """
    core, (at, q) = core_of(world, shape), start_pose(world, shape, h)
    shapes, none = integers(world, SHAPE), (0.0, 0.0, 0.0)
    axis, arm = turned(q, (0.0, 0.0, 1.0)), minus(point, at)
    if core == CENTRE:
        on_side = shapes[shape, SHAPE_KIND] == CAPSULE and abs(dot(axis, normal)) < _LEVEL
        return float(flat(world, GEOMETRY)[shapes[shape, BEGIN]]), axis if on_side else none
    across = length(minus(normal, times(dot(axis, normal), axis)))
    if core == NO_CORE or across < _STEEPEST:
        return 0.0, none
    return length(minus(arm, times(dot(axis, arm), axis))) / across, axis


@compiled(inline=True)
def moves_body(world: int, i: int, body: int) -> bool:
    """Whether a body receives the reaction of a particle; a sleeping one does if it is hit, and wakes before the next step."""
    own, v = integers(world, BODY), vector_at(floats(world, PARTICLE), i, PARTICLE_VELOCITY)
    slow = floats(world, SETTINGS)[0, SLEEP_SPEED]
    takes: bool = own[body, BODY_KIND] == DYNAMIC and (own[body, AWAKE] != 0 or dot(v, v) > slow * slow)
    return takes


@compiled
def shares_of(world: int, row: int) -> Shares:
    """Return the particles of a contact, their shares, those over their masses, and the inverse mass of the point."""
    contact, particle = integers(world, CLOTH_CONTACT), floats(world, PARTICLE)
    corners = (contact[row, TOUCHING_PARTICLE], contact[row, OTHER_PARTICLE], contact[row, THIRD_PARTICLE])
    share = vector_at(floats(world, CLOTH_CONTACT_NUMBERS), row, SHARES)
    by = (
        share[0] * particle[corners[0], PARTICLE_INVERSE_MASS],
        share[1] * particle[corners[1], PARTICLE_INVERSE_MASS],
        share[2] * particle[corners[2], PARTICLE_INVERSE_MASS],
    )
    return corners, share, by, dot(share, by)


@compiled(inline=True)
def gap_of(world: int, row: int) -> float:
    """Return the gap of a contact, m, wherever its particles have been moved to since it was found."""
    contact, numbers, particle = (
        integers(world, CLOTH_CONTACT),
        floats(world, CLOTH_CONTACT_NUMBERS),
        floats(world, PARTICLE),
    )
    share = vector_at(numbers, row, SHARES)
    p = times(share[0], vector_at(particle, contact[row, TOUCHING_PARTICLE], 0))
    p = plus(p, times(share[1], vector_at(particle, contact[row, OTHER_PARTICLE], 0)))
    p = plus(p, times(share[2], vector_at(particle, contact[row, THIRD_PARTICLE], 0)))
    gap: float = dot(vector_at(numbers, row, CLOTH_NORMAL), p) - numbers[row, CLOTH_OFFSET]
    return gap


@compiled(inline=True)
def add_shares(particle: Any, corners: Corners, column: int, by: Vector, way: Vector) -> None:
    """Add a vector, times each of `by`, to the vectors of three particles at a column."""
    for k in range(3):
        particle[corners[0], column + k] += by[0] * way[k]
        particle[corners[1], column + k] += by[1] * way[k]
        particle[corners[2], column + k] += by[2] * way[k]
