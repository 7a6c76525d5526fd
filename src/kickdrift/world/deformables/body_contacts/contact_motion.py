"""Points of cloths that touch surfaces: their relative velocities, how bodies respond, and impulses on both."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.body_contacts.body_impulses import load_body, push_body, response_to_load
from kickdrift.world.deformables.body_contacts.contact_rows import Shares, add_shares, gap_of, shares_of
from kickdrift.world.deformables.body_contacts.pinned_corners import (
    is_held,
    point_velocity,
    push_holders,
    response_with_holders,
)
from kickdrift.world.deformables.layout import (
    CLOTH_NORMAL,
    GROUND_VELOCITY,
    MOVES_BODY,
    PARTICLE_VELOCITY,
    TOUCHED_BODY,
    TOUCHED_POINT,
)
from kickdrift.world.layout import ANGULAR_VELOCITY, VELOCITY
from kickdrift.world.tables import CLOTH_CONTACT, CLOTH_CONTACT_NUMBERS, MOTION, PARTICLE, floats, integers


@compiled(inline=True)
def ground_velocity(world: int, row: int) -> Vector:
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
def slip_velocity(world: int, row: int) -> Vector:
    """Return the velocity of a point relative to the surface that it touches."""
    return minus(point_velocity(world, row), ground_velocity(world, row))


@compiled
def response_of_bodies(world: int, row: int, n: Vector) -> float:
    """Return by how much faster bodies let a point and what it touches part along n, for a unit impulse along n, 1/kg."""
    contact, arm = integers(world, CLOTH_CONTACT), vector_at(floats(world, CLOTH_CONTACT_NUMBERS), row, TOUCHED_POINT)
    if is_held(world, row):
        return float(response_with_holders(world, row, n))
    if contact[row, MOVES_BODY] == 0:
        return 0.0
    return float(response_to_load(world, contact[row, TOUCHED_BODY], arm, load_direction(world, row), n))


@compiled(inline=True)
def load_direction(world: int, row: int) -> Vector:
    """Return the direction in which a contact loads its body."""
    return times(-1.0, vector_at(floats(world, CLOTH_CONTACT_NUMBERS), row, CLOTH_NORMAL))


@compiled
def give_impulse(world: int, row: int, shares: Shares, impulse: Vector, left: float) -> None:
    """Apply an impulse to the point of a contact, N s, and its reaction to the body; `shares` are those of `shares_of`."""
    contact = integers(world, CLOTH_CONTACT)
    corners, share, by, _ = shares
    add_shares(floats(world, PARTICLE), corners, PARTICLE_VELOCITY, by, impulse)
    if contact[row, MOVES_BODY] != 0:
        push_touched(world, row, times(-1.0, impulse), left)
    push_holders(world, row, share, impulse, left)


@compiled
def push_touched(world: int, row: int, impulse: Vector, left: float) -> None:
    """Apply an impulse to the body that a contact touches."""
    body, arm = (
        integers(world, CLOTH_CONTACT)[row, TOUCHED_BODY],
        vector_at(floats(world, CLOTH_CONTACT_NUMBERS), row, TOUCHED_POINT),
    )
    if is_held(world, row):
        push_body(world, body, arm, impulse, left)
    else:
        load_body(world, body, arm, load_direction(world, row), impulse, left)


@compiled(inline=True)
def move_out(world: int, row: int, n: Vector, most: float) -> None:
    """Move a point inside its shape out, as far as no particle moves by more than `most`, m."""
    gap = gap_of(world, row)
    if gap < 0.0:
        corners, _, by, inverse_mass = shares_of(world, row)
        if inverse_mass > 0.0:
            out = min(-gap, most * inverse_mass / max(by[0], by[1], by[2]))
            add_shares(floats(world, PARTICLE), corners, 0, by, times(out / inverse_mass, n))
