"""Tethers: vertices go no farther from a pinned one than the way along the unstretched cloth, times a factor.

Forces alone stretch a cloth that the step has made softer, while each tether acts over the whole way at once (Kim, Chentanez
and Mueller-Fischer, Long range attachments: a method to simulate inextensible clothing in computer games, SCA 2012). Where a
vertex would go beyond its tether in a part of a substep, an impulse along the line at its end stops it there.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts.layout import TETHER_CHUNK
from kickdrift.world.deformables.body_contacts.body_impulses import mutual_response, push_body
from kickdrift.world.deformables.body_contacts.pinned_corners import arm_of_pin, velocity_with
from kickdrift.world.deformables.chunks import Numbers, for_chunks
from kickdrift.world.deformables.layout import (
    FIRST_TETHER,
    LAST_FREE_TETHER,
    LAST_TETHER,
    PARTICLE_VELOCITY,
    PINNED_BODY,
    TETHER_ANCHOR,
    TETHER_LENGTH,
    TETHER_PIN,
    TETHERED,
)
from kickdrift.world.tables import CLOTH, PARTICLE, PIN, TETHER, TETHER_NUMBERS, floats, integers

_IN_CHUNK = 512  # tethers


@compiled
def hold_tethers(world: int, cloth: int, part: float, left: float) -> None:
    """Stop vertices that would go beyond the length of their tether in a part of a substep, s.

    Those that contacts or moving pins have brought beyond it go no farther; to move them back would do work. Bodies to which
    vertices are pinned are stopped with them, and move with the change for the time `left` in the substep, s.
    """
    own = integers(world, CLOTH)
    first, bodies, last = own[cloth, FIRST_TETHER], own[cloth, LAST_FREE_TETHER], own[cloth, LAST_TETHER]
    for_chunks(world, TETHER_CHUNK, _IN_CHUNK, cloth, first, bodies, (part, 0.0, 0.0, 0.0, 0.0))
    for row in range(bodies, last):
        _hold_body(world, row, part, left)


@compiled
def hold_some(world: int, cloth: int, first: int, last: int, numbers: Numbers) -> None:
    """Hold vertices that are not pinned by some tethers; the first of the numbers is the part."""
    particle, part = floats(world, PARTICLE), numbers[0]
    for row in range(first, last):
        i = integers(world, TETHER)[row, TETHERED]
        n, faster = _beyond(world, row, _way(world, row), vector_at(particle, i, PARTICLE_VELOCITY), part)
        for k in range(3):
            particle[i, PARTICLE_VELOCITY + k] -= faster * n[k]


@compiled
def _hold_body(world: int, row: int, part: float, left: float) -> None:
    """Hold a vertex that is pinned to a body."""
    tether = integers(world, TETHER)
    pin, v = tether[row, TETHER_PIN], velocity_with(world, tether[row, TETHERED], tether[row, TETHER_PIN])
    n, faster = _beyond(world, row, _way(world, row), v, part)
    if faster > 0.0:
        body, arm = integers(world, PIN)[pin, PINNED_BODY], arm_of_pin(world, pin)
        push_body(world, body, arm, times(-faster / mutual_response(world, body, arm, arm, n), n), left)


@compiled(inline=True)
def _way(world: int, row: int) -> Vector:
    """Return the vector from the anchor of a tether to its vertex, m."""
    tether, particle = integers(world, TETHER), floats(world, PARTICLE)
    return minus(vector_at(particle, tether[row, TETHERED], 0), vector_at(particle, tether[row, TETHER_ANCHOR], 0))


@compiled(inline=True)
def _beyond(world: int, row: int, way: Vector, v: Vector, part: float) -> tuple[Vector, float]:
    """Return a direction, and by how much a vertex is too fast along it to be at the end of its tether after a part, m/s."""
    anchor, most = integers(world, TETHER)[row, TETHER_ANCHOR], floats(world, TETHER_NUMBERS)[row, TETHER_LENGTH]
    ahead = plus(way, times(part, minus(v, vector_at(floats(world, PARTICLE), anchor, PARTICLE_VELOCITY))))
    if dot(ahead, ahead) > most * most:
        reach, allowed = length(ahead), max(most, length(way))
        if reach > allowed:
            return times(1.0 / reach, ahead), (reach - allowed) / part
    return (0.0, 0.0, 0.0), 0.0
