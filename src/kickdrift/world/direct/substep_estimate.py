"""How much shorter substeps have to be where joints lose energy: an estimate, for the warning."""

import math

from kickdrift.core.compilation import compiled
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.direct_bodies import mass_of
from kickdrift.world.direct.island_velocities import inner_speed, kinetic_energy
from kickdrift.world.direct.loop_closures import has_loops
from kickdrift.world.joints import layout as j
from kickdrift.world.layout import BODY_KIND, DYNAMIC
from kickdrift.world.tables import (
    BODY,
    ISLAND,
    ISLAND_JOINT,
    JOINT,
    LINK,
    LINK_NUMBERS,
    MOTION,
    STARTED_MOTION,
    floats,
    integers,
)

LONG_TURN = 0.5  # rad in a substep: too far

# Chosen on 42 random chains and trees with 10 to 300 rad/s that lose more, of which 36 keep their energy to 1 % for 5 s with so
# many times sqrt(turn) substeps, and half of them with half as many; of 61 others, 47 do.
_PER_ROOT = 6.0

# And this many times as many with loops, which near dead points change direction faster than their bodies turn: enough for half
# of 22 four-bar linkages that are parallelograms to 5 % or less. Five of them need more than 96 substeps at 1/60 s.
_OF_LOOPS = 4.0

_ALL_AXES = 63


@compiled(cached=False)
def refinement(world: int, island: int, turn: float, substep: float) -> float:
    """Return the factor by which there should be more substeps, for bodies that now turn by `turn` in one, rad.

    Energy passes on from body to body. At worst all of it turns the one joint with the least inertia.
    """
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    joints, bodies, work = integers(world, JOINT), integers(world, BODY), floats(world, LINK_NUMBERS)
    movable, most, held = 0, 0.0, False
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        link = order[place, 0]
        joint = links[link, j.LINK_JOINT]
        for side in range(2):
            held = held or bodies[joints[joint, j.BODY_A + side], BODY_KIND] != DYNAMIC
        if joints[joint, j.LOCKED] != _ALL_AXES:
            movable += 1
        for k in range(3, 6):
            if place < own[d.FIRST_CLOSING] and not joints[joint, j.LOCKED] >> k & 1:
                most = max(most, work[link, j.YIELD + k])
    if held and movable < 2:
        return max(turn / LONG_TURN, 2.0)
    energy = 0.0
    for velocities in (STARTED_MOTION, MOTION):
        if held:
            energy = max(energy, kinetic_energy(world, island, velocities))
        else:
            energy = max(energy, 0.5 * mass_of(world, island) * inner_speed(world, island, velocities) ** 2)
    factor = max(_PER_ROOT * math.sqrt(max(turn, substep * math.sqrt(2.0 * energy * most))), 2.0)
    return _OF_LOOPS * factor if has_loops(world, island) else factor
