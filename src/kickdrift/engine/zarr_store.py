"""Rows in a Zarr group on disk, written while the run goes on: arrays along time that xarray reads at any moment.

Whole chunks are written, each once. What readers see is the consolidated metadata, which is replaced after the chunks that it
tells of: all arrays have the same length at any time.
"""

import os
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, FileFormatError, missing_extra

_CHUNK = 1 << 20  # bytes of the largest array
_RUN = "kickdrift_run"  # the attribute that tells runs apart


class Array(NamedTuple):
    """An array along time: the names and the lengths of its other dimensions, and its unit."""

    dimensions: tuple[str, ...] = ()
    shape: tuple[int, ...] = ()
    unit: str = ""


class ZarrStore:
    """A group of arrays along time.

    Parameters
    ----------
    path : path
        Of a folder.
    run : str
        What tells the run apart, of which alone a store that is there is gone on with.

    Raises
    ------
    ArgumentError
        For what is no path.
    MissingExtraError
        If zarr is not installed.
    """

    def __init__(self, path: Any, run: str) -> None:
        if not isinstance(path, str | os.PathLike) or not str(path) or "\0" in str(path):
            raise ArgumentError(f"save_to={path!r} is no path; give a folder, such as 'run.zarr'.")
        try:
            import zarr
        except ImportError:
            raise missing_extra("save_to", "zarr", "zarr") from None
        self.path, self._run, self._zarr = Path(path), run, zarr
        self.rows = 0
        self._group: Any = None

    def check(self, again: bool) -> None:
        """Refuse a folder that holds something, unless that is this run and it may go on, or begin `again`.

        Raises
        ------
        ArgumentError
        """
        if not self.path.exists() or (self.path.is_dir() and not any(self.path.iterdir())):
            if not self.path.absolute().parent.is_dir():
                raise ArgumentError(f"save_to={str(self.path)!r} lies in a folder that there is not; make it first.")
            return
        known: Any = None
        with suppress(Exception):  # of whatever it may be
            known = dict(self._zarr.open_group(self.path, mode="r", use_consolidated=False).attrs).get(_RUN)
        if known is None:
            raise ArgumentError(f"save_to={str(self.path)!r} is there already; name another folder, or remove it.")
        if not (again and known == self._run):
            other = (
                "holds another run" if known != self._run else "holds this run, which checkpoint=... would go on with"
            )
            raise ArgumentError(f"save_to={str(self.path)!r} {other}; name another folder, or remove it to begin anew.")

    def create(self, attributes: Mapping[str, Any], arrays: Mapping[str, Array], labels: Mapping[str, Any]) -> None:
        """Make the group, in the place of what this run has left there.

        Raises
        ------
        FileFormatError
            If it cannot be written.
        """
        widest = max(8 * int(np.prod(array.shape, initial=1)) for array in arrays.values())
        self.chunk = max(1, _CHUNK // widest)
        with self._writing():
            marked = {**attributes, _RUN: self._run}
            self._group = self._zarr.open_group(self.path, mode="w", zarr_format=3, attributes=marked)
            for name, array in arrays.items():
                self._group.create_array(
                    name,
                    shape=(0, *array.shape),
                    chunks=(self.chunk, *array.shape),
                    dtype="float64",
                    dimension_names=("time", *array.dimensions),
                    attributes={"units": array.unit} if array.unit else {},
                    compressors=None,
                )
            for name, values in labels.items():
                along = np.asarray(values)
                made = self._group.create_array(name, shape=along.shape, dtype=along.dtype, dimension_names=(name,))
                made[:] = along
            self._commit()

    def go_on(self, rows: int) -> None:
        """Go on after so many rows; what was written beyond them is cut off.

        Raises
        ------
        FileFormatError
            If there are not so many.
        """
        with self._writing():
            try:
                self._group = self._zarr.open_group(self.path, mode="r+", use_consolidated=False)
                there = min(array.shape[0] for _, array in self._along_time())
            except (FileNotFoundError, KeyError, ValueError) as error:
                raise FileFormatError(
                    f"save_to={str(self.path)!r} is not what the checkpoint goes on from ({type(error).__name__}: {error});"
                    " remove the checkpoints to begin anew."
                ) from None
            if there < rows:
                raise FileFormatError(
                    f"save_to={str(self.path)!r} has {there} rows, and the checkpoint goes on after {rows}; remove the"
                    " checkpoints to begin anew."
                )
            self.chunk = self._group["time"].chunks[0]
            for _, array in self._along_time():
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
                array = self._group[name]
                array.resize((end, *array.shape[1:]))
                array[self.rows : end] = values
            self._group.attrs.update(attributes)
            self._commit()
        self.rows = end

    def _along_time(self) -> Iterator[tuple[str, Any]]:
        return ((name, array) for name, array in self._group.arrays() if array.metadata.dimension_names[0] == "time")

    def _commit(self) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that consolidated metadata are not in the specification yet
            self._zarr.consolidate_metadata(self._group.store)

    @contextmanager
    def _writing(self) -> Iterator[None]:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # that texts are not in the specification yet
                yield
        except OSError as error:
            raise FileFormatError(
                f"save_to={str(self.path)!r} cannot be written: {error.strerror or error}; choose another folder."
            ) from None
