"""Rigid impact zones: sets of particles that move through a part of a substep as a rigid body, so that nothing in them crosses.

Momentum and angular momentum are those of their particles. While these move along straight lines to the pose of a rigid body,
the zone is rotated and scaled as a whole, so that nothing crosses in between. Particles that are pinned to dynamic bodies take
the velocities of the zone, which the next part of the substep shares with the bodies, but stay with these until then. If they
counted as held, two of them could set a zone spinning: a folded sheet of 0.08 J between two light balls gained 240 J.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Symmetric, applied, cross, exponential, inverse_symmetric, minus, times, turned
from kickdrift.world.columns import symmetric_at, vector_at
from kickdrift.world.deformables.layout import (
    IN_ZONE,
    PARTICLE_INVERSE_MASS,
    PARTICLE_MASS,
    PARTICLE_VELOCITY,
    ZONE_CENTRE,
    ZONE_INERTIA,
    ZONE_MASS,
    ZONE_MOMENTUM,
    ZONE_SPIN,
)
from kickdrift.world.deformables.self_collision.near_pairs import inverse_mass
from kickdrift.world.disjoint_sets import first_of, unite
from kickdrift.world.tables import PARTICLE, PARTICLE_SHIFT, ZONE, ZONE_NUMBERS, floats, integers, rows

_HELD = 1e9  # factor of the mass of pinned particles
_FLAT = 1e-9  # of the trace of the inertia, added to its diagonal so that it is invertible for collinear zones


@compiled
def begin_zones(world: int) -> None:
    """Make each particle a zone of its own."""
    zone = integers(world, ZONE)
    for i in range(rows(world, PARTICLE)):
        zone[i, IN_ZONE] = i


@compiled
def join_zone(world: int, i: int, j: int) -> None:
    """Unite the zones of two particles."""
    unite(integers(world, ZONE), IN_ZONE, i, j)


@compiled
def move_zones(world: int, part: float) -> None:
    """Give the particles of each zone of more than one the velocities of a rigid body in a part, s.

    Shifts add the difference between the rotation of that body and straight lines.
    """
    zone, numbers, count = integers(world, ZONE), floats(world, ZONE_NUMBERS), rows(world, PARTICLE)
    particle, shift = floats(world, PARTICLE), floats(world, PARTICLE_SHIFT)
    for i in range(count):
        for k in range(ZONE_NUMBERS.width):
            numbers[i, k] = 0.0
    for i in range(count):
        first, m = first_of(zone, IN_ZONE, i), _mass(world, i)
        numbers[first, ZONE_MASS] += m
        for k in range(3):
            numbers[first, ZONE_CENTRE + k] += m * particle[i, k]
            numbers[first, ZONE_MOMENTUM + k] += m * particle[i, PARTICLE_VELOCITY + k]
    for i in range(count):
        _add_turn(world, i)
    for i in range(count):
        first = first_of(zone, IN_ZONE, i)
        if inverse_mass(world, i) == 0.0 or numbers[first, ZONE_MASS] == _mass(world, i):
            continue
        share = 1.0 / numbers[first, ZONE_MASS]
        arm = minus(vector_at(particle, i, 0), times(share, vector_at(numbers, first, ZONE_CENTRE)))
        inertia = _thickened(symmetric_at(numbers, first, ZONE_INERTIA))
        turn = applied(inverse_symmetric(inertia), vector_at(numbers, first, ZONE_SPIN))
        v, chord = cross(turn, arm), minus(turned(exponential(times(part, turn)), arm), arm)
        pinned = particle[i, PARTICLE_INVERSE_MASS] == 0.0
        for k in range(3):
            was = particle[i, PARTICLE_VELOCITY + k]
            now = particle[i, PARTICLE_VELOCITY + k] = share * numbers[first, ZONE_MOMENTUM + k] + v[k]
            shift[i, k] = shift[i, k] + part * (was - now) if pinned else chord[k] - part * v[k]


@compiled
def _add_turn(world: int, i: int) -> None:
    """Add the angular momentum of a particle about the centre of its zone, and its moments of inertia."""
    zone, numbers, particle = integers(world, ZONE), floats(world, ZONE_NUMBERS), floats(world, PARTICLE)
    first, m = first_of(zone, IN_ZONE, i), _mass(world, i)
    arm = minus(
        vector_at(particle, i, 0), times(1.0 / numbers[first, ZONE_MASS], vector_at(numbers, first, ZONE_CENTRE))
    )
    spin = cross(arm, vector_at(particle, i, PARTICLE_VELOCITY))
    x, y, z = arm
    moments = (y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z)
    for k in range(3):
        numbers[first, ZONE_SPIN + k] += m * spin[k]
    for k in range(6):
        numbers[first, ZONE_INERTIA + k] += m * moments[k]


@compiled(inline=True)
def _mass(world: int, i: int) -> float:
    """Return the mass of a particle in a zone, kg: very large if it is pinned, except to a dynamic body."""
    lightness = inverse_mass(world, i)
    return 1.0 / lightness if lightness > 0.0 else _HELD * float(floats(world, PARTICLE)[i, PARTICLE_MASS])


@compiled(inline=True)
def _thickened(s: Symmetric) -> Symmetric:
    """Return an inertia with `_FLAT` times its trace added to the diagonal."""
    more = _FLAT * (s[0] + s[1] + s[2])
    return (s[0] + more, s[1] + more, s[2] + more, s[3], s[4], s[5])
