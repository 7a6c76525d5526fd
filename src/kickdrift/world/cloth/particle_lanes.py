"""Positions and forces of the particles of cloths, field by field, for vectors of lanes."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector
from kickdrift.world.cloth.lanes import rows_to_fields
from kickdrift.world.cloth.layout import FIRST_PARTICLE, FORCES, LANE_FIELDS, LAST_PARTICLE, PLACES
from kickdrift.world.contacts.layout import WIDTH
from kickdrift.world.tables import CLOTH, PARTICLE, PARTICLE_LANES, flat, floats, integers, rows


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


@compiled(inline=True)
def force_on(world: int, i: int) -> Vector:
    """Return the force on a particle."""
    fields, size = flat(world, PARTICLE_LANES), field_size(world)
    return (fields[FORCES * size + i], fields[(FORCES + 1) * size + i], fields[(FORCES + 2) * size + i])


@compiled(inline=True)
def add_force(world: int, i: int, k: int, force: float) -> None:
    """Add to a component of the force on a particle."""
    flat(world, PARTICLE_LANES)[(FORCES + k) * field_size(world) + i] += force
