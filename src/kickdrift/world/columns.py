"""Columns of tables: declared once, and read as numbers, vectors, quaternions and symmetric matrices.

`column` declares those of a table, `Fields` what is no row of a table but numbered in the same way. Both give out the first
number of what is declared, an integer that compiled code takes for a constant.
"""

import sys
from typing import Any, NamedTuple

from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.core.vectors import Quaternion, Symmetric, Vector
from kickdrift.world.tables import Table


class Columns(NamedTuple):
    """Neighbouring columns of a table that are one thing.

    Attributes
    ----------
    first, size : int
        The first of them, and how many.
    unit : str
        Of what is in them.
    module : str
        That declares them.
    over : bool
        Whether they are those of another thing, too.
    """

    first: int
    size: int
    unit: str
    module: str
    over: bool = False


DECLARED: dict[int, list[Columns]] = {}  # by the places of tables


def column(table: Table, size: int = 1, unit: str = "", over: int | None = None) -> int:
    """Declare the next columns of a table.

    Parameters
    ----------
    table : Table
    size : int
        How many.
    unit : str
        Of what is in them.
    over : int, optional
        First column of another thing that no row has at the same time: they are its columns, and no next ones.

    Returns
    -------
    int
        The first of them, a constant for compiled code: columns of one table follow each other, none is in two things but
        for those that are declared over another.

    Raises
    ------
    ArgumentError
        If the table is not as wide, if they are more than those that they are declared over, or if columns of the table are
        declared in another module, so that their order would depend on which of the two is imported first.
    """
    module = str(sys._getframe(1).f_globals["__name__"])
    declared = DECLARED.setdefault(table.place, [])
    if declared and declared[-1].module != module:
        raise ArgumentError(
            f"Columns of table {table.place} are declared in {declared[-1].module}; declare those of {module} there."
        )
    if over is not None:
        _check_over(table, size, over)
        declared.append(Columns(over, size, unit, module, over=True))
        return over
    first = max((columns.first + columns.size for columns in declared), default=0)
    if first + size > table.width:
        raise ArgumentError(
            f"Table {table.place} has {table.width} columns, and {first + size} are declared; make it wider."
        )
    declared.append(Columns(first, size, unit, module))
    return first


def _check_over(table: Table, size: int, over: int) -> None:
    room = {columns.first: columns.size for columns in DECLARED[table.place] if not columns.over}
    if size > room.get(over, 0):
        raise ArgumentError(
            f"{size} columns of table {table.place} are declared over those at {over}, which are {room.get(over, 0)};"
            " declare them over other columns, or as columns of their own."
        )


class Fields:
    """Numbers that follow each other and are no row of a table: of a point in a row, of a lane, of a buffer."""

    def __init__(self) -> None:
        self.declared: list[Columns] = []
        self._closed = False

    def field(self, size: int = 1, unit: str = "") -> int:
        """Declare the next of them, and return the first, as `column` does."""
        if self._closed:
            raise ArgumentError(
                "A field is declared after `close`, which has fixed the number of columns; declare it before."
            )
        first = self._end()
        self.declared.append(Columns(first, size, unit, str(sys._getframe(1).f_globals["__name__"])))
        return first

    def close(self) -> int:
        """Close the declaration, and return how many numbers the columns are."""
        self._closed = True
        return self._end()

    def _end(self) -> int:
        return self.declared[-1].first + self.declared[-1].size if self.declared else 0


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
