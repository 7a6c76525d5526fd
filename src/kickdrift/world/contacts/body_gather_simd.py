"""Numbers of the bodies of a group of contacts, copied to the scratch memory of its lanes and back."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.prepare_simd import INERTIA_A, INERTIA_B, VELOCITY_A, VELOCITY_B
from kickdrift.world.contacts.simd_transpose import fetch_rows, gather_rows, scatter_rows
from kickdrift.world.layout import INVERSE_INERTIA_IN_WORLD, VELOCITY
from kickdrift.world.tables import (
    DELTA_POSE,
    GROUPS,
    INVERSE_MASS,
    MEMBER,
    MOTION,
    flat_integers,
    floats,
    integers,
    rows,
)

_W = c.WIDTH
_MANY = 3000  # bodies of a batch, above which velocities, displacements and inertia do not fit into half a megabyte


@compiled
def fetch(world: int, g: int) -> None:
    """Prefetch the bodies of the group after the next, if there are many; their rows are too scattered for the hardware."""
    if rows(world, MEMBER) < _MANY or g + 2 >= rows(world, GROUPS):
        return
    bodies, begin = flat_integers(world, GROUPS), GROUPS.width * (g + 2)
    for side in (c.BODIES_A, c.BODIES_B):
        fetch_rows(floats(world, MOTION), 0, bodies, begin + side)
        fetch_rows(floats(world, DELTA_POSE), 0, bodies, begin + side)
        fetch_rows(floats(world, INVERSE_MASS), 0, bodies, begin + side)


@compiled(inline=True)
def gather(world: int, g: int, table: Any, field: int, scratch: Any) -> None:
    """Copy the first six columns of both bodies of every lane to `field`, those of the second body to `field` + 6."""
    bodies = flat_integers(world, GROUPS)
    gather_rows(table, 0, bodies, GROUPS.width * g + c.BODIES_A, scratch, field)
    gather_rows(table, 0, bodies, GROUPS.width * g + c.BODIES_B, scratch, field + 6)


@compiled(inline=True)
def gather_inertia(world: int, g: int, scratch: Any) -> None:
    """Copy the inverse inertias of both bodies of every lane."""
    bodies, inverse_mass = flat_integers(world, GROUPS), floats(world, INVERSE_MASS)
    gather_rows(inverse_mass, INVERSE_INERTIA_IN_WORLD, bodies, GROUPS.width * g + c.BODIES_A, scratch, INERTIA_A)
    gather_rows(inverse_mass, INVERSE_INERTIA_IN_WORLD, bodies, GROUPS.width * g + c.BODIES_B, scratch, INERTIA_B)


@compiled(inline=True)
def scatter(world: int, g: int, motion: Any, scratch: Any) -> None:
    """Write the velocities of both bodies of every lane back."""
    bodies = flat_integers(world, GROUPS)
    scatter_rows(motion, bodies, GROUPS.width * g + c.BODIES_A, scratch, VELOCITY_A)
    scatter_rows(motion, bodies, GROUPS.width * g + c.BODIES_B, scratch, VELOCITY_B)


@compiled(inline=True)
def add_changes(world: int, g: int, motion: Any, scratch: Any) -> None:
    """Add the changes of velocity in scratch to the bodies of every lane, one lane after the other."""
    groups = integers(world, GROUPS)
    for lane in range(_W):
        if groups[g, c.GROUP_CONTACTS + lane] < 0:
            continue
        a, b = groups[g, c.BODIES_A + lane], groups[g, c.BODIES_B + lane]
        for k in range(6):
            motion[a, VELOCITY + k] += scratch[(VELOCITY_A + k) * _W + lane]
            motion[b, VELOCITY + k] += scratch[(VELOCITY_B + k) * _W + lane]
