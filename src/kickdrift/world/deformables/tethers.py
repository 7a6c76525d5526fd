"""Tethers: vertices are never farther from a pinned one than the way along the unstretched cloth, times a factor.

Forces alone stretch a cloth that the step has made softer, while each tether acts over the whole way at once (Kim, Chentanez
and Mueller-Fischer, Long range attachments: a method to simulate inextensible clothing in computer games, SCA 2012). Where a
vertex would go beyond its tether in a part of a substep, an impulse along the line at its end stops it there.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.body_contacts.body_impulses import mutual_response, push_body
from kickdrift.world.deformables.body_contacts.pinned_corners import FREE, arm_of_pin, velocity_with
from kickdrift.world.deformables.layout import (
    FIRST_TETHER,
    LAST_TETHER,
    PARTICLE_VELOCITY,
    PINNED_BODY,
    TETHER_ANCHOR,
    TETHER_LENGTH,
    TETHER_PIN,
    TETHERED,
)
from kickdrift.world.tables import CLOTH, PARTICLE, PIN, TETHER, TETHER_NUMBERS, floats, integers


@compiled
def hold_tethers(world: int, cloth: int, part: float, push: float, left: float) -> None:
    """Stop vertices that would go beyond the length of their tether in a part of a substep, s.

    Those that are beyond it already are moved back, at most with the speed `push`, m/s, without gaining velocity. Bodies to
    which vertices are pinned are stopped with them, and move with the change for the time `left` in the substep, s.
    """
    own, tether, particle = integers(world, CLOTH), integers(world, TETHER), floats(world, PARTICLE)
    for row in range(own[cloth, FIRST_TETHER], own[cloth, LAST_TETHER]):
        i, pin, anchor = tether[row, TETHERED], tether[row, TETHER_PIN], tether[row, TETHER_ANCHOR]
        most, way = floats(world, TETHER_NUMBERS)[row, TETHER_LENGTH], _from_anchor(world, i, anchor)
        if pin == FREE and dot(way, way) > most * most:
            _move_back(world, i, way, length(way) - most, part * push)
            way = _from_anchor(world, i, anchor)
        v = minus(velocity_with(world, i, pin), vector_at(particle, anchor, PARTICLE_VELOCITY))
        ahead = plus(way, times(part, v))
        if dot(ahead, ahead) > most * most:
            reach, allowed = length(ahead), max(most, length(way))
            if reach > allowed:
                _slow_down(world, i, pin, times(1.0 / reach, ahead), (reach - allowed) / part, left)


@compiled(inline=True)
def _from_anchor(world: int, i: int, anchor: int) -> Vector:
    """Return the vector from a pinned particle to another one, m."""
    particle = floats(world, PARTICLE)
    return minus(vector_at(particle, i, 0), vector_at(particle, anchor, 0))


@compiled(inline=True)
def _move_back(world: int, i: int, way: Vector, beyond: float, most: float) -> None:
    """Move a particle by how far it is beyond its tether, but by no more than `most`, m."""
    particle, share = floats(world, PARTICLE), min(beyond, most) / length(way)
    for k in range(3):
        particle[i, k] -= share * way[k]


@compiled(inline=True)
def _slow_down(world: int, i: int, pin: int, n: Vector, by: float, left: float) -> None:
    """Reduce the velocity of a particle along n, or that of its point of the body to which it is pinned, m/s."""
    if pin == FREE:
        particle = floats(world, PARTICLE)
        for k in range(3):
            particle[i, PARTICLE_VELOCITY + k] -= by * n[k]
        return
    body, arm = integers(world, PIN)[pin, PINNED_BODY], arm_of_pin(world, pin)
    push_body(world, body, arm, times(-by / mutual_response(world, body, arm, arm, n), n), left)
