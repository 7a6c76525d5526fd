"""Rotation of a free rigid body in a substep, with w* = I^-1 (P + P') / 2, which conserves its energy: see `integration`."""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import (
    Quaternion,
    Symmetric,
    Vector,
    applied,
    cross,
    dot,
    exponential,
    minus,
    plus,
    product,
    times,
    turned,
    turned_back,
)

_ROUNDS = 20
_ROUNDING = 1e-34  # square of half a unit in the last place, nearly
# Turn in a part, rad, and most parts: 1.2e6 rad/s at 60 steps per second of 4 substeps, in a millisecond or two. The energy is
# right to rounding; in turns of 1.5 it changes by 1e-5 in a second, and of 2 there may be no solution.
_PART, _PARTS = 0.5, 10_000
# Squares of the relative increment below which the exact derivative is used, and of the largest turn for it.
_NEAR, _LARGE = 1e-4, 2.0
_SLOW = 1e-16  # square of the turn in a substep, rad^2, above which terms of second order exceed rounding
_FAST = 1.0  # likewise, above which free bodies rotate in parts
_MOMENTS = 1e4  # largest ratio of moments of inertia allowed for: that of a rod a hundred times as long as it is thick


@compiled(inline=True)
def turned_product(q: Quaternion, moments: Symmetric, w: Vector) -> Vector:
    """Return R I R^T w: the angular momentum in the world's axes, kg m^2/s."""
    return turned(q, applied(moments, turned_back(q, w)))


@compiled
def mean_turn(h: float, q: Quaternion, moments: Symmetric, spin: Vector, turn: Vector) -> Vector:
    """Return the angular velocity w* of a body in free flight for a time h, rad/s.

    The body has the orientation q and the angular momentum `spin`, in the world's axes; `turn` is the initial guess. Newton's
    method begins with a derivative to first order in h, which is enough for all but slender bodies: after 20 rounds with it,
    sticks of 1:20 that turn by half a radian gain 2e-5 of their energy in that turn. The exact one is used near the solution,
    since farther away it may lead elsewhere.
    """
    momentum, w = turned_back(q, spin), turned_back(q, turn)
    error = 0.0
    for _ in range(_ROUNDS):
        way = times(h, w)
        rotation = exponential(way)
        later = turned_back(rotation, momentum)
        middle = times(0.5, plus(momentum, later))
        missing = minus(middle, applied(moments, w))
        if 0.0 < error < _NEAR * dot(w, w) and dot(way, way) < _LARGE:
            step = _newton_step(h, moments, way, rotation, later, missing)
        else:
            step = _first_order_step(moments, times(0.5 * h, middle), missing)
        w = plus(w, step)
        change = dot(step, step)
        # Iterated until this increment, or the next one as estimated, is below rounding, or until increments no longer
        # shrink: a larger tolerance would let the energy drift. Where there is no solution, at turns of some two radians,
        # the last iterate still conserves the momentum.
        size = dot(w, w)
        # To first order in h, the next increment is about this fraction of the present one, at most.
        part = min(_MOMENTS * h * h * max(size, change), 1.0)
        if change * part * part <= _ROUNDING * size or change * change <= _ROUNDING * size * error:
            break
        if 0.0 < error <= change < 1e-20 * size:
            break
        error = change
    return turned(q, w)


@compiled
def free_rotation(
    h: float, q: Quaternion, moments: Symmetric, spin: Vector, now: Vector, kicked: Vector, w: Vector, last: float
) -> tuple[Quaternion, float, Vector, Vector]:
    """Return how a body without joints rotates in a substep.

    Where contacts have acted on it since the kick, w* is computed again from its present angular momentum: about an axis that
    is right to first order only, a capsule without friction would gain or lose spin.

    Parameters
    ----------
    h, q, moments, spin
        The substep, s, and the orientation, moments of inertia and angular momentum of the body.
    now, kicked, w : Vector
        Its angular velocity, w* as the kick left it, and w* with the impulses since then, rad/s.
    last : float
        When in the substep its last impact was, s; 0.0 if there was none.

    Returns
    -------
    q, left, w, turn
        An orientation in the substep, the time that is left from there on, w* in it, and the turn over the whole substep, rad.
    """
    won = minus(w, kicked)
    left, turn, change = h, times(h, w), dot(won, won)
    if change == 0.0 and last == 0.0 and h * h * dot(now, now) > _FAST:
        q, left, w = fast_rotation(h, q, moments, spin, now)
    elif change > 0.0 and h * h * dot(w, w) > _SLOW:
        # From the orientation that it had at its last impact within the substep
        turn, left = times(last, kicked), h - last
        q = product(exponential(turn), q)
        w = mean_turn(left, q, moments, spin, w)
        turn = plus(turn, times(left, w))
    return q, left, w, turn


@compiled
def fast_rotation(
    h: float, q: Quaternion, moments: Symmetric, spin: Vector, turn: Vector
) -> tuple[Quaternion, float, Vector]:
    """Rotate a body in free flight for a time h in parts, and return its orientation before the last, its time, and w* in it.

    `turn` is its angular velocity now. Contacts know of one rotation in a substep: this is for bodies that have none.
    """
    parts = int(min(h * math.sqrt(dot(turn, turn)) / _PART, _PARTS - 1.0)) + 1
    part = h / parts
    w = mean_turn(part, q, moments, spin, turn)
    for _ in range(parts - 1):
        q = product(exponential(times(part, w)), q)
        w = mean_turn(part, q, moments, spin, w)
    return q, part, w


@compiled(inline=True)
def _first_order_step(moments: Symmetric, p: Vector, b: Vector) -> Vector:
    """Solve (I - [p]x) w = b, Newton's equation for w = I^-1 (P + exp(-h w) P) / 2 to first order in h."""
    r0 = (moments[0], moments[3] + p[2], moments[4] - p[1])
    r1 = (moments[3] - p[2], moments[1], moments[5] + p[0])
    r2 = (moments[4] + p[1], moments[5] - p[0], moments[2])
    return _solved(r0, r1, r2, b)


@compiled
def _newton_step(h: float, moments: Symmetric, a: Vector, rotation: Quaternion, g: Vector, b: Vector) -> Vector:
    """Solve the same equation exactly, where a = h w is not zero, and g = exp(-a) P.

    With the right Jacobian J of the exponential (Sola, Deray, Atchuthan, arXiv:1812.01537, eq. 143), dg = h [g]x J dw, and for
    t = |a|, [g]x J = (sin t / t) [g]x - (1 - cos t) / t^2 (a g' - (a.g) 1) + (t - sin t) / t^3 (g x a) a'.
    """
    square, c = dot(a, a), rotation[0]
    s = dot(a, (rotation[1], rotation[2], rotation[3])) / square  # sin(t / 2) / t
    p, v = times(h * c * s, g), times(h * s * s, g)
    u, d = times(0.5 * h * (2.0 * c * s - 1.0) / square, cross(g, a)), dot(a, v)
    r0 = (moments[0] - d, moments[3] + p[2], moments[4] - p[1])
    r1 = (moments[3] - p[2], moments[1] - d, moments[5] + p[0])
    r2 = (moments[4] + p[1], moments[5] - p[0], moments[2] - d)
    r0 = plus(r0, plus(times(a[0], v), times(u[0], a)))
    r1 = plus(r1, plus(times(a[1], v), times(u[1], a)))
    r2 = plus(r2, plus(times(a[2], v), times(u[2], a)))
    return _solved(r0, r1, r2, b)


@compiled(inline=True)
def _solved(r0: Vector, r1: Vector, r2: Vector, b: Vector) -> Vector:
    """Solve three linear equations, given by the rows of their matrix, by Cramer's rule."""
    c0, c1, c2 = cross(r1, r2), cross(r2, r0), cross(r0, r1)
    return times(1.0 / dot(r0, c0), plus(plus(times(b[0], c0), times(b[1], c1)), times(b[2], c2)))
