"""How forces and gravity accelerate bodies in a step, which the search for contacts has to know before the kick."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, length, minus, plus, times
from kickdrift.world.columns import symmetric_at, vector_at
from kickdrift.world.contacts.layout import BODY_A, BODY_B, SHAPE_A, SHAPE_B
from kickdrift.world.layout import (
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    PLACE_POSITION,
    RADIUS,
    SUBSTEP_FORCE,
    SUBSTEP_TORQUE,
)
from kickdrift.world.settings import GRAVITY
from kickdrift.world.tables import CONTACT, FORCE, INVERSE_MASS, PLACE, SETTINGS, floats, integers

# Bodies at rest approach each other more slowly than at the speed that forces add in so many substeps.
RESTING_SUBSTEPS = 4.0


@compiled(inline=True)
def acceleration(world: int, body: int) -> Vector:
    """Return the acceleration of the centre of mass of a body by gravity and forces, m/s^2; zero if they do not move it."""
    inverse = floats(world, INVERSE_MASS)[body, INVERSE_LINEAR_MASS]
    if inverse == 0.0:
        return 0.0, 0.0, 0.0
    push = times(inverse, vector_at(floats(world, FORCE), body, SUBSTEP_FORCE))
    return plus(vector_at(floats(world, SETTINGS), 0, GRAVITY), push)


@compiled(inline=True)
def weight_per_mass(world: int, body: int) -> float:
    """Return the acceleration with which gravity, or greater forces, press a body on its support, m/s^2."""
    gravity = length(vector_at(floats(world, SETTINGS), 0, GRAVITY))
    return max(gravity, length(acceleration(world, body)))


@compiled(inline=True)
def angular_acceleration(world: int, body: int) -> Vector:
    """Return the angular acceleration of a body by torques, rad/s^2."""
    torque = vector_at(floats(world, FORCE), body, SUBSTEP_TORQUE)
    if torque[0] == 0.0 and torque[1] == 0.0 and torque[2] == 0.0:
        return torque
    return applied(symmetric_at(floats(world, INVERSE_MASS), body, INVERSE_INERTIA_IN_WORLD), torque)


@compiled(inline=True)
def closing_acceleration(world: int, row: int) -> float:
    """Bound the acceleration of the shapes of a contact towards each other by forces, m/s^2; one of them may be held."""
    contact, place = integers(world, CONTACT), floats(world, PLACE)
    a, b = contact[row, BODY_A], contact[row, BODY_B]
    of_a, of_b = acceleration(world, a), acceleration(world, b)
    total = max(length(minus(of_b, of_a)), max(length(of_a), length(of_b)))
    turn_a, turn_b = length(angular_acceleration(world, a)), length(angular_acceleration(world, b))
    if turn_a > 0.0:
        total += turn_a * reach(place, contact[row, SHAPE_A])
    if turn_b > 0.0:
        total += turn_b * reach(place, contact[row, SHAPE_B])
    return total


@compiled(inline=True)
def reach(place: Any, shape: int) -> float:
    """Return the largest distance of a shape from the centre of mass of its body."""
    far: float = place[shape, RADIUS] + length(vector_at(place, shape, PLACE_POSITION))
    return far
