"""The lag of velocities behind positions in islands with springs, without which bounces would not conserve energy.

Where the whole kick comes before the drift, velocities belong to times half a substep before those of the positions. A bounce
that reverses such a velocity changes the energy of a body of speed v on which a force F acts by h F v, to either side. So
velocities are advanced by half a kick by gravity, forces and springs for the bounces, and taken back by the same after them.
Springs act as in `kickdrift.world.joints.axis_laws`: a body on a linear spring that bounces with e = 1 conserves the energy of
Newmark's method, whatever the stiffness. Of a hundred balls on springs that bounce off walls for 4 s, the worst gained 0.9 of
its largest kinetic energy before, and 0.02 with this; with 16 substeps, 0.7 and 0.003.

Damping and friction, which reverse with the velocity, and motors have no part in it, nor do islands without springs.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import applied
from kickdrift.world.collision.body_acceleration import acceleration
from kickdrift.world.columns import symmetric_at, vector_at
from kickdrift.world.contacts.layout import SHAPE_A, SHAPE_B
from kickdrift.world.direct.active_set import aim_island, solve
from kickdrift.world.direct.contacts import LAGGING
from kickdrift.world.direct.layout import (
    AFTER_CONTACT,
    AFTER_JOINT,
    AFTER_NODE,
    FIRST_CONTACT,
    FIRST_JOINT,
    FIRST_NODE,
    LINK_ROW,
)
from kickdrift.world.direct.linked_contacts import row_of
from kickdrift.world.direct.loop_closures import stay_closings
from kickdrift.world.direct.node_selection import node_of
from kickdrift.world.joints.axis_laws import push_by_half
from kickdrift.world.joints.impulses import note_speeds
from kickdrift.world.joints.layout import DRIVE_STIFFNESS, LAG, LAWS, LINK_BODY, LINK_JOINT
from kickdrift.world.joints.right_hand_side import RELAX
from kickdrift.world.layout import INVERSE_INERTIA_IN_WORLD, KICK, RESTITUTION, SUBSTEP_TORQUE, WHOLE_KICK
from kickdrift.world.tables import (
    CONTACT,
    FORCE,
    INVERSE_MASS,
    ISLAND,
    ISLAND_CONTACT,
    ISLAND_JOINT,
    JOINT,
    JOINT_AXES,
    KICKED,
    LINK,
    LINK_NUMBERS,
    MOTION,
    NODE,
    PLACE,
    floats,
    integers,
)


@compiled(cached=False)
def catch_up(world: int, island: int, h: float) -> None:
    """Advance the velocities of an island to the time of the positions, if it has springs and may bounce."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    work, motion, lags = floats(world, LINK_NUMBERS), floats(world, MOTION), _lags(world, island)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        for k in range(6):
            work[link, LAG + k] = motion[links[link, LINK_BODY], k] if lags else 0.0
        if lags:
            _kick_by_half(world, links[link, LINK_BODY], h)
    if not lags:
        return
    aim_island(world, island, h, RELAX)
    order, joints = integers(world, ISLAND_JOINT), integers(world, JOINT)
    for place in range(own[FIRST_JOINT], own[AFTER_JOINT]):
        link = order[place, 0]
        if joints[links[link, LINK_JOINT], LAWS] != 0:
            push_by_half(world, links[link, LINK_JOINT], link, h)
    stay_closings(world, island)
    solve(world, island, h, 0.0, LAGGING, True, False)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        for k in range(6):
            work[link, LAG + k] = motion[links[link, LINK_BODY], k] - work[link, LAG + k]


@compiled(cached=False)
def fall_behind(world: int, island: int) -> None:
    """Take the velocities of an island back to before the time of the positions, after its bounces."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    work, motion, order = floats(world, LINK_NUMBERS), floats(world, MOTION), integers(world, ISLAND_JOINT)
    if not _lags(world, island):
        return
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        for k in range(6):
            motion[links[link, LINK_BODY], k] -= work[link, LAG + k]
    for place in range(own[FIRST_JOINT], own[AFTER_JOINT]):
        note_speeds(world, links[order[place, 0], LINK_JOINT])


@compiled(cached=False)
def read_lags(world: int, a: int, b: int, lag: Any) -> None:
    """Read the lags of the velocities of both bodies of a contact, (12,)."""
    for side in range(2):
        link = node_of(world, b if side == 1 else a)
        for k in range(6):
            lag[6 * side + k] = floats(world, LINK_NUMBERS)[link, LAG + k] if link >= 0 else 0.0


@compiled(cached=False)
def _lags(world: int, island: int) -> bool:
    """Whether an island has springs, and a contact that may bounce."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    joints, laws, springs = integers(world, JOINT), floats(world, JOINT_AXES), False
    for place in range(own[FIRST_JOINT], own[AFTER_JOINT]):
        joint = links[order[place, 0], LINK_JOINT]
        for k in range(6 if joints[joint, LAWS] != 0 else 0):
            springs = springs or laws[6 * joint + k, DRIVE_STIFFNESS] > 0.0
    contact, surface, bounces = integers(world, CONTACT), floats(world, PLACE), False
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT] if springs else own[FIRST_CONTACT]):
        row = row_of(world, integers(world, ISLAND_CONTACT)[k, 0])
        bounces = (
            bounces
            or max(surface[contact[row, SHAPE_A], RESTITUTION], surface[contact[row, SHAPE_B], RESTITUTION]) > 0.0
        )
    return bounces


@compiled(cached=False)
def _kick_by_half(world: int, body: int, h: float) -> None:
    """Add half of a kick by gravity and forces to a body, if its last kick was whole."""
    if floats(world, KICKED)[body, KICK] != WHOLE_KICK:
        return
    motion, push = floats(world, MOTION), acceleration(world, body)
    inverse = symmetric_at(floats(world, INVERSE_MASS), body, INVERSE_INERTIA_IN_WORLD)
    turn = applied(inverse, vector_at(floats(world, FORCE), body, SUBSTEP_TORQUE))
    for k in range(3):
        motion[body, k] += 0.5 * h * push[k]
        motion[body, 3 + k] += 0.5 * h * turn[k]
