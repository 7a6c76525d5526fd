"""Properties of the contact of two shapes, mixed from those of their surfaces."""

import math

from kickdrift.core.compilation import compiled
from kickdrift.world.layout import RESTITUTION, ROLLING
from kickdrift.world.tables import PLACE, floats


@compiled(inline=True)
def mixed_friction(one: float, other: float) -> float:
    """Return the coefficient of friction of two surfaces: the geometric mean of theirs."""
    return math.sqrt(one * other)


@compiled(inline=True)
def mixed_restitution(world: int, a: int, b: int) -> float:
    """Return the coefficient of restitution of two shapes: the larger one of theirs."""
    place = floats(world, PLACE)
    e: float = max(place[a, RESTITUTION], place[b, RESTITUTION])
    return e


@compiled(inline=True)
def mixed_rolling_resistance(world: int, a: int, b: int) -> float:
    """Return the rolling resistance of two shapes, m: the larger one of theirs."""
    place = floats(world, PLACE)
    resistance: float = max(place[a, ROLLING], place[b, ROLLING])
    return resistance
