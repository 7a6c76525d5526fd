"""Constraints from manifolds, in lanes: makes a group from the data of eight contacts.

`raw` are the fields that `kickdrift.world.contacts.constraint_inputs` gathers, `own` those of the group, `s` the scratch, whose
fields are declared here too. `kickdrift.world.contacts.contact_solver_simd` explains how loops over lanes are written.
Positions are relative to the centre of mass of the first body, where rounding errors are small.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector
from kickdrift.world.columns import Fields
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.simd_vectors import NEXT, W, cross, dot, minus, plus, put, times, turn, vector

# Fields of raw
_RAW = Fields()
NORMAL = _RAW.field(3)  # in the world's axes
TURN_A = _RAW.field(4)  # orientation of the first shape
ARM_A = _RAW.field(3, "m")  # and its origin from the centre of its body
TURN_B = _RAW.field(4)
ARM_B = _RAW.field(3, "m")
APART = _RAW.field(3, "m")  # from the centre of the first body to that of the second
_POINTS = _RAW.field(4 * c.ANCHOR_SIZE)  # as those of a constraint, in the frames of the shapes
ON_A, ON_B, RADII = _POINTS + c.ANCHOR_A, _POINTS + c.ANCHOR_B, _POINTS + c.RADII
IMPULSE = _RAW.field(4, "N s")  # of the points
COUNT = _RAW.field()
MASS_A = _RAW.field(1, "1/kg")  # inverse
MASS_B = _RAW.field(1, "1/kg")
FRICTION = _RAW.field()
SURFACE_SLIP = _RAW.field(3, "m/s")
FRICTION_IMPULSE = _RAW.field(3, "N s")
TWISTED = _RAW.field(1, "N m s")
RESISTANCE = _RAW.field(1, "m")
ROLLED = _RAW.field(3, "N m s")
SOFTNESS = _RAW.field(3)
SHARE = _RAW.field()
TURNS = _RAW.field()
LANDING = _RAW.field(1, "m/s")
STALE = _RAW.field(2, "rad, m")
HALF_A = _RAW.field(3, "m")  # half axes of the cores of balls and capsules, in the world's axes, if the normal turns
HALF_B = _RAW.field(3, "m")
AXIS_A = _RAW.field(3)  # in the world's axes
AXIS_B = _RAW.field(3)
SPIN_AXIS = _RAW.field(3)  # in the world's axes
TURNING_A = _RAW.field(3, "rad/s")  # angular velocities
TURNING_B = _RAW.field(3, "rad/s")
RAW = _RAW.close()

# Fields of scratch, of the first bodies and the second
_SCRATCH = Fields()
VELOCITY_A = _SCRATCH.field(6, "m/s, rad/s")
VELOCITY_B = _SCRATCH.field(6, "m/s, rad/s")
DELTA_POSE_A = _SCRATCH.field(6, "m, rad")
DELTA_POSE_B = _SCRATCH.field(6, "m, rad")
INERTIA_A = _SCRATCH.field(6, "1/(kg m^2)")  # inverse
INERTIA_B = _SCRATCH.field(6, "1/(kg m^2)")
TURNED_A = _SCRATCH.field(4)  # rotations of the bodies since the step began, or from the present to the pose at rest
TURNED_B = _SCRATCH.field(4)
FROM_A_TO_B = _SCRATCH.field(3, "m")
MARK = _SCRATCH.field()  # 1.0 where arms are to be recomputed; or the residual of the contact, m/s
SCRATCH_SIZE = _SCRATCH.close() * W
_ANCHORS, _ANCHOR = c.ANCHORS * W, c.ANCHOR_SIZE * W


@compiled(fast=True, inline=True)
def turned(array: Any, field: int, lane: int, a: Vector) -> Vector:
    """Return a vector rotated by the quaternion in a field."""
    i, (x, y, z) = field * W + lane, a
    w, u, v, t = array[i], array[i + W], array[i + 2 * W], array[i + 3 * W]
    p, q, r = 2.0 * (v * z - t * y), 2.0 * (t * x - u * z), 2.0 * (u * y - v * x)
    return x + w * p + v * r - t * q, y + w * q + t * p - u * r, z + w * r + u * q - v * p


@compiled(fast=True, inline=True)
def response_to(array: Any, field: int, lane: int, a: Vector, b: Vector) -> float:
    """Return b . M a for the symmetric matrix M in a field."""
    return dot(b, turn(array, field, lane, a))


@compiled(fast=True, inline=True)
def bend_of(array: Any, field: int, lane: int, n: Vector, arm: Vector) -> float:
    """Return the centripetal acceleration along n of a point with an arm, with the angular velocity in a field."""
    w = vector(array, field, lane)
    along = dot(n, w) * dot(w, arm)
    bend: float = along - dot(w, w) * dot(n, arm)
    return bend


@compiled(fast=True, inline=True)
def away(array: Any, field: int, lane: int, n: Vector, axis: Vector) -> tuple[Vector, float, float]:
    """Return the direction of radii about an axis, which rotates with the angular velocity in a field.

    Returns
    -------
    direction : (3,) tuple
        Unit vector: the part of n perpendicular to the axis; n if the axis is zero.
    rise : float
        Its component along n, sqrt(1 - m^2) with m = n . axis.
    bend : float
        The second derivative of this component, 1/s^2.
    """
    along = dot(n, axis)
    slope = dot(n, cross(vector(array, field, lane), axis))
    bend = bend_of(array, field, lane, n, axis)
    out = minus(n, times(along, axis))
    rise = math.sqrt(dot(out, out) + 1e-300)
    scale = 1.0 / rise
    return times(scale, out), rise, -(slope * slope * scale * scale + along * bend) * scale


@compiled(fast=True, inline=True)
def _fill_point(own: Any, raw: Any, lane: int, j: int, i: int, at: int, h: float, round_a: Any, round_b: Any) -> None:
    """Write the anchors of a point at `at`, and its gap into its fields, which begin at i; its raw fields begin at j.

    Sweeps assume that the speed of a gap is constant within the substep h; the gap includes the second-order term of rotation.
    """
    n = vector(raw, NORMAL, lane)
    arm_a = vector(raw, ARM_A, lane)
    on_a = plus(turned(raw, TURN_A, lane, vector(raw, 0, j)), arm_a)
    put(own, 0, at, on_a)
    arm_b = vector(raw, ARM_B, lane)
    on_b = plus(turned(raw, TURN_B, lane, vector(raw, 3, j)), arm_b)
    put(own, 3, at, on_b)
    gap = dot(n, minus(plus(on_b, vector(raw, APART, lane)), on_a))
    bend = bend_of(raw, TURNING_B, lane, n, on_b) - bend_of(raw, TURNING_A, lane, n, on_a)
    (_, rise_a, bend_a), (_, rise_b, bend_b) = round_a, round_b
    radius_a, radius_b = raw[j + c.RADII * W], raw[j + (c.RADII + 1) * W]
    own[at + c.RADII * W], own[at + (c.RADII + 1) * W] = radius_a, radius_b
    bend -= radius_a * bend_a + radius_b * bend_b
    own[i + c.GAP * W] = gap - radius_a * rise_a - radius_b * rise_b + 0.5 * h * h * bend


@compiled(fast=True)
def fill(own: Any, raw: Any, h: float, unused: float, none: float, count: int) -> None:
    """Write all fields of the constraints of a group except those of `refresh` and `refresh_friction`; h is the substep, s."""
    for lane in range(count):
        i, j, at = c.P * W + lane, ON_A * W + lane, _ANCHORS + lane
        n = vector(raw, NORMAL, lane)
        axis = vector(raw, AXIS_A, lane)
        put(own, c.AXES, lane, axis)
        round_a = away(raw, TURNING_A, lane, n, axis)
        axis = vector(raw, AXIS_B, lane)
        put(own, c.AXES + 3, lane, axis)
        put(own, c.SPIN_AXIS, lane, vector(raw, SPIN_AXIS, lane))
        round_b = away(raw, TURNING_B, lane, n, axis)
        _fill_point(own, raw, lane, j, i, at, h, round_a, round_b)
        _fill_point(own, raw, lane, j + _ANCHOR, i + NEXT, at + _ANCHOR, h, round_a, round_b)
        _fill_point(own, raw, lane, j + 2 * _ANCHOR, i + 2 * NEXT, at + 2 * _ANCHOR, h, round_a, round_b)
        _fill_point(own, raw, lane, j + 3 * _ANCHOR, i + 3 * NEXT, at + 3 * _ANCHOR, h, round_a, round_b)
        i += c.IMPULSE * W
        own[i], own[i + NEXT] = raw[IMPULSE * W + lane], raw[(IMPULSE + 1) * W + lane]
        own[i + 2 * NEXT], own[i + 3 * NEXT] = raw[(IMPULSE + 2) * W + lane], raw[(IMPULSE + 3) * W + lane]
        own[c.TURNS * W + lane] = raw[TURNS * W + lane]
        own[c.SHARE * W + lane], own[c.COUNT * W + lane] = raw[SHARE * W + lane], raw[COUNT * W + lane]
        own[c.MOST_TURN * W + lane], own[c.MOST_SLIDE * W + lane] = raw[STALE * W + lane], raw[(STALE + 1) * W + lane]
        own[c.REFRESHED * W + lane], own[c.BOUNCE_THRESHOLD * W + lane] = 0.0, 1e300
        own[c.LANDED * W + lane], own[c.LANDING_SPEED * W + lane] = 0.0, raw[LANDING * W + lane]
        own[c.MASS_A * W + lane], own[c.MASS_B * W + lane] = raw[MASS_A * W + lane], raw[MASS_B * W + lane]
        put(own, c.BIAS_RATE, lane, vector(raw, SOFTNESS, lane))
        n = vector(raw, NORMAL, lane)
        put(own, c.N, lane, n)
        # A tangent perpendicular to the normal, and to z unless the normal is close to it.
        low = 1.0 if abs(n[2]) < 0.7 else 0.0
        first = (-low * n[1], low * n[0] - (1.0 - low) * n[2], (1.0 - low) * n[1])
        first = times(1.0 / math.sqrt(dot(first, first) + 1e-300), first)
        put(own, c.T, lane, first)
        second = cross(n, first)
        own[c.FRICTION * W + lane] = raw[FRICTION * W + lane]
        slip = vector(raw, SURFACE_SLIP, lane)
        own[c.SURFACE_SPEED * W + lane], own[(c.SURFACE_SPEED + 1) * W + lane] = dot(first, slip), dot(second, slip)
        rubbed = vector(raw, FRICTION_IMPULSE, lane)
        own[c.TANGENT_IMPULSE * W + lane], own[(c.TANGENT_IMPULSE + 1) * W + lane] = (
            dot(first, rubbed),
            dot(second, rubbed),
        )
        own[c.TWISTING_IMPULSE * W + lane] = raw[TWISTED * W + lane]
        own[c.ROLL_RESISTANCE * W + lane] = raw[RESISTANCE * W + lane]
        put(own, c.ROLL_IMPULSE, lane, vector(raw, ROLLED, lane))
