"""Velocities of an island: their energy, and going back to those that were noted."""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, dot, turned_back
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.direct.contacts import (
    note_impulses,
)
from kickdrift.world.direct.layout import (
    AFTER_CLOSING,
    AFTER_NODE,
    FIRST_CLOSING,
    FIRST_NODE,
    LINK_ROW,
)
from kickdrift.world.flight import BODY_INERTIA, MASS
from kickdrift.world.joints.layout import (
    ANGULAR_PART,
    BEFORE,
    JOINT_IMPULSE,
    LINEAR_PART,
    LINK_BODY,
    LINK_JOINT,
    SOLVED,
    int64,
)
from kickdrift.world.tables import (
    INERTIA,
    ISLAND,
    ISLAND_CLOSING,
    JOINT_NUMBERS,
    KICKED,
    LINK,
    LINK_NUMBERS,
    MOTION,
    NODE,
    POSE,
    Table,
    floats,
    integers,
)


@compiled(cached=False)
def kinetic_energy(island: int, world: int) -> float:
    """Kinetic energy of an island."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    motion, total = floats(world, MOTION), 0.0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        body = links[nodes[node, LINK_ROW], LINK_BODY]
        total += _energy(body, vector_at(motion, body, LINEAR_PART), vector_at(motion, body, ANGULAR_PART), world)
    return total


@compiled(cached=False)
def mass_of(island: int, world: int) -> float:
    """Mass of an island."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    total = 0.0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        total += floats(world, INERTIA)[links[nodes[node, LINK_ROW], LINK_BODY], MASS]
    return total


@compiled(cached=False)
def noted_energy(island: int, world: int) -> float:
    """Kinetic energy that an island had with the velocities that were noted."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    work, total = floats(world, LINK_NUMBERS), 0.0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        total += _energy(
            links[link, LINK_BODY], vector_at(work, link, BEFORE), vector_at(work, link, BEFORE + 3), world
        )
    return total


@compiled(cached=False)
def _energy(body: int, v: Vector, w: Vector, world: int) -> float:
    pose, inertia = floats(world, POSE), floats(world, INERTIA)
    turn = turned_back(quaternion_at(pose, body, ANGULAR_PART), w)
    moments = symmetric_at(inertia, body, int64(BODY_INERTIA))
    energy: float = 0.5 * (inertia[body, MASS] * dot(v, v) + dot(turn, applied(moments, turn)))
    return energy


@compiled(cached=False)
def fastest_turn(island: int, h: float, world: int) -> float:
    """Greatest angle by which a body of an island turns in a substep."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    motion, most = floats(world, MOTION), 0.0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        w = vector_at(motion, links[nodes[node, LINK_ROW], LINK_BODY], ANGULAR_PART)
        most = max(most, dot(w, w))
    return h * math.sqrt(most)


@compiled(cached=False)
def note_velocities(island: int, world: int) -> None:
    """Keep the velocities of an island."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    motion, work = floats(world, MOTION), floats(world, LINK_NUMBERS)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        for k in range(6):
            work[link, BEFORE + k] = motion[links[link, LINK_BODY], k]


@compiled(cached=False)
def take_back_velocities(island: int, world: int) -> None:
    """Go back to the velocities that were noted; taking impulses back would leave their rounding."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    motion, work = floats(world, MOTION), floats(world, LINK_NUMBERS)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        link = nodes[node, LINK_ROW]
        for k in range(6):
            motion[links[link, LINK_BODY], k] = work[link, BEFORE + k]


@compiled(cached=False)
def take_back(island: int, world: int) -> None:
    """Go back to the velocities that were noted, and to the impulses that they had."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    order = integers(world, ISLAND_CLOSING)
    take_back_velocities(island, world)
    note_impulses(island, True, world)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        if links[nodes[node, LINK_ROW], LINK_JOINT] >= 0:
            begin_anew(links[nodes[node, LINK_ROW], LINK_JOINT], world)
    for place in range(own[FIRST_CLOSING], own[AFTER_CLOSING]):
        begin_anew(links[order[place, 0], LINK_JOINT], world)


@compiled(cached=False)
def begin_anew(joint: int, world: int) -> None:
    """Let a joint have given what it had in the end of the substep before."""
    numbers = floats(world, JOINT_NUMBERS)
    for k in range(6):
        numbers[joint, JOINT_IMPULSE + k] = numbers[joint, SOLVED + k]


@compiled(cached=False)
def fastest(island: int, table: Table, world: int) -> float:
    """Greatest speed of a body of an island, m/s, by the velocities in a table, which has them first."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    velocities, most = floats(world, table), 0.0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        v = vector_at(velocities, links[nodes[node, LINK_ROW], LINK_BODY], LINEAR_PART)
        most = max(most, dot(v, v))
    return math.sqrt(most)


@compiled(cached=False)
def kicked_energy(island: int, world: int) -> float:
    """Kinetic energy that an island had after the kick."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    kicked, total = floats(world, KICKED), 0.0
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        body = links[nodes[node, LINK_ROW], LINK_BODY]
        total += _energy(body, vector_at(kicked, body, LINEAR_PART), vector_at(kicked, body, ANGULAR_PART), world)
    return total


@compiled(cached=False)
def begin_from_kick(island: int, world: int) -> None:
    """Go back to the velocities after the kick."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    kicked, motion = floats(world, KICKED), floats(world, MOTION)
    for node in range(own[FIRST_NODE], own[AFTER_NODE]):
        body = links[nodes[node, LINK_ROW], LINK_BODY]
        for k in range(6):
            motion[body, k] = kicked[body, k]
