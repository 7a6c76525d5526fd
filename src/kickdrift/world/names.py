"""Names that users give to bodies, joints and cloths, unique among those of one kind."""

from collections.abc import Mapping
from typing import Any

from kickdrift.core.errors import ArgumentError, unknown_name
from kickdrift.core.interruption import InterruptionNoted


class Names:
    """Names of rows of a table.

    Parameters
    ----------
    what : str
        The kind of the rows, for messages: "body", "joint".
    """

    def __init__(self, what: str) -> None:
        self._what = what
        self._names: dict[int, str] = {}
        self._rows: dict[str, int] = {}

    def checked(self, name: Any, row: int | None = None) -> str | None:
        """Return a name if a row can have it, or None for none.

        Raises
        ------
        ArgumentError
            If it is not a string, is empty, or is the name of another row.
        """
        if name is None:
            return None
        if not isinstance(name, str) or not name:
            raise ArgumentError(f"name={name!r} must be a non-empty string, or None.")
        if self._rows.get(name, row) != row:
            raise ArgumentError(
                f"name={name!r} belongs to another {self._what}, row {self._rows[name]}; give a new name."
            )
        return name

    def give(self, row: int, name: str | None) -> None:
        """Set the name of a row, already checked, or remove it."""
        with InterruptionNoted(passed_on=True):
            self._rows.pop(self._names.pop(row, ""), None)
            if name is not None:
                self._names[row], self._rows[name] = name, row

    def of(self, row: int) -> str | None:
        """Return the name of a row, or None."""
        return self._names.get(row)

    def row(self, name: str) -> int:
        """Return the row of a name.

        Raises
        ------
        UnknownNameError
            If there is none; the message lists the names.
        """
        if not isinstance(name, str) or name not in self._rows:
            raise unknown_name("name", name, self._rows)
        return self._rows[name]

    def all(self) -> dict[int, str]:
        """Return the names by row."""
        return dict(self._names)

    def replace(self, names: Mapping[int, str]) -> None:
        """Replace all names by others, by row."""
        self._names = dict(names)
        self._rows = {name: row for row, name in names.items()}
