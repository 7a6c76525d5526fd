"""Normals and arms of contacts whose bodies have moved since the step began.

The core of a ball is its centre, that of a capsule a segment. The normal of two such shapes is the direction between the
nearest points of their cores, which turns as they pass each other; their arms end on these cores, so that their impulse has no
torque about the axes of capsules.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, exponential, length, minus, plus, product, times, turned
from kickdrift.world.collision.shape_poses import pose_on_body
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.constraint_groups import vector_of
from kickdrift.world.contacts.impacts.impact_motion import Place, is_moved, place_of
from kickdrift.world.contacts.round_cores import are_parallel, half_axis
from kickdrift.world.layout import ANGULAR_VELOCITY, BODY_ROW, ORIENTATION, POSITION, VELOCITY
from kickdrift.world.settings import PLANE_NORMAL
from kickdrift.world.shapes.closest_points import along, clamped, segments
from kickdrift.world.tables import CONTACT, MOTION, POSE, SETTINGS, SHAPE, STARTED_POSE, floats, integers

_NONE: Vector = (0.0, 0.0, 0.0)
_PARALLEL = 1e-7  # sine of the angle between two axes below which capsules touch side by side, at two points


@compiled
def normal_between(world: int, row: int, own: Any, a: Place, b: Place) -> tuple[Vector, float]:
    """Return the normal of a contact at these places, and the distance over which it turns, m.

    For two balls it turns over the distance of their centres. With a capsule the distance counts as infinite, which leaves the
    turning out of the gap's second derivative only; the normal of other shapes is the one found, and does not turn.
    """
    normal = vector_of(own, c.N)
    if not _is_between_cores(own):
        return normal, math.inf
    contact = integers(world, CONTACT)
    core_a, core_b = _core(world, contact[row, c.SHAPE_A], a), _core(world, contact[row, c.SHAPE_B], b)
    first, second = _nearest(core_a, core_b)
    line, plane = minus(second, first), vector_at(floats(world, SETTINGS), 0, PLANE_NORMAL)
    line = minus(line, times(dot(plane, line), plane))
    far = length(line)
    if far <= 1e-9 * (own[(c.ANCHORS + c.RADII) * c.WIDTH] + own[(c.ANCHORS + c.RADII + 1) * c.WIDTH]):
        return normal, math.inf
    passes = core_a[1] == _NONE and core_b[1] == _NONE
    return times(1.0 / far, line), far if passes else math.inf


@compiled
def arms_between(own: Any, point: int, normal: Vector, a: Place, b: Place) -> tuple[Vector, Vector, Vector]:
    """Return the arms of both bodies to their own points of contact, and the vector from the first point to the second."""
    anchor = c.ANCHORS + c.ANCHOR_SIZE * point
    arm_a, arm_b = turned(a[1], vector_of(own, anchor)), turned(b[1], vector_of(own, anchor + c.ANCHOR_B))
    radius_a, radius_b = own[(anchor + c.RADII) * c.WIDTH], own[(anchor + c.RADII + 1) * c.WIDTH]
    arm_a = plus(arm_a, times(radius_a, _away(turned(a[1], vector_of(own, c.AXES)), normal)))
    arm_b = minus(arm_b, times(radius_b, _away(turned(b[1], vector_of(own, c.AXES + 3)), normal)))
    return arm_a, arm_b, minus(plus(minus(b[0], a[0]), arm_b), arm_a)


@compiled
def meeting_arms(
    world: int, row: int, own: Any, point: int, normal: Vector, a: Place, b: Place
) -> tuple[Vector, Vector, float]:
    """Return the arms of both bodies to a point of contact at their impact, and its gap.

    The places `a` and `b` are those of the bodies then.
    """
    contact = integers(world, CONTACT)
    arm_a, arm_b, between = arms_between(own, point, normal, a, b)
    gap, share = dot(normal, between), own[c.SHARE * c.WIDTH]
    if not _is_between_cores(own):
        return plus(arm_a, times(share, between)), minus(arm_b, times(1.0 - share, between)), gap
    core_a, core_b = _core(world, contact[row, c.SHAPE_A], a), _core(world, contact[row, c.SHAPE_B], b)
    if own[c.COUNT * c.WIDTH] > 1.0 and are_parallel(core_a[1], core_b[1], _PARALLEL):
        # Both points slide along the axes only: any other slide would give the impulse a torque about these.
        slid = times(dot(core_a[1], between) / dot(core_a[1], core_a[1]), core_a[1])
    else:
        first, second = _nearest(core_a, core_b)
        radii, slid = c.ANCHORS + c.ANCHOR_SIZE * point + c.RADII, _NONE
        arm_a = plus(minus(first, a[0]), times(own[radii * c.WIDTH], normal))
        arm_b = minus(minus(second, b[0]), times(own[(radii + 1) * c.WIDTH], normal))
    # They end at one point: otherwise the friction of shapes that overlap would change the angular momentum.
    between = plus(minus(minus(b[0], a[0]), arm_a), arm_b)
    slid = plus(slid, times(dot(normal, between), normal))
    return plus(arm_a, times(share, slid)), minus(arm_b, times(1.0 - share, slid)), gap


@compiled
def meets_at_one_point(world: int, row: int, own: Any, a: Place, b: Place) -> bool:
    """Whether a contact has one point whatever is listed: it is that of two balls or capsules that are not parallel."""
    contact = integers(world, CONTACT)
    if not _is_between_cores(own):
        return False
    core_a, core_b = _core(world, contact[row, c.SHAPE_A], a), _core(world, contact[row, c.SHAPE_B], b)
    return not are_parallel(core_a[1], core_b[1], _PARALLEL)


@compiled(inline=True)
def torque_arm(own: Any, place: Place, arm: Vector, normal: Vector) -> Vector:
    """Return arm x normal of the body that moves, without its part about the axis of a solid of revolution, if there is one."""
    turn, axis = cross(arm, normal), turned(place[1], vector_of(own, c.SPIN_AXIS))
    return minus(turn, times(dot(turn, axis), axis))


@compiled(inline=True)
def place_now(world: int, body: int, when: float) -> Place:
    """Return the present place of a body, or for an immovable one that at a time in the substep: it is not moved to impacts."""
    pose, motion = floats(world, POSE), floats(world, MOTION)
    at, q = vector_at(pose, body, POSITION), quaternion_at(pose, body, ORIENTATION)
    if not is_moved(world, body):
        at = plus(at, times(when, vector_at(motion, body, VELOCITY)))
        q = product(exponential(times(when, vector_at(motion, body, ANGULAR_VELOCITY))), q)
    return place_of(world, body, at, q)


@compiled(inline=True)
def _away(axis: Vector, normal: Vector) -> Vector:
    """Return the direction of radii about an axis: the part of the normal perpendicular to it; the normal for a zero axis."""
    way = minus(normal, times(dot(normal, axis), axis))
    return times(1.0 / max(length(way), 1e-150), way)


@compiled(inline=True)
def _is_between_cores(own: Any) -> bool:
    """Whether both shapes of a contact are balls or capsules."""
    radii, axes = c.ANCHORS + c.RADII, c.AXES
    about_axes = length(vector_of(own, axes)) + length(vector_of(own, axes + 3)) > 0.0
    return bool(own[radii * c.WIDTH] > 0.0 and own[(radii + 1) * c.WIDTH] > 0.0 and not about_axes)


@compiled
def _core(world: int, shape: int, place: Place) -> tuple[Vector, Vector]:
    """Return the middle of the core of a ball or a capsule whose body is at a place, and the vector from there to its end."""
    shapes = integers(world, SHAPE)
    started = quaternion_at(floats(world, STARTED_POSE), shapes[shape, BODY_ROW], ORIENTATION)
    at, q = pose_on_body(world, shape, place[0], product(place[1], started))
    return at, half_axis(world, shape, q)


@compiled
def _nearest(a: tuple[Vector, Vector], b: tuple[Vector, Vector]) -> tuple[Vector, Vector]:
    """Return the nearest points of two cores."""
    (middle, u), (other, v) = a, b
    offset, uu, vv, s, t = minus(other, middle), dot(u, u), dot(v, v), 0.0, 0.0
    if uu > 0.0 and vv > 0.0:
        s, t = segments(offset, u, v)
    elif uu > 0.0:
        s = clamped(dot(offset, u) / uu, -1.0, 1.0)
    elif vv > 0.0:
        t = clamped(-dot(offset, v) / vv, -1.0, 1.0)
    return along(middle, s, u), along(other, t, v)
