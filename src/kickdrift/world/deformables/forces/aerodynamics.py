"""Aerodynamic forces on cloth: drag along the relative wind, and lift perpendicular to it, on every triangle."""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import cross, dot, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.layout import (
    AREA_DENSITY,
    CORNERS,
    DRAG,
    FACE_AREA,
    FIRST_FACE,
    LAST_FACE,
    LIFT,
    PARTICLE_VELOCITY,
    WIND,
)
from kickdrift.world.deformables.particle_fields import add_force
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    FACE,
    FACE_NUMBERS,
    PARTICLE,
    PARTICLE_WIND,
    floats,
    integers,
    rows,
)


@compiled
def calm(t: float, h: float, world: int) -> None:
    """Set the winds of users' functions, which add to those of cloths, to zero."""
    blows = floats(world, PARTICLE_WIND)
    for i in range(rows(world, PARTICLE_WIND)):
        for k in range(3):
            blows[i, k] = 0.0


@compiled
def add_wind(world: int, cloth: int, h: float, part: float) -> None:
    """Add the forces of the air on the particles of a cloth, which in the first part, s, give the impulse of a substep h.

    Velocities change only afterwards, so that no triangle feels the impulses of others before it. With the area A, the normal n
    and the relative wind s d, of speed s, of a triangle, drag is rho C_d A s^2 |n . d| d / 2 and lift
    rho C_l A s^2 (n . d) (n - (n . d) d) / 2. In a substep drag takes at most the relative wind of a triangle, so it never
    reverses it, and drag and lift together do not increase it, since lift only turns it.
    """
    numbers, face, own = floats(world, CLOTH_NUMBERS), integers(world, FACE), integers(world, CLOTH)
    particle, rest, blows = floats(world, PARTICLE), floats(world, FACE_NUMBERS), floats(world, PARTICLE_WIND)
    drag, lift, wind = numbers[cloth, DRAG], numbers[cloth, LIFT], vector_at(numbers, cloth, WIND)
    if drag == 0.0 and lift == 0.0:
        return
    for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
        a, b, c = face[f, CORNERS], face[f, CORNERS + 1], face[f, CORNERS + 2]
        origin = vector_at(particle, a, 0)
        across = cross(minus(vector_at(particle, b, 0), origin), minus(vector_at(particle, c, 0), origin))
        doubled = math.sqrt(dot(across, across))
        moves = plus(vector_at(particle, a, PARTICLE_VELOCITY), vector_at(particle, b, PARTICLE_VELOCITY))
        moves = times(1.0 / 3.0, plus(moves, vector_at(particle, c, PARTICLE_VELOCITY)))
        gust = plus(vector_at(blows, a, 0), plus(vector_at(blows, b, 0), vector_at(blows, c, 0)))
        felt = plus(wind, minus(times(1.0 / 3.0, gust), moves))
        speed = math.sqrt(dot(felt, felt))
        if doubled == 0.0 or speed == 0.0:
            continue
        n, d = times(1.0 / doubled, across), times(1.0 / speed, felt)
        facing = dot(n, d)
        pressure = 0.25 * doubled * speed * speed
        mass = numbers[cloth, AREA_DENSITY] * rest[f, FACE_AREA]
        pull = min(h * drag * pressure * abs(facing), mass * speed)
        rise = min(h * lift * pressure * abs(facing), mass * speed)
        up = times(math.copysign(rise, facing), minus(n, times(facing, d)))
        left = minus(times(mass * speed - pull, d), up)
        keep = min(mass * speed / max(math.sqrt(dot(left, left)), 1e-300), 1.0)
        impulse = minus(times(mass * speed, d), times(keep, left))
        for corner in range(3):
            for k in range(3):
                add_force(world, face[f, CORNERS + corner], k, impulse[k] / (3.0 * part))
