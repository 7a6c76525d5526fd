"""Solutions that are rejected for their energy: before the drift, after it, and of an impact.

The bounds of the energy that an island receives from outside are those of `kickdrift.world.direct.energy_bounds`.
"""

from kickdrift.core.compilation import compiled
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.direct_bodies import mass_of
from kickdrift.world.direct.energy_bounds import driving_speed, energy_from_outside, energy_received
from kickdrift.world.direct.island_velocities import fastest, kinetic_energy
from kickdrift.world.direct.substep_estimate import LONG_TURN
from kickdrift.world.joints import layout as j
from kickdrift.world.tables import ISLAND, KICKED, MOTION, NOTED, integers

# Ratio to which heaps, islands with contacts and fast rotating ones may increase their energy after the drift. Of sixty
# spinning chains of random rods 46 gain more than a tenth with 1.02, and six with 1.001. Of 800 linkages thrown at walls at 3
# to 100 m/s, in space and in planes, 33 gain more than a hundredth if those with contacts may gain half of theirs, one of
# them a tenth in one impact, and one does with 1.001.
KEPT = 1.001

# Ratio to which the tolerances of the solution of an impact may increase the energy; one with more is none.
NO_MORE = 1.001

# Square of a negligible speed, m^2/s^2.
_STILL = 1e-12


@compiled(cached=False)
def allowance(world: int, island: int, h: float) -> float:
    """Return the ratio to which the energy of an island may increase before the drift.

    Turning by an angle a in the substep adds the fraction a^2 / 2. With a margin of a tenth: distant, spurious solutions have
    more, that of a grid of 4 x 4 balls by a sixth.
    """
    turn = h * fastest(world, island, NOTED, j.ANGULAR_PART)
    return 1.1 + 0.6 * min(turn, 1.5) ** 2


@compiled(cached=False)
def gained(world: int, island: int, h: float) -> float:
    """Return the energy that an island has gained since the kick, beyond a tolerance and what was given from outside, J.

    Zero or less if none, and then what was given is not subtracted. Zero without contacts and without large rotations in a
    substep: such islands are not checked.
    """
    own = integers(world, ISLAND)[island]
    far = h * fastest(world, island, MOTION, j.ANGULAR_PART) > LONG_TURN
    if own[d.FIRST_CONTACT] == own[d.AFTER_CONTACT] and not far:
        return 0.0
    more = kinetic_energy(world, island, MOTION) - KEPT * kinetic_energy(world, island, KICKED)
    if more <= 0.0:
        return more
    if own[d.HAS_JOINTS] != 0:
        return more - energy_from_outside(world, island)
    speed = driving_speed(world, island)
    return more - mass_of(world, island) * (speed * speed + _STILL)


@compiled(cached=False)
def has_more(world: int, island: int, energy: float) -> bool:
    """Whether an island has more than an energy and that which it has received from other islands, J."""
    more: bool = kinetic_energy(world, island, MOTION) > energy + NO_MORE * energy_received(world, island, NOTED)
    return more
