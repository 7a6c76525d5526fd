"""Contacts that are resolved eight at a time: of different particles, with shapes that they do not move."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts.layout import WIDTH
from kickdrift.world.deformables.layout import IN_LANES, MOVES_BODY, ON_LOAD_PATH, OTHER_PARTICLE, TOUCHING_PARTICLE
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    CLOTH_CONTACT,
    CLOTH_CONTACT_NUMBERS,
    CONTACT_LANE_PARTICLES,
    CONTACT_LANES,
    floats,
    integers,
    room,
)

_COLUMNS = CONTACT_LANES.width // WIDTH


@compiled
def fill_contact_lanes(world: int, first: int, last: int) -> bool:
    """Mark the contacts, from one row to another, that are in lanes, and copy them there; False if there is no room."""
    contact, row, run = integers(world, CLOTH_CONTACT), first, first
    if room(world, CONTACT_LANES) <= last // WIDTH:
        ask_for_room(world, CONTACT_LANES, last // WIDTH + 1)
        return False
    while row < last:
        contact[row, IN_LANES] = 0
        if _fits(contact, row, last):
            _copy(world, row)
            if row > run and contact[row, TOUCHING_PARTICLE] <= contact[row - 1, TOUCHING_PARTICLE]:
                run = row  # no particle is twice in a run, which is resolved in parallel
            row += WIDTH
            contact[run, IN_LANES] = row - run
        else:
            row += 1
            run = row
    return True


@compiled(inline=True)
def _fits(contact: Any, row: int, last: int) -> bool:
    """Whether the eight contacts from a row on are of different particles each, move no body and carry nothing."""
    fits = row + WIDTH <= last
    for k in range(row, row + WIDTH if fits else row):
        fits = fits and contact[k, MOVES_BODY] == 0 and contact[k, ON_LOAD_PATH] == 0
        fits = fits and contact[k, OTHER_PARTICLE] == contact[k, TOUCHING_PARTICLE]
        fits = fits and (k == row or contact[k, TOUCHING_PARTICLE] > contact[k - 1, TOUCHING_PARTICLE])
    return fits


@compiled
def _copy(world: int, row: int) -> None:
    """Copy eight contacts, from a row on, to lanes."""
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    particles, lanes = integers(world, CONTACT_LANE_PARTICLES), floats(world, CONTACT_LANES)
    for lane in range(WIDTH):
        particles[row // WIDTH, lane] = contact[row + lane, TOUCHING_PARTICLE]
        for k in range(_COLUMNS):
            lanes[row // WIDTH, WIDTH * k + lane] = numbers[row + lane, k]
