"""How bounces depend on speed: the coefficient of restitution of two shapes, and the speeds from which on they bounce."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import cross, dot, length, minus
from kickdrift.world.collision.body_acceleration import RESTING_SUBSTEPS, acceleration, angular_acceleration
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.constraint_groups import constraint, vector_of
from kickdrift.world.material_mixing import mixed_restitution
from kickdrift.world.settings import BOUNCE_SPEED, GRAVITY, SLOP
from kickdrift.world.tables import CONTACT, SETTINGS, floats, integers

_UNSEEN = 1e-9  # of the slop: shorter ways in a substep are no approach; without weight, they would halve for ever


@compiled(inline=True)
def restitution_of(world: int, row: int) -> float:
    """Return the coefficient of restitution of a contact."""
    contact = integers(world, CONTACT)
    return mixed_restitution(world, contact[row, c.SHAPE_A], contact[row, c.SHAPE_B])


@compiled
def slowest_bounce(world: int, h: float, row: int) -> float:
    """Return the speed of approach above which the shapes of a contact bounce, m/s."""
    settings = floats(world, SETTINGS)
    slowest: float = settings[0, BOUNCE_SPEED]
    if slowest < 0.0:
        # Without forces in it, bodies pressed by them would bounce for ever.
        slowest = RESTING_SUBSTEPS * h * max(length(vector_at(settings, 0, GRAVITY)), pressing_acceleration(world, row))
    return max(slowest, slowest_approach(world, h))


@compiled(inline=True)
def slowest_approach(world: int, h: float) -> float:
    """Return the speed from which on an approach is seen in a substep, m/s."""
    slowest: float = _UNSEEN * floats(world, SETTINGS)[0, SLOP] / h
    return slowest


@compiled(inline=True)
def pressing_acceleration(world: int, row: int) -> float:
    """Return the acceleration by which forces press the points of a contact together, along its normal, m/s^2."""
    contact, own = integers(world, CONTACT), constraint(world, row)
    a, b, normal = contact[row, c.BODY_A], contact[row, c.BODY_B], vector_of(own, c.N)
    turn_a, turn_b = angular_acceleration(world, a), angular_acceleration(world, b)
    fastest = 0.0
    for k in range(contact[row, c.POINTS]):
        arm_a = vector_of(own, c.P + c.POINT_FIELDS * k + c.ARM)
        arm_b = minus(arm_a, cross(vector_of(own, c.BETWEEN), normal))
        fastest = max(fastest, dot(turn_a, arm_a) - dot(turn_b, arm_b))
    return dot(normal, minus(acceleration(world, a), acceleration(world, b))) + fastest
