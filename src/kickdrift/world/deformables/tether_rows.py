"""Rows of tethers: from the vertices of a cloth to the nearest ones that nothing moves but the user."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.body_contacts.pinned_corners import FREE
from kickdrift.world.deformables.geodesics import Lines, lines_on, shortest_ways
from kickdrift.world.deformables.mesh_tables import mesh_in
from kickdrift.world.deformables.row_ranges import rows_of
from kickdrift.world.layout import BODY_KIND, DYNAMIC
from kickdrift.world.tables import BODY, CLOTH, CLOTH_NUMBERS, PARTICLE, PIN, TETHER, TETHER_NUMBERS, Tables


def put_tethers(tables: Tables, lines: dict[int, Lines]) -> None:
    """Write the tethers of all cloths; `lines` keeps those on their meshes, by rows of cloths, for the next time."""
    for table in (TETHER, TETHER_NUMBERS):
        tables.resize(table, 0)
    for row, own in enumerate(tables.array(CLOTH)):
        own[[c.FIRST_TETHER, c.LAST_FREE_TETHER, c.LAST_TETHER]] = tables.count(TETHER)
        if tables.array(CLOTH_NUMBERS)[row, c.TETHER_STRAIN] > 0.0:
            _put_tethers_of(tables, row, lines)


def _put_tethers_of(tables: Tables, row: int, lines: dict[int, Lines]) -> None:
    """Write the tethers of a cloth after those of others."""
    own, pins = tables.array(CLOTH)[row], _pins_to_dynamic_bodies(tables, row)
    pinned = rows_of(tables, row, c.FIRST_PARTICLE, PARTICLE)[:, c.PARTICLE_INVERSE_MASS] == 0.0
    anchors = np.flatnonzero(pinned & (pins == FREE))
    if not anchors.size:
        return
    if row not in lines:
        lines[row] = lines_on(mesh_in(tables, row))
    lengths, nearest = shortest_ways(lines[row], len(pins), anchors)
    lengths[anchors] = np.inf
    tethered, first = np.flatnonzero(np.isfinite(lengths)), tables.count(TETHER)
    tethered = tethered[np.argsort(pins[tethered] != FREE, kind="stable")]
    own[c.LAST_TETHER] = first + len(tethered)
    own[c.LAST_FREE_TETHER] = first + np.count_nonzero(pins[tethered] == FREE)
    ends = tables.resize(TETHER, int(own[c.LAST_TETHER]))[first:]
    ends[:, c.TETHERED], ends[:, c.TETHER_PIN] = own[c.FIRST_PARTICLE] + tethered, pins[tethered]
    ends[:, c.TETHER_ANCHOR] = own[c.FIRST_PARTICLE] + nearest[tethered]
    longer = 1.0 + tables.array(CLOTH_NUMBERS)[row, c.TETHER_STRAIN]
    tables.resize(TETHER_NUMBERS, int(own[c.LAST_TETHER]))[first:, c.TETHER_LENGTH] = longer * lengths[tethered]


def _pins_to_dynamic_bodies(tables: Tables, row: int) -> NDArray[np.int64]:
    """Return the row of the pin of each particle of a cloth to a dynamic body, or `FREE`, (N,)."""
    own, pins = tables.array(CLOTH)[row], rows_of(tables, row, c.FIRST_PIN, PIN)
    rows = np.full(int(own[c.LAST_PARTICLE] - own[c.FIRST_PARTICLE]), FREE)
    moved = np.flatnonzero(tables.array(BODY)[pins[:, c.PINNED_BODY], BODY_KIND] == DYNAMIC)
    rows[pins[moved, c.PINNED_PARTICLE] - own[c.FIRST_PARTICLE]] = own[c.FIRST_PIN] + moved
    return rows
