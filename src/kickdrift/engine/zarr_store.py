"""Rows in a Zarr group on disk, written during the run: arrays along time that xarray can read at any moment.

Whole chunks are written, each once. Readers see the consolidated metadata, which is replaced after the chunks that it
describes: all arrays have the same length at any time.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import FileFormatError
from kickdrift.engine.description import unit_attributes
from kickdrift.engine.zarr_group import Array, ZarrGroup

_CHUNK = 1 << 20  # bytes of a chunk of the largest array


class ZarrStore(ZarrGroup):
    """A group of arrays along time.

    Attributes
    ----------
    rows : int
        Number of rows.
    chunk : int
        Number of rows written at a time.
    """

    rows, chunk = 0, 1
    _arrays: dict[str, Any]

    def create(self, attributes: Mapping[str, Any], arrays: Mapping[str, Array], labels: Mapping[str, Any]) -> None:
        """Create the group, replacing an earlier one of this run.

        Raises
        ------
        FileFormatError
            If it cannot be written.
        """
        widest = max(8 * int(np.prod(array.shape, initial=1)) for array in arrays.values())
        self.chunk = max(1, _CHUNK // widest)
        with self._writing():
            self._begin(attributes, labels)
            self._arrays = {}
            for name, array in arrays.items():
                self._arrays[name] = self._create_array(
                    name,
                    shape=(0, *array.shape),
                    chunks=(self.chunk, *array.shape),
                    dtype="float64",
                    dimension_names=("time", *array.dimensions),
                    attributes=unit_attributes(array.unit),
                )
            self._commit()

    def go_on(self, rows: int) -> None:
        """Resume after a number of rows; those beyond are removed.

        Raises
        ------
        FileFormatError
            If there are not so many.
        """
        with self._writing():
            try:
                self._group = self._zarr.open_group(self.path, mode="r+", use_consolidated=False)
                self._arrays = dict(self._along_time())
                there = min(array.shape[0] for array in self._arrays.values())
            except (FileNotFoundError, KeyError, ValueError) as error:
                raise FileFormatError(
                    f"save_to={str(self.path)!r} does not match the checkpoint ({type(error).__name__}: {error});"
                    " remove the checkpoints to start again."
                ) from None
            if there < rows:
                raise FileFormatError(
                    f"save_to={str(self.path)!r} has {there} rows, but the checkpoint continues after {rows}; remove"
                    " the checkpoints to start again."
                )
            self.chunk = self._group["time"].chunks[0]
            for array in self._arrays.values():
                array.resize((rows, *array.shape[1:]))
            self.rows = rows
            self._commit()

    def append(self, rows: Mapping[str, NDArray[np.float64]], attributes: Mapping[str, Any]) -> None:
        """Add rows, and set attributes.

        Raises
        ------
        FileFormatError
            If they cannot be written; those before them are as they were.
        """
        end = self.rows + len(rows["time"])
        with self._writing():
            for name, values in rows.items():
                array = self._arrays[name]
                array.resize((end, *array.shape[1:]))
                array[self.rows : end] = values
            self._group.attrs.update(attributes)
            self._commit()
        self.rows = end

    def rows_at(self, which: NDArray[np.intp]) -> tuple[NDArray[np.float64], ...]:
        """Return time, x and v of some rows."""
        names = ("time", "x", "v") if "v" in self._arrays else ("time", "x")
        rows = [np.asarray(self._arrays[name].get_orthogonal_selection(which)) for name in names]
        return (*rows, *[np.zeros((len(which), 0))] * (3 - len(rows)))

    def _along_time(self) -> Iterator[tuple[str, Any]]:
        return ((name, array) for name, array in self._group.arrays() if array.metadata.dimension_names[0] == "time")
