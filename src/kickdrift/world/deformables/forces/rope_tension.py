"""The tension of a rope: the energy of a segment of length L at rest and l now is E A (l - L)^2 / (2 L).

Damping is that of a Kelvin-Voigt solid, as that of cloth. The rate of strain is that of the velocities, which are those of the
last drift: the force is along the segment, and conserves angular momentum.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot, length, minus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.layout import (
    CORNERS,
    FIRST_FACE,
    LAST_FACE,
    MEMBRANE_DAMPING,
    PARTICLE_VELOCITY,
    REST_LENGTH,
    STRETCH,
)
from kickdrift.world.deformables.particle_fields import add_force
from kickdrift.world.tables import CLOTH, CLOTH_NUMBERS, FACE, FACE_NUMBERS, PARTICLE, floats, integers


@compiled
def add_tension(world: int, cloth: int, share: float, damped: float) -> None:
    """Add `share` times the tension of a rope and `damped` times that of its damping to the forces on its particles."""
    numbers, own, face = floats(world, CLOTH_NUMBERS), integers(world, CLOTH), integers(world, FACE)
    rest, particle = floats(world, FACE_NUMBERS), floats(world, PARTICLE)
    stiffness, ahead = numbers[cloth, STRETCH], damped * numbers[cloth, MEMBRANE_DAMPING]
    for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
        i, j = face[f, CORNERS], face[f, CORNERS + 1]
        way = minus(vector_at(particle, j, 0), vector_at(particle, i, 0))
        speed = minus(vector_at(particle, j, PARTICLE_VELOCITY), vector_at(particle, i, PARTICLE_VELOCITY))
        now, at_rest = length(way), rest[f, REST_LENGTH]
        if now == 0.0:
            continue  # its direction is undetermined
        tension = stiffness * (share * (now - at_rest) + ahead * dot(way, speed) / now) / at_rest
        pull = times(tension / now, way)
        for k in range(3):
            add_force(world, i, k, pull[k])
            add_force(world, j, k, -pull[k])
