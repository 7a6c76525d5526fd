"""Ranges of rows: in every table, the rows of a cloth follow those of the cloth before it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables import layout as c
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_LOAD,
    CLOTH_NUMBERS,
    COUPLING,
    COUPLING_NUMBERS,
    CURVED_FACE,
    CURVED_FACE_NUMBERS,
    FACE,
    FACE_NUMBERS,
    PARTICLE,
    PARTICLE_COUPLINGS,
    PARTICLE_REST,
    PIN,
    PIN_NUMBERS,
    TETRAHEDRON,
    TETRAHEDRON_NUMBERS,
    Table,
    Tables,
)

# By the columns in which ranges begin; particles last, since rows of the other tables refer to them
TABLES_OF = {
    c.FIRST_FACE: (FACE, FACE_NUMBERS),
    c.FIRST_COUPLING: (COUPLING, COUPLING_NUMBERS),
    c.FIRST_TETRAHEDRON: (TETRAHEDRON, TETRAHEDRON_NUMBERS),
    c.FIRST_CURVED: (CURVED_FACE, CURVED_FACE_NUMBERS),
    c.FIRST_PIN: (PIN, PIN_NUMBERS),
    c.FIRST_PARTICLE: (PARTICLE, PARTICLE_REST, PARTICLE_COUPLINGS),
}
_PARTICLES_IN = (
    (FACE, c.FIRST_FACE, c.CORNERS, 3), (CURVED_FACE, c.FIRST_CURVED, c.STENCIL, 6), (PIN, c.FIRST_PIN, c.PINNED_PARTICLE, 1),
    (TETRAHEDRON, c.FIRST_TETRAHEDRON, c.TETRAHEDRON_CORNERS, 4),
)  # fmt: skip


def add_range(tables: Tables) -> int:
    """Add a row for a cloth after all others, with empty ranges, and return it."""
    row = tables.count(CLOTH)
    tables.resize(CLOTH_NUMBERS, row + 1)
    own = tables.resize(CLOTH, row + 1)[row]
    for first, of in TABLES_OF.items():
        own[[first, first + 1]] = tables.count(of[0])
    return row


def rows_of(tables: Tables, row: int, first: int, table: Table) -> NDArray[Any]:
    """Return the rows of a cloth in a table, a live view."""
    begin, end = tables.array(CLOTH)[row, [first, first + 1]].tolist()
    return tables.array(table)[begin:end]


def replace_rows(tables: Tables, row: int, first: int, anew: Mapping[Table, NDArray[Any]]) -> None:
    """Replace the rows of a cloth in the tables whose range begins in column `first`; rows of later cloths move."""
    cloths = tables.array(CLOTH)
    begin, end = cloths[row, [first, first + 1]].tolist()
    for table, values in anew.items():
        now = tables.array(table)
        tables.put(table, np.concatenate((now[:begin], values, now[end:])))
        growth = len(values) - (end - begin)
    cloths[row, first + 1] += growth
    cloths[row + 1 :, [first, first + 1]] += growth
    if first == c.FIRST_PARTICLE:
        for table, of, column, size in _PARTICLES_IN:
            tables.array(table)[cloths[row, of + 1] :, column : column + size] += growth


def remove_range(tables: Tables, row: int) -> None:
    """Remove a cloth with all of its rows, and the loads of cloths on bodies; those after it move up."""
    for first, of in TABLES_OF.items():
        replace_rows(tables, row, first, {table: tables.array(table)[:0].copy() for table in of})
    for table in (CLOTH, CLOTH_NUMBERS):
        tables.put(table, np.delete(tables.array(table), row, axis=0))
    tables.array(CLOTH_LOAD)[:] = 0.0
