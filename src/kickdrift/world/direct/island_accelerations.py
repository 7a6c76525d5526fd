"""Accelerations of the bodies of an island by forces, by what they rest on, and by the joints that hold them."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot, plus, times
from kickdrift.world.collision.body_acceleration import acceleration, angular_acceleration
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts.resting_support import impulse_of
from kickdrift.world.direct.active_set import aim_island, solve
from kickdrift.world.direct.contact_lookup import bodies_of, constraint
from kickdrift.world.direct.contact_states import REST
from kickdrift.world.direct.direct_bodies import body_of, node_of, place_in
from kickdrift.world.direct.island_velocities import note_velocities, take_back_velocities
from kickdrift.world.direct.layout import AFTER_CONTACT, AFTER_NODE, FIRST_CONTACT, FIRST_NODE, LINK_ROW, PREDICTION
from kickdrift.world.direct.loop_closures import stay_closings
from kickdrift.world.joints.layout import ACCELERATION, ANGULAR_PART, GAIN, LINEAR_PART
from kickdrift.world.joints.right_hand_side import RELAX
from kickdrift.world.layout import INVERSE_LINEAR_MASS
from kickdrift.world.tables import INVERSE_MASS, ISLAND, ISLAND_CONTACT, LINK_NUMBERS, MOTION, NODE, floats, integers


@compiled(cached=False)
def find_accelerations(world: int, island: int, h: float) -> None:
    """Store the accelerations of the bodies of an island by forces, support and joints, without motors and rotation."""
    own, nodes = integers(world, ISLAND)[island], integers(world, NODE)
    work, motion = floats(world, LINK_NUMBERS), floats(world, MOTION)
    _find_support(world, island, h)
    note_velocities(world, island)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        body, link = body_of(world, node), nodes[node, LINK_ROW]
        free, turn = acceleration(world, body), angular_acceleration(world, body)
        carried = plus(free, vector_at(work, link, ACCELERATION))
        if dot(carried, carried) < dot(free, free):  # otherwise an impact has stopped it, as in `add_support`
            free = carried
        for k in range(3):
            work[link, ACCELERATION + k], work[link, ACCELERATION + 3 + k] = free[k], turn[k]
            motion[body, LINEAR_PART + k] += h * free[k]
            motion[body, ANGULAR_PART + k] += h * turn[k]
    aim_island(world, island, h, RELAX)
    stay_closings(world, island)
    solve(world, island, h, PREDICTION, REST, True, False)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        for k in range(6):
            work[link, ACCELERATION + k] += work[link, GAIN + k] / h
    take_back_velocities(world, island)


@compiled(cached=False)
def _find_support(world: int, island: int, h: float) -> None:
    """Store the accelerations by the contacts on which bodies rest, with their impulses of the substep before."""
    own, nodes, order = integers(world, ISLAND)[island], integers(world, NODE), integers(world, ISLAND_CONTACT)
    work, inverse_mass = floats(world, LINK_NUMBERS), floats(world, INVERSE_MASS)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        for k in range(3):
            work[nodes[node, LINK_ROW], ACCELERATION + k] = 0.0
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        push = times(1.0 / h, impulse_of(constraint(world, order[k, 0])))
        a, b = bodies_of(world, order[k, 0])
        for side in range(2):
            body, sign = (b, 1.0) if side == 1 else (a, -1.0)
            if place_in(world, island, body) >= 0:
                for i in range(3):
                    gained = sign * inverse_mass[body, INVERSE_LINEAR_MASS] * push[i]
                    work[node_of(world, body), ACCELERATION + i] += gained


@compiled(cached=False)
def read_accelerations(world: int, island: int, a: int, b: int, numbers: Any) -> None:
    """Read the accelerations of two bodies, (12,); those of bodies outside the island are those of free ones."""
    work = floats(world, LINK_NUMBERS)
    for side in range(2):
        body = b if side == 1 else a
        free, turn, link = acceleration(world, body), angular_acceleration(world, body), node_of(world, body)
        for k in range(3):
            numbers[6 * side + k], numbers[6 * side + 3 + k] = free[k], turn[k]
        if place_in(world, island, body) >= 0:
            for k in range(6):
                numbers[6 * side + k] = work[link, ACCELERATION + k]
