"""Columns of tables: declared once, and read as numbers, vectors, quaternions and symmetric matrices.

`column` declares columns of a table, `Fields` those of other records: a point in a row, a lane, a buffer. Both return the index
of the first column, an integer that compiled code treats as a constant.
"""

import sys
from typing import Any, NamedTuple

from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.core.vectors import Quaternion, Symmetric, Vector
from kickdrift.world.tables import Table


class Columns(NamedTuple):
    """Adjacent columns of a table that hold one quantity.

    Attributes
    ----------
    first, size : int
        The first column, and their number.
    unit : str
        Unit of the quantity.
    module : str
        The module that declares them.
    over : bool
        Whether they share the columns of another quantity, like a union in C.
    """

    first: int
    size: int
    unit: str
    module: str
    over: bool = False


DECLARED: dict[int, list[Columns]] = {}  # by `Table.place`


def column(table: Table, size: int = 1, unit: str = "", over: int | None = None) -> int:
    """Declare the next columns of a table.

    Parameters
    ----------
    table : Table
    size : int
        Number of columns.
    unit : str
        Unit of the quantity that they hold.
    over : int, optional
        First column of another quantity, whose columns these share instead of taking new ones; no row may have both.

    Returns
    -------
    int
        Index of the first column, a constant for compiled code.

    Raises
    ------
    ArgumentError
        If the table is not wide enough, if `size` exceeds that of the columns to share, or if columns of the table are
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
    """Columns of a record that is not a row of a table: a point in a row, a lane, a buffer."""

    def __init__(self) -> None:
        self.declared: list[Columns] = []
        self._closed = False

    def field(self, size: int = 1, unit: str = "") -> int:
        """Declare the next columns, and return the index of the first, as `column` does."""
        if self._closed:
            raise ArgumentError(
                "A field is declared after `close`, which has fixed the number of columns; declare it before."
            )
        first = self._end()
        self.declared.append(Columns(first, size, unit, str(sys._getframe(1).f_globals["__name__"])))
        return first

    def close(self) -> int:
        """End the declarations, and return the total number of columns."""
        self._closed = True
        return self._end()

    def _end(self) -> int:
        return self.declared[-1].first + self.declared[-1].size if self.declared else 0


@compiled(inline=True, cached=False)
def vector_at(table: Any, row: int, column: int) -> Vector:
    """Return the vector that begins at a column of a row."""
    return (table[row, column], table[row, column + 1], table[row, column + 2])


@compiled(inline=True, cached=False)
def point_at(numbers: Any, at: int) -> Vector:
    """Return the vector that begins at a place of a flat array."""
    return (numbers[at], numbers[at + 1], numbers[at + 2])


@compiled(inline=True, cached=False)
def quaternion_at(table: Any, row: int, column: int) -> Quaternion:
    """Return the quaternion that begins at a column of a row."""
    return (table[row, column], table[row, column + 1], table[row, column + 2], table[row, column + 3])


@compiled(inline=True, cached=False)
def symmetric_at(table: Any, row: int, column: int) -> Symmetric:
    """Return the symmetric matrix that begins at a column of a row: xx, yy, zz, xy, xz, yz."""
    return (
        table[row, column],
        table[row, column + 1],
        table[row, column + 2],
        table[row, column + 3],
        table[row, column + 4],
        table[row, column + 5],
    )
