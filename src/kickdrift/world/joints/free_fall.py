"""Articulations in free fall: on their links nothing acts but gravity, which is the same for all, and their joints.

Their links drift as free bodies do, with the mean of the velocities before and after the kick; this correction is the same for
all links, so joints are not affected.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.joints.layout import END, FIRST, LINK_BODY, LINK_JOINT, LINKS
from kickdrift.world.layout import ADDED, FALLS, MASS
from kickdrift.world.tables import ARTICULATION, INERTIA, KICKED, LINK, MOTION, floats, integers, rows

# Rounding errors, relative to the velocity that the kick adds, and to momenta, which joints conserve up to rounding.
_SAME, _ROUNDING = 1e-9, 1e-13


@compiled(cached=False)
def let_fall(world: int) -> None:
    """Mark the links of articulations in free fall, before the drift."""
    articulations, links, kicked = integers(world, ARTICULATION), integers(world, LINK), floats(world, KICKED)
    for row in range(rows(world, ARTICULATION)):
        first = articulations[row, FIRST]
        if articulations[row, END] > first and links[first, LINK_JOINT] < 0 and _is_falling(row, world):
            for link in range(first, first + articulations[row, LINKS]):
                kicked[links[link, LINK_BODY], FALLS] = 1.0


@compiled(cached=False)
def _is_falling(row: int, world: int) -> bool:
    """Whether the momentum of an articulation has not changed since the kick, and the kick was the same for all links."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, motion, kicked = integers(world, LINK), floats(world, MOTION), floats(world, KICKED)
    first, inertia = links[articulation[FIRST], LINK_BODY], floats(world, INERTIA)
    for k in range(3):
        given, unnoticed = 0.0, 0.0
        for link in range(articulation[FIRST], articulation[FIRST] + articulation[LINKS]):
            body = links[link, LINK_BODY]
            added, mass = kicked[body, ADDED + k], inertia[body, MASS]
            if abs(added - kicked[first, ADDED + k]) > _SAME * abs(added):
                return False
            given += mass * (motion[body, k] - kicked[body, k])
            unnoticed += mass * (_SAME * abs(added) + _ROUNDING * abs(motion[body, k]))
        if abs(given) > unnoticed:
            return False
    return True
