"""Columns of tables: declared once, and read as numbers, vectors, quaternions and symmetric matrices."""

import sys
from typing import Any, NamedTuple

from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.core.vectors import Quaternion, Symmetric, Vector
from kickdrift.world.tables import Table


class Columns(NamedTuple):
    """Neighbouring columns of a table that are one thing: the first of them, how many, their unit, and who declares them."""

    first: int
    size: int
    unit: str
    module: str


DECLARED: dict[int, list[Columns]] = {}  # by the places of tables


def column(table: Table, size: int = 1, unit: str = "") -> int:
    """Declare the next columns of a table.

    Parameters
    ----------
    table : Table
    size : int
        How many.
    unit : str
        Of what is in them.

    Returns
    -------
    int
        The first of them, a constant for compiled code: columns of one table follow each other, none is in two.

    Raises
    ------
    ArgumentError
        If the table is not as wide, or if columns of it are declared in another module, so that their order would depend
        on which of the two is imported first.
    """
    module = str(sys._getframe(1).f_globals["__name__"])
    declared = DECLARED.setdefault(table.place, [])
    first = declared[-1].first + declared[-1].size if declared else 0
    if declared and declared[-1].module != module:
        raise ArgumentError(
            f"Columns of table {table.place} are declared in {declared[-1].module}; declare those of {module} there."
        )
    if first + size > table.width:
        raise ArgumentError(
            f"Table {table.place} has {table.width} columns, and {first + size} are declared; make it wider."
        )
    declared.append(Columns(first, size, unit, module))
    return first


@compiled(inline=True, cached=False)
def vector_at(table: Any, row: int, column: int) -> Vector:
    """Three numbers of a row."""
    return (table[row, column], table[row, column + 1], table[row, column + 2])


@compiled(inline=True, cached=False)
def quaternion_at(table: Any, row: int, column: int) -> Quaternion:
    """Four numbers of a row."""
    return (table[row, column], table[row, column + 1], table[row, column + 2], table[row, column + 3])


@compiled(inline=True, cached=False)
def symmetric_at(table: Any, row: int, column: int) -> Symmetric:
    """Six numbers of a row."""
    return (
        table[row, column],
        table[row, column + 1],
        table[row, column + 2],
        table[row, column + 3],
        table[row, column + 4],
        table[row, column + 5],
    )
