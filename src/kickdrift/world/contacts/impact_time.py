"""When the points of a contact hit: the first zero of each gap, as both bodies fly.

With normal n and arms r, the gap closes at the speed n . (v + w x r) and bends by n . (w x (w x r) + w' x r). Newton's method
of second order marches along it, by no more than a part of a turn at a time, so that a corner that comes down and goes up
again within a substep is not missed.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, plus, turned
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.impact_motion import Flight, Place, arms_between, flown, place_of, vector_of
from kickdrift.world.layout import ADDED, ANGULAR_VELOCITY, VELOCITY
from kickdrift.world.settings import MIDPOINT
from kickdrift.world.tables import CONTACT, KICKED, MOTION, SETTINGS, floats, integers

_STILL = 0.1  # rad a substep
_TURN = 0.25  # rad, of which a gap bends by a percent less than a parabola
_MARCHES = 64  # through a substep at most; faster corners may be missed, and then hit late
_ROUNDS = 8  # of Newton's method
_ENOUGH = 1e-12  # of the substep


@compiled
def rests(h: float, world: int, row: int, own: Any, slowest: float) -> bool:
    """Whether no point of a contact can become as fast as what bounces within the substep, as of most things that lie."""
    contact, motion = integers(world, CONTACT), floats(world, MOTION)
    a, b, normal = contact[row, c.BODY_A], contact[row, c.BODY_B], vector_of(own, c.N)
    across = dot(normal, minus(vector_at(motion, b, VELOCITY), vector_at(motion, a, VELOCITY)))
    turn_a, turn_b = length(vector_at(motion, a, ANGULAR_VELOCITY)), length(vector_at(motion, b, ANGULAR_VELOCITY))
    reach_a, reach_b = 0.0, 0.0
    for k in range(contact[row, c.POINTS]):
        anchor = c.ANCHORS + c.ANCHOR_SIZE * k
        reach_a = max(reach_a, length(vector_of(own, anchor)) + own[(anchor + c.RADII) * c.WIDTH])
        reach_b = max(reach_b, length(vector_of(own, anchor + c.ANCHOR_B)) + own[(anchor + c.RADII + 1) * c.WIDTH])
    # Twice, as the angular velocity of what is not round grows in its flight
    fastest = abs(across) + abs(_added(world, a, b, normal)) + 2.0 * (turn_a * reach_a + turn_b * reach_b)
    return fastest < slowest and max(turn_a, turn_b) * h < _STILL


@compiled
def find_time(
    h: float,
    world: int,
    row: int,
    own: Any,
    point: int,
    since: float,
    slowest: float,
    flight_a: Flight,
    flight_b: Flight,
) -> Any:
    """Find when a point hits faster than the slowest that bounce; its bodies fly so when the last impact has left them.

    Returns
    -------
    when : float
        Where it does not within the substep, when it touches; infinity if never.
    speed : float
        0.0 where it does not hit.
    free : bool
        Whether the sweeps, which take velocities to be constant, are not to touch it: it does not touch, but may become as
        fast as that within the substep, or shapes that overlap there come to part as fast.
    """
    normal = vector_of(own, c.N)
    gap, speed, bend = _gap(h, world, row, own, point, normal, flight_a, flight_b)
    rate, most = _fastest_turn(h, world, row, own, point, normal, flight_a, flight_b)
    left = h - since
    if gap > 0.0 and gap + left * speed - 0.5 * most * left * left > 0.0:
        return math.inf, 0.0, most * left > slowest
    if gap <= 0.0 and abs(speed) + most * left < slowest:
        return since, 0.0, False
    when, touches, leaves = since, since if gap <= 0.0 else math.inf, speed
    window = max(_TURN / max(rate, 1e-150), left / _MARCHES)
    for _ in range(4 * _MARCHES):
        if gap <= 0.0 and speed < -slowest:
            return when, -speed, False
        if when >= h:
            break
        first, above = when, gap > 0.0
        when = min(when + min(window, _until(gap, speed, bend) if above else window), h)
        gap, speed, bend = _gap_at(h, world, row, own, point, normal, when)
        for _ in range(_ROUNDS if above else 0):
            step = _until(gap, speed, bend)
            if abs(step) <= _ENOUGH * h:
                gap = 0.0
            if gap == 0.0 or not first <= when + step <= min(first + window, h):
                break
            when += step
            gap, speed, bend = _gap_at(h, world, row, own, point, normal, when)
        touches, leaves = min(touches, when if gap <= 0.0 else math.inf), max(leaves, speed)
    return touches, 0.0, leaves > slowest or (touches == math.inf and most * left > slowest)


@compiled(inline=True)
def _until(gap: float, speed: float, bend: float) -> float:
    """Return when a parabola comes down to zero, before now if the gap is below it; infinity if never."""
    root = speed * speed - 2.0 * bend * gap
    if root < 0.0 or math.sqrt(root) <= speed:
        return math.inf
    return 2.0 * gap / (math.sqrt(root) - speed)


@compiled
def _gap_at(
    h: float, world: int, row: int, own: Any, point: int, normal: Vector, when: float
) -> tuple[float, float, float]:
    contact = integers(world, CONTACT)
    flight_a, flight_b = flown(h, world, contact[row, c.BODY_A], when), flown(h, world, contact[row, c.BODY_B], when)
    return _gap(h, world, row, own, point, normal, flight_a, flight_b)


@compiled
def _gap(
    h: float, world: int, row: int, own: Any, point: int, normal: Vector, flight_a: Flight, flight_b: Flight
) -> tuple[float, float, float]:
    """Return the gap of a point where its bodies fly, and its first and second derivative."""
    contact = integers(world, CONTACT)
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    place_a, place_b = place_of(world, a, flight_a[0], flight_a[1]), place_of(world, b, flight_b[0], flight_b[1])
    arm_a, arm_b, between = arms_between(own, point, normal, place_a, place_b)
    speed = dot(
        normal, minus(plus(flight_b[2], cross(flight_b[3], arm_b)), plus(flight_a[2], cross(flight_a[3], arm_a)))
    )
    anchor = c.ANCHORS + c.ANCHOR_SIZE * point
    bend = _added(world, a, b, normal) / h
    bend -= _bend(own, anchor, anchor + c.RADII, c.AXES, normal, place_a, flight_a, -1.0)
    bend += _bend(own, anchor + c.ANCHOR_B, anchor + c.RADII + 1, c.AXES + 3, normal, place_b, flight_b, 1.0)
    return dot(normal, between), speed, bend


@compiled(inline=True)
def _added(world: int, a: int, b: int, normal: Vector) -> float:
    """How much faster a gap opens after the substep than before, by the kick."""
    kicked, midpoint = floats(world, KICKED), floats(world, SETTINGS)[0, MIDPOINT]
    added: float = midpoint * dot(normal, minus(vector_at(kicked, b, ADDED), vector_at(kicked, a, ADDED)))
    return added


@compiled(inline=True)
def _bend(
    own: Any, anchor: int, radius: int, axis: int, normal: Vector, place: Place, flight: Flight, side: float
) -> float:
    """Acceleration along the normal of a point of a body that goes round, on the side of a that is -1.0, or of b that is 1.0.

    The surface of a round shape is farther than its core by the radius times sqrt(1 - m^2), m = n . axis.
    """
    arm, along = turned(place[1], vector_of(own, anchor)), turned(place[1], vector_of(own, axis))
    bend: float = dot(normal, _acceleration(flight, arm))
    if own[radius * c.WIDTH] > 0.0 and dot(along, along) > 0.0:
        m, slope = dot(normal, along), dot(normal, cross(flight[3], along))
        rise = math.sqrt(max(1.0 - m * m, 1e-12))
        bend += (
            side
            * own[radius * c.WIDTH]
            * (slope * slope / rise**2 + m * dot(normal, _acceleration(flight, along)))
            / rise
        )
    return bend


@compiled(inline=True)
def _acceleration(flight: Flight, arm: Vector) -> Vector:
    return plus(cross(flight[3], cross(flight[3], arm)), cross(flight[4], arm))


@compiled
def _fastest_turn(
    h: float, world: int, row: int, own: Any, point: int, normal: Vector, flight_a: Flight, flight_b: Flight
) -> tuple[float, float]:
    """Bound how fast a point goes round, rad/s, and how its gap bends, m/s^2; what is round may spin about its core."""
    contact = integers(world, CONTACT)
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    anchor = c.ANCHORS + c.ANCHOR_SIZE * point
    place_a, place_b = place_of(world, a, flight_a[0], flight_a[1]), place_of(world, b, flight_b[0], flight_b[1])
    rate_a, most_a = _turn_of(own, anchor, anchor + c.RADII, c.AXES, normal, place_a, flight_a)
    rate_b, most_b = _turn_of(own, anchor + c.ANCHOR_B, anchor + c.RADII + 1, c.AXES + 3, normal, place_b, flight_b)
    return max(rate_a, rate_b), most_a + most_b + abs(_added(world, a, b, normal)) / h


@compiled(inline=True)
def _turn_of(
    own: Any, anchor: int, radius: int, axis: int, normal: Vector, place: Place, flight: Flight
) -> tuple[float, float]:
    arm, along = turned(place[1], vector_of(own, anchor)), turned(place[1], vector_of(own, axis))
    turn, reach = flight[3], own[radius * c.WIDTH]
    rate, size = length(turn), length(arm)
    round_core, tilting = length(cross(turn, arm)), length(cross(turn, along))
    if reach > 0.0:
        rate = min(rate, round_core / max(size, 1e-150) + tilting)
    # A point that goes round an axis has at most |w x r| |w x n| along n; twice that, as the axis moves, too.
    most = 2.0 * length(cross(turn, normal)) * (round_core + reach * tilting)
    return rate, most + 2.0 * length(flight[4]) * (size + reach * length(along))
