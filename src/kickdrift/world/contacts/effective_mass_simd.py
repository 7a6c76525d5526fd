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
from kickdrift.world.contacts.simd_vectors import NEXT, W, put, vector

# Factors by which turns about the normal and slides count more than tilts in deciding whether arms are kept
TWIST_STRICTNESS, SLIP_STRICTNESS = 50.0, 2.0
_ANCHORS, _ANCHOR = c.ANCHORS * W, c.ANCHOR_SIZE * W


@compiled(fast=True)
def find_stale(own: Any, s: Any, twist: float, slip: float, none: float, n: int) -> None:
    """Mark lanes whose bodies have turned, slid past each other or approached since their arms were computed.

    Turns about the normal count `twist` times as much as tilts, and slides `slip` times as much as approaches. Arms from before
    an approach end at two points, and friction would change the angular momentum.
    """
    for lane in range(n):
        nx, ny, nz = vector(own, c.N, lane)
        ax, ay, az = vector(s, DELTA_POSE_A + 3, lane)
        bx, by, bz = vector(s, DELTA_POSE_B + 3, lane)
        x, y, z = vector(own, c.REFERENCE, lane)
        ax, ay, az = ax - x, ay - y, az - z
        x, y, z = vector(own, c.REFERENCE + 3, lane)
        bx, by, bz = bx - x, by - y, bz - z
        dx, dy, dz = vector(s, DELTA_POSE_B, lane)
        x, y, z = vector(s, DELTA_POSE_A, lane)
        dx, dy, dz = dx - x, dy - y, dz - z
        x, y, z = vector(own, c.REFERENCE + 6, lane)
        dx, dy, dz = dx - x, dy - y, dz - z
        x, y, z = vector(own, c.CENTRE, lane)
        dx, dy, dz = dx - (ay * z - az * y), dy - (az * x - ax * z), dz - (ax * y - ay * x)
        px, py, pz = vector(own, c.BETWEEN, lane)
        x, y, z = x - px, y - py, z - pz
        dx, dy, dz = dx + (by * z - bz * y), dy + (bz * x - bx * z), dz + (bx * y - by * x)
        along = nx * dx + ny * dy + nz * dz
        slid = dx * dx + dy * dy + dz * dz - along * along
        twist_a, twist_b = nx * ax + ny * ay + nz * az, nx * bx + ny * by + nz * bz
        more = twist * twist - 1.0
        turned_a = ax * ax + ay * ay + az * az + more * twist_a * twist_a
        turned_b = bx * bx + by * by + bz * bz + more * twist_b * twist_b
        most, farthest = own[c.MOST_TURN * W + lane], own[c.MOST_SLIDE * W + lane]
        turned = 1.0 if max(turned_a, turned_b) > most * most else 0.0
        moved = slip * slip * slid + along * along
        s[MARK * W + lane] = max(turned, 1.0 if moved > farthest * farthest else 0.0)


@compiled(fast=True, inline=True)
def _refresh_point(
    own: Any, s: Any, lane: int, i: int, at: int, k: float, slop: float, h: float, rounds: Any, axis: Any, sums: Any
) -> Any:
    """Recompute arm, effective mass and, if h > 0, the gap of a point; return the weighted sum of positions so far."""
    nx, ny, nz = vector(own, c.N, lane)
    weight, sx, sy, sz = sums
    there = 1.0 if own[c.COUNT * W + lane] > k else 0.0
    dx, dy, dz = vector(s, FROM_A_TO_B, lane)
    n = (nx, ny, nz)
    ((px, py, pz), _, bend_a), ((qx, qy, qz), _, bend_b) = rounds
    radius = own[at + c.RADII * W]
    x, y, z = vector(own, 0, at)
    x, y, z = turned(s, TURNED_A * W + lane, x, y, z)
    bend = bend_of(s, (VELOCITY_A + 3) * W + lane, n, x, y, z) + radius * bend_a
    ax, ay, az = x + radius * px, y + radius * py, z + radius * pz
    radius = own[at + (c.RADII + 1) * W]
    x, y, z = vector(own, c.ANCHOR_B, at)
    x, y, z = turned(s, TURNED_B * W + lane, x, y, z)
    bend = bend_of(s, (VELOCITY_B + 3) * W + lane, n, x, y, z) - radius * bend_b - bend
    bx, by, bz = x + dx - radius * qx - ax, y + dy - radius * qy - ay, z + dz - radius * qz - az
    gap = nx * bx + ny * by + nz * bz
    share = own[c.SHARE * W + lane]
    px, py, pz = ax + share * bx, ay + share * by, az + share * bz
    qx, qy, qz = px - dx, py - dy, pz - dz
    ux, uy, uz = py * nz - pz * ny, pz * nx - px * nz, px * ny - py * nx
    vx, vy, vz = qy * nz - qz * ny, qz * nx - qx * nz, qx * ny - qy * nx
    # One of the bodies is immovable where there is an axis; the change of its own arm has no effect.
    (ax, ay, az), fixed = axis, own[c.MASS_A * W + lane] == 0.0
    spin = (vx if fixed else ux) * ax + (vy if fixed else uy) * ay + (vz if fixed else uz) * az
    ux, uy, uz = ux - spin * ax, uy - spin * ay, uz - spin * az
    vx, vy, vz = vx - spin * ax, vy - spin * ay, vz - spin * az
    response = own[c.MASS_A * W + lane] + own[c.MASS_B * W + lane]
    response += response_to(s, INERTIA_A * W + lane, ux, uy, uz, ux, uy, uz)
    response += response_to(s, INERTIA_B * W + lane, vx, vy, vz, vx, vy, vz)
    ax, ay, az = vector(s, DELTA_POSE_A, lane)
    bx, by, bz = vector(s, DELTA_POSE_B, lane)
    linear = nx * (bx - ax) + ny * (by - ay) + nz * (bz - az)
    ax, ay, az = vector(s, DELTA_POSE_A + 3, lane)
    bx, by, bz = vector(s, DELTA_POSE_B + 3, lane)
    linear += vx * bx + vy * by + vz * bz - ux * ax - uy * ay - uz * az
    anew = s[MARK * W + lane] > 0.0
    old = own[i + c.GAP * W]
    own[i + c.GAP * W] = gap - linear + 0.5 * h * h * bend if anew & (h > 0.0) else old
    x, y, z = vector(own, 0, i)
    x, y, z = there * ux if anew else x, there * uy if anew else y, there * uz if anew else z
    put(own, 0, i, x, y, z)
    old = own[i + c.POINT_MASS * W]
    own[i + c.POINT_MASS * W] = there / (response + 1e-300) if anew else old
    # Touching points carry the friction, and the centre must not jump when a distant one appears or disappears.
    part = there * min(max(2.0 - gap / (4.0 * slop), 1e-10), 1.0)
    return weight + part, sx + part * px, sy + part * py, sz + part * pz


@compiled(fast=True, inline=True)
def _lever(own: Any, i: int, nx: float, ny: float, nz: float, cx: float, cy: float, cz: float) -> float:
    """Return the distance of a point from the centre of the contact in its plane; arms are products with the normal."""
    ax, ay, az = vector(own, c.ARM, i)
    bx, by, bz = cy * nz - cz * ny, cz * nx - cx * nz, cx * ny - cy * nx
    return math.sqrt((ax - bx) * (ax - bx) + (ay - by) * (ay - by) + (az - bz) * (az - bz))


@compiled(fast=True)
def refresh(own: Any, s: Any, slop: float, h: float, none: float, n: int) -> None:
    """Recompute arms, effective masses and centres of the marked lanes, and gaps unless h is 0.0."""
    for lane in range(n):
        sums = (0.0, 0.0, 0.0, 0.0)
        i, at = c.P * W + lane, _ANCHORS + lane
        normal = vector(own, c.N, lane)
        x, y, z = vector(own, c.AXES, lane)
        x, y, z = turned(s, TURNED_A * W + lane, x, y, z)
        round_a = away(s, (VELOCITY_A + 3) * W + lane, normal, x, y, z)
        x, y, z = vector(own, c.AXES + 3, lane)
        x, y, z = turned(s, TURNED_B * W + lane, x, y, z)
        u, v, w = vector(own, c.SPIN_AXIS, lane)
        px, py, pz = turned(s, TURNED_A * W + lane, u, v, w)
        qx, qy, qz = turned(s, TURNED_B * W + lane, u, v, w)
        fixed = own[c.MASS_A * W + lane] == 0.0
        axis = (qx if fixed else px, qy if fixed else py, qz if fixed else pz)
        rounds = (round_a, away(s, (VELOCITY_B + 3) * W + lane, normal, x, y, z))
        sums = _refresh_point(own, s, lane, i, at, 0.5, slop, h, rounds, axis, sums)
        sums = _refresh_point(own, s, lane, i + NEXT, at + _ANCHOR, 1.5, slop, h, rounds, axis, sums)
        sums = _refresh_point(own, s, lane, i + 2 * NEXT, at + 2 * _ANCHOR, 2.5, slop, h, rounds, axis, sums)
        sums = _refresh_point(own, s, lane, i + 3 * NEXT, at + 3 * _ANCHOR, 3.5, slop, h, rounds, axis, sums)
        weight, cx, cy, cz = sums
        scale = 1.0 / (weight + 1e-300)
        cx, cy, cz = cx * scale, cy * scale, cz * scale
        anew = s[MARK * W + lane] > 0.0
        x, y, z = vector(own, c.CENTRE, lane)
        cx, cy, cz = cx if anew else x, cy if anew else y, cz if anew else z
        put(own, c.CENTRE, lane, cx, cy, cz)
        x, y, z = vector(own, c.BETWEEN, lane)
        px, py, pz = vector(s, FROM_A_TO_B, lane)
        px, py, pz = px if anew else x, py if anew else y, pz if anew else z
        put(own, c.BETWEEN, lane, px, py, pz)


@compiled(fast=True)
def refresh_friction(own: Any, s: Any, unused: float, moved: float, none: float, n: int) -> None:
    """Recompute effective masses of friction, torsion and rolling resistance in the marked lanes, after `refresh`."""
    for lane in range(n):
        nx, ny, nz = vector(own, c.N, lane)
        ux, uy, uz = vector(own, c.T, lane)
        vx, vy, vz = ny * uz - nz * uy, nz * ux - nx * uz, nx * uy - ny * ux
        ax, ay, az = vector(own, c.CENTRE, lane)
        bx, by, bz = vector(own, c.BETWEEN, lane)
        bx, by, bz = ax - bx, ay - by, az - bz
        i = c.P * W + lane
        own[i + c.LEVER * W] = _lever(own, i, nx, ny, nz, ax, ay, az)
        own[i + NEXT + c.LEVER * W] = _lever(own, i + NEXT, nx, ny, nz, ax, ay, az)
        own[i + 2 * NEXT + c.LEVER * W] = _lever(own, i + 2 * NEXT, nx, ny, nz, ax, ay, az)
        own[i + 3 * NEXT + c.LEVER * W] = _lever(own, i + 3 * NEXT, nx, ny, nz, ax, ay, az)
        k11 = own[c.MASS_A * W + lane] + own[c.MASS_B * W + lane]
        k22, k12 = k11, 0.0
        px, py, pz = ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux
        qx, qy, qz = ay * vz - az * vy, az * vx - ax * vz, ax * vy - ay * vx
        i = INERTIA_A * W + lane
        k11 += response_to(s, i, px, py, pz, px, py, pz)
        k22 += response_to(s, i, qx, qy, qz, qx, qy, qz)
        k12 += response_to(s, i, px, py, pz, qx, qy, qz)
        px, py, pz = by * uz - bz * uy, bz * ux - bx * uz, bx * uy - by * ux
        qx, qy, qz = by * vz - bz * vy, bz * vx - bx * vz, bx * vy - by * vx
        j = INERTIA_B * W + lane
        k11 += response_to(s, j, px, py, pz, px, py, pz)
        k22 += response_to(s, j, qx, qy, qz, qx, qy, qz)
        k12 += response_to(s, j, px, py, pz, qx, qy, qz)
        scale = 1.0 / (k11 * k22 - k12 * k12 + 1e-300)
        spin = response_to(s, i, nx, ny, nz, nx, ny, nz) + response_to(s, j, nx, ny, nz, nx, ny, nz)
        # The mean of the three inverse moments of inertia: one number for every axis of rolling.
        trace = s[i] + s[i + W] + s[i + 2 * W] + s[j] + s[j + W] + s[j + 2 * W]
        anew = s[MARK * W + lane] > 0.0
        x, y, z = vector(own, c.GRIP, lane)
        x, y, z = k22 * scale if anew else x, k11 * scale if anew else y, -k12 * scale if anew else z
        put(own, c.GRIP, lane, x, y, z)
        x, y = own[c.TWIST_MASS * W + lane], own[c.ROLL_MASS * W + lane]
        own[c.TWIST_MASS * W + lane] = 1.0 / (spin + 1e-300) if anew else x
        own[c.ROLL_MASS * W + lane] = 3.0 / (trace + 1e-300) if anew else y
        ax, ay, az = vector(s, DELTA_POSE_A + 3, lane)
        x, y, z = vector(own, c.REFERENCE, lane)
        put(own, c.REFERENCE, lane, ax if anew else x, ay if anew else y, az if anew else z)
        ax, ay, az = vector(s, DELTA_POSE_B + 3, lane)
        x, y, z = vector(own, c.REFERENCE + 3, lane)
        put(own, c.REFERENCE + 3, lane, ax if anew else x, ay if anew else y, az if anew else z)
        ax, ay, az = vector(s, DELTA_POSE_A, lane)
        bx, by, bz = vector(s, DELTA_POSE_B, lane)
        x, y, z = vector(own, c.REFERENCE + 6, lane)
        bx, by, bz = bx - ax, by - ay, bz - az
        put(own, c.REFERENCE + 6, lane, bx if anew else x, by if anew else y, bz if anew else z)
        own[c.REFRESHED * W + lane] = max(own[c.REFRESHED * W + lane], moved * s[MARK * W + lane])
