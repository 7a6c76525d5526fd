"""Assembly of contacts: their terms in the matrix of an island, and in the loads on its nodes."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.spatial import plus_scaled, put_spatial, put_spatial_of, spatial_at, spatial_of
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_active_set import twelve
from kickdrift.world.direct.contact_lookup import contact_row
from kickdrift.world.direct.contact_rows import bound_rows, first_row
from kickdrift.world.direct.contact_wrenches import wrench_of
from kickdrift.world.direct.matrix import add_row
from kickdrift.world.joints import layout as j
from kickdrift.world.tables import ISLAND, ISLAND_CONTACT, LINK_NUMBERS, NODE, floats, integers


@compiled(cached=False, fast=True)
def add_contacts(world: int, island: int) -> None:
    """Add the rows of contacts to the matrix of an island."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    wrench = twelve()
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        numbers = contact_row(world, order[k, 0])
        a, b = int(numbers[d.NODES]), int(numbers[d.NODES + 1])
        for i in range(d.TANGENT):
            if numbers[d.ACTIVE + i] != 0.0 and numbers[d.STATE + i] == d.HELD:
                row = wrench_of(numbers, i)
                add_row(world, a, b, numbers[d.STIFFNESS + i], row, row)
        for bound in range(3):
            begin = first_row(bound)
            held = numbers[d.STATE + begin] == d.HELD
            stiffness = numbers[d.STIFFNESS + begin] * (1.0 if held else numbers[d.SLIDING_PART + bound])
            if numbers[d.ACTIVE + begin] == 0.0 or stiffness == 0.0:
                continue
            end = begin + bound_rows(bound)
            for i in range(begin, end):
                row = wrench_of(numbers, i)
                for at in range(0, 12, 6):
                    put_spatial_of(wrench, at, spatial_of(row, at))
                if not held:
                    for m in range(begin, end):
                        share = numbers[d.DIRECTION + i] * numbers[d.DIRECTION + m]
                        for at in range(0, 12, 6):
                            other = spatial_of(numbers, d.WRENCH + 12 * m + at)
                            put_spatial_of(wrench, at, plus_scaled(spatial_of(wrench, at), -share, other))
                add_row(world, a, b, stiffness, row, wrench)


@compiled(cached=False, fast=True)
def load_contacts(world: int, island: int) -> None:
    """Add to the loads on the nodes of an island the impulses of its contacts at no change of speed (CONSTANT)."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        numbers = contact_row(world, order[k, 0])
        a, b = int(numbers[d.NODES]), int(numbers[d.NODES + 1])
        for i in range(d.CONTACT_ROWS):
            if numbers[d.ACTIVE + i] != 0.0:
                _load(world, a, b, numbers[d.CONSTANT + i], numbers, d.WRENCH + 12 * i)


@compiled(inline=True, cached=False, fast=True)
def _load(world: int, a: int, b: int, impulse: float, numbers: Any, wrench: int) -> None:
    """Apply an impulse along a row to the nodes of a contact."""
    nodes, work = integers(world, NODE), floats(world, LINK_NUMBERS)
    for side in range(2):
        node = b if side == 1 else a
        if node >= 0:
            link = nodes[node, d.LINK_ROW]
            load = plus_scaled(
                spatial_at(work, link, j.CLOSING_IMPULSE), impulse, spatial_of(numbers, wrench + 6 * side)
            )
            put_spatial(work, link, j.CLOSING_IMPULSE, load)
