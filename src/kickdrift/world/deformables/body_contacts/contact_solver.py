"""Impulses between particles, segments or triangles of cloths and the bodies that they touch."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot, length, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts.layout import CONTACT_CHUNK, WIDTH
from kickdrift.world.deformables.body_contacts.contact_motion import (
    give_impulse,
    ground_velocity,
    move_out,
    response_of_bodies,
    slip_velocity,
)
from kickdrift.world.deformables.body_contacts.contact_rows import gap_of, shares_of
from kickdrift.world.deformables.body_contacts.contact_solver_simd import resolve_lanes
from kickdrift.world.deformables.body_contacts.load_path import IS_CARRIED
from kickdrift.world.deformables.body_contacts.loaded_contacts import begin_loaded, resolve_loaded
from kickdrift.world.deformables.body_contacts.tilt_stiffness import resist_tilting
from kickdrift.world.deformables.chunks import Numbers, for_chunks
from kickdrift.world.deformables.layout import (
    CLOTH_NORMAL,
    CLOTH_OFFSET,
    CLOTH_RADIUS,
    CONTACT_FRICTION,
    CONTACT_IMPULSE,
    FIRST_CONTACT,
    IN_LANES,
    LAST_CONTACT,
    ON_LOAD_PATH,
    OTHER_PARTICLE,
    SHARED_PARTS,
    TOUCHING_PARTICLE,
)
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_CONTACT,
    CLOTH_CONTACT_NUMBERS,
    CLOTH_NUMBERS,
    CLOTH_SEARCH,
    CONTACT_LANE_PARTICLES,
    CONTACT_LANES,
    PARTICLE,
    flat,
    flat_integers,
    floats,
    integers,
)

# Largest number of further sweeps, and the change of speed, m/s, that ends them. With 16 and 1e-3, loaded sheets tremble less
# by a tenth, and a net with boxes takes a third longer; with 2, they tremble twice as much.
_SWEEPS, _ENOUGH = 8, 1e-2
_ROWS_IN_CHUNK = 32


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
    row, shared, advance = first, False, min(part, left)
    while row < last:  # on a load path contacts add to each other's impulses: all begin before any is resolved
        if contact[row, ON_LOAD_PATH] != 0:
            shared = True
            begin_loaded(world, row, part * push)
        row = _after(contact, row)
    row = first
    while row < last:
        if contact[row, IN_LANES] > 0:
            begin, end = row // WIDTH, (row + contact[row, IN_LANES]) // WIDTH
            for_chunks(world, CONTACT_CHUNK, _ROWS_IN_CHUNK, cloth, begin, end, (part, push, advance, 0.0, 0.0))
        else:
            shared = shared or contact[row, OTHER_PARTICLE] != contact[row, TOUCHING_PARTICLE]
            if contact[row, ON_LOAD_PATH] == 0:
                _begin(world, row, part * push, left)
            if contact[row, ON_LOAD_PATH] != IS_CARRIED:
                _resolve(world, row, part, left)
        row = _after(contact, row)
    if shared:
        _iterate(world, cloth, part, left, part * floats(world, CLOTH_SEARCH)[0, SHARED_PARTS])
    row = first
    while row < last:
        if contact[row, IN_LANES] == 0:
            _advance(world, row, advance)
        row = _after(contact, row)


@compiled
def resolve_rows(world: int, cloth: int, first: int, last: int, numbers: Numbers) -> None:
    """Resolve the contacts in some rows of lanes; the numbers are part, push, and the time for which bodies move."""
    touching, lanes = flat_integers(world, CONTACT_LANE_PARTICLES), flat(world, CONTACT_LANES)
    particle, part, push, advance = floats(world, PARTICLE), numbers[0], numbers[1], numbers[2]
    for row in range(first, last):
        resolve_lanes(touching, lanes, particle, row, part, push, advance)


@compiled(inline=True)
def _after(contact: Any, row: int) -> int:
    """Return the row of the next contact, or of the first after those in lanes."""
    after: int = row + max(contact[row, IN_LANES], 1)
    return after


@compiled
def _iterate(world: int, cloth: int, part: float, left: float, h: float) -> None:
    """Iterate the impulses of contacts that share particles until they change little, and apply torques against tilting."""
    contact = integers(world, CLOTH_CONTACT)
    first, last = integers(world, CLOTH)[cloth, FIRST_CONTACT], integers(world, CLOTH)[cloth, LAST_CONTACT]
    radius = floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS]
    for _ in range(_SWEEPS):
        change = _resolve_loads(world, first, last, part, left)
        row = first
        while row < last:
            if contact[row, IN_LANES] == 0 and contact[row, ON_LOAD_PATH] != IS_CARRIED:
                change = max(change, _resolve(world, row, part, left))
            row = _after(contact, row)
        if change < _ENOUGH:
            break
    _resolve_loads(world, first, last, part, left)
    row = first
    while row < last:
        if contact[row, IN_LANES] == 0:
            resist_tilting(world, row, radius, h, left)
        row = _after(contact, row)


@compiled
def _resolve_loads(world: int, first: int, last: int, part: float, left: float) -> float:
    """Resolve contacts that others carry, after these, so that cloth under a load is held by what does not move first."""
    contact, row, change = integers(world, CLOTH_CONTACT), first, 0.0
    while row < last:
        if contact[row, IN_LANES] == 0 and contact[row, ON_LOAD_PATH] == IS_CARRIED:
            change = max(change, resolve_loaded(world, row, part, left))
        row = _after(contact, row)
    return change


@compiled
def _begin(world: int, row: int, most: float, left: float) -> None:
    """Begin a contact with the impulse of the part before, and move a point inside its shape out.

    No particle moves by more than `most`, beside a pinned one either. Points that cannot move leave a body as deep as it is.
    """
    numbers = floats(world, CLOTH_CONTACT_NUMBERS)
    n = vector_at(numbers, row, CLOTH_NORMAL)
    move_out(world, row, n, most)
    if numbers[row, CONTACT_IMPULSE] != 0.0:
        impulse = plus(times(numbers[row, CONTACT_IMPULSE], n), vector_at(numbers, row, CONTACT_IMPULSE + 1))
        give_impulse(world, row, shares_of(world, row), impulse, left)


@compiled
def _resolve(world: int, row: int, part: float, left: float) -> float:
    """Change the impulse of a contact so that it obeys the laws of contact and friction; return the change of speed, m/s."""
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    if contact[row, ON_LOAD_PATH] != 0:
        return float(resolve_loaded(world, row, part, left))
    shares, n = shares_of(world, row), vector_at(numbers, row, CLOTH_NORMAL)
    inverse_mass = shares[3]
    v = slip_velocity(world, row)
    approach, wanted = dot(n, v), -max(gap_of(world, row), 0.0) / part
    before, sliding = numbers[row, CONTACT_IMPULSE], vector_at(numbers, row, CONTACT_IMPULSE + 1)
    now = before + (wanted - approach) / (inverse_mass + response_of_bodies(world, row, n))
    now = max(now, 0.0)
    if now == 0.0 and before == 0.0:
        return 0.0
    slip = minus(v, times(approach, n))
    speed, friction = length(slip), sliding
    if speed > 0.0:
        along = times(1.0 / speed, slip)
        stop = 1.0 / (inverse_mass + response_of_bodies(world, row, along))
        friction = minus(sliding, times(stop, slip))
    size, most = length(friction), numbers[row, CONTACT_FRICTION] * now
    if size > most:
        friction = times(most / size, friction)
    impulse = plus(times(now - before, n), minus(friction, sliding))
    numbers[row, CONTACT_IMPULSE] = now
    for k in range(3):
        numbers[row, CONTACT_IMPULSE + 1 + k] = friction[k]
    give_impulse(world, row, shares, impulse, left)
    return inverse_mass * length(impulse)


@compiled
def _advance(world: int, row: int, time: float) -> None:
    """Move the surface of a contact on for a time, s."""
    numbers = floats(world, CLOTH_CONTACT_NUMBERS)
    speed = dot(vector_at(numbers, row, CLOTH_NORMAL), ground_velocity(world, row))
    numbers[row, CLOTH_OFFSET] += time * speed
