"""Arms, effective masses and gaps of constraints, in lanes, for the present poses of bodies.

In the sweeps, `refresh` and `refresh_friction` alone compute arms and effective masses. Points turn with their bodies; for
round shapes the core does (`kickdrift.world.contacts.round_cores`), and the radius stays along the normal, so that spinning
about the core does not turn the contact, and rolling does not open it. Both arms end at one point, which conserves momentum and
angular momentum.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.prepare_simd import (
    DELTA_POSE_A,
    DELTA_POSE_B,
    FROM_A_TO_B,
    INERTIA_A,
    INERTIA_B,
    MARK,
    TURNED_A,
    TURNED_B,
    VELOCITY_A,
    VELOCITY_B,
    away,
    bend_of,
    response_to,
    turned,
)
from kickdrift.world.contacts.simd_vectors import NEXT, W, chosen, cross, dot, minus, plus, put_where, times, vector

# Factors by which turns about the normal and slides count more than tilts in deciding whether arms are kept
TWIST_STRICTNESS, SLIP_STRICTNESS = 50.0, 2.0
_ANCHORS, _ANCHOR = c.ANCHORS * W, c.ANCHOR_SIZE * W


@compiled(fast=True)
def find_stale(own: Any, s: Any, unused: float, none: float, nothing: float, n: int) -> None:
    """Mark lanes whose bodies have turned, slid past each other or approached since their arms were computed.

    Turns about the normal count `TWIST_STRICTNESS` times as much as tilts, and slides `SLIP_STRICTNESS` times as much as
    approaches. Arms from before an approach end at two points, and friction would change the angular momentum.
    """
    for lane in range(n):
        normal = vector(own, c.N, lane)
        turn_a = minus(vector(s, DELTA_POSE_A + 3, lane), vector(own, c.REFERENCE, lane))
        turn_b = minus(vector(s, DELTA_POSE_B + 3, lane), vector(own, c.REFERENCE + 3, lane))
        way = minus(vector(s, DELTA_POSE_B, lane), vector(s, DELTA_POSE_A, lane))
        way = minus(way, vector(own, c.REFERENCE + 6, lane))
        arm_a = vector(own, c.CENTRE, lane)
        arm_b = minus(arm_a, vector(own, c.BETWEEN, lane))
        way = plus(minus(way, cross(turn_a, arm_a)), cross(turn_b, arm_b))
        along = dot(normal, way)
        slid = dot(way, way) - along * along
        twist_a, twist_b, more = dot(normal, turn_a), dot(normal, turn_b), TWIST_STRICTNESS**2 - 1.0
        turned_a = dot(turn_a, turn_a) + more * twist_a * twist_a
        turned_b = dot(turn_b, turn_b) + more * twist_b * twist_b
        most, farthest = own[c.MOST_TURN * W + lane], own[c.MOST_SLIDE * W + lane]
        turned = 1.0 if max(turned_a, turned_b) > most * most else 0.0
        moved = SLIP_STRICTNESS**2 * slid + along * along
        s[MARK * W + lane] = max(turned, 1.0 if moved > farthest * farthest else 0.0)


@compiled(fast=True, inline=True)
def _refresh_point(
    own: Any, s: Any, lane: int, i: int, at: int, k: float, slop: float, h: float, rounds: Any, axis: Any, sums: Any
) -> Any:
    """Recompute arm, effective mass and, if h > 0, the gap of a point; return the weighted sum of positions so far."""
    n, between = vector(own, c.N, lane), vector(s, FROM_A_TO_B, lane)
    weight, middle = sums
    there = 1.0 if own[c.COUNT * W + lane] > k else 0.0
    (out_a, _, bend_a), (out_b, _, bend_b) = rounds
    radius_a = own[at + c.RADII * W]
    on_a = turned(s, TURNED_A, lane, vector(own, c.ANCHOR_A, at))
    bend = bend_of(s, VELOCITY_A + 3, lane, n, on_a) + radius_a * bend_a
    on_a = plus(on_a, times(radius_a, out_a))
    radius_b = own[at + (c.RADII + 1) * W]
    on_b = turned(s, TURNED_B, lane, vector(own, c.ANCHOR_B, at))
    bend = bend_of(s, VELOCITY_B + 3, lane, n, on_b) - radius_b * bend_b - bend
    apart = minus(minus(plus(on_b, between), times(radius_b, out_b)), on_a)
    gap = dot(n, apart)
    on_a = plus(on_a, times(own[c.SHARE * W + lane], apart))
    arm_a, arm_b = cross(on_a, n), cross(minus(on_a, between), n)
    # One of the bodies is immovable where there is an axis; the change of its own arm has no effect.
    spin = dot(chosen(own[c.MASS_A * W + lane] == 0.0, arm_b, arm_a), axis)
    arm_a, arm_b = minus(arm_a, times(spin, axis)), minus(arm_b, times(spin, axis))
    response = own[c.MASS_A * W + lane] + own[c.MASS_B * W + lane]
    response += response_to(s, INERTIA_A, lane, arm_a, arm_a) + response_to(s, INERTIA_B, lane, arm_b, arm_b)
    way_a, way_b = vector(s, DELTA_POSE_A, lane), vector(s, DELTA_POSE_B, lane)
    tilt_a, tilt_b = vector(s, DELTA_POSE_A + 3, lane), vector(s, DELTA_POSE_B + 3, lane)
    linear = dot(n, minus(way_b, way_a)) + dot(arm_b, tilt_b) - dot(arm_a, tilt_a)
    anew = s[MARK * W + lane] > 0.0
    old = own[i + c.GAP * W]
    own[i + c.GAP * W] = gap - linear + 0.5 * h * h * bend if anew & (h > 0.0) else old
    put_where(anew, own, c.ARM, i, times(there, arm_a))
    old = own[i + c.POINT_MASS * W]
    own[i + c.POINT_MASS * W] = there / (response + 1e-300) if anew else old
    # Touching points carry the friction, and the centre must not jump when a distant one appears or disappears.
    part = there * min(max(2.0 - gap / (4.0 * slop), 1e-10), 1.0)
    return weight + part, plus(middle, times(part, on_a))


@compiled(fast=True)
def refresh(own: Any, s: Any, slop: float, h: float, none: float, n: int) -> None:
    """Recompute arms, effective masses and centres of the marked lanes, and gaps unless h is 0.0."""
    for lane in range(n):
        sums = (0.0, (0.0, 0.0, 0.0))
        i, at = c.P * W + lane, _ANCHORS + lane
        normal = vector(own, c.N, lane)
        axis = turned(s, TURNED_A, lane, vector(own, c.AXES, lane))
        round_a = away(s, VELOCITY_A + 3, lane, normal, axis)
        axis = turned(s, TURNED_B, lane, vector(own, c.AXES + 3, lane))
        spin = vector(own, c.SPIN_AXIS, lane)
        fixed = own[c.MASS_A * W + lane] == 0.0
        rounds = (round_a, away(s, VELOCITY_B + 3, lane, normal, axis))
        axis = chosen(fixed, turned(s, TURNED_B, lane, spin), turned(s, TURNED_A, lane, spin))
        sums = _refresh_point(own, s, lane, i, at, 0.5, slop, h, rounds, axis, sums)
        sums = _refresh_point(own, s, lane, i + NEXT, at + _ANCHOR, 1.5, slop, h, rounds, axis, sums)
        sums = _refresh_point(own, s, lane, i + 2 * NEXT, at + 2 * _ANCHOR, 2.5, slop, h, rounds, axis, sums)
        sums = _refresh_point(own, s, lane, i + 3 * NEXT, at + 3 * _ANCHOR, 3.5, slop, h, rounds, axis, sums)
        anew, (weight, middle) = s[MARK * W + lane] > 0.0, sums
        put_where(anew, own, c.CENTRE, lane, times(1.0 / (weight + 1e-300), middle))
        put_where(anew, own, c.BETWEEN, lane, vector(s, FROM_A_TO_B, lane))


@compiled(fast=True, inline=True)
def _write_lever(own: Any, i: int, normal: Any, centre: Any) -> None:
    """Write the distance of a point from the centre of the contact in its plane; arms are products with the normal."""
    off = minus(vector(own, c.ARM, i), cross(centre, normal))
    own[i + c.LEVER * W] = math.sqrt(dot(off, off))


@compiled(fast=True)
def refresh_friction(own: Any, s: Any, unused: float, moved: float, none: float, n: int) -> None:
    """Recompute effective masses of friction, torsion and rolling resistance in the marked lanes, after `refresh`."""
    for lane in range(n):
        normal, first = vector(own, c.N, lane), vector(own, c.T, lane)
        second = cross(normal, first)
        arm_a = vector(own, c.CENTRE, lane)
        arm_b = minus(arm_a, vector(own, c.BETWEEN, lane))
        i = c.P * W + lane
        _write_lever(own, i, normal, arm_a)
        _write_lever(own, i + NEXT, normal, arm_a)
        _write_lever(own, i + 2 * NEXT, normal, arm_a)
        _write_lever(own, i + 3 * NEXT, normal, arm_a)
        k11 = own[c.MASS_A * W + lane] + own[c.MASS_B * W + lane]
        p_a, q_a, p_b, q_b = cross(arm_a, first), cross(arm_a, second), cross(arm_b, first), cross(arm_b, second)
        k12 = response_to(s, INERTIA_A, lane, p_a, q_a) + response_to(s, INERTIA_B, lane, p_b, q_b)
        k22 = k11 + response_to(s, INERTIA_A, lane, q_a, q_a) + response_to(s, INERTIA_B, lane, q_b, q_b)
        k11 += response_to(s, INERTIA_A, lane, p_a, p_a) + response_to(s, INERTIA_B, lane, p_b, p_b)
        # One mass for all directions, that of the largest response. Off the line of centres the impulse that stops a contact
        # does not oppose its sliding, as friction does; and where many bodies rest on each other, such impulses overshoot
        # together: of 40 chimneys of 66 to 180 blocks 10 would move at 0.03 m/s and more for ever, now 2.
        half, between = 0.5 * (k11 + k22), 0.5 * (k11 - k22)
        response = half + math.sqrt(between * between + k12 * k12)
        spin = response_to(s, INERTIA_A, lane, normal, normal) + response_to(s, INERTIA_B, lane, normal, normal)
        # The mean of the three inverse moments of inertia: one number for every axis of rolling.
        i, j = INERTIA_A * W + lane, INERTIA_B * W + lane
        trace = s[i] + s[i + W] + s[i + 2 * W] + s[j] + s[j + W] + s[j + 2 * W]
        anew = s[MARK * W + lane] > 0.0
        twist_mass, roll_mass = own[c.TWIST_MASS * W + lane], own[c.ROLL_MASS * W + lane]
        friction_mass = own[c.FRICTION_MASS * W + lane]
        own[c.FRICTION_MASS * W + lane] = 1.0 / (response + 1e-300) if anew else friction_mass
        own[c.TWIST_MASS * W + lane] = 1.0 / (spin + 1e-300) if anew else twist_mass
        own[c.ROLL_MASS * W + lane] = 3.0 / (trace + 1e-300) if anew else roll_mass
        put_where(anew, own, c.REFERENCE, lane, vector(s, DELTA_POSE_A + 3, lane))
        put_where(anew, own, c.REFERENCE + 3, lane, vector(s, DELTA_POSE_B + 3, lane))
        way_a, way_b = vector(s, DELTA_POSE_A, lane), vector(s, DELTA_POSE_B, lane)
        put_where(anew, own, c.REFERENCE + 6, lane, minus(way_b, way_a))
        own[c.REFRESHED * W + lane] = max(own[c.REFRESHED * W + lane], moved * s[MARK * W + lane])
