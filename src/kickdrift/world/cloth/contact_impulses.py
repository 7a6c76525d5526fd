"""Impulses between particles, segments or triangles of cloths and the bodies that they touch."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, cross, dot, exponential, length, minus, plus, product, times
from kickdrift.world.cloth.contact_lanes import resolve_lanes
from kickdrift.world.cloth.contact_rows import add_shares, shares_of
from kickdrift.world.cloth.layout import (
    CLOTH_GAP,
    CLOTH_NORMAL,
    CONTACT_FRICTION,
    CONTACT_IMPULSE,
    FIRST_CONTACT,
    GROUND_VELOCITY,
    IN_LANES,
    LAST_CONTACT,
    MOVES_BODY,
    OTHER_PARTICLE,
    PARTICLE_VELOCITY,
    SHARED_PARTS,
    TOUCHED_BODY,
    TOUCHED_POINT,
    TOUCHING_PARTICLE,
)
from kickdrift.world.cloth.tilting import resist_tilting
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.contacts.layout import WIDTH
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    DISPLACEMENT,
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    ORIENTATION,
    POSITION,
    ROTATION,
    VELOCITY,
)
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_CONTACT,
    CLOTH_CONTACT_NUMBERS,
    CLOTH_SEARCH,
    DELTA_POSE,
    INVERSE_MASS,
    MOTION,
    PARTICLE,
    POSE,
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
    row, shared = first, False
    while row < last:
        if contact[row, IN_LANES] != 0:
            resolve_lanes(contact, numbers, particle, row, part, push)
        else:
            shared = shared or contact[row, OTHER_PARTICLE] != contact[row, TOUCHING_PARTICLE]
            _begin(world, row, part * push, left)
            _resolve(world, row, part, left)
        row = _after(contact, row)
    if shared:
        _iterate(world, first, last, part, left)
    row = first
    while row < last:
        if contact[row, IN_LANES] == 0:
            _advance_gap(world, row, part)
        row = _after(contact, row)


@compiled(inline=True)
def _after(contact: Any, row: int) -> int:
    """Return the row of the next contact, or of the next eight."""
    return row + WIDTH if contact[row, IN_LANES] != 0 else row + 1


@compiled
def _iterate(world: int, first: int, last: int, part: float, left: float) -> None:
    """Iterate the impulses of contacts that share particles until they change little, and apply the torques of triangles."""
    contact, h = integers(world, CLOTH_CONTACT), part * floats(world, CLOTH_SEARCH)[0, SHARED_PARTS]
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
            resist_tilting(world, row, h)
        row = _after(contact, row)


@compiled
def _begin(world: int, row: int, most: float, left: float) -> None:
    """Begin a contact with the impulse of the part before, and move a point inside its shape out.

    No particle moves by more than `most`, beside a pinned one either.
    """
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    particle, gap, n = floats(world, PARTICLE), numbers[row, CLOTH_GAP], vector_at(numbers, row, CLOTH_NORMAL)
    if gap >= 0.0 and numbers[row, CONTACT_IMPULSE] == 0.0:
        return
    corners, _, by, inverse_mass = shares_of(world, row)
    if gap < 0.0:
        out = min(-gap, most * inverse_mass / max(by[0], by[1], by[2]))
        numbers[row, CLOTH_GAP] = gap + out
        add_shares(particle, corners, 0, by, times(out / inverse_mass, n))
    impulse = plus(times(numbers[row, CONTACT_IMPULSE], n), vector_at(numbers, row, CONTACT_IMPULSE + 1))
    add_shares(particle, corners, PARTICLE_VELOCITY, by, impulse)
    if contact[row, MOVES_BODY] != 0:
        body, arm = contact[row, TOUCHED_BODY], vector_at(numbers, row, TOUCHED_POINT)
        _push_body(world, body, arm, times(-1.0, impulse), left)


@compiled
def _velocity(world: int, row: int) -> Vector:
    """Return the velocity of a point relative to the surface that it touches."""
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    particle, motion, body = floats(world, PARTICLE), floats(world, MOTION), contact[row, TOUCHED_BODY]
    (i, j, k), share, _, _ = shares_of(world, row)
    ground = vector_at(numbers, row, GROUND_VELOCITY)
    if contact[row, MOVES_BODY] != 0:
        turn = cross(vector_at(motion, body, ANGULAR_VELOCITY), vector_at(numbers, row, TOUCHED_POINT))
        ground = plus(plus(vector_at(motion, body, VELOCITY), turn), ground)
    v = minus(times(share[0], vector_at(particle, i, PARTICLE_VELOCITY)), ground)
    v = plus(v, times(share[1], vector_at(particle, j, PARTICLE_VELOCITY)))
    return plus(v, times(share[2], vector_at(particle, k, PARTICLE_VELOCITY)))


@compiled
def _resolve(world: int, row: int, part: float, left: float) -> float:
    """Change the impulse of a contact so that it obeys the laws of contact and friction; return the change of speed, m/s."""
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    corners, _, by, inverse_mass = shares_of(world, row)
    body, moves = contact[row, TOUCHED_BODY], contact[row, MOVES_BODY] != 0
    n, arm = vector_at(numbers, row, CLOTH_NORMAL), vector_at(numbers, row, TOUCHED_POINT)
    v = _velocity(world, row)
    approach, wanted = dot(n, v), -max(numbers[row, CLOTH_GAP], 0.0) / part
    before, sliding = numbers[row, CONTACT_IMPULSE], vector_at(numbers, row, CONTACT_IMPULSE + 1)
    now = before + (wanted - approach) / (inverse_mass + (_response(world, body, arm, n) if moves else 0.0))
    now = max(now, 0.0)
    if now == 0.0 and before == 0.0:
        return 0.0
    slip = minus(v, times(approach, n))
    speed, friction = length(slip), sliding
    if speed > 0.0:
        along = times(1.0 / speed, slip)
        stop = 1.0 / (inverse_mass + (_response(world, body, arm, along) if moves else 0.0))
        friction = minus(sliding, times(stop, slip))
    size, most = length(friction), numbers[row, CONTACT_FRICTION] * now
    if size > most:
        friction = times(most / size, friction)
    impulse = plus(times(now - before, n), minus(friction, sliding))
    numbers[row, CONTACT_IMPULSE] = now
    for k in range(3):
        numbers[row, CONTACT_IMPULSE + 1 + k] = friction[k]
    add_shares(floats(world, PARTICLE), corners, PARTICLE_VELOCITY, by, impulse)
    if moves:
        _push_body(world, body, arm, times(-1.0, impulse), left)
    return inverse_mass * length(impulse)


@compiled
def _advance_gap(world: int, row: int, part: float) -> None:
    """Let the gap of a contact change in a part with the velocity that its point has."""
    numbers = floats(world, CLOTH_CONTACT_NUMBERS)
    approach = dot(vector_at(numbers, row, CLOTH_NORMAL), _velocity(world, row))
    numbers[row, CLOTH_GAP] += part * approach


@compiled(inline=True)
def _response(world: int, body: int, arm: Vector, n: Vector) -> float:
    """Return the change of velocity of a point of a body along n by a unit impulse along n, 1/kg."""
    inverse = floats(world, INVERSE_MASS)
    lever = cross(arm, n)
    turn = applied(symmetric_at(inverse, body, INVERSE_INERTIA_IN_WORLD), lever)
    response: float = inverse[body, INVERSE_LINEAR_MASS] + dot(lever, turn)
    return response


@compiled
def _push_body(world: int, body: int, arm: Vector, impulse: Vector, left: float) -> None:
    """Apply an impulse to a body at a point, `arm` from its centre of mass."""
    inverse = floats(world, INVERSE_MASS)
    shift = times(inverse[body, INVERSE_LINEAR_MASS], impulse)
    turn = applied(symmetric_at(inverse, body, INVERSE_INERTIA_IN_WORLD), cross(arm, impulse))
    move_on(world, body, shift, turn, left)


@compiled
def move_on(world: int, body: int, shift: Vector, turn: Vector, left: float) -> None:
    """Add to the velocity and the angular velocity of a body, and move it with these for the time `left`, s.

    The body has drifted through the substep already. If the changes acted on its pose in the next substep only, a load on
    a spring of cloth would gain energy: a lag of h / 2 is a negative damping.
    """
    motion, pose, delta = floats(world, MOTION), floats(world, POSE), floats(world, DELTA_POSE)
    for k in range(3):
        motion[body, VELOCITY + k] += shift[k]
        motion[body, ANGULAR_VELOCITY + k] += turn[k]
        pose[body, POSITION + k] += left * shift[k]
        delta[body, DISPLACEMENT + k] += left * shift[k]
        delta[body, ROTATION + k] += left * turn[k]
    q = product(exponential(times(left, turn)), quaternion_at(pose, body, ORIENTATION))
    for k in range(4):
        pose[body, ORIENTATION + k] = q[k]
