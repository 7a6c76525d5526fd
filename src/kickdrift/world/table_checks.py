"""The tables read from a file, and checks of their numbers."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


class FileTables:
    """The tables of a file by their names, and checks of their numbers.

    Raises
    ------
    ValueError
        By every method that checks, if the condition does not hold.
    """

    def __init__(self, tables: Mapping[str, NDArray[Any]]) -> None:
        self._tables = tables

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._tables[name]

    def count(self, name: str, wanted: int) -> None:
        """Check that a table has a number of rows."""
        if len(self[name]) != wanted:
            raise ValueError(f"table {name} has {len(self[name])} rows, but other tables require {wanted}")

    def within(self, name: str, first: int, least: int, most: int, size: int = 1, of: Any = slice(None)) -> None:
        """Check that `size` columns from `first` on are between two numbers, in all rows or in those of a selection."""
        values = self[name][of, first : first + size]
        wrong = ~((values >= least) & (values <= most))  # NaN is wrong, too
        if wrong.any():
            raise ValueError(
                f"table {name} has {values[wrong][0]} in column {first}, where values are from {least} to {most}"
            )

    def holds(self, name: str, column: int, true: Any) -> None:
        """Check that a condition on a column, which `true` holds for each row, is met."""
        if not np.all(true):
            raise ValueError(f"table {name} has a number in column {column} that is inconsistent with the others")
