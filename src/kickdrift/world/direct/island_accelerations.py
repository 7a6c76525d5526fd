"""Accelerations of the bodies of an island by forces, by what they rest on, and by the joints that hold them."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import times
from kickdrift.world.collision.body_acceleration import acceleration, angular_acceleration
from kickdrift.world.columns import point_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_active_set import REST, twelve
from kickdrift.world.direct.contact_lookup import linked_bodies, linked_constraint
from kickdrift.world.direct.contact_rows import impulse_field
from kickdrift.world.direct.contact_wrenches import write_wrench
from kickdrift.world.direct.direct_bodies import body_of, node_of, place_in
from kickdrift.world.direct.island_calls import aim_island, solve
from kickdrift.world.direct.island_velocities import kinetic_energy, note_velocities, take_back_velocities
from kickdrift.world.direct.joint_impulses import clear_impulses
from kickdrift.world.direct.loop_closures import stay_closings
from kickdrift.world.impulses import push_body
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.right_hand_side import RELAX
from kickdrift.world.tables import ISLAND, ISLAND_CONTACT, LINK_NUMBERS, MOTION, NODE, NOTED, floats, integers


@compiled(cached=False)
def find_accelerations(world: int, island: int, h: float) -> None:
    """Store the accelerations of the bodies of an island by forces, support, joints and their laws, without rotation.

    Impulses of contacts are those of the substep before; those of laws are found anew, since after half a kick they are half as
    large. Both are left out if bodies would be accelerated more with them than without: then an impact stops bodies there. The
    impulses of joints are overwritten.
    """
    note_velocities(world, island)
    falling = _find(world, island, h, False)
    if not _find(world, island, h, True) <= falling:
        _find(world, island, h, False)
    take_back_velocities(world, island)


@compiled(cached=False)
def _find(world: int, island: int, h: float, supported: bool) -> float:
    """Store the accelerations; return the kinetic energy of what they change in a substep, J. Velocities are overwritten."""
    own, nodes = integers(world, ISLAND)[island], integers(world, NODE)
    work, motion, noted = floats(world, LINK_NUMBERS), floats(world, MOTION), floats(world, NOTED)
    take_back_velocities(world, island)
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        body = body_of(world, node)
        free, turn = acceleration(world, body), angular_acceleration(world, body)
        for k in range(3):
            motion[body, j.LINEAR_PART + k] += h * free[k]
            motion[body, j.ANGULAR_PART + k] += h * turn[k]
    if supported:
        _push_by_contacts(world, island)
    clear_impulses(world, island)
    aim_island(world, island, h, RELAX)
    stay_closings(world, island)
    solve(world, island, h, 0.0 if supported else d.PREDICTION, REST, True, False)
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        body, link = body_of(world, node), nodes[node, d.LINK_ROW]
        for k in range(6):
            motion[body, k] += (0.0 if supported else work[link, j.GAIN + k]) - noted[body, k]
            work[link, j.ACCELERATION + k] = motion[body, k] / h
    return kinetic_energy(world, island, MOTION)


@compiled(cached=False)
def _push_by_contacts(world: int, island: int) -> None:
    """Apply the impulses of the contacts on which bodies of an island rest."""
    own, order, wrench = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), twelve()
    for place in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        fields, (a, b) = linked_constraint(world, order[place, 0]), linked_bodies(world, order[place, 0])
        for row in range(d.CONTACT_ROWS):
            impulse = fields[impulse_field(row) * c.WIDTH]
            if impulse == 0.0:
                continue
            write_wrench(fields, row, wrench)
            for side in range(2):
                body, at = b if side == 1 else a, 6 * side
                if place_in(world, island, body) >= 0:
                    push, turn = times(impulse, point_at(wrench, at)), times(impulse, point_at(wrench, at + 3))
                    push_body(world, body, push, turn)


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
                numbers[6 * side + k] = work[link, j.ACCELERATION + k]
