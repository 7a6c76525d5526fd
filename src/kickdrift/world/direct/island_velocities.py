"""Velocities of an island: largest speed, kinetic energy, and restoring of velocities stored before.

Functions take the table of the velocities: ``MOTION``, the present ones; ``KICKED``, those after the kick; ``NOTED``, those
before a solution.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import applied, dot, plus, times, turned_back
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_active_set import note_impulses
from kickdrift.world.direct.contact_impulses import forget_contacts
from kickdrift.world.direct.contact_lookup import linked_bodies
from kickdrift.world.direct.direct_bodies import body_of, is_across
from kickdrift.world.joints import layout as j
from kickdrift.world.layout import BODY_INERTIA, MASS
from kickdrift.world.tables import (
    INERTIA,
    ISLAND,
    ISLAND_CONTACT,
    ISLAND_JOINT,
    JOINT_NUMBERS,
    KICKED,
    LINK,
    MOTION,
    NOTED,
    POSE,
    Table,
    floats,
    integers,
)


@compiled(cached=False)
def kinetic_energy(world: int, island: int, velocities: Table) -> float:
    """Return the kinetic energy of an island with the velocities of a table, J."""
    own, total = integers(world, ISLAND)[island], 0.0
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        total += energy_of(world, body_of(world, node), velocities, POSE)
    return total


@compiled(cached=False)
def inner_speed(world: int, island: int, velocities: Table) -> float:
    """Return the speed of an island whose kinetic energy in its centre-of-mass frame is m v^2 / 2, m/s."""
    own, mass, momentum = integers(world, ISLAND)[island], 0.0, (0.0, 0.0, 0.0)
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        body = body_of(world, node)
        mass += floats(world, INERTIA)[body, MASS]
        velocity = vector_at(floats(world, velocities), body, j.LINEAR_PART)
        momentum = plus(momentum, times(floats(world, INERTIA)[body, MASS], velocity))
    energy = kinetic_energy(world, island, velocities) - 0.5 * dot(momentum, momentum) / mass
    return math.sqrt(2.0 * max(energy, 0.0) / mass)


@compiled(cached=False)
def energy_of(world: int, body: int, velocities: Table, poses: Table) -> float:
    """Return the kinetic energy of a body with the velocity and the pose of two tables, J."""
    speeds, inertia = floats(world, velocities), floats(world, INERTIA)
    v = vector_at(speeds, body, j.LINEAR_PART)
    turn = turned_back(
        quaternion_at(floats(world, poses), body, j.ANGULAR_PART), vector_at(speeds, body, j.ANGULAR_PART)
    )
    moments = symmetric_at(inertia, body, BODY_INERTIA)
    energy: float = 0.5 * (inertia[body, MASS] * dot(v, v) + dot(turn, applied(moments, turn)))
    return energy


@compiled(cached=False)
def fastest(world: int, island: int, velocities: Table, part: int) -> float:
    """Return the largest speed, m/s, or angular speed, rad/s, of a body of an island, with the velocities of a table."""
    own, speeds, most = integers(world, ISLAND)[island], floats(world, velocities), 0.0
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        v = vector_at(speeds, body_of(world, node), part)
        most = max(most, dot(v, v))
    return math.sqrt(most)


@compiled(cached=False)
def note_velocities(world: int, island: int) -> None:
    """Store the velocities of an island, and of bodies across its cut contacts, in NOTED."""
    _copy(world, island, MOTION, NOTED)
    _copy_across(world, island, MOTION, NOTED)


@compiled(cached=False)
def take_back_velocities(world: int, island: int) -> None:
    """Restore the velocities stored in NOTED; subtracting impulses would leave rounding errors."""
    _copy(world, island, NOTED, MOTION)
    _copy_across(world, island, NOTED, MOTION)


@compiled(cached=False)
def begin_from_kick(world: int, island: int) -> None:
    """Restore the velocities after the kick, and set the impulses of joints and contacts to zero."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    numbers = floats(world, JOINT_NUMBERS)
    forget_contacts(world, island)
    _copy(world, island, KICKED, MOTION)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        joint = links[order[place, 0], j.LINK_JOINT]
        for k in range(6):
            numbers[joint, j.JOINT_IMPULSE + k], numbers[joint, j.SOLVED + k] = 0.0, 0.0


@compiled(cached=False)
def _copy(world: int, island: int, source: Table, target: Table) -> None:
    """Copy the velocities of an island from one table to another."""
    own = integers(world, ISLAND)[island]
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        _copy_of(world, body_of(world, node), source, target)


@compiled(cached=False)
def _copy_across(world: int, island: int, source: Table, target: Table) -> None:
    """Copy the velocities of bodies of other islands that the contacts of an island push."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        for body in linked_bodies(world, order[k, 0]):
            if is_across(world, island, body):
                _copy_of(world, body, source, target)


@compiled(inline=True, cached=False)
def _copy_of(world: int, body: int, source: Table, target: Table) -> None:
    """Copy the velocities of a body."""
    old, new = floats(world, source), floats(world, target)
    for k in range(6):
        new[body, k] = old[body, k]


@compiled(cached=False)
def take_back(world: int, island: int) -> None:
    """Restore the noted velocities, and the impulses that belong to them."""
    take_back_velocities(world, island)
    note_impulses(world, island, True)
    restore_impulses(world, island)


@compiled(cached=False)
def restore_impulses(world: int, island: int) -> None:
    """Restore the impulses with which the joints of an island begin the substep."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    numbers = floats(world, JOINT_NUMBERS)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        joint = links[order[place, 0], j.LINK_JOINT]
        for k in range(6):
            numbers[joint, j.JOINT_IMPULSE + k] = numbers[joint, j.SOLVED + k]
