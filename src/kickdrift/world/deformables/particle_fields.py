"""Positions and forces of the particles of cloths, field by field, for vectors of lanes."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector
from kickdrift.world.contacts.layout import DRIFT_CHUNK, KICK_CHUNK, WIDTH
from kickdrift.world.deformables.chunks import Numbers, for_chunks
from kickdrift.world.deformables.layout import (
    FIRST_PARTICLE,
    FORCES,
    FORCES_APART,
    LANE_FIELDS,
    LAST_PARTICLE,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
    PLACES,
)
from kickdrift.world.deformables.simd_vectors import drift_lanes, kick_lanes, rows_to_fields
from kickdrift.world.tables import CLOTH, PARTICLE, PARTICLE_LANES, flat, floats, integers, rows

PARTICLES_IN_CHUNK = 512  # a multiple of the lanes


@compiled(inline=True)
def field_size(world: int) -> int:
    """Return the number of elements of a field."""
    return rows(world, PARTICLE_LANES) // LANE_FIELDS


@compiled
def fill_lanes(world: int, cloth: int) -> None:
    """Copy the positions of the particles of a cloth."""
    own, particle, fields, size = (
        integers(world, CLOTH),
        floats(world, PARTICLE),
        flat(world, PARTICLE_LANES),
        field_size(world),
    )
    first, last = own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]
    for i in range(first, last - WIDTH + 1, WIDTH):
        rows_to_fields(particle, i, 0, fields, PLACES * size + i, size)
    for i in range(last - (last - first) % WIDTH, last):
        for k in range(3):
            fields[(PLACES + k) * size + i] = particle[i, k]


@compiled
def drift_particles(world: int, part: float) -> None:
    """Move all particles with their velocities through a part of a substep, s, and copy their positions."""
    for_chunks(world, DRIFT_CHUNK, PARTICLES_IN_CHUNK, 0, 0, rows(world, PARTICLE), (part, 0.0, 0.0, 0.0, 0.0))


@compiled
def drift_some(world: int, cloth: int, first: int, last: int, numbers: Numbers) -> None:
    """Do the same for some particles; the first of the numbers is the part."""
    particle, part = floats(world, PARTICLE), numbers[0]
    fields, size = flat(world, PARTICLE_LANES), field_size(world)
    for i in range(first, last - WIDTH + 1, WIDTH):
        drift_lanes(particle, i, fields, PLACES * size + i, size, part)
    for i in range(last - (last - first) % WIDTH, last):
        for k in range(3):
            particle[i, k] += part * particle[i, PARTICLE_VELOCITY + k]
            fields[(PLACES + k) * size + i] = particle[i, k]


@compiled
def kick_by_forces(world: int, cloth: int, part: float, keep: float, fall: Vector) -> None:
    """Kick the particles of a cloth that are not pinned by the forces on them in a part, s, and by `fall`, m/s.

    Their velocities are then multiplied by `keep`, and the forces set to zero.
    """
    first, last = integers(world, CLOTH)[cloth, FIRST_PARTICLE], integers(world, CLOTH)[cloth, LAST_PARTICLE]
    for_chunks(world, KICK_CHUNK, PARTICLES_IN_CHUNK, cloth, first, last, (part, keep, *fall))


@compiled
def kick_some(world: int, cloth: int, first: int, last: int, numbers: Numbers) -> None:
    """Do the same for some particles; the numbers are the part, `keep` and `fall`."""
    particle, part, keep, fall = floats(world, PARTICLE), numbers[0], numbers[1], numbers[2:]
    fields, size = flat(world, PARTICLE_LANES), field_size(world)
    for i in range(first, last - WIDTH + 1, WIDTH):
        kick_lanes(particle, i, fields, FORCES * size + i, FORCES_APART * size + i, size, part, keep, fall)
    for i in range(last - (last - first) % WIDTH, last):
        inverse_mass, force = particle[i, PARTICLE_INVERSE_MASS], force_on(world, i)
        for k in range(3):
            if inverse_mass > 0.0:
                kick = part * inverse_mass * force[k] + fall[k]
                particle[i, PARTICLE_VELOCITY + k] = keep * (particle[i, PARTICLE_VELOCITY + k] + kick)
            fields[(FORCES + k) * size + i] = fields[(FORCES_APART + k) * size + i] = 0.0


@compiled(inline=True)
def force_on(world: int, i: int) -> Vector:
    """Return the force on a particle."""
    fields, size = flat(world, PARTICLE_LANES), field_size(world)
    x, y, z = FORCES * size + i, (FORCES + 1) * size + i, (FORCES + 2) * size + i
    more = (FORCES_APART - FORCES) * size
    return (fields[x] + fields[x + more], fields[y] + fields[y + more], fields[z] + fields[z + more])


@compiled(inline=True)
def add_force(world: int, i: int, k: int, force: float) -> None:
    """Add to a component of the force on a particle."""
    flat(world, PARTICLE_LANES)[(FORCES + k) * field_size(world) + i] += force
