"""The kernel of friction: rolling resistance, torsional friction, and friction at the centre of a contact."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.prepare_simd import INERTIA_A, INERTIA_B, VELOCITY_A, VELOCITY_B
from kickdrift.world.contacts.simd_vectors import NEXT, W, cross, dot, impulses, minus, plus, put, times, turn, vector

_LEVER = (c.P + c.LEVER) * W


@compiled(fast=True)
def solve_friction(own: Any, s: Any, unused: float, none: float, nothing: float, n: int) -> None:
    """Do one sweep over rolling resistance, torsional friction and friction at the centre, bounded by the normal impulses."""
    for lane in range(n):
        normal = vector(own, c.N, lane)
        mass_a, mass_b = own[c.MASS_A * W + lane], own[c.MASS_B * W + lane]
        velocity_a, turn_a = vector(s, VELOCITY_A, lane), vector(s, VELOCITY_A + 3, lane)
        velocity_b, turn_b = vector(s, VELOCITY_B, lane), vector(s, VELOCITY_B + 3, lane)
        n0, n1, n2, n3 = impulses(own, lane)
        pressed = n0 + n1 + n2 + n3
        lever = n0 * own[_LEVER + lane] + n1 * own[_LEVER + NEXT + lane]
        lever += n2 * own[_LEVER + 2 * NEXT + lane] + n3 * own[_LEVER + 3 * NEXT + lane]
        friction = own[c.FRICTION * W + lane]
        # Rolling resistance
        before = vector(own, c.ROLL_IMPULSE, lane)
        after = minus(before, times(own[c.ROLL_MASS * W + lane], minus(turn_b, turn_a)))
        most = own[c.ROLL_RESISTANCE * W + lane] * pressed
        after = times(min(1.0, most / math.sqrt(dot(after, after) + 1e-300)), after)
        put(own, c.ROLL_IMPULSE, lane, after)
        torque = minus(after, before)
        turn_a, turn_b = minus(turn_a, turn(s, INERTIA_A, lane, torque)), plus(turn_b, turn(s, INERTIA_B, lane, torque))
        # Twist takes what rolling resistance leaves of the spin: with both at once boxes would turn to and fro for ever
        old = own[c.TWISTING_IMPULSE * W + lane]
        spin = dot(normal, minus(turn_b, turn_a))
        new = min(max(old - own[c.TWIST_MASS * W + lane] * spin, -friction * lever), friction * lever)
        own[c.TWISTING_IMPULSE * W + lane] = new
        torque = times(new - old, normal)
        turn_a, turn_b = minus(turn_a, turn(s, INERTIA_A, lane, torque)), plus(turn_b, turn(s, INERTIA_B, lane, torque))
        # Friction
        first = vector(own, c.T, lane)
        second = cross(normal, first)
        arm_a = vector(own, c.CENTRE, lane)
        arm_b = minus(arm_a, vector(own, c.BETWEEN, lane))
        (ax, ay, az), (bx, by, bz), (px, py, pz), (qx, qy, qz) = arm_a, arm_b, turn_a, turn_b
        slip = (
            velocity_b[0] + qy * bz - qz * by - velocity_a[0] - py * az + pz * ay,
            velocity_b[1] + qz * bx - qx * bz - velocity_a[1] - pz * ax + px * az,
            velocity_b[2] + qx * by - qy * bx - velocity_a[2] - px * ay + py * ax,
        )
        s1 = dot(first, slip) - own[c.SURFACE_SPEED * W + lane]
        s2 = dot(second, slip) - own[(c.SURFACE_SPEED + 1) * W + lane]
        old1, old2 = own[c.TANGENT_IMPULSE * W + lane], own[(c.TANGENT_IMPULSE + 1) * W + lane]
        most, mass = friction * pressed, own[c.FRICTION_MASS * W + lane]
        new1, new2 = old1 - mass * s1, old2 - mass * s2
        scale = min(1.0, most / math.sqrt(new1 * new1 + new2 * new2 + 1e-300))
        new1, new2 = new1 * scale, new2 * scale
        own[c.TANGENT_IMPULSE * W + lane] = new1
        own[(c.TANGENT_IMPULSE + 1) * W + lane] = new2
        impulse = plus(times(new1 - old1, first), times(new2 - old2, second))
        put(s, VELOCITY_A, lane, minus(velocity_a, times(mass_a, impulse)))
        put(s, VELOCITY_A + 3, lane, minus(turn_a, turn(s, INERTIA_A, lane, cross(arm_a, impulse))))
        put(s, VELOCITY_B, lane, plus(velocity_b, times(mass_b, impulse)))
        put(s, VELOCITY_B + 3, lane, plus(turn_b, turn(s, INERTIA_B, lane, cross(arm_b, impulse))))
