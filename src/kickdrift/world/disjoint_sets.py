"""Disjoint sets of rows (union-find): a column holds the parent of each row, a lower one, or itself for the first of a set."""

from typing import Any

from kickdrift.core.compilation import compiled


@compiled(cached=False)
def first_of(table: Any, column: int, row: int) -> int:
    """Return the first row of the set of a row, halving the path to it."""
    while table[row, column] != row:
        table[row, column] = table[table[row, column], column]
        row = table[row, column]
    return row


@compiled(cached=False)
def unite(table: Any, column: int, a: int, b: int) -> None:
    """Unite the sets of two rows."""
    first, second = first_of(table, column, a), first_of(table, column, b)
    table[max(first, second), column] = min(first, second)
