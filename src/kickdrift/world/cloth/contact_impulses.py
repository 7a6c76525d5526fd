"""Impulses between particles, segments or triangles of cloths and the bodies that they touch."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, cross, dot, exponential, length, minus, plus, product, times
from kickdrift.world.cloth.contact_lanes import resolve_lanes
from kickdrift.world.cloth.contact_rows import Corners
from kickdrift.world.cloth.layout import (
    CLOTH_GAP,
    CLOTH_NORMAL,
    CONTACT_FRICTION,
    FIRST_CONTACT,
    GROUND_VELOCITY,
    IN_LANES,
    LAST_CONTACT,
    MOVES_BODY,
    OTHER_PARTICLE,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
    SHARES,
    THIRD_PARTICLE,
    TOUCHED_BODY,
    TOUCHED_POINT,
    TOUCHING_PARTICLE,
)
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
    DELTA_POSE,
    INVERSE_MASS,
    MOTION,
    PARTICLE,
    POSE,
    floats,
    integers,
)


@compiled
def resolve_contacts(world: int, cloth: int, part: float, push: float, left: float) -> None:
    """Stop the particles of a cloth from moving into shapes in a part of a substep, with the reactions on bodies.

    Bodies move with their changes of velocity for the time `left` in the substep, s. Particles that are inside already are
    pushed out, at most with the speed `push`, m/s, without gaining velocity.
    """
    cloths, contact, numbers = (
        integers(world, CLOTH),
        integers(world, CLOTH_CONTACT),
        floats(world, CLOTH_CONTACT_NUMBERS),
    )
    particle = floats(world, PARTICLE)
    row = cloths[cloth, FIRST_CONTACT]
    while row < cloths[cloth, LAST_CONTACT]:
        if contact[row, IN_LANES] != 0:
            resolve_lanes(contact, numbers, particle, row, part, push)
            row += WIDTH
        else:
            _resolve(world, row, part, push, left)
            row += 1


@compiled
def _resolve(world: int, row: int, part: float, push: float, left: float) -> None:
    """Resolve one contact, at a point of a triangle of particles; see `kickdrift.world.cloth.contact_rows.note_contact`."""
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    particle, motion = floats(world, PARTICLE), floats(world, MOTION)
    i, j, k = contact[row, TOUCHING_PARTICLE], contact[row, OTHER_PARTICLE], contact[row, THIRD_PARTICLE]
    share, body, moves = vector_at(numbers, row, SHARES), contact[row, TOUCHED_BODY], contact[row, MOVES_BODY] != 0
    by = (
        share[0] * particle[i, PARTICLE_INVERSE_MASS],
        share[1] * particle[j, PARTICLE_INVERSE_MASS],
        share[2] * particle[k, PARTICLE_INVERSE_MASS],
    )
    inverse_mass = dot(share, by)
    n, arm = vector_at(numbers, row, CLOTH_NORMAL), vector_at(numbers, row, TOUCHED_POINT)
    ground = vector_at(numbers, row, GROUND_VELOCITY)
    if moves:
        turn = cross(vector_at(motion, body, ANGULAR_VELOCITY), arm)
        ground = plus(plus(vector_at(motion, body, VELOCITY), turn), ground)
    v = minus(times(share[0], vector_at(particle, i, PARTICLE_VELOCITY)), ground)
    v = plus(v, times(share[1], vector_at(particle, j, PARTICLE_VELOCITY)))
    v = plus(v, times(share[2], vector_at(particle, k, PARTICLE_VELOCITY)))
    gap, approach = numbers[row, CLOTH_GAP], dot(n, v)
    if gap < 0.0:  # no particle moves faster than `push`, beside a pinned one either
        out = min(-gap, part * push * inverse_mass / max(by[0], by[1], by[2]))
        gap += out
        _shift(particle, (i, j, k), 0, by, times(out / inverse_mass, n))
    wanted = -max(gap, 0.0) / part
    numbers[row, CLOTH_GAP] = gap + part * max(approach, wanted)
    if approach >= wanted:
        return
    given = (wanted - approach) / (inverse_mass + (_response(world, body, arm, n) if moves else 0.0))
    impulse = times(given, n)
    slip = minus(v, times(approach, n))
    speed = length(slip)
    if speed > 0.0:
        along = times(1.0 / speed, slip)
        stop = speed / (inverse_mass + (_response(world, body, arm, along) if moves else 0.0))
        impulse = minus(impulse, times(min(numbers[row, CONTACT_FRICTION] * given, stop), along))
    _shift(particle, (i, j, k), PARTICLE_VELOCITY, by, impulse)
    if moves:
        _push_body(world, body, arm, times(-1.0, impulse), left)


@compiled(inline=True)
def _shift(particle: Any, corners: Corners, column: int, by: Vector, way: Vector) -> None:
    """Add a vector to one of each of three particles, times `by`."""
    for k in range(3):
        particle[corners[0], column + k] += by[0] * way[k]
        particle[corners[1], column + k] += by[1] * way[k]
        particle[corners[2], column + k] += by[2] * way[k]


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
