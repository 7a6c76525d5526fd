"""Normals of balls and capsules that turn within a step, in lanes, with the direction between their cores."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.prepare_simd import FROM_A_TO_B, MARK, TURNED_A, TURNED_B, turned
from kickdrift.world.contacts.simd_vectors import W, chosen, dot, minus, plus, put, put_where, times, vector

_PASSED = 0.5  # cosine of the angle by which the normal of two cores turns in a substep, below which they have passed
_ANCHORS, _ANCHOR = c.ANCHORS * W, c.ANCHOR_SIZE * W


@compiled(fast=True, inline=True)
def _core(own: Any, s: Any, lane: int, core: int, turn: int) -> Any:
    """Return the middle of a core from the centre of mass of its body, and its half axis."""
    middle, half = vector(own, core, lane), vector(own, core + 3, lane)
    return turned(s, turn, lane, middle), turned(s, turn, lane, half)


@compiled(fast=True, inline=True)
def _foot(half_a: Any, half_b: Any, apart: Any, along: float) -> float:
    """Return where on the second core, from -1 to 1 along its half axis, it is nearest to a point on the first one."""
    at = along * dot(half_a, half_b) - dot(half_b, apart)
    return min(max(at / (dot(half_b, half_b) + 1e-300), -1.0), 1.0)


@compiled(fast=True, inline=True)
def _nearest(half_a: Any, half_b: Any, apart: Any) -> float:
    """Return where on the line of the first core it is nearest to that of the second; `apart` is between their middles.

    C. Ericson, Real-Time Collision Detection (2005), section 5.1.9.
    """
    aa, bb, ab = dot(half_a, half_a) + 1e-300, dot(half_b, half_b) + 1e-300, dot(half_a, half_b)
    at = (dot(half_a, apart) * bb - ab * dot(half_b, apart)) / (aa * bb - ab * ab + 1e-300)
    return min(max(at, -1.0), 1.0)


@compiled(fast=True, inline=True)
def _listed(own: Any, lane: int, at: int) -> float:
    """Return where on the first core the anchor at `at` is."""
    middle, half = vector(own, c.CORE_A, lane), vector(own, c.CORE_A + 3, lane)
    return dot(minus(vector(own, c.ANCHOR_A, at), middle), half) / (dot(half, half) + 1e-300)


@compiled(fast=True, inline=True)
def _put_on_core(own: Any, lane: int, core: int, i: int, along: float, turns: bool) -> None:
    """Move the anchor at i to a position along a core."""
    put_where(turns, own, 0, i, plus(vector(own, core, lane), times(along, vector(own, core + 3, lane))))


@compiled(fast=True)
def turn_normals(own: Any, s: Any, unused: float, none: float, nothing: float, count: int) -> None:
    """Turn the normals and tangents of the marked lanes of balls and capsules to the direction between their cores.

    A single point is moved to where the cores are nearest to each other; of two, between capsules that are nearly parallel,
    those on the second core follow those on the first. With normal and points from the start of the step, frictionless balls
    that pass each other get spin, and capsules spin about their axes, by 1.2 rad/s. Where cores have passed each other, the
    shapes overlap, and the old normal tells where each came from. Accumulated impulses keep their components along the new
    directions.
    """
    for lane in range(count):
        n = vector(own, c.N, lane)
        middle_a, half_a = _core(own, s, lane, c.CORE_A, TURNED_A)
        middle_b, half_b = _core(own, s, lane, c.CORE_B, TURNED_B)
        apart = minus(plus(middle_b, vector(s, FROM_A_TO_B, lane)), middle_a)
        two, i = own[c.COUNT * W + lane] > 1.5, _ANCHORS + lane
        listed, nearest = _listed(own, lane, i), _nearest(half_a, half_b, apart)
        b_1 = _foot(half_a, half_b, apart, listed if two else nearest)
        b_2 = _foot(half_a, half_b, apart, _listed(own, lane, i + _ANCHOR))
        back = times(-1.0, apart)
        a_1, a_2 = _foot(half_b, half_a, back, b_1), _foot(half_b, half_a, back, b_2)
        on_a, on_b = 0.5 * (a_1 + a_2) if two else a_1, 0.5 * (b_1 + b_2) if two else b_1
        line = minus(plus(apart, times(on_b, half_b)), times(on_a, half_a))
        scale = 1.0 / math.sqrt(dot(line, line) + 1e-300)
        turned_to = scale * dot(line, n)
        turns = own[c.TURNS * W + lane] * s[MARK * W + lane] * max(turned_to - _PASSED, 0.0) > 0.0
        _put_on_core(own, lane, c.CORE_A, i + c.ANCHOR_A * W, a_1, turns)
        _put_on_core(own, lane, c.CORE_B, i + c.ANCHOR_B * W, b_1, turns)
        _put_on_core(own, lane, c.CORE_A, i + _ANCHOR + c.ANCHOR_A * W, a_2, turns)
        _put_on_core(own, lane, c.CORE_B, i + _ANCHOR + c.ANCHOR_B * W, b_2, turns)
        n, first = chosen(turns, times(scale, line), n), vector(own, c.T, lane)
        put(own, c.N, lane, n)
        across = minus(first, times(dot(n, first), n))
        put_where(turns, own, c.T, lane, times(1.0 / math.sqrt(dot(across, across) + 1e-300), across))
