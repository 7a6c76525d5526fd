"""Energy that an island loses or gains over many steps, too little in each to be noticed.

The energy of an island on which nothing but gravity acts is conserved. A step that is too long lets it drift: its energy is
compared with that at the beginning, for as long as nothing else acts on it. The comparison begins anew after contacts, damping,
forces, or active motors, limits, springs or friction, and after users have placed or pushed a body between two steps.

Where half of a kick comes before the drift, a substep conserves the energy E (`kickdrift.world.direct.half_kicks`); where all
of it does, the energy half a kick later, E + h/2 sum m g . v. Only energy that is missing from both is a loss. Where substeps
change in length, h/2 sum m g . v jumps, and the loss leaves these jumps out.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot
from kickdrift.world.columns import vector_at
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.direct_bodies import body_of, mass_of
from kickdrift.world.direct.island_velocities import energy_of
from kickdrift.world.joints import layout as j
from kickdrift.world.layout import BODY_KIND, DAMPING, HALF_KICK, KICK, KINEMATIC, MASS, TURN_DAMPING
from kickdrift.world.settings import GRAVITY, SUBSTEPS
from kickdrift.world.tables import (
    BODY,
    CLOTH,
    FORCE,
    INERTIA,
    ISLAND,
    ISLAND_JOINT,
    JOINT,
    JOINT_NUMBERS,
    KICKED,
    LINK,
    MOTION,
    POSE,
    SETTINGS,
    STARTED_MOTION,
    STARTED_POSE,
    Table,
    floats,
    integers,
    rows,
)

# Fraction of its energy by which an island may differ from its state after the last step and still count as unchanged.
_SAME = 1e-6

# Islands are judged once their speed has been this many times the speed that gravity adds in a step: hanging islands at rest
# are not. The oscillation with the kicks, to second order in that of one of four substeps, is then about 1 % of the energy at
# most.
_SLOW = 2.0

# Weight of a step in the mean of losses: where the light end of a chain cracks like a whip, its energy is off by 2 % for a few.
_WEIGHT = 0.125


@compiled(cached=False)
def drift_of_energy(world: int, island: int, t: float, h: float) -> float:
    """Return the fraction of its energy that an island without contacts has lost since it was last acted upon.

    Negative for a gain. The data for this are kept with the first joint of the island.
    """
    numbers, keeper = floats(world, JOINT_NUMBERS), _keeper(world, island)
    if not _is_conservative(world, island):
        forget_drift(world, island)
        return 0.0
    half = 0.5 * h / floats(world, SETTINGS)[0, SUBSTEPS]
    kinetic, total, lag = _energies(world, island, half, STARTED_MOTION, STARTED_POSE)
    began = abs(total - numbers[keeper, j.ENERGY_LEFT]) > _SAME * max(kinetic, numbers[keeper, j.MOST_KINETIC])
    numbers[keeper, j.LAG_AT_FIRST] += (
        lag - numbers[keeper, j.LAG_LEFT]
    )  # zero unless the length of substeps has changed
    kinetic, total, lag = _energies(world, island, half, MOTION, POSE)
    if began or numbers[keeper, j.MOST_KINETIC] == 0.0:
        numbers[keeper, j.ENERGY_AT_FIRST], numbers[keeper, j.LAG_AT_FIRST] = total, lag
        numbers[keeper, j.MOST_KINETIC], numbers[keeper, j.MEAN_LOSS], numbers[keeper, j.JUDGED_SINCE] = 0.0, 0.0, t
    numbers[keeper, j.ENERGY_LEFT], numbers[keeper, j.LAG_LEFT] = total, lag
    numbers[keeper, j.MOST_KINETIC] = max(numbers[keeper, j.MOST_KINETIC], kinetic)
    lost = numbers[keeper, j.ENERGY_AT_FIRST] - total
    shifted = lost + numbers[keeper, j.LAG_AT_FIRST] - lag
    loss = max(min(lost, shifted), min(max(lost, shifted), 0.0))
    numbers[keeper, j.MEAN_LOSS] += _WEIGHT * (loss - numbers[keeper, j.MEAN_LOSS])
    gravity = vector_at(floats(world, SETTINGS), 0, GRAVITY)
    slow = 0.5 * mass_of(world, island) * (_SLOW * h) ** 2 * dot(gravity, gravity)
    return (
        numbers[keeper, j.MEAN_LOSS] / numbers[keeper, j.MOST_KINETIC]
        if numbers[keeper, j.MOST_KINETIC] > slow
        else 0.0
    )


@compiled(cached=False)
def forget_drift(world: int, island: int) -> None:
    """Begin anew after this step."""
    floats(world, JOINT_NUMBERS)[_keeper(world, island), j.MOST_KINETIC] = 0.0


@compiled(cached=False)
def judged_since(world: int, island: int) -> float:
    """Return the time from which on the energy of an island has been compared, s."""
    since: float = floats(world, JOINT_NUMBERS)[_keeper(world, island), j.JUDGED_SINCE]
    return since


@compiled(cached=False)
def _keeper(world: int, island: int) -> int:
    """Return the joint with which an island keeps its energy."""
    order, links = integers(world, ISLAND_JOINT), integers(world, LINK)
    joint: int = links[order[integers(world, ISLAND)[island, d.FIRST_JOINT], 0], j.LINK_JOINT]
    return joint


@compiled(cached=False)
def _is_conservative(world: int, island: int) -> bool:
    """Whether nothing but gravity and joints has acted on an island without contacts in the step."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    inertia, force = floats(world, INERTIA), floats(world, FORCE)
    joints, bodies = integers(world, JOINT), integers(world, BODY)
    if rows(world, CLOTH) > 0:
        return False
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        body = body_of(world, node)
        push = 0.0
        for k in range(6):
            push += abs(force[body, k])
        if push + inertia[body, DAMPING] + inertia[body, TURN_DAMPING] != 0.0:
            return False
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        joint = links[order[place, 0], j.LINK_JOINT]
        for side in range(2):
            if bodies[joints[joint, j.BODY_A + side], BODY_KIND] == KINEMATIC:
                return False
        for k in range(6):
            if joints[joint, j.LAWS] >> k & 1 and floats(world, JOINT_NUMBERS)[joint, j.TOTAL + k] != 0.0:
                return False
    return True


@compiled(cached=False)
def _energies(world: int, island: int, half: float, velocities: Table, poses: Table) -> tuple[float, float, float]:
    """Return the kinetic energy of an island, its total energy, and the energy by which it lags half a kick, J."""
    own, gravity = integers(world, ISLAND)[island], vector_at(floats(world, SETTINGS), 0, GRAVITY)
    speeds, places, kicked = floats(world, velocities), floats(world, poses), floats(world, KICKED)
    kinetic, potential, lag = 0.0, 0.0, 0.0
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        body = body_of(world, node)
        mass = floats(world, INERTIA)[body, MASS]
        kinetic += energy_of(world, body, velocities, poses)
        potential -= mass * dot(gravity, vector_at(places, body, j.LINEAR_PART))
        if kicked[body, KICK] != HALF_KICK:
            lag += half * mass * dot(gravity, vector_at(speeds, body, j.LINEAR_PART))
    return kinetic, kinetic + potential, lag
