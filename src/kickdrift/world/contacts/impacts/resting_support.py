"""Support of bodies by what they rest on, while impacts are found.

Impacts come before the sweeps, after a kick by which a resting body falls. Its contacts carry it, with the impulses of the
substep before: while impacts are found they count as part of the kick. Taken as falling, a heavy box on a floor gives a ball
that drops on it up to 10 % of its energy, or takes as much. The velocities that they give are stored in `NOTED`, which the
direct solver uses at other times.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.constraint_groups import constraint, vector_of
from kickdrift.world.contacts.graph_colouring import LINKED
from kickdrift.world.layout import ADDED, INVERSE_LINEAR_MASS, KICKED_VELOCITY, VELOCITY
from kickdrift.world.tables import COLOURS, CONTACT, GROUPS, INVERSE_MASS, KICKED, MOTION, NOTED, floats, integers, rows


@compiled
def add_support(world: int) -> None:
    """Add to the velocities of supported bodies what their contacts will give them, if it balances part of the kick."""
    groups, kicked, support = integers(world, GROUPS), floats(world, KICKED), floats(world, NOTED)
    for body in range(rows(world, KICKED)):
        for k in range(3):
            support[body, VELOCITY + k] = 0.0
    for g in range(integers(world, COLOURS)[LINKED, c.FIRST_GROUP]):
        for lane in range(c.WIDTH):
            if groups[g, c.GROUP_CONTACTS + lane] >= 0:
                _add_contact(world, groups[g, c.GROUP_CONTACTS + lane])
    for body in range(rows(world, KICKED)):
        added = vector_at(kicked, body, ADDED)
        net = plus(added, vector_at(support, body, VELOCITY))
        if dot(net, net) >= dot(added, added):  # not at rest, but stopped by an impact in the substep before
            for k in range(3):
                support[body, VELOCITY + k] = 0.0
    _shift(world, 1.0)


@compiled
def remove_support(world: int) -> None:
    """Subtract what `add_support` has added: the sweeps begin with these impulses."""
    _shift(world, -1.0)


@compiled
def _add_contact(world: int, row: int) -> None:
    """Add the impulses of a contact to the support of its bodies."""
    contact, support, inverse_mass = integers(world, CONTACT), floats(world, NOTED), floats(world, INVERSE_MASS)
    impulse = _impulse_of(constraint(world, row))
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    for k in range(3):
        support[a, VELOCITY + k] -= inverse_mass[a, INVERSE_LINEAR_MASS] * impulse[k]
        support[b, VELOCITY + k] += inverse_mass[b, INVERSE_LINEAR_MASS] * impulse[k]


@compiled
def _impulse_of(own: Any) -> Vector:
    """Return the impulse of a contact on its second body, N s."""
    normal, first, total = vector_of(own, c.N), vector_of(own, c.T), 0.0
    for k in range(int(own[c.COUNT * c.WIDTH])):
        total += own[(c.P + c.POINT_FIELDS * k + c.IMPULSE) * c.WIDTH]
    along, across = own[c.TANGENT_IMPULSE * c.WIDTH], own[(c.TANGENT_IMPULSE + 1) * c.WIDTH]
    return plus(times(total, normal), plus(times(along, first), times(across, cross(normal, first))))


@compiled
def _shift(world: int, sign: float) -> None:
    """Add the support of all bodies, times a sign, to their velocities and to their kicks."""
    kicked, motion, support = floats(world, KICKED), floats(world, MOTION), floats(world, NOTED)
    for body in range(rows(world, KICKED)):
        for k in range(3):
            change = sign * support[body, VELOCITY + k]
            motion[body, VELOCITY + k] += change
            kicked[body, KICKED_VELOCITY + k] += change
            kicked[body, ADDED + k] += change
