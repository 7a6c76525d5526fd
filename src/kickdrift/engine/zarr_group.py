"""A Zarr group on disk that one run writes, and xarray reads at any moment."""

import os
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from kickdrift.core.errors import ArgumentError, FileFormatError, KickdriftError, missing_extra
from kickdrift.core.locking import FileLock, LockedError

_RUN = "kickdrift_run"  # attribute with the identity of the run
KEPT = "solution.npz"  # the solution without its rows, once the run has ended


class Array(NamedTuple):
    """An array along time: the names and the lengths of its other dimensions, and its unit."""

    dimensions: tuple[str, ...] = ()
    shape: tuple[int, ...] = ()
    unit: str = ""


class ZarrGroup:
    """A group of arrays.

    Parameters
    ----------
    path : path
        The folder.
    run : str
        The identity of the run; an existing group is continued only if it is the same.

    Raises
    ------
    ArgumentError
        For an invalid path.
    MissingExtraError
        If zarr is not installed.
    """

    def __init__(self, path: Any, run: str) -> None:
        if not isinstance(path, str | os.PathLike) or not str(path) or "\0" in str(path):
            raise ArgumentError(f"save_to={path!r} is not a path; give a folder, such as 'run.zarr'.")
        try:
            import zarr
            import zarr.codecs
        except ImportError:
            raise missing_extra("save_to", "zarr", "zarr") from None
        self.path, self._run, self._zarr = Path(path), run, zarr
        self._group: Any = None
        self._lock: FileLock | None = None

    def close(self) -> None:
        """Release the folder to other runs."""
        if self._lock is not None:
            self._lock.release()

    def check(self, again: bool) -> bool:
        """Refuse a folder that is not empty, unless it contains this run, and `again` allows to continue or to repeat it.

        From then on it is locked against other runs until it is closed.

        Returns
        -------
        bool
            Whether it holds this run.

        Raises
        ------
        ArgumentError
        """
        try:
            self._lock = FileLock(self.path.with_name(f".{self.path.name}.lock"))
        except LockedError as holder:
            raise ArgumentError(
                f"save_to={str(self.path)!r} is in use by a run of {holder}; wait until that run has ended, or name"
                " another folder."
            ) from None
        try:
            return self._holds_this_run(again)
        except BaseException:
            self.close()
            raise

    def _holds_this_run(self, again: bool) -> bool:
        if not self.path.exists() or (self.path.is_dir() and not any(self.path.iterdir())):
            if not self.path.absolute().parent.is_dir():
                raise ArgumentError(
                    f"save_to={str(self.path)!r} lies in a folder that does not exist; create it first."
                )
            return False
        known: Any = None
        with suppress(Exception):  # the folder may contain anything
            known = dict(self._zarr.open_group(self.path, mode="r", use_consolidated=False).attrs).get(_RUN)
        if known is None:
            raise ArgumentError(f"save_to={str(self.path)!r} exists already; name another folder, or remove it.")
        if again and known == self._run:
            (self.path / KEPT).unlink(missing_ok=True)
        else:
            other = "holds another run" if known != self._run else "holds this run, which checkpoint=... would continue"
            raise ArgumentError(
                f"save_to={str(self.path)!r} {other}; name another folder, or remove it to start again."
            )
        return True

    def _begin(self, attributes: Mapping[str, Any], labels: Mapping[str, Any]) -> None:
        """Create the group, replacing an earlier one of this run, with labels along dimensions of their names."""
        marked = {**attributes, _RUN: self._run}
        self._group = self._zarr.open_group(self.path, mode="w", zarr_format=3, attributes=marked)
        for name, values in labels.items():
            along = np.asarray(values)
            made = self._create_array(name, shape=along.shape, dtype=along.dtype, dimension_names=(name,))
            made[:] = along

    def _create_array(self, name: str, **layout: Any) -> Any:
        """Add an array whose chunks have checksums, so that damaged ones are errors and not other numbers."""
        return self._group.create_array(name, compressors=self._zarr.codecs.Crc32cCodec(), **layout)

    def _commit(self) -> None:
        self._zarr.consolidate_metadata(self._group.store)

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Name the user's argument in errors of files, missing or damaged; silence Zarr's warnings of unspecified features."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # consolidated metadata, and texts
                yield
        except KickdriftError:
            raise
        except (LookupError, TypeError, ValueError) as error:
            raise FileFormatError(
                f"save_to={str(self.path)!r} is damaged ({type(error).__name__}: {error}); remove it to start again, or name"
                " another folder."
            ) from error
        except OSError as error:
            raise FileFormatError(
                f"save_to={str(self.path)!r} cannot be written: {error.strerror or error}; choose another folder."
            ) from None
