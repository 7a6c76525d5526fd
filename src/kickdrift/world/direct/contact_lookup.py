"""Access to the contacts that are solved directly, by their index in the linked colour: each group holds eight in its lanes."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.graph_colouring import LINKED
from kickdrift.world.tables import COLOURS, CONTACT_ROW, GROUPS, LANES, flat, integers

_COLUMNS = CONTACT_ROW.width


@compiled(inline=True, cached=False, fast=True)
def linked_contacts(world: int) -> int:
    """Return how many contacts are solved directly."""
    count: int = integers(world, COLOURS)[LINKED, c.COLOUR_CONTACTS]
    return count


@compiled(inline=True, cached=False, fast=True)
def contact_row(world: int, index: int) -> Any:
    """Return the row of a contact in CONTACT_ROW, as a view."""
    return flat(world, CONTACT_ROW)[_COLUMNS * index : _COLUMNS * (index + 1)]


@compiled(inline=True, cached=False, fast=True)
def linked_constraint(world: int, index: int) -> Any:
    """Return the constraint of a contact: field k is number k WIDTH."""
    g = integers(world, COLOURS)[LINKED, c.FIRST_GROUP] + index // c.WIDTH
    return flat(world, LANES)[g * c.GROUP_SIZE + index % c.WIDTH : (g + 1) * c.GROUP_SIZE]


@compiled(inline=True, cached=False, fast=True)
def linked_bodies(world: int, index: int) -> tuple[int, int]:
    """Return the bodies of a contact."""
    groups, g = integers(world, GROUPS), integers(world, COLOURS)[LINKED, c.FIRST_GROUP] + index // c.WIDTH
    return groups[g, c.BODIES_A + index % c.WIDTH], groups[g, c.BODIES_B + index % c.WIDTH]


@compiled(inline=True, cached=False, fast=True)
def row_of(world: int, index: int) -> int:
    """Return the row of a contact in CONTACT."""
    g = integers(world, COLOURS)[LINKED, c.FIRST_GROUP] + index // c.WIDTH
    row: int = integers(world, GROUPS)[g, c.GROUP_CONTACTS + index % c.WIDTH]
    return row
