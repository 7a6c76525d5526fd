"""Constraints from manifolds, in lanes: what `kickdrift.world.contacts.prepare` gathers of eight contacts, made into a group.

`raw` are the fields gathered, `own` those of the group; see `kickdrift.world.contacts.lanes` for how loops over lanes are
written. Everything is seen from the centre of mass of the first body, where little is rounded off.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c

W = c.WIDTH
# Fields of raw
NORMAL = 0  # in the frame of the first shape (3)
TURN_A, ARM_A = 3, 7  # orientation of the first shape, and its origin from the centre of its body (3)
TURN_B, ARM_B = 10, 14
APART = 17  # from the centre of the first body to that of the second (3)
ON_A, ON_B = 20, 23  # points in the frames of the shapes (3 and 3), six numbers a point
IMPULSE = 44  # of four points
COUNT = 48
MASS_A, MASS_B, INERTIA_A, INERTIA_B = 49, 50, 51, 57  # inverse
FRICTION, SLIDE, SLID, TWISTED = 63, 64, 67, 70
RESISTANCE, ROLLED = 71, 72
SOFTNESS = 75
GLIDE_A, OFFSET, FARTHEST = 78, 79, 82
RAW = 83


@compiled(fast=True, inline=True)
def _vector(array: Any, i: int) -> tuple[float, float, float]:
    return array[i], array[i + W], array[i + 2 * W]


@compiled(fast=True, inline=True)
def _put(array: Any, i: int, x: float, y: float, z: float) -> None:
    array[i], array[i + W], array[i + 2 * W] = x, y, z


@compiled(fast=True, inline=True)
def _turned(array: Any, i: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Turn a vector by the quaternion that begins at i."""
    w, u, v, t = array[i], array[i + W], array[i + 2 * W], array[i + 3 * W]
    p, q, r = 2.0 * (v * z - t * y), 2.0 * (t * x - u * z), 2.0 * (u * y - v * x)
    return x + w * p + v * r - t * q, y + w * q + t * p - u * r, z + w * r + u * q - v * p


@compiled(fast=True, inline=True)
def _response(array: Any, i: int, x: float, y: float, z: float, p: float, q: float, r: float) -> float:
    """Product of two vectors with the symmetric matrix that begins at i between them."""
    product: float = (
        p * (array[i] * x + array[i + 3 * W] * y + array[i + 4 * W] * z)
        + q * (array[i + 3 * W] * x + array[i + W] * y + array[i + 5 * W] * z)
        + r * (array[i + 4 * W] * x + array[i + 5 * W] * y + array[i + 2 * W] * z)
    )
    return product


@compiled(fast=True, inline=True)
def _fill_point(own: Any, raw: Any, lane: int, j: int, i: int, k: float, slop: float, normal: Any, sums: Any) -> Any:
    """Make point k, whose raw fields begin at j and whose own at i; return the weighted sum of the points so far."""
    nx, ny, nz = normal
    weight, sx, sy, sz = sums
    there = 1.0 if raw[COUNT * W + lane] > k else 0.0
    dx, dy, dz = _vector(raw, APART * W + lane)
    ox, oy, oz = _vector(raw, ARM_A * W + lane)
    x, y, z = _vector(raw, j)
    ax, ay, az = _turned(raw, TURN_A * W + lane, x, y, z)
    ax, ay, az = ax + ox, ay + oy, az + oz
    ox, oy, oz = _vector(raw, ARM_B * W + lane)
    x, y, z = _vector(raw, j + 3 * W)
    bx, by, bz = _turned(raw, TURN_B * W + lane, x, y, z)
    bx, by, bz = bx + ox + dx, by + oy + dy, bz + oz + dz
    gap = nx * (bx - ax) + ny * (by - ay) + nz * (bz - az)
    px, py, pz = 0.5 * (ax + bx), 0.5 * (ay + by), 0.5 * (az + bz)
    ex, ey, ez = _vector(raw, OFFSET * W + lane)
    qx, qy, qz = px + 0.5 * ex - dx, py + 0.5 * ey - dy, pz + 0.5 * ez - dz
    px, py, pz = px - 0.5 * ex, py - 0.5 * ey, pz - 0.5 * ez
    ux, uy, uz = py * nz - pz * ny, pz * nx - px * nz, px * ny - py * nx
    vx, vy, vz = qy * nz - qz * ny, qz * nx - qx * nz, qx * ny - qy * nx
    response = raw[MASS_A * W + lane] + raw[MASS_B * W + lane]
    response += _response(raw, INERTIA_A * W + lane, ux, uy, uz, ux, uy, uz)
    response += _response(raw, INERTIA_B * W + lane, vx, vy, vz, vx, vy, vz)
    _put(own, i + c.ARM * W, there * ux, there * uy, there * uz)
    own[i + c.GAP * W] = gap
    own[i + c.POINT_MASS * W] = there / (response + 1e-300)
    # Points that touch carry the friction: the centre must not jump where a distant one comes or goes.
    share = there * min(max(2.0 - gap / (4.0 * slop), 1e-10), 1.0)
    return weight + share, sx + share * px, sy + share * py, sz + share * pz


@compiled(fast=True, inline=True)
def _lever(own: Any, i: int, nx: float, ny: float, nz: float, cx: float, cy: float, cz: float) -> float:
    """Distance of a point from the centre of the contact in its plane: arms are at right angles to the normal."""
    ax, ay, az = _vector(own, i + c.ARM * W)
    bx, by, bz = cy * nz - cz * ny, cz * nx - cx * nz, cx * ny - cy * nx
    return math.sqrt((ax - bx) * (ax - bx) + (ay - by) * (ay - by) + (az - bz) * (az - bz))


@compiled(fast=True)
def fill(own: Any, raw: Any, slop: float, unused: float, none: float, n: int) -> None:
    """Make the constraints of a group."""
    for lane in range(n):
        own[c.GLIDE_A * W + lane], own[c.FARTHEST * W + lane] = raw[GLIDE_A * W + lane], raw[FARTHEST * W + lane]
        x, y, z = _vector(raw, OFFSET * W + lane)
        _put(own, c.OFFSET * W + lane, x, y, z)
        x, y, z = _vector(raw, lane)
        nx, ny, nz = _turned(raw, TURN_A * W + lane, x, y, z)
        normal, sums = (nx, ny, nz), (0.0, 0.0, 0.0, 0.0)
        i, j = c.P * W + lane, ON_A * W + lane
        sums = _fill_point(own, raw, lane, j, i, 0.5, slop, normal, sums)
        sums = _fill_point(own, raw, lane, j + 6 * W, i + _NEXT, 1.5, slop, normal, sums)
        sums = _fill_point(own, raw, lane, j + 12 * W, i + 2 * _NEXT, 2.5, slop, normal, sums)
        sums = _fill_point(own, raw, lane, j + 18 * W, i + 3 * _NEXT, 3.5, slop, normal, sums)
        weight, cx, cy, cz = sums
        scale = 1.0 / (weight + 1e-300)
        cx, cy, cz = cx * scale, cy * scale, cz * scale
        own[i + c.LEVER * W] = _lever(own, i, nx, ny, nz, cx, cy, cz)
        own[i + _NEXT + c.LEVER * W] = _lever(own, i + _NEXT, nx, ny, nz, cx, cy, cz)
        own[i + 2 * _NEXT + c.LEVER * W] = _lever(own, i + 2 * _NEXT, nx, ny, nz, cx, cy, cz)
        own[i + 3 * _NEXT + c.LEVER * W] = _lever(own, i + 3 * _NEXT, nx, ny, nz, cx, cy, cz)
        i += c.IMPULSE * W
        own[i], own[i + _NEXT] = raw[IMPULSE * W + lane], raw[(IMPULSE + 1) * W + lane]
        own[i + 2 * _NEXT], own[i + 3 * _NEXT] = raw[(IMPULSE + 2) * W + lane], raw[(IMPULSE + 3) * W + lane]
        _put(own, c.N * W + lane, nx, ny, nz)
        dx, dy, dz = _vector(raw, APART * W + lane)
        _put(own, c.CENTRE * W + lane, cx, cy, cz)
        ex, ey, ez = _vector(raw, OFFSET * W + lane)
        _put(own, c.BETWEEN * W + lane, dx - ex, dy - ey, dz - ez)
        x, y, z = _vector(raw, SOFTNESS * W + lane)
        _put(own, c.SOFTNESS * W + lane, x, y, z)
        own[c.MASS_A * W + lane], own[c.MASS_B * W + lane] = raw[MASS_A * W + lane], raw[MASS_B * W + lane]


@compiled(fast=True)
def fill_friction(own: Any, raw: Any, slop: float, unused: float, none: float, n: int) -> None:
    """Make the friction, twist and rolling resistance of a group that `fill` has begun."""
    for lane in range(n):
        nx, ny, nz = _vector(own, c.N * W + lane)
        # A tangent at right angles to the normal, and to z unless the normal is near it.
        low = 1.0 if abs(nz) < 0.7 else 0.0
        ux, uy, uz = -low * ny, low * nx - (1.0 - low) * nz, (1.0 - low) * ny
        scale = 1.0 / math.sqrt(ux * ux + uy * uy + uz * uz + 1e-300)
        ux, uy, uz = ux * scale, uy * scale, uz * scale
        vx, vy, vz = ny * uz - nz * uy, nz * ux - nx * uz, nx * uy - ny * ux
        ax, ay, az = _vector(own, c.CENTRE * W + lane)
        bx, by, bz = _vector(own, c.BETWEEN * W + lane)
        bx, by, bz = ax - bx, ay - by, az - bz
        k11 = raw[MASS_A * W + lane] + raw[MASS_B * W + lane]
        k22, k12 = k11, 0.0
        px, py, pz = ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux
        qx, qy, qz = ay * vz - az * vy, az * vx - ax * vz, ax * vy - ay * vx
        i = INERTIA_A * W + lane
        k11 += _response(raw, i, px, py, pz, px, py, pz)
        k22 += _response(raw, i, qx, qy, qz, qx, qy, qz)
        k12 += _response(raw, i, px, py, pz, qx, qy, qz)
        px, py, pz = by * uz - bz * uy, bz * ux - bx * uz, bx * uy - by * ux
        qx, qy, qz = by * vz - bz * vy, bz * vx - bx * vz, bx * vy - by * vx
        j = INERTIA_B * W + lane
        k11 += _response(raw, j, px, py, pz, px, py, pz)
        k22 += _response(raw, j, qx, qy, qz, qx, qy, qz)
        k12 += _response(raw, j, px, py, pz, qx, qy, qz)
        scale = 1.0 / (k11 * k22 - k12 * k12 + 1e-300)
        _put(own, c.GRIP * W + lane, k22 * scale, k11 * scale, -k12 * scale)
        _put(own, c.T * W + lane, ux, uy, uz)
        own[c.FRICTION * W + lane] = raw[FRICTION * W + lane]
        x, y, z = _vector(raw, SLIDE * W + lane)
        own[c.SLIDE * W + lane], own[(c.SLIDE + 1) * W + lane] = ux * x + uy * y + uz * z, vx * x + vy * y + vz * z
        x, y, z = _vector(raw, SLID * W + lane)
        own[c.SLID * W + lane], own[(c.SLID + 1) * W + lane] = ux * x + uy * y + uz * z, vx * x + vy * y + vz * z
        spin = _response(raw, i, nx, ny, nz, nx, ny, nz) + _response(raw, j, nx, ny, nz, nx, ny, nz)
        own[c.TWIST * W + lane], own[(c.TWIST + 1) * W + lane] = 1.0 / (spin + 1e-300), raw[TWISTED * W + lane]
        # The mean of the three moments of inertia: one number serves every axis of rolling.
        trace = raw[i] + raw[i + W] + raw[i + 2 * W] + raw[j] + raw[j + W] + raw[j + 2 * W]
        own[c.ROLL * W + lane], own[(c.ROLL + 1) * W + lane] = raw[RESISTANCE * W + lane], 3.0 / (trace + 1e-300)
        x, y, z = _vector(raw, ROLLED * W + lane)
        _put(own, (c.ROLL + 2) * W + lane, x, y, z)


_NEXT = c.POINT_FIELDS * W  # from a field of a point to the same of the next
