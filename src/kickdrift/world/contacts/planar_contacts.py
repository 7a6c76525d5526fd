"""Contacts of a planar world: the effect within the plane of contacts whose normals are oblique to it.

Bodies move at right angles to the normal p of the plane, so that of a contact's normal n = c n' + s p only n' acts on their
motion. A gap g between them has the length g / c along n'. A push N' along n' is a normal force N' / c; the guides that keep
bodies in the plane bear the rest, and friction is greater by 1 / c, like that of a wedge in a groove.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length, minus, plus, times, turned, turned_back
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts import prepare_simd as r
from kickdrift.world.contacts.constraint_groups import put_vector_of, vector_of

_W = c.WIDTH
_WITHIN = 1e-9  # component of a normal across the plane, below which it is rounding
# Cosine c below which a contact is a floor: bodies lie on it, with friction, and glide over it whatever its slope
_FLOOR = 0.05
# Bodies do not sink into floors to where a spring carries them: with one, balls slide with 0.275 for a coefficient of 0.3.
_RIGID = (0.0, 1.0, 0.0)
_ROLLS = 1e-6  # sine of the angle between the axis of a cylinder or cone and p, up to which it rolls in the plane


@compiled
def flatten_contact(raw: Any, plane: Vector) -> None:
    """Transform the gathered data of a contact to the plane with this normal."""
    normal = vector_of(raw, r.NORMAL)
    across = dot(plane, normal)
    if abs(across) <= _WITHIN:
        return
    put_vector_of(raw, r.SPIN_AXIS, (0.0, 0.0, 0.0))  # the normal within the plane does not meet the axis
    within = minus(normal, times(across, plane))
    cosine = length(within)
    _keep_from_rolling(raw, r.AXIS_A, r.TURN_A, r.ON_A, 0, normal, plane)
    _keep_from_rolling(raw, r.AXIS_B, r.TURN_B, r.ON_B, 1, times(-1.0, normal), plane)
    is_floor = cosine < _FLOOR
    flat = times(math.copysign(1.0, across), plane) if is_floor else times(1.0 / cosine, within)
    most = 0.0  # points share one normal and one coefficient of friction: those of the one that touches most within the plane
    for k in range(int(raw[r.COUNT * _W])):
        if is_floor:
            _lay_on_floor(raw, k, normal, flat)
        else:
            most = max(most, _flatten_point(raw, k, plane, flat, cosine, across))
    if is_floor:
        put_vector_of(raw, r.SOFTNESS, _RIGID)
    elif most < _FLOOR:  # round shapes that pass each other
        raw[r.COUNT * _W] = 0.0
        for field in range(r.IMPULSE, r.IMPULSE + 4):
            raw[field * _W] = 0.0
        for field in range(r.FRICTION_IMPULSE, r.TWISTED + 1):
            raw[field * _W] = 0.0
        put_vector_of(raw, r.ROLLED, (0.0, 0.0, 0.0))
    else:
        raw[r.FRICTION * _W] /= most
        raw[r.RESISTANCE * _W] /= most
    put_vector_of(raw, r.NORMAL, flat)


@compiled(inline=True)
def _turn(raw: Any, field: int) -> Any:
    return (raw[field * _W], raw[(field + 1) * _W], raw[(field + 2) * _W], raw[(field + 3) * _W])


@compiled
def _move(raw: Any, turn: int, point: int, way: Vector) -> None:
    """Move a point, which is given in the frame of its shape, by a way in the world's axes."""
    put_vector_of(raw, point, plus(vector_of(raw, point), turned_back(_turn(raw, turn), way)))


@compiled
def _keep_from_rolling(raw: Any, axis: int, turn: int, points: int, side: int, out: Vector, plane: Vector) -> None:
    """Fix in the body the points of a shape whose axis is not along p: in the plane it does not turn about it."""
    along = vector_of(raw, axis)
    off = minus(along, times(dot(plane, along), plane))
    if dot(along, along) == 0.0 or dot(off, off) <= _ROLLS**2:
        return
    radial = minus(out, times(dot(along, out), along))
    radial = times(1.0 / max(length(radial), 1e-150), radial)
    for k in range(4):
        at, radius = points + c.ANCHOR_SIZE * k, (r.RADII + c.ANCHOR_SIZE * k + side) * _W
        _move(raw, turn, at, times(raw[radius], radial))
        raw[radius] = 0.0
    put_vector_of(raw, axis, (0.0, 0.0, 0.0))


@compiled(inline=True)
def _apart(raw: Any, k: int) -> Vector:
    """From the first point to the second; of round shapes from core to core."""
    at = c.ANCHOR_SIZE * k
    a = plus(turned(_turn(raw, r.TURN_A), vector_of(raw, r.ON_A + at)), vector_of(raw, r.ARM_A))
    b = plus(turned(_turn(raw, r.TURN_B), vector_of(raw, r.ON_B + at)), vector_of(raw, r.ARM_B))
    return minus(plus(b, vector_of(raw, r.APART)), a)


@compiled
def _flatten_point(raw: Any, k: int, plane: Vector, flat: Vector, cosine: float, across: float) -> float:
    """Make radii and gap of a point those in the plane, and return the cosine where it touches.

    Of balls and capsules only the part c of the radius lies in the plane. Where one touches a face or an edge, the point of
    that shape is moved along it to the depth at which they touch. Two round shapes touch where the distance of their cores in
    the plane is that which their depths leave.
    """
    at = c.ANCHOR_SIZE * k
    radii = (r.RADII + at) * _W
    radius_a = raw[radii] if dot(vector_of(raw, r.AXIS_A), vector_of(raw, r.AXIS_A)) == 0.0 else 0.0
    radius_b = raw[radii + _W] if dot(vector_of(raw, r.AXIS_B), vector_of(raw, r.AXIS_B)) == 0.0 else 0.0
    deep = dot(plane, _apart(raw, k))
    if radius_a > 0.0 and radius_b > 0.0:
        sine = deep / (radius_a + radius_b)
        cosine = math.sqrt(max(1.0 - sine * sine, 0.0))
        _move(raw, r.TURN_B, r.ON_B + at, times(-deep, plane))
    else:
        deep -= across * (radius_a + radius_b)
        way = minus(times(deep * across / cosine, flat), times(deep, plane))
        if radius_b > 0.0:
            _move(raw, r.TURN_A, r.ON_A + at, times(-1.0, way))
        else:
            _move(raw, r.TURN_B, r.ON_B + at, way)
    raw[radii] -= (1.0 - cosine) * radius_a
    raw[radii + _W] -= (1.0 - cosine) * radius_b
    return cosine


@compiled
def _lay_on_floor(raw: Any, k: int, normal: Vector, flat: Vector) -> None:
    """Set the gap of an overlapping point of a floor to zero, since no motion in the plane can end the overlap."""
    at = c.ANCHOR_SIZE * k
    radii = raw[(r.RADII + at) * _W] + raw[(r.RADII + at + 1) * _W]
    apart = _apart(raw, k)
    gap = max(dot(normal, apart) - radii, 0.0)
    _move(raw, r.TURN_B, r.ON_B + at, times(gap + radii - dot(flat, apart), flat))
