"""Corners of touching triangles, and ends of segments, that are pinned to bodies: these bodies get their shares of impulses."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, plus, times, turned
from kickdrift.world.collision.broad_phase.filters_and_sensors import is_excluded
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.deformables.body_contacts.body_impulses import mutual_response, push_body
from kickdrift.world.deformables.layout import (
    FIRST_PIN,
    HELD_BY,
    LAST_PIN,
    MOVES_BODY,
    OTHER_PARTICLE,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
    PIN_POSITION,
    PINNED_BODY,
    PINNED_PARTICLE,
    SHARES,
    THIRD_PARTICLE,
    TOUCHED_BODY,
    TOUCHED_POINT,
    TOUCHING_PARTICLE,
)
from kickdrift.world.layout import ANGULAR_VELOCITY, ORIENTATION, VELOCITY
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_CONTACT,
    CLOTH_CONTACT_NUMBERS,
    MOTION,
    PARTICLE,
    PIN,
    PIN_NUMBERS,
    POSE,
    floats,
    integers,
)

Corners = tuple[int, int, int]

FREE = -1  # instead of a pin


@compiled
def pin_of(world: int, cloth: int, i: int) -> int:
    """Return the row of the pin of a particle to a body, or `FREE`."""
    own, pin = integers(world, CLOTH), integers(world, PIN)
    if floats(world, PARTICLE)[i, PARTICLE_INVERSE_MASS] == 0.0:
        for k in range(own[cloth, FIRST_PIN], own[cloth, LAST_PIN]):
            if pin[k, PINNED_PARTICLE] == i:
                return k
    return FREE


@compiled
def is_pinned_to(world: int, cloth: int, corners: Corners, body: int) -> bool:
    """Whether one of three particles is pinned to a body."""
    for k in range(3):
        at = pin_of(world, cloth, corners[k])
        if at != FREE and integers(world, PIN)[at, PINNED_BODY] == body:
            return True
    return False


@compiled
def holds_off(world: int, cloth: int, i: int, body: int) -> bool:
    """Whether a pinned particle stops a body that moves: unless it is pinned to it, or to one that never touches it."""
    at = pin_of(world, cloth, i)
    if at == FREE:
        return True
    holder = integers(world, PIN)[at, PINNED_BODY]
    return holder != body and not is_excluded(world, min(holder, body), max(holder, body))


@compiled(inline=True)
def arm_of_pin(world: int, pin: int) -> Vector:
    """Return the vector from the centre of mass of the body to a pin, m."""
    q = quaternion_at(floats(world, POSE), integers(world, PIN)[pin, PINNED_BODY], ORIENTATION)
    return turned(q, vector_at(floats(world, PIN_NUMBERS), pin, PIN_POSITION))


@compiled(inline=True)
def is_held(world: int, row: int) -> bool:
    """Whether a corner of a contact is pinned to a body."""
    contact = integers(world, CLOTH_CONTACT)
    held: bool = max(contact[row, HELD_BY], contact[row, HELD_BY + 1], contact[row, HELD_BY + 2]) != FREE
    return held


@compiled(inline=True)
def corner_velocity(world: int, row: int, k: int) -> Vector:
    """Return the velocity of a corner of a contact: that of its body where it is pinned, which may have changed since."""
    contact, columns = integers(world, CLOTH_CONTACT), (TOUCHING_PARTICLE, OTHER_PARTICLE, THIRD_PARTICLE)
    return velocity_with(world, contact[row, columns[k]], contact[row, HELD_BY + k])


@compiled(inline=True)
def velocity_with(world: int, i: int, pin: int) -> Vector:
    """Return the velocity of a particle: that of its body where it is pinned, which may have changed since."""
    if pin == FREE:
        return vector_at(floats(world, PARTICLE), i, PARTICLE_VELOCITY)
    body, motion = integers(world, PIN)[pin, PINNED_BODY], floats(world, MOTION)
    turn = cross(vector_at(motion, body, ANGULAR_VELOCITY), arm_of_pin(world, pin))
    return plus(vector_at(motion, body, VELOCITY), turn)


@compiled
def point_velocity(world: int, row: int) -> Vector:
    """Return the velocity of the point of a cloth at a contact."""
    share = vector_at(floats(world, CLOTH_CONTACT_NUMBERS), row, SHARES)
    v = plus(times(share[0], corner_velocity(world, row, 0)), times(share[1], corner_velocity(world, row, 1)))
    return plus(v, times(share[2], corner_velocity(world, row, 2)))


@compiled
def push_holders(world: int, row: int, shares: Vector, impulse: Vector, left: float) -> None:
    """Apply shares of an impulse on a contact to the bodies to which its corners are pinned."""
    contact, pin = integers(world, CLOTH_CONTACT), integers(world, PIN)
    for k in range(3):
        at = contact[row, HELD_BY + k]
        if at != FREE:
            push_body(world, pin[at, PINNED_BODY], arm_of_pin(world, at), times(shares[k], impulse), left)


@compiled
def holder_response(world: int, row: int, k: int, n: Vector) -> float:
    """Return the change of velocity of a corner along n by a unit impulse along n on the body to which it is pinned, 1/kg."""
    body, arm, share = _point(world, row, k)
    return 0.0 if share == 0.0 else float(mutual_response(world, body, arm, arm, n))


@compiled
def response_with_holders(world: int, row: int, n: Vector) -> float:
    """Return by how much faster the bodies let a contact part along n, for a unit impulse along n, 1/kg.

    Each body moves by the impulses on all its points, of which the touched one has the share -1.
    """
    total = 0.0
    for k in range(4):
        body, arm, share = _point(world, row, k)
        for m in range(4):
            other_body, other_arm, other_share = _point(world, row, m)
            if share * other_share != 0.0 and body == other_body:
                total += share * other_share * mutual_response(world, body, arm, other_arm, n)
    return total


@compiled
def _point(world: int, row: int, k: int) -> tuple[int, Vector, float]:
    """Return body, arm and share of the impulse of the k-th pinned corner, or of the touched point as the fourth."""
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    if k == 3:
        share = -1.0 if contact[row, MOVES_BODY] != 0 else 0.0
        return contact[row, TOUCHED_BODY], vector_at(numbers, row, TOUCHED_POINT), share
    pin = contact[row, HELD_BY + k]
    if pin == FREE:
        return 0, (0.0, 0.0, 0.0), 0.0
    return integers(world, PIN)[pin, PINNED_BODY], arm_of_pin(world, pin), numbers[row, SHARES + k]
