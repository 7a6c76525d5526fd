"""Impulses on bodies."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied
from kickdrift.world.columns import symmetric_at
from kickdrift.world.layout import ANGULAR_VELOCITY, INVERSE_INERTIA_IN_WORLD, INVERSE_LINEAR_MASS, VELOCITY
from kickdrift.world.tables import INVERSE_MASS, MOTION, floats


@compiled(inline=True, cached=False)
def push_body(world: int, body: int, push: Vector, turn: Vector) -> None:
    """Apply an impulse at the centre of mass and an angular impulse to a body."""
    motion, inverse_mass = floats(world, MOTION), floats(world, INVERSE_MASS)
    turned = applied(symmetric_at(inverse_mass, body, INVERSE_INERTIA_IN_WORLD), turn)
    for k in range(3):
        motion[body, VELOCITY + k] += inverse_mass[body, INVERSE_LINEAR_MASS] * push[k]
        motion[body, ANGULAR_VELOCITY + k] += turned[k]
