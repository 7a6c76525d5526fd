"""Kernels of the contact solver: loops over the lanes of a group of constraints that the compiler vectorises.

`own` are the fields of a group, `s` its scratch; both are flat, with field k of lane l at k WIDTH + l, so that the compiler
can prove that lanes do not overlap. The number of lanes n is an argument: a loop of eight or fewer iterations, known in
advance, would be unrolled before the vectoriser sees it. All kernels have one signature and are called by address: linked into
the stages that use them, each would be compiled several times.
"""

import math
from typing import Any

from numba import types

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.effective_mass_simd import find_stale, refresh, refresh_friction
from kickdrift.world.contacts.prepare_simd import (
    DELTA_POSE_A,
    DELTA_POSE_B,
    INERTIA_A,
    INERTIA_B,
    MARK,
    VELOCITY_A,
    VELOCITY_B,
    fill,
)

W = c.WIDTH
_NEXT = c.POINT_FIELDS * W  # distance from a field of a point to the same field of the next
_LEVER = (c.P + c.LEVER) * W

_ARRAY = types.Array(types.float64, 1, "C")
KERNEL = types.none(_ARRAY, _ARRAY, types.float64, types.float64, types.float64, types.int64)


@compiled(fast=True, inline=True)
def _turn(s: Any, inertia: int, lane: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return the change of angular velocity by an angular impulse; `inertia` is the field of the inverse inertia."""
    i = inertia * W + lane
    return (
        s[i] * x + s[i + 3 * W] * y + s[i + 4 * W] * z,
        s[i + 3 * W] * x + s[i + W] * y + s[i + 5 * W] * z,
        s[i + 4 * W] * x + s[i + 5 * W] * y + s[i + 2 * W] * z,
    )


@compiled(fast=True, inline=True)
def _vector(array: Any, field: int, lane: int) -> tuple[float, float, float]:
    i = field * W + lane
    return array[i], array[i + W], array[i + 2 * W]


@compiled(fast=True, inline=True)
def _impulses(own: Any, lane: int) -> tuple[float, float, float, float]:
    """Return the normal impulses of the four points; a loop here would prevent vectorisation of the loop over lanes."""
    i = (c.P + c.IMPULSE) * W + lane
    return own[i], own[i + _NEXT], own[i + 2 * _NEXT], own[i + 3 * _NEXT]


@compiled(fast=True, inline=True)
def _put(array: Any, field: int, lane: int, x: float, y: float, z: float) -> None:
    i = field * W + lane
    array[i] = x
    array[i + W] = y
    array[i + 2 * W] = z


@compiled(fast=True, inline=True)
def _solve_point(own: Any, s: Any, lane: int, i: int, opened: float, arms: Any, spring: Any, state: Any) -> Any:
    """Solve one point, whose fields begin at i; return the state: sum of impulses, normal and both angular velocities."""
    rate, soft_mass, soft_impulse, per_h, bound, closed, bounces, sum_mass = spring
    tx, ty, tz, ex, ey, ez = arms
    total, v, wax, way, waz, wbx, wby, wbz = state
    ax, ay, az = _vector(own, c.ARM, i)
    impulse = own[i + c.IMPULSE * W]
    gap = own[i + c.GAP * W] + opened + (ax * tx + ay * ty + az * tz)
    bx, by, bz = ax - ex, ay - ey, az - ez
    # Without branches, which would prevent vectorisation: separated points are rigid, and their bias is gap / h.
    apart = 1.0 if gap > 0.0 else 0.0
    bias = max(gap, 0.0) * per_h + soft_mass * rate * min(gap, 0.0)
    scale = soft_mass + apart * (1.0 - soft_mass)
    leak = (1.0 - apart) * soft_impulse
    speed = v + (bx * wbx + by * wby + bz * wbz) - (ax * wax + ay * way + az * waz)
    mass = own[i + c.POINT_MASS * W]
    rounding = 1e-9 * mass * abs(speed)
    # Bounds the speed of separation. A bound on the bias would turn deep overlaps into springs whose force does not depend on
    # depth, between which balls wander for ever.
    change = min(-mass * (scale * speed + bias) - leak * impulse, mass * (bound - speed))
    new = max(impulse + change, 0.0)
    # The relaxing sweep adds nothing to points that are separated by more than rounding and carry no impulse, since they may
    # bounce when they meet in the next substep; of loaded points, rounding decides whether they are separated. Neither sweep
    # adds anything to points that approach fast enough to bounce, and have not bounced yet.
    idle = ((gap > closed) | (speed < bounces)) & (impulse <= rounding)
    d = min(new - impulse, 0.0 if idle else 1e300)
    own[i + c.IMPULSE * W] = impulse + d
    cx, cy, cz = _turn(s, INERTIA_A, lane, ax, ay, az)
    ex, ey, ez = _turn(s, INERTIA_B, lane, bx, by, bz)
    return (
        total + d,
        v + sum_mass * d,
        wax - d * cx,
        way - d * cy,
        waz - d * cz,
        wbx + d * ex,
        wby + d * ey,
        wbz + d * ez,
    )


@compiled(fast=True)
def solve_normals(own: Any, s: Any, per_h: float, soft: float, bound: float, n: int) -> None:
    """Do one sweep over the points: soft and with bias if `soft` is 1.0, rigid and without bias if it is 0.0.

    With bias, `bound` is the largest speed at which overlapping points separate, m/s. Without bias, it is the depth from which
    points begin to carry impulses, m, and bounds no speed.
    """
    closed = 1e300 if soft > 0.0 else -bound
    for lane in range(n):
        nx, ny, nz = _vector(own, c.N, lane)
        mass_a, mass_b = own[c.MASS_A * W + lane], own[c.MASS_B * W + lane]
        rate = soft * own[c.BIAS_RATE * W + lane]
        soft_mass = 1.0 + soft * (own[c.SOFT_MASS * W + lane] - 1.0)
        soft_impulse = soft * own[c.SOFT_IMPULSE * W + lane]
        vax, vay, vaz = _vector(s, VELOCITY_A, lane)
        wax, way, waz = _vector(s, VELOCITY_A + 3, lane)
        vbx, vby, vbz = _vector(s, VELOCITY_B, lane)
        wbx, wby, wbz = _vector(s, VELOCITY_B + 3, lane)
        dax, day, daz = _vector(s, DELTA_POSE_A, lane)
        tax, tay, taz = _vector(s, DELTA_POSE_A + 3, lane)
        dbx, dby, dbz = _vector(s, DELTA_POSE_B, lane)
        tbx, tby, tbz = _vector(s, DELTA_POSE_B + 3, lane)
        # The arm of b is that of a less the vector between the bodies, times the normal.
        dx, dy, dz = _vector(own, c.BETWEEN, lane)
        ex, ey, ez = dy * nz - dz * ny, dz * nx - dx * nz, dx * ny - dy * nx
        dx, dy, dz = dbx - dax, dby - day, dbz - daz
        opened = nx * dx + ny * dy + nz * dz - (ex * tbx + ey * tby + ez * tbz)
        arms = (tbx - tax, tby - tay, tbz - taz, ex, ey, ez)
        v = nx * (vbx - vax) + ny * (vby - vay) + nz * (vbz - vaz)
        state = (0.0, v, wax, way, waz, wbx, wby, wbz)
        bounces = -own[c.BOUNCE_THRESHOLD * W + lane]
        spring = (rate, soft_mass, soft_impulse, per_h, bound, closed, bounces, mass_a + mass_b)
        # Indices are sums of constants and the lane: others might be negative to the compiler, and prevent vectorisation.
        i = c.P * W + lane
        state = _solve_point(own, s, lane, i, opened, arms, spring, state)
        state = _solve_point(own, s, lane, i + _NEXT, opened, arms, spring, state)
        state = _solve_point(own, s, lane, i + 2 * _NEXT, opened, arms, spring, state)
        state = _solve_point(own, s, lane, i + 3 * _NEXT, opened, arms, spring, state)
        total, v, wax, way, waz, wbx, wby, wbz = state
        a, b = total * mass_a, total * mass_b
        _put(s, VELOCITY_A, lane, vax - a * nx, vay - a * ny, vaz - a * nz)
        _put(s, VELOCITY_A + 3, lane, wax, way, waz)
        _put(s, VELOCITY_B, lane, vbx + b * nx, vby + b * ny, vbz + b * nz)
        _put(s, VELOCITY_B + 3, lane, wbx, wby, wbz)


@compiled(fast=True)
def solve_friction(own: Any, s: Any, per_h: float, soft: float, bound: float, n: int) -> None:
    """Do one sweep over rolling resistance, torsional friction and friction at the centre, bounded by the normal impulses."""
    for lane in range(n):
        nx, ny, nz = _vector(own, c.N, lane)
        mass_a, mass_b = own[c.MASS_A * W + lane], own[c.MASS_B * W + lane]
        vax, vay, vaz = _vector(s, VELOCITY_A, lane)
        wax, way, waz = _vector(s, VELOCITY_A + 3, lane)
        vbx, vby, vbz = _vector(s, VELOCITY_B, lane)
        wbx, wby, wbz = _vector(s, VELOCITY_B + 3, lane)
        n0, n1, n2, n3 = _impulses(own, lane)
        normal = n0 + n1 + n2 + n3
        lever = n0 * own[_LEVER + lane] + n1 * own[_LEVER + _NEXT + lane]
        lever += n2 * own[_LEVER + 2 * _NEXT + lane] + n3 * own[_LEVER + 3 * _NEXT + lane]
        friction = own[c.FRICTION * W + lane]
        # Rolling resistance
        px, py, pz = _vector(own, c.ROLL_IMPULSE, lane)
        mass = own[c.ROLL_MASS * W + lane]
        qx, qy, qz = px - mass * (wbx - wax), py - mass * (wby - way), pz - mass * (wbz - waz)
        most = own[c.ROLL_RESISTANCE * W + lane] * normal
        scale = min(1.0, most / math.sqrt(qx * qx + qy * qy + qz * qz + 1e-300))
        qx, qy, qz = qx * scale, qy * scale, qz * scale
        _put(own, c.ROLL_IMPULSE, lane, qx, qy, qz)
        tx, ty, tz = qx - px, qy - py, qz - pz
        # Twist
        old = own[c.TWISTING_IMPULSE * W + lane]
        spin = nx * (wbx - wax) + ny * (wby - way) + nz * (wbz - waz)
        new = min(max(old - own[c.TWIST_MASS * W + lane] * spin, -friction * lever), friction * lever)
        own[c.TWISTING_IMPULSE * W + lane] = new
        tx, ty, tz = tx + (new - old) * nx, ty + (new - old) * ny, tz + (new - old) * nz
        cx, cy, cz = _turn(s, INERTIA_A, lane, tx, ty, tz)
        wax, way, waz = wax - cx, way - cy, waz - cz
        cx, cy, cz = _turn(s, INERTIA_B, lane, tx, ty, tz)
        wbx, wby, wbz = wbx + cx, wby + cy, wbz + cz
        # Friction
        ux, uy, uz = _vector(own, c.T, lane)
        mx, my, mz = ny * uz - nz * uy, nz * ux - nx * uz, nx * uy - ny * ux
        ax, ay, az = _vector(own, c.CENTRE, lane)
        bx, by, bz = _vector(own, c.BETWEEN, lane)
        bx, by, bz = ax - bx, ay - by, az - bz
        rx = vbx + wby * bz - wbz * by - vax - way * az + waz * ay
        ry = vby + wbz * bx - wbx * bz - vay - waz * ax + wax * az
        rz = vbz + wbx * by - wby * bx - vaz - wax * ay + way * ax
        s1 = ux * rx + uy * ry + uz * rz - own[c.SURFACE_SPEED * W + lane]
        s2 = mx * rx + my * ry + mz * rz - own[(c.SURFACE_SPEED + 1) * W + lane]
        k11, k22, k12 = _vector(own, c.GRIP, lane)
        old1, old2 = own[c.TANGENT_IMPULSE * W + lane], own[(c.TANGENT_IMPULSE + 1) * W + lane]
        new1 = old1 - (k11 * s1 + k12 * s2)
        new2 = old2 - (k12 * s1 + k22 * s2)
        # A sticking contact gets the impulse that stops it. Off the line of centres that impulse does not oppose the sliding,
        # as friction on a sliding contact is: hence one mass, the smallest, for all directions.
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
        cx, cy, cz = _turn(s, INERTIA_A, lane, ay * pz - az * py, az * px - ax * pz, ax * py - ay * px)
        _put(s, VELOCITY_A, lane, vax - mass_a * px, vay - mass_a * py, vaz - mass_a * pz)
        _put(s, VELOCITY_A + 3, lane, wax - cx, way - cy, waz - cz)
        cx, cy, cz = _turn(s, INERTIA_B, lane, by * pz - bz * py, bz * px - bx * pz, bx * py - by * px)
        _put(s, VELOCITY_B, lane, vbx + mass_b * px, vby + mass_b * py, vbz + mass_b * pz)
        _put(s, VELOCITY_B + 3, lane, wbx + cx, wby + cy, wbz + cz)


@compiled(fast=True)
def apply_impulses(own: Any, s: Any, per_h: float, soft: float, bound: float, n: int) -> None:
    """Apply the accumulated impulses to the velocities (warm start)."""
    for lane in range(n):
        nx, ny, nz = _vector(own, c.N, lane)
        ux, uy, uz = _vector(own, c.T, lane)
        mx, my, mz = ny * uz - nz * uy, nz * ux - nx * uz, nx * uy - ny * ux
        d1, d2 = own[c.TANGENT_IMPULSE * W + lane], own[(c.TANGENT_IMPULSE + 1) * W + lane]
        px, py, pz = d1 * ux + d2 * mx, d1 * uy + d2 * my, d1 * uz + d2 * mz
        ax, ay, az = _vector(own, c.CENTRE, lane)
        bx, by, bz = _vector(own, c.BETWEEN, lane)
        bx, by, bz = ax - bx, ay - by, az - bz
        tx, ty, tz = _vector(own, c.ROLL_IMPULSE, lane)
        twist = own[c.TWISTING_IMPULSE * W + lane]
        tx, ty, tz = tx + twist * nx, ty + twist * ny, tz + twist * nz
        lax, lay, laz = ay * pz - az * py + tx, az * px - ax * pz + ty, ax * py - ay * px + tz
        lbx, lby, lbz = by * pz - bz * py + tx, bz * px - bx * pz + ty, bx * py - by * px + tz
        normal, gx, gy, gz = 0.0, 0.0, 0.0, 0.0
        for k in range(4):
            f = c.P + c.POINT_FIELDS * k
            impulse = own[(f + c.IMPULSE) * W + lane]
            normal += impulse
            qx, qy, qz = _vector(own, f + c.ARM, lane)
            gx, gy, gz = gx + impulse * qx, gy + impulse * qy, gz + impulse * qz
        lax, lay, laz = lax + gx, lay + gy, laz + gz
        ex, ey, ez = _vector(own, c.BETWEEN, lane)
        ex, ey, ez = normal * ex, normal * ey, normal * ez
        lbx, lby, lbz = lbx + gx - (ey * nz - ez * ny), lby + gy - (ez * nx - ex * nz), lbz + gz - (ex * ny - ey * nx)
        px, py, pz = px + normal * nx, py + normal * ny, pz + normal * nz
        mass_a, mass_b = own[c.MASS_A * W + lane], own[c.MASS_B * W + lane]
        vx, vy, vz = _vector(s, VELOCITY_A, lane)
        _put(s, VELOCITY_A, lane, vx - mass_a * px, vy - mass_a * py, vz - mass_a * pz)
        vx, vy, vz = _vector(s, VELOCITY_B, lane)
        _put(s, VELOCITY_B, lane, vx + mass_b * px, vy + mass_b * py, vz + mass_b * pz)
        wx, wy, wz = _vector(s, VELOCITY_A + 3, lane)
        cx, cy, cz = _turn(s, INERTIA_A, lane, lax, lay, laz)
        _put(s, VELOCITY_A + 3, lane, wx - cx, wy - cy, wz - cz)
        wx, wy, wz = _vector(s, VELOCITY_B + 3, lane)
        cx, cy, cz = _turn(s, INERTIA_B, lane, lbx, lby, lbz)
        _put(s, VELOCITY_B + 3, lane, wx + cx, wy + cy, wz + cz)


@compiled(fast=True, inline=True)
def _point_speed(own: Any, lane: int, i: int, v: float, turning: Any, between: Any) -> float:
    """Return the normal speed of a point whose fields begin at i; 0.0 if it carries no impulse."""
    wax, way, waz, wbx, wby, wbz = turning
    ex, ey, ez = between
    ax, ay, az = _vector(own, c.ARM, i)
    speed = v + (ax - ex) * wbx + (ay - ey) * wby + (az - ez) * wbz - (ax * wax + ay * way + az * waz)
    return abs(speed) if own[i + c.IMPULSE * W] > 0.0 else 0.0


@compiled(fast=True)
def measure_normals(own: Any, s: Any, unused: float, none: float, nothing: float, n: int) -> None:
    """Write into MARK of each lane the largest normal speed of points that carry an impulse, m/s."""
    for lane in range(n):
        nx, ny, nz = _vector(own, c.N, lane)
        ax, ay, az = _vector(s, VELOCITY_A, lane)
        bx, by, bz = _vector(s, VELOCITY_B, lane)
        v = nx * (bx - ax) + ny * (by - ay) + nz * (bz - az)
        turning = _vector(s, VELOCITY_A + 3, lane) + _vector(s, VELOCITY_B + 3, lane)
        dx, dy, dz = _vector(own, c.BETWEEN, lane)
        between = (dy * nz - dz * ny, dz * nx - dx * nz, dx * ny - dy * nx)
        i = c.P * W + lane
        most = _point_speed(own, lane, i, v, turning, between)
        most = max(most, _point_speed(own, lane, i + _NEXT, v, turning, between))
        most = max(most, _point_speed(own, lane, i + 2 * _NEXT, v, turning, between))
        s[MARK * W + lane] = max(most, _point_speed(own, lane, i + 3 * _NEXT, v, turning, between))


# By columns of the table `KERNEL_ADDRESSES`, which holds their addresses
KERNELS = {
    c.APPLY_IMPULSES: apply_impulses, c.SOLVE_NORMALS: solve_normals, c.SOLVE_FRICTION: solve_friction, c.FILL: fill,
    c.FIND_STALE: find_stale, c.REFRESH: refresh, c.REFRESH_FRICTION: refresh_friction, c.MEASURE: measure_normals,
}  # fmt: skip
