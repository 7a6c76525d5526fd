"""The load path through cloth that lies between two bodies: what presses on it presses on what carries it.

A particle weighs a ten-thousandth of a body that lies on it, so that sweeps over both of its contacts would need as many rounds
to pass the weight on: a book on a tablecloth sank through it. Where a contact carries the particle, the impulse of another one
that presses against it is passed on to it at once, and the particle keeps its velocity. Friction is passed on, too, between the
bodies alone: see `kickdrift.world.deformables.body_contacts.transmitted_friction`.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.body_contacts.contact_motion import give_impulse, response_of_bodies, slip_velocity
from kickdrift.world.deformables.body_contacts.contact_rows import gap_of, shares_of
from kickdrift.world.deformables.layout import (
    CARRIED_BY,
    CARRIER,
    CLOTH_NORMAL,
    CLOTH_OFFSET,
    CLOTH_RADIUS,
    CONTACT_IMPULSE,
    MOVES_BODY,
    ON_LOAD_PATH,
    OTHER_PARTICLE,
    PARTICLE_INVERSE_MASS,
    SHARES,
    THIRD_PARTICLE,
    TOUCHING_PARTICLE,
)
from kickdrift.world.settings import GRAVITY
from kickdrift.world.tables import (
    CLOTH_CONTACT,
    CLOTH_CONTACT_NUMBERS,
    CLOTH_NUMBERS,
    PARTICLE,
    PARTICLE_SHIFT,
    SETTINGS,
    floats,
    integers,
)

_OPPOSED = -0.8  # cosine between the normals of contacts, below which one carries what the other presses on
_FITS = 0.9  # height of an edge above the middle of the cloth, over half of the thickness, under which it fits
NOTHING = -1  # instead of a row
CARRIES, IS_CARRIED = 1, 2  # values of ON_LOAD_PATH
_CORNERS = (TOUCHING_PARTICLE, OTHER_PARTICLE, THIRD_PARTICLE)


@compiled
def find_load_paths(world: int, cloth: int, first: int, last: int) -> None:
    """Note which contacts of a cloth, from one row to another, are carried by which."""
    contact, carrier, pressed = integers(world, CLOTH_CONTACT), floats(world, PARTICLE_SHIFT), False
    for row in range(first, last):
        pressed = pressed or contact[row, MOVES_BODY] != 0
        contact[row, ON_LOAD_PATH] = 0
        for k in range(3):
            contact[row, CARRIED_BY + k] = NOTHING
    if not pressed:
        return
    for row in range(first, last):
        i = contact[row, TOUCHING_PARTICLE]
        known = int(carrier[i, CARRIER]) - 1
        if contact[row, OTHER_PARTICLE] != i or floats(world, PARTICLE)[i, PARTICLE_INVERSE_MASS] == 0.0:
            continue
        if known < 0 or _steadiness(world, row) > _steadiness(world, known):
            carrier[i, CARRIER] = row + 1
    for row in range(first, last):
        for k in range(3):
            _note_carrier(world, row, k)
        if contact[row, ON_LOAD_PATH] != 0:
            _straighten(world, row)
        elif contact[row, MOVES_BODY] != 0:
            _drop_wall(world, row, floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS])
    for row in range(first, last):
        for k in range(3):
            carrier[contact[row, _CORNERS[k]], CARRIER] = 0.0


@compiled(inline=True)
def _steadiness(world: int, row: int) -> float:
    """Return by how much rather than others a contact carries its particle: what does not move, then what is below."""
    normal, gravity = floats(world, CLOTH_CONTACT_NUMBERS), vector_at(floats(world, SETTINGS), 0, GRAVITY)
    if integers(world, CLOTH_CONTACT)[row, MOVES_BODY] == 0:
        return math.inf
    return -dot(vector_at(normal, row, CLOTH_NORMAL), gravity)


@compiled(inline=True)
def _note_carrier(world: int, row: int, k: int) -> None:
    """Note by what a corner of a contact that presses on it with a body is carried."""
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    by = int(floats(world, PARTICLE_SHIFT)[contact[row, _CORNERS[k]], CARRIER]) - 1
    if by < 0 or by == row or contact[row, MOVES_BODY] == 0 or numbers[row, SHARES + k] == 0.0:
        return
    if dot(vector_at(numbers, row, CLOTH_NORMAL), vector_at(numbers, by, CLOTH_NORMAL)) < _OPPOSED:
        contact[row, CARRIED_BY + k] = by
        contact[row, ON_LOAD_PATH], contact[by, ON_LOAD_PATH] = IS_CARRIED, CARRIES


@compiled
def _straighten(world: int, row: int) -> None:
    """Let a contact press against the one that carries most of it, with the same gap.

    Where an edge passes over a particle the normal tilts, and would squeeze out the particle, which friction holds below.
    """
    numbers, on, most = floats(world, CLOTH_CONTACT_NUMBERS), NOTHING, 0.0
    for k in range(3):
        by = integers(world, CLOTH_CONTACT)[row, CARRIED_BY + k]
        if by >= 0 and numbers[row, SHARES + k] > most:
            on, most = by, numbers[row, SHARES + k]
    if on < 0:
        return
    gap = gap_of(world, row)
    for k in range(3):
        numbers[row, CLOTH_NORMAL + k] = -numbers[on, CLOTH_NORMAL + k]
    numbers[row, CLOTH_OFFSET] += gap_of(world, row) - gap


@compiled
def _drop_wall(world: int, row: int, radius: float) -> None:
    """Drop a contact with the edge of a body under which the cloth, of half of the thickness `radius`, fits as it is carried.

    To a point beside the body the edge looks like a wall. Cloth that slid under a plate of 0.2 kg with 3 m/s pushed against
    such walls with seven times its friction.
    """
    numbers, carrier = floats(world, CLOTH_CONTACT_NUMBERS), floats(world, PARTICLE_SHIFT)
    n, to_edge, fits = vector_at(numbers, row, CLOTH_NORMAL), gap_of(world, row) + radius, False
    for k in range(3):
        on = int(carrier[integers(world, CLOTH_CONTACT)[row, _CORNERS[k]], CARRIER]) - 1
        if on >= 0 and on != row and numbers[row, SHARES + k] > 0.0:
            height = -dot(n, vector_at(numbers, on, CLOTH_NORMAL)) * to_edge
            fits = fits or height > _FITS * radius
    if fits:
        numbers[row, CLOTH_OFFSET] = -math.inf


@compiled(inline=True)
def carrier_of(world: int, row: int, k: int) -> int:
    """Return the row of the contact that carries a corner of a contact at present, or `NOTHING`."""
    by: int = integers(world, CLOTH_CONTACT)[row, CARRIED_BY + k]
    numbers = floats(world, CLOTH_CONTACT_NUMBERS)
    if by >= 0 and numbers[by, CONTACT_IMPULSE] <= 0.0:
        by = NOTHING
    return by


@compiled
def is_carried(world: int, row: int) -> bool:
    """Whether all corners of a contact are carried."""
    carried = True
    for k in range(3):
        has_share = floats(world, CLOTH_CONTACT_NUMBERS)[row, SHARES + k] != 0.0
        carried = carried and (not has_share or carrier_of(world, row, k) >= 0)
    return carried


@compiled
def room_below(world: int, row: int) -> float:
    """Return by how much a contact may move its corners along its normal until another one carries them, m."""
    room = math.inf
    for k in range(3):
        by = integers(world, CLOTH_CONTACT)[row, CARRIED_BY + k]
        if by >= 0:
            room = min(room, max(gap_of(world, by), 0.0))
    return room


@compiled
def slip_below(world: int, row: int) -> Vector:
    """Return the part of the velocity of a point with which its corners move relative to what carries them."""
    v = (0.0, 0.0, 0.0)
    for k in range(3):
        on = carrier_of(world, row, k)
        if on >= 0:
            v = plus(v, times(floats(world, CLOTH_CONTACT_NUMBERS)[row, SHARES + k], slip_velocity(world, on)))
    return v


@compiled
def response_below(world: int, row: int, n: Vector) -> float:
    """Return by how much faster what carries a point moves along n, for a unit impulse along n on the point, 1/kg."""
    response = 0.0
    for k in range(3):
        on = carrier_of(world, row, k)
        if on >= 0:
            response += abs(floats(world, CLOTH_CONTACT_NUMBERS)[row, SHARES + k]) * response_of_bodies(world, on, n)
    return response


@compiled
def carried_response(world: int, row: int, n: Vector, by: Vector) -> float:
    """Return the inverse mass of a point along n, with what carries it, 1/kg; `by` are shares of its corners over masses."""
    numbers, response = floats(world, CLOTH_CONTACT_NUMBERS), 0.0
    for k in range(3):
        share, on = numbers[row, SHARES + k], carrier_of(world, row, k)
        cosine = dot(n, vector_at(numbers, on, CLOTH_NORMAL)) if on >= 0 else 0.0
        response += share * by[k] * (1.0 - cosine * cosine)
        if on >= 0:
            response += abs(share) * response_of_bodies(world, on, n)
    return response


@compiled
def pass_on_pressure(world: int, row: int, impulse: float, left: float) -> None:
    """Pass an impulse along the normal of a contact, N s, on to the contacts that carry its corners."""
    numbers = floats(world, CLOTH_CONTACT_NUMBERS)
    n = vector_at(numbers, row, CLOTH_NORMAL)
    for k in range(3):
        on = carrier_of(world, row, k)
        if on < 0:
            continue
        ground = vector_at(numbers, on, CLOTH_NORMAL)
        more = -numbers[row, SHARES + k] * impulse * dot(n, ground)
        more = max(more, -numbers[on, CONTACT_IMPULSE])
        numbers[on, CONTACT_IMPULSE] += more
        give_impulse(world, on, shares_of(world, on), times(more, ground), left)
