"""The kernel of friction: rolling resistance, torsional friction, and friction at the centre of a contact."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.prepare_simd import INERTIA_A, INERTIA_B, VELOCITY_A, VELOCITY_B
from kickdrift.world.contacts.simd_vectors import NEXT, W, impulses, put, turn, vector

_LEVER = (c.P + c.LEVER) * W


@compiled(fast=True)
def solve_friction(own: Any, s: Any, per_h: float, soft: float, bound: float, n: int) -> None:
    """Do one sweep over rolling resistance, torsional friction and friction at the centre, bounded by the normal impulses."""
    for lane in range(n):
        nx, ny, nz = vector(own, c.N, lane)
        mass_a, mass_b = own[c.MASS_A * W + lane], own[c.MASS_B * W + lane]
        vax, vay, vaz = vector(s, VELOCITY_A, lane)
        wax, way, waz = vector(s, VELOCITY_A + 3, lane)
        vbx, vby, vbz = vector(s, VELOCITY_B, lane)
        wbx, wby, wbz = vector(s, VELOCITY_B + 3, lane)
        n0, n1, n2, n3 = impulses(own, lane)
        normal = n0 + n1 + n2 + n3
        lever = n0 * own[_LEVER + lane] + n1 * own[_LEVER + NEXT + lane]
        lever += n2 * own[_LEVER + 2 * NEXT + lane] + n3 * own[_LEVER + 3 * NEXT + lane]
        friction = own[c.FRICTION * W + lane]
        # Rolling resistance
        px, py, pz = vector(own, c.ROLL_IMPULSE, lane)
        mass = own[c.ROLL_MASS * W + lane]
        qx, qy, qz = px - mass * (wbx - wax), py - mass * (wby - way), pz - mass * (wbz - waz)
        most = own[c.ROLL_RESISTANCE * W + lane] * normal
        scale = min(1.0, most / math.sqrt(qx * qx + qy * qy + qz * qz + 1e-300))
        qx, qy, qz = qx * scale, qy * scale, qz * scale
        put(own, c.ROLL_IMPULSE, lane, qx, qy, qz)
        tx, ty, tz = qx - px, qy - py, qz - pz
        # Twist
        old = own[c.TWISTING_IMPULSE * W + lane]
        spin = nx * (wbx - wax) + ny * (wby - way) + nz * (wbz - waz)
        new = min(max(old - own[c.TWIST_MASS * W + lane] * spin, -friction * lever), friction * lever)
        own[c.TWISTING_IMPULSE * W + lane] = new
        tx, ty, tz = tx + (new - old) * nx, ty + (new - old) * ny, tz + (new - old) * nz
        cx, cy, cz = turn(s, INERTIA_A, lane, tx, ty, tz)
        wax, way, waz = wax - cx, way - cy, waz - cz
        cx, cy, cz = turn(s, INERTIA_B, lane, tx, ty, tz)
        wbx, wby, wbz = wbx + cx, wby + cy, wbz + cz
        # Friction
        ux, uy, uz = vector(own, c.T, lane)
        mx, my, mz = ny * uz - nz * uy, nz * ux - nx * uz, nx * uy - ny * ux
        ax, ay, az = vector(own, c.CENTRE, lane)
        bx, by, bz = vector(own, c.BETWEEN, lane)
        bx, by, bz = ax - bx, ay - by, az - bz
        rx = vbx + wby * bz - wbz * by - vax - way * az + waz * ay
        ry = vby + wbz * bx - wbx * bz - vay - waz * ax + wax * az
        rz = vbz + wbx * by - wby * bx - vaz - wax * ay + way * ax
        s1 = ux * rx + uy * ry + uz * rz - own[c.SURFACE_SPEED * W + lane]
        s2 = mx * rx + my * ry + mz * rz - own[(c.SURFACE_SPEED + 1) * W + lane]
        k11, k22, k12 = vector(own, c.GRIP, lane)
        old1, old2 = own[c.TANGENT_IMPULSE * W + lane], own[(c.TANGENT_IMPULSE + 1) * W + lane]
        new1 = old1 - (k11 * s1 + k12 * s2)
        new2 = old2 - (k12 * s1 + k22 * s2)
        # A sticking contact gets the impulse that stops it. Off the line of centres that impulse does not oppose the sliding,
        # as friction on a sliding contact does: hence one mass, the smallest, for all directions.
        most = friction * normal
        sticks = new1 * new1 + new2 * new2 <= most * most
        half, between = 0.5 * (k11 + k22), 0.5 * (k11 - k22)
        mass = half - math.sqrt(between * between + k12 * k12)
        new1, new2 = new1 if sticks else old1 - mass * s1, new2 if sticks else old2 - mass * s2
        scale = min(1.0, most / math.sqrt(new1 * new1 + new2 * new2 + 1e-300))
        new1, new2 = new1 * scale, new2 * scale
        own[c.TANGENT_IMPULSE * W + lane] = new1
        own[(c.TANGENT_IMPULSE + 1) * W + lane] = new2
        d1, d2 = new1 - old1, new2 - old2
        px, py, pz = d1 * ux + d2 * mx, d1 * uy + d2 * my, d1 * uz + d2 * mz
        cx, cy, cz = turn(s, INERTIA_A, lane, ay * pz - az * py, az * px - ax * pz, ax * py - ay * px)
        put(s, VELOCITY_A, lane, vax - mass_a * px, vay - mass_a * py, vaz - mass_a * pz)
        put(s, VELOCITY_A + 3, lane, wax - cx, way - cy, waz - cz)
        cx, cy, cz = turn(s, INERTIA_B, lane, by * pz - bz * py, bz * px - bx * pz, bx * py - by * px)
        put(s, VELOCITY_B, lane, vbx + mass_b * px, vby + mass_b * py, vbz + mass_b * pz)
        put(s, VELOCITY_B + 3, lane, wbx + cx, wby + cy, wbz + cz)
