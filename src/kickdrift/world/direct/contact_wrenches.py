"""Wrenches of the rows of a contact: a unit impulse along a row, on both bodies."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.spatial import inner, spatial_of
from kickdrift.core.vectors import Vector, cross, dot, minus
from kickdrift.world.columns import point_at, symmetric_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.constraint_groups import vector_of
from kickdrift.world.direct import layout as d
from kickdrift.world.joints.kinematics import turning
from kickdrift.world.layout import INVERSE_INERTIA_IN_WORLD, INVERSE_LINEAR_MASS
from kickdrift.world.tables import INVERSE_MASS, floats


@compiled(inline=True, cached=False, fast=True)
def wrench_of(rows: Any, k: int) -> Any:
    """Return the wrench of row k of a contact, (12,), as a view."""
    return rows[d.WRENCH + 12 * k : d.WRENCH + 12 * k + 12]


@compiled(cached=False, fast=True)
def write_wrench(own: Any, k: int, wrench: Any) -> None:
    """Write the wrench of a unit impulse along row k, (12,)."""
    n, u = vector_of(own, c.N), vector_of(own, c.T)
    push: Vector = (0.0, 0.0, 0.0)
    turn_a, turn_b = n, n
    if k < d.TANGENT:
        push = n
        turn_a = vector_of(own, c.P + c.POINT_FIELDS * k + c.ARM)
        turn_b = minus(turn_a, cross(vector_of(own, c.BETWEEN), n))
    elif k < d.TWIST:
        push = u if k == d.TANGENT else cross(n, u)
        turn_a = cross(vector_of(own, c.CENTRE), push)
        turn_b = minus(turn_a, cross(vector_of(own, c.BETWEEN), push))
    elif k >= d.ROLL:
        turn_a = (1.0 if k == d.ROLL else 0.0, 1.0 if k == d.ROLL + 1 else 0.0, 1.0 if k == d.ROLL + 2 else 0.0)
        turn_b = turn_a
    for i in range(3):
        wrench[i], wrench[3 + i] = -push[i], -turn_a[i]
        wrench[6 + i], wrench[9 + i] = push[i], turn_b[i]


@compiled(cached=False, fast=True)
def along(wrench: Any, velocity: Any) -> float:
    """Return the relative speed of both bodies along a row, from their velocities, (12,)."""
    of_a: float = inner(spatial_of(wrench, 0), spatial_of(velocity, 0))
    of_b: float = inner(spatial_of(wrench, 6), spatial_of(velocity, 6))
    return of_a + of_b


@compiled(cached=False, fast=True)
def mobility(world: int, wrench: Any, body: int, side: int) -> float:
    """Return the change of speed along a row per unit impulse along it, by one of its bodies alone."""
    response, push, turn = floats(world, INVERSE_MASS), point_at(wrench, 6 * side), point_at(wrench, 6 * side + 3)
    total: float = response[body, INVERSE_LINEAR_MASS] * dot(push, push)
    return total + turning(symmetric_at(response, body, INVERSE_INERTIA_IN_WORLD), turn)
