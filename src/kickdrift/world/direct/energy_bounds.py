"""Bounds of the energy that motors and drives, kinematic bodies, moving surfaces and other islands add to an island.

A solution with more energy than that and the initial one is spurious.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import length, minus
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.constraint_groups import vector_of
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_lookup import linked_bodies, linked_constraint
from kickdrift.world.direct.direct_bodies import is_across, mass_of, node_of
from kickdrift.world.direct.island_velocities import energy_of
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.external_work import external_work
from kickdrift.world.tables import (
    ISLAND,
    ISLAND_CONTACT,
    ISLAND_JOINT,
    KICKED,
    LINK,
    MOTION,
    POSE,
    Table,
    floats,
    integers,
)


@compiled(cached=False)
def energy_given(world: int, island: int) -> float:
    """Bound the energy that contacts and joints have added to an island in the substep, J."""
    total: float = energy_from_outside(world, island) + energy_received(world, island, KICKED)
    return total


@compiled(cached=False)
def energy_from_outside(world: int, island: int) -> float:
    """Bound the energy that motors, and bodies and surfaces that no island moves, have added in the substep, J."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    total = energy_driven(world, island, 0.0)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        total += external_work(world, links[order[place, 0], j.LINK_JOINT])
    return total


@compiled(cached=False)
def energy_driven(world: int, island: int, energy: float) -> float:
    """Bound the energy of an island after an impact of bodies that it does not move, J, from its energy before.

    A body that is struck by a heavy one of speed u is faster by at most (1 + e) u than if it had bounced off a body at rest.
    """
    gained = 2.0 * math.sqrt(0.5 * mass_of(world, island)) * driving_speed(world, island)
    bound: float = (math.sqrt(energy) + gained) ** 2
    return bound


@compiled(cached=False)
def energy_received(world: int, island: int, before: Table) -> float:
    """Return the kinetic energy that bodies of other islands in contact with this one have lost since, J.

    `before` is the table of the velocities before.
    """
    own, order, lost = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), 0.0
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        for body in linked_bodies(world, order[k, 0]):
            if is_across(world, island, body):
                less = energy_of(world, body, before, POSE) - energy_of(world, body, MOTION, POSE)
                lost += max(less, 0.0)
    return lost


@compiled(cached=False)
def driving_speed(world: int, island: int) -> float:
    """Return the largest speed of bodies that an island does not move, at their contacts, and of moving surfaces, m/s."""
    own, order, motion = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), floats(world, MOTION)
    most = 0.0
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        fields = linked_constraint(world, order[k, 0])
        most = max(most, abs(fields[c.SURFACE_SPEED * c.WIDTH]), abs(fields[(c.SURFACE_SPEED + 1) * c.WIDTH]))
        bodies, arm = linked_bodies(world, order[k, 0]), vector_of(fields, c.CENTRE)
        for side in range(2):
            body = bodies[1] if side == 1 else bodies[0]
            if node_of(world, body) < 0:
                reach = length(minus(arm, vector_of(fields, c.BETWEEN)) if side == 1 else arm)
                turn = length(vector_at(motion, body, j.ANGULAR_PART))
                most = max(most, length(vector_at(motion, body, j.LINEAR_PART)) + reach * turn)
    return most
