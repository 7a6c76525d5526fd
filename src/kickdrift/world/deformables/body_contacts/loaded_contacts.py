"""Contacts on a load path: what presses on a cloth, and what carries it there (`load_path`)."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.body_contacts.contact_motion import (
    give_impulse,
    move_out,
    response_of_bodies,
    slip_velocity,
)
from kickdrift.world.deformables.body_contacts.contact_rows import gap_of, shares_of
from kickdrift.world.deformables.body_contacts.load_path import (
    carried_response,
    is_carried,
    pass_on_pressure,
    response_below,
    room_below,
    slip_below,
)
from kickdrift.world.deformables.body_contacts.transmitted_friction import friction_bound, pass_on_friction, within
from kickdrift.world.deformables.layout import CLOTH_NORMAL, CONTACT_IMPULSE, PASSED_FRICTION
from kickdrift.world.tables import CLOTH_CONTACT_NUMBERS, floats


@compiled
def begin_loaded(world: int, row: int, most: float) -> None:
    """Begin a contact on a load path without impulses, and move a point inside its shape out by `most` at most, m."""
    numbers = floats(world, CLOTH_CONTACT_NUMBERS)
    for k in range(4):
        numbers[row, CONTACT_IMPULSE + k] = 0.0
    for k in range(3):
        numbers[row, PASSED_FRICTION + k] = 0.0
    move_out(world, row, vector_at(numbers, row, CLOTH_NORMAL), min(most, room_below(world, row)))


@compiled
def resolve_loaded(world: int, row: int, part: float, left: float) -> float:
    """Do as `_resolve` for a contact on a load path, with what it passes on."""
    numbers, shares = floats(world, CLOTH_CONTACT_NUMBERS), shares_of(world, row)
    n, inverse_mass = vector_at(numbers, row, CLOTH_NORMAL), shares[3]
    approach = dot(n, minus(slip_velocity(world, row), slip_below(world, row)))
    wanted = -max(gap_of(world, row), 0.0) / part
    before, sliding = numbers[row, CONTACT_IMPULSE], vector_at(numbers, row, CONTACT_IMPULSE + 1)
    now = before + (wanted - approach) / (
        carried_response(world, row, n, shares[2]) + response_of_bodies(world, row, n)
    )
    now = max(now, 0.0)
    if now == 0.0 and before == 0.0:
        return 0.0
    impulse = times(now - before, n)
    numbers[row, CONTACT_IMPULSE] = now
    give_impulse(world, row, shares, impulse, left)
    pass_on_pressure(world, row, now - before, left)
    if is_carried(world, row):
        slip = _tangential(minus(slip_velocity(world, row), slip_below(world, row)), n)
        way = _direction(slip)
        pass_on_friction(world, row, slip, response_of_bodies(world, row, way) + response_below(world, row, way), left)
    friction = minus(_friction(world, row, inverse_mass), sliding)
    for k in range(3):
        numbers[row, CONTACT_IMPULSE + 1 + k] += friction[k]
    give_impulse(world, row, shares, friction, left)
    return inverse_mass * length(plus(impulse, friction))


@compiled(inline=True)
def _tangential(v: Vector, n: Vector) -> Vector:
    """Return the part of a vector across a unit vector."""
    return minus(v, times(dot(n, v), n))


@compiled(inline=True)
def _direction(v: Vector) -> Vector:
    return times(1.0 / max(length(v), 1e-300), v)


@compiled
def _friction(world: int, row: int, inverse_mass: float) -> Vector:
    """Return the impulse of friction that would stop a point of an inverse mass, 1/kg, within Coulomb's bound, N s."""
    numbers = floats(world, CLOTH_CONTACT_NUMBERS)
    n, friction = vector_at(numbers, row, CLOTH_NORMAL), vector_at(numbers, row, CONTACT_IMPULSE + 1)
    v = slip_velocity(world, row)
    slip = _tangential(v, n)
    if dot(slip, slip) > 0.0:
        friction = minus(friction, times(1.0 / (inverse_mass + response_of_bodies(world, row, _direction(slip))), slip))
    # What is passed on through the cloth is bounded by what passes it: an excess of it would throw the cloth.
    passed = vector_at(numbers, row, PASSED_FRICTION)
    most = max(friction_bound(world, row), length(passed))
    return minus(within(plus(friction, passed), most), passed)
