"""Impulses between particles, segments or triangles of cloths and the bodies that they touch."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, plus, times
from kickdrift.world.cloth.body_impulses import mutual_response, push_body
from kickdrift.world.cloth.contact_lanes import resolve_lanes
from kickdrift.world.cloth.contact_rows import add_shares, gap_of, shares_of
from kickdrift.world.cloth.layout import (
    CARRIES,
    CLOTH_NORMAL,
    CLOTH_OFFSET,
    CLOTH_RADIUS,
    CONTACT_IMPULSE,
    FIRST_CONTACT,
    GROUND_VELOCITY,
    IN_LANES,
    LAST_CONTACT,
    MOVES_BODY,
    OTHER_PARTICLE,
    PARTICLE_VELOCITY,
    PASSED_FRICTION,
    SHARED_PARTS,
    SLIP,
    TOUCHED_BODY,
    TOUCHED_POINT,
    TOUCHING_PARTICLE,
)
from kickdrift.world.cloth.load_path import carried_response, is_carried, is_on_load_path, pass_on_pressure, room_below
from kickdrift.world.cloth.passed_friction import forget, friction_bound, note_part, pass_on_friction, within
from kickdrift.world.cloth.pinned_corners import is_held, point_velocity, push_holders, response_with_holders
from kickdrift.world.cloth.tilt_stiffness import resist_tilting
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts.layout import WIDTH
from kickdrift.world.layout import ANGULAR_VELOCITY, VELOCITY
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_CONTACT,
    CLOTH_CONTACT_NUMBERS,
    CLOTH_NUMBERS,
    CLOTH_SEARCH,
    MOTION,
    PARTICLE,
    floats,
    integers,
)

# Largest number of further sweeps, and the change of speed, m/s, that ends them. With 16 and 1e-3, loaded sheets tremble less
# by a tenth, and a net with boxes takes a third longer; with 2, they tremble twice as much.
_SWEEPS, _ENOUGH = 8, 1e-2


@compiled
def resolve_contacts(world: int, cloth: int, part: float, push: float, left: float) -> None:
    """Stop a cloth from moving into shapes in a part of a substep, with the reactions on bodies: projected Gauss-Seidel.

    Bodies move with their changes of velocity for the time `left` in the substep, s. Particles that are inside already are
    pushed out, at most with the speed `push`, m/s, without gaining velocity.
    """
    contact, first, last = (
        integers(world, CLOTH_CONTACT),
        integers(world, CLOTH)[cloth, FIRST_CONTACT],
        integers(world, CLOTH)[cloth, LAST_CONTACT],
    )
    numbers, particle = floats(world, CLOTH_CONTACT_NUMBERS), floats(world, PARTICLE)
    row, shared, advance = first, False, min(part, left)
    while row < last:
        if contact[row, IN_LANES] != 0:
            resolve_lanes(contact, numbers, particle, row, part, push, advance)
        else:
            shared = shared or contact[row, OTHER_PARTICLE] != contact[row, TOUCHING_PARTICLE]
            shared = shared or contact[row, CARRIES] != 0
            _begin(world, row, part * push, left)
            _resolve(world, row, part, left)
        row = _after(contact, row)
    if shared:
        _iterate(world, cloth, part, left)
    row = first
    while row < last:
        if contact[row, IN_LANES] == 0:
            _advance(world, row, advance)
        row = _after(contact, row)


@compiled(inline=True)
def _after(contact: Any, row: int) -> int:
    """Return the row of the next contact, or of the next eight."""
    return row + WIDTH if contact[row, IN_LANES] != 0 else row + 1


@compiled
def _iterate(world: int, cloth: int, part: float, left: float) -> None:
    """Iterate the impulses of contacts that share particles until they change little, and apply torques against tilting."""
    contact, h = integers(world, CLOTH_CONTACT), part * floats(world, CLOTH_SEARCH)[0, SHARED_PARTS]
    first, last = integers(world, CLOTH)[cloth, FIRST_CONTACT], integers(world, CLOTH)[cloth, LAST_CONTACT]
    radius = floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS]
    for _ in range(_SWEEPS):
        row, change = first, 0.0
        while row < last:
            if contact[row, IN_LANES] == 0:
                change = max(change, _resolve(world, row, part, left))
            row = _after(contact, row)
        if change < _ENOUGH:
            break
    row = first
    while row < last:
        if contact[row, IN_LANES] == 0:
            resist_tilting(world, row, radius, h, left)
        row = _after(contact, row)


@compiled
def _begin(world: int, row: int, most: float, left: float) -> None:
    """Begin a contact with the impulse of the part before, and move a point inside its shape out.

    No particle moves by more than `most`, beside a pinned one either. Points that cannot move leave a body as deep as it is.
    """
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    particle = floats(world, PARTICLE)
    gap, n = gap_of(world, row), vector_at(numbers, row, CLOTH_NORMAL)
    note_part(world, row)
    if contact[row, CARRIES] != 0:
        v = _velocity(world, row)
        numbers[row, SLIP] = length(minus(v, times(dot(n, v), n)))
    if gap >= 0.0 and numbers[row, CONTACT_IMPULSE] == 0.0:
        return
    corners, _, by, inverse_mass = shares_of(world, row)
    if gap < 0.0 and inverse_mass > 0.0:
        out = min(-gap, most * inverse_mass / max(by[0], by[1], by[2]), room_below(world, row))
        add_shares(particle, corners, 0, by, times(out / inverse_mass, n))
    if is_on_load_path(world, row):  # its impulses are those of a whole substep, not of a part
        forget(world, row)
        return
    impulse = plus(times(numbers[row, CONTACT_IMPULSE], n), vector_at(numbers, row, CONTACT_IMPULSE + 1))
    _give(world, row, impulse, left)


@compiled(inline=True)
def _ground_velocity(world: int, row: int) -> Vector:
    """Return the velocity of the surface of a contact."""
    contact, numbers, motion = (
        integers(world, CLOTH_CONTACT),
        floats(world, CLOTH_CONTACT_NUMBERS),
        floats(world, MOTION),
    )
    body, ground = contact[row, TOUCHED_BODY], vector_at(numbers, row, GROUND_VELOCITY)
    if contact[row, MOVES_BODY] != 0:
        turn = cross(vector_at(motion, body, ANGULAR_VELOCITY), vector_at(numbers, row, TOUCHED_POINT))
        ground = plus(plus(vector_at(motion, body, VELOCITY), turn), ground)
    return ground


@compiled
def _velocity(world: int, row: int) -> Vector:
    """Return the velocity of a point relative to the surface that it touches."""
    return minus(point_velocity(world, row), _ground_velocity(world, row))


@compiled
def _resolve(world: int, row: int, part: float, left: float) -> float:
    """Change the impulse of a contact so that it obeys the laws of contact and friction; return the change of speed, m/s."""
    numbers, n = (
        floats(world, CLOTH_CONTACT_NUMBERS),
        vector_at(floats(world, CLOTH_CONTACT_NUMBERS), row, CLOTH_NORMAL),
    )
    _, _, by, inverse_mass = shares_of(world, row)
    approach, wanted = dot(n, _velocity(world, row)), -max(gap_of(world, row), 0.0) / part
    before, sliding = numbers[row, CONTACT_IMPULSE], vector_at(numbers, row, CONTACT_IMPULSE + 1)
    now = before + (wanted - approach) / (carried_response(world, row, n, by) + _response(world, row, n))
    now = max(now, 0.0)
    if now == 0.0 and before == 0.0:
        return 0.0
    impulse = times(now - before, n)
    numbers[row, CONTACT_IMPULSE] = now
    _give(world, row, impulse, left)
    pass_on_pressure(world, row, now - before, left)
    if is_carried(world, row):
        v = _velocity(world, row)
        slip = minus(v, times(dot(n, v), n))
        pass_on_friction(world, row, slip, _response(world, row, _direction(slip)), left)
    friction = minus(_friction(world, row, inverse_mass), sliding)
    for k in range(3):
        numbers[row, CONTACT_IMPULSE + 1 + k] += friction[k]
    _give(world, row, friction, left)
    return inverse_mass * length(plus(impulse, friction))


@compiled(inline=True)
def _direction(v: Vector) -> Vector:
    return times(1.0 / max(length(v), 1e-300), v)


@compiled
def _friction(world: int, row: int, inverse_mass: float) -> Vector:
    """Return the impulse of friction that would stop a point of an inverse mass, 1/kg, within Coulomb's bound, N s."""
    numbers = floats(world, CLOTH_CONTACT_NUMBERS)
    n, friction = vector_at(numbers, row, CLOTH_NORMAL), vector_at(numbers, row, CONTACT_IMPULSE + 1)
    v = _velocity(world, row)
    slip = minus(v, times(dot(n, v), n))
    if dot(slip, slip) > 0.0:
        friction = minus(friction, times(1.0 / (inverse_mass + _response(world, row, _direction(slip))), slip))
    # What is passed on through the cloth is bounded by what passes it: an excess of it would throw the cloth.
    passed = vector_at(numbers, row, PASSED_FRICTION)
    most = max(friction_bound(world, row), length(passed))
    return minus(within(plus(friction, passed), most), passed)


@compiled
def _give(world: int, row: int, impulse: Vector, left: float) -> None:
    """Apply an impulse to the point of a contact, N s, and its reaction to the body."""
    contact = integers(world, CLOTH_CONTACT)
    corners, share, by, _ = shares_of(world, row)
    add_shares(floats(world, PARTICLE), corners, PARTICLE_VELOCITY, by, impulse)
    if contact[row, MOVES_BODY] != 0:
        arm = vector_at(floats(world, CLOTH_CONTACT_NUMBERS), row, TOUCHED_POINT)
        push_body(world, contact[row, TOUCHED_BODY], arm, times(-1.0, impulse), left)
    push_holders(world, row, share, impulse, left)


@compiled
def _advance(world: int, row: int, time: float) -> None:
    """Move the surface of a contact on for a time, s."""
    numbers = floats(world, CLOTH_CONTACT_NUMBERS)
    speed = dot(vector_at(numbers, row, CLOTH_NORMAL), _ground_velocity(world, row))
    numbers[row, CLOTH_OFFSET] += time * speed


@compiled
def _response(world: int, row: int, n: Vector) -> float:
    """Return by how much faster bodies let a point and what it touches part along n, for a unit impulse along n, 1/kg."""
    contact, arm = integers(world, CLOTH_CONTACT), vector_at(floats(world, CLOTH_CONTACT_NUMBERS), row, TOUCHED_POINT)
    if is_held(world, row):
        return float(response_with_holders(world, row, n))
    return (
        float(mutual_response(world, contact[row, TOUCHED_BODY], arm, arm, n)) if contact[row, MOVES_BODY] != 0 else 0.0
    )
