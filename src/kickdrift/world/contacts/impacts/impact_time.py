"""Times of impact of the points of a contact: the first zero of each gap along the free flight of both bodies.

With normal n and arms r, the gap has the derivatives n . (v + w x r) and n . (w x (w x r) + w' x r). Newton's method of second
order, with parabolas, marches along it by at most a fraction of a turn at a time, so that a corner that comes down and goes up
again within a substep is not missed. The normal of two balls or capsules is the direction between their cores, which turns as
they pass each other, so that those that have stopped along it do not seem to approach along that of before.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, plus, times, turned
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.constraint_groups import vector_of
from kickdrift.world.contacts.impacts.impact_motion import Flight, Place, flown, place_of
from kickdrift.world.contacts.impacts.moved_contacts import arms_between, normal_between
from kickdrift.world.layout import ADDED, ANGULAR_VELOCITY, VELOCITY
from kickdrift.world.settings import MIDPOINT
from kickdrift.world.tables import CONTACT, KICKED, MOTION, SETTINGS, floats, integers

_STILL = 0.1  # rad per substep
_TURN = 0.25  # rad, over which a gap deviates from a parabola by a percent
_MARCHES = 64  # windows per substep, at most; faster corners may be missed, and then hit late
_ROUNDS = 8  # of Newton's method
_TOLERANCE = 1e-12  # of the substep


@compiled
def rests(world: int, h: float, row: int, own: Any, slowest: float) -> bool:
    """Whether no point of a contact can reach the bounce speed `slowest` within the substep: true of most resting contacts."""
    contact, motion = integers(world, CONTACT), floats(world, MOTION)
    a, b, normal = contact[row, c.BODY_A], contact[row, c.BODY_B], vector_of(own, c.N)
    across = dot(normal, minus(vector_at(motion, b, VELOCITY), vector_at(motion, a, VELOCITY)))
    turn_a, turn_b = length(vector_at(motion, a, ANGULAR_VELOCITY)), length(vector_at(motion, b, ANGULAR_VELOCITY))
    reach_a, reach_b = 0.0, 0.0
    for k in range(contact[row, c.POINTS]):
        anchor = c.ANCHORS + c.ANCHOR_SIZE * k
        reach_a = max(reach_a, length(vector_of(own, anchor)) + own[(anchor + c.RADII) * c.WIDTH])
        reach_b = max(reach_b, length(vector_of(own, anchor + c.ANCHOR_B)) + own[(anchor + c.RADII + 1) * c.WIDTH])
    # Twice, as the angular velocity of bodies with unequal moments may grow in flight
    fastest = abs(across) + abs(_added(world, a, b, normal)) + 2.0 * (turn_a * reach_a + turn_b * reach_b)
    return fastest < slowest and max(turn_a, turn_b) * h < _STILL


@compiled
def find_time(
    world: int,
    h: float,
    row: int,
    own: Any,
    point: int,
    since: float,
    slowest: float,
    flight_a: Flight,
    flight_b: Flight,
) -> Any:
    """Find when a point hits faster than `slowest`, m/s; `flight_a` and `flight_b` are the motions at the time `since`.

    Returns
    -------
    when : float
        Time of impact in the substep, s; if it does not hit, the time at which it touches, or infinity.
    speed : float
        Speed of approach then, m/s; 0.0 if it does not hit.
    free : bool
        Whether the sweeps, which assume constant velocities, must ignore the point: it does not touch but may reach that speed
        within the substep, or it overlaps and comes to separate as fast.
    """
    normal = vector_of(own, c.N)
    gap, speed, bend = _gap(world, h, row, own, point, flight_a, flight_b)
    rate, most = _fastest_turn(world, h, row, own, point, normal, flight_a, flight_b)
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
        when = min(when + min(window, _time_to_zero(gap, speed, bend) if above else window), h)
        gap, speed, bend = _gap_at(world, h, row, own, point, when)
        for _ in range(_ROUNDS if above else 0):
            step = _time_to_zero(gap, speed, bend)
            if abs(step) <= _TOLERANCE * h:
                gap = 0.0
            if gap == 0.0 or not first <= when + step <= min(first + window, h):
                break
            when += step
            gap, speed, bend = _gap_at(world, h, row, own, point, when)
        touches, leaves = min(touches, when if gap <= 0.0 else math.inf), max(leaves, speed)
    return touches, 0.0, leaves > slowest or (touches == math.inf and most * left > slowest)


@compiled(inline=True)
def _time_to_zero(gap: float, speed: float, bend: float) -> float:
    """Return the time until a parabola falls to zero, negative if the gap is negative; infinity if it never does."""
    root = speed * speed - 2.0 * bend * gap
    if root < 0.0 or math.sqrt(root) <= speed:
        return math.inf
    return 2.0 * gap / (math.sqrt(root) - speed)


@compiled
def _gap_at(world: int, h: float, row: int, own: Any, point: int, when: float) -> tuple[float, float, float]:
    """Return `_gap` at a time in the substep."""
    contact = integers(world, CONTACT)
    flight_a, flight_b = flown(world, h, contact[row, c.BODY_A], when), flown(world, h, contact[row, c.BODY_B], when)
    return _gap(world, h, row, own, point, flight_a, flight_b)


@compiled
def _gap(
    world: int, h: float, row: int, own: Any, point: int, flight_a: Flight, flight_b: Flight
) -> tuple[float, float, float]:
    """Return the gap of a point and its first and second derivative in time, for the given motions of its bodies."""
    contact = integers(world, CONTACT)
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    place_a, place_b = place_of(world, a, flight_a[0], flight_a[1]), place_of(world, b, flight_b[0], flight_b[1])
    normal, far = normal_between(world, row, own, place_a, place_b)
    arm_a, arm_b, between = arms_between(own, point, normal, place_a, place_b)
    speed = dot(
        normal, minus(plus(flight_b[2], cross(flight_b[3], arm_b)), plus(flight_a[2], cross(flight_a[3], arm_a)))
    )
    anchor = c.ANCHORS + c.ANCHOR_SIZE * point
    bend = _added(world, a, b, normal) / h
    if far < math.inf:
        bend += _passing(own, anchor, normal, flight_a, flight_b, arm_a, arm_b) / far
    bend -= _normal_acceleration(own, anchor, anchor + c.RADII, c.AXES, normal, place_a, flight_a, -1.0)
    anchor_b, radius_b = anchor + c.ANCHOR_B, anchor + c.RADII + 1
    bend += _normal_acceleration(own, anchor_b, radius_b, c.AXES + 3, normal, place_b, flight_b, 1.0)
    return dot(normal, between), speed, bend


@compiled(inline=True)
def _passing(
    own: Any, anchor: int, normal: Vector, flight_a: Flight, flight_b: Flight, arm_a: Vector, arm_b: Vector
) -> float:
    """Return the square of the speed at which the centres of two balls pass each other, across their normal, m^2/s^2."""
    radius_a, radius_b = own[(anchor + c.RADII) * c.WIDTH], own[(anchor + c.RADII + 1) * c.WIDTH]
    turn_a = cross(flight_a[3], minus(arm_a, times(radius_a, normal)))
    turn_b = cross(flight_b[3], plus(arm_b, times(radius_b, normal)))
    across = cross(normal, minus(plus(flight_b[2], turn_b), plus(flight_a[2], turn_a)))
    return dot(across, across)


@compiled(inline=True)
def _added(world: int, a: int, b: int, normal: Vector) -> float:
    """Return the change of a gap's speed in the substep by the kick, m/s; zero unless free flight uses the midpoint rule."""
    kicked, midpoint = floats(world, KICKED), floats(world, SETTINGS)[0, MIDPOINT]
    added: float = midpoint * dot(normal, minus(vector_at(kicked, b, ADDED), vector_at(kicked, a, ADDED)))
    return added


@compiled(inline=True)
def _normal_acceleration(
    own: Any, anchor: int, radius: int, axis: int, normal: Vector, place: Place, flight: Flight, side: float
) -> float:
    """Return the acceleration along the normal of a point of a rotating body, m/s^2; `side` is -1.0 for a, 1.0 for b.

    The surface of a round shape is farther along the normal than its core by the radius times sqrt(1 - m^2), m = n . axis.
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
    """Return the acceleration of a point relative to the centre of its body, w x (w x r) + w' x r."""
    return plus(cross(flight[3], cross(flight[3], arm)), cross(flight[4], arm))


@compiled
def _fastest_turn(
    world: int, h: float, row: int, own: Any, point: int, normal: Vector, flight_a: Flight, flight_b: Flight
) -> tuple[float, float]:
    """Bound the rate at which a point turns, rad/s, and the second derivative of its gap, m/s^2.

    Rotation of a round shape about its core does not count.
    """
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
    """Return the part of one body in the bounds of `_fastest_turn`."""
    arm, along = turned(place[1], vector_of(own, anchor)), turned(place[1], vector_of(own, axis))
    turn, reach = flight[3], own[radius * c.WIDTH]
    rate, size = length(turn), length(arm)
    round_core, tilting = length(cross(turn, arm)), length(cross(turn, along))
    if reach > 0.0:
        rate = min(rate, round_core / max(size, 1e-150) + tilting)
    # The acceleration along n of a point that rotates is at most |w x r| |w x n|; twice that, as the axis moves, too.
    most = 2.0 * length(cross(turn, normal)) * (round_core + reach * tilting)
    return rate, most + 2.0 * length(flight[4]) * (size + reach * length(along))
