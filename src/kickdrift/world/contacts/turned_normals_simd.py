"""Normals of balls and capsules that turn within a step, in lanes, with the direction between their cores."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.prepare_simd import FROM_A_TO_B, MARK, TURNED_A, TURNED_B, turned
from kickdrift.world.contacts.simd_vectors import W, put, vector

_PASSED = 0.5  # cosine of the angle by which the normal of two cores turns in a substep, below which they have passed
_ANCHORS, _ANCHOR = c.ANCHORS * W, c.ANCHOR_SIZE * W


@compiled(fast=True, inline=True)
def _core(own: Any, s: Any, lane: int, core: int, turn: int) -> Any:
    """Return the middle of a core from the centre of mass of its body, and its half axis."""
    x, y, z = vector(own, core, lane)
    u, v, w = vector(own, core + 3, lane)
    return turned(s, turn * W + lane, x, y, z), turned(s, turn * W + lane, u, v, w)


@compiled(fast=True, inline=True)
def _dot(u: Any, v: Any) -> float:
    product: float = u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    return product


@compiled(fast=True, inline=True)
def _foot(half_a: Any, half_b: Any, apart: Any, along: float) -> float:
    """Return where on the second core, from -1 to 1 along its half axis, it is nearest to a point on the first one."""
    at = along * _dot(half_a, half_b) - _dot(half_b, apart)
    return min(max(at / (_dot(half_b, half_b) + 1e-300), -1.0), 1.0)


@compiled(fast=True, inline=True)
def _nearest(half_a: Any, half_b: Any, apart: Any) -> float:
    """Return where on the line of the first core it is nearest to that of the second; `apart` is between their middles.

    C. Ericson, Real-Time Collision Detection (2005), section 5.1.9.
    """
    aa, bb, ab = _dot(half_a, half_a) + 1e-300, _dot(half_b, half_b) + 1e-300, _dot(half_a, half_b)
    at = (_dot(half_a, apart) * bb - ab * _dot(half_b, apart)) / (aa * bb - ab * ab + 1e-300)
    return min(max(at, -1.0), 1.0)


@compiled(fast=True, inline=True)
def _listed(own: Any, lane: int, at: int) -> float:
    """Return where on the first core the anchor at `at` is."""
    x, y, z = vector(own, c.CORE_A, lane)
    half = vector(own, c.CORE_A + 3, lane)
    u, v, w = vector(own, c.ANCHOR_A, at)
    return _dot((u - x, v - y, w - z), half) / (_dot(half, half) + 1e-300)


@compiled(fast=True, inline=True)
def _put_on_core(own: Any, lane: int, core: int, i: int, along: float, turns: bool) -> None:
    """Move the anchor at i to a position along a core."""
    x, y, z = vector(own, core, lane)
    u, v, w = vector(own, core + 3, lane)
    p, q, r = vector(own, 0, i)
    x, y, z = x + along * u, y + along * v, z + along * w
    put(own, 0, i, x if turns else p, y if turns else q, z if turns else r)


@compiled(fast=True)
def turn_normals(own: Any, s: Any, unused: float, none: float, nothing: float, n: int) -> None:
    """Turn the normals and tangents of the marked lanes of balls and capsules to the direction between their cores.

    A single point is moved to where the cores are nearest to each other; of two, between capsules that are nearly parallel,
    those on the second core follow those on the first. With normal and points from the start of the step, frictionless balls
    that pass each other get spin, and capsules spin about their axes, by 1.2 rad/s. Where cores have passed each other, the
    shapes overlap, and the old normal tells where each came from. Accumulated impulses keep their components along the new
    directions.
    """
    for lane in range(n):
        nx, ny, nz = vector(own, c.N, lane)
        (ax, ay, az), half_a = _core(own, s, lane, c.CORE_A, TURNED_A)
        (bx, by, bz), half_b = _core(own, s, lane, c.CORE_B, TURNED_B)
        dx, dy, dz = vector(s, FROM_A_TO_B, lane)
        x, y, z = bx + dx - ax, by + dy - ay, bz + dz - az
        apart, two, i = (x, y, z), own[c.COUNT * W + lane] > 1.5, _ANCHORS + lane
        listed, nearest = _listed(own, lane, i), _nearest(half_a, half_b, apart)
        b_1 = _foot(half_a, half_b, apart, listed if two else nearest)
        b_2 = _foot(half_a, half_b, apart, _listed(own, lane, i + _ANCHOR))
        a_1, a_2 = _foot(half_b, half_a, (-x, -y, -z), b_1), _foot(half_b, half_a, (-x, -y, -z), b_2)
        on_a, on_b = 0.5 * (a_1 + a_2) if two else a_1, 0.5 * (b_1 + b_2) if two else b_1
        x, y, z = (
            x + on_b * half_b[0] - on_a * half_a[0],
            y + on_b * half_b[1] - on_a * half_a[1],
            z + on_b * half_b[2] - on_a * half_a[2],
        )
        scale = 1.0 / math.sqrt(x * x + y * y + z * z + 1e-300)
        turned_to = scale * (x * nx + y * ny + z * nz)
        turns = own[c.TURNS * W + lane] * s[MARK * W + lane] * max(turned_to - _PASSED, 0.0) > 0.0
        _put_on_core(own, lane, c.CORE_A, i + c.ANCHOR_A * W, a_1, turns)
        _put_on_core(own, lane, c.CORE_B, i + c.ANCHOR_B * W, b_1, turns)
        _put_on_core(own, lane, c.CORE_A, i + _ANCHOR + c.ANCHOR_A * W, a_2, turns)
        _put_on_core(own, lane, c.CORE_B, i + _ANCHOR + c.ANCHOR_B * W, b_2, turns)
        nx, ny, nz = x * scale if turns else nx, y * scale if turns else ny, z * scale if turns else nz
        put(own, c.N, lane, nx, ny, nz)
        ux, uy, uz = vector(own, c.T, lane)
        along = nx * ux + ny * uy + nz * uz
        x, y, z = ux - along * nx, uy - along * ny, uz - along * nz
        scale = 1.0 / math.sqrt(x * x + y * y + z * z + 1e-300)
        ux, uy, uz = x * scale if turns else ux, y * scale if turns else uy, z * scale if turns else uz
        put(own, c.T, lane, ux, uy, uz)
