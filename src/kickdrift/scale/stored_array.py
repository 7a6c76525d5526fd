"""Zarr arrays that are indexed as NumPy's are, as far as that reads only the part selected."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, FileFormatError


class StoredArray:
    """An array on disk; indexing reads only the selected part.

    Parameters
    ----------
    array : zarr.Array

    Attributes
    ----------
    shape, dtype, chunks : tuple of int, dtype, tuple of int
        As of the array.
    """

    def __init__(self, array: Any) -> None:
        self._array = array
        self.shape, self.dtype, self.chunks = tuple(array.shape), array.dtype, tuple(array.chunks)

    @property
    def ndim(self) -> int:
        """Number of dimensions."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """Number of elements."""
        return int(np.prod(self.shape))

    def __len__(self) -> int:
        return int(self.shape[0])

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.asarray(self[...], dtype=dtype)

    def __getitem__(self, key: Any) -> Any:
        """Read elements given by integers, slices in either direction, and for one dimension a list or a mask.

        Raises
        ------
        ArgumentError
            For another index.
        FileFormatError
            If the files are damaged.
        """
        places = [self._place(axis, part) for axis, part in enumerate(self._parts(key))]
        if sum(isinstance(place, np.ndarray) for place in places) > 1:
            raise self._refused(key, "has lists for more than one dimension")
        try:
            read = self._array.oindex[tuple(_forwards(place) for place in places)]
        except (OSError, LookupError, TypeError, ValueError) as error:
            raise FileFormatError(
                f"the array {self._array.name!r} in {self._array.store} cannot be read ({type(error).__name__}: {error}); it"
                " is damaged: remove the folder, and repeat the call that wrote it."
            ) from error
        kept = [place for place in places if not isinstance(place, int)]
        return read[tuple(slice(None, None, -1 if isinstance(p, slice) and p.step < 0 else 1) for p in kept)]

    def _parts(self, key: Any) -> list[Any]:
        """Return an index for each dimension."""
        parts = list(key) if isinstance(key, tuple) else [key]
        dots = [k for k, part in enumerate(parts) if part is Ellipsis]
        missing = self.ndim - len(parts) + len(dots)
        if missing < 0 or len(dots) > 1:
            raise self._refused(key, f"has more parts than there are dimensions, {self.ndim}")
        at = dots[0] if dots else len(parts)
        return parts[:at] + [slice(None)] * missing + parts[at + len(dots) :]

    def _place(self, axis: int, part: Any) -> Any:
        count = self.shape[axis]
        if isinstance(part, slice):
            try:
                start, stop, step = part.indices(count)
            except (TypeError, ValueError) as error:
                raise self._refused(part, f"is not a slice ({error})") from None
            return slice(start, max(start, stop), step) if step > 0 else slice(start, stop, step)
        if isinstance(part, int | np.integer) and not isinstance(part, bool):
            if not -count <= part < count:
                raise self._refused(part, f"is beyond dimension {axis}, which has {count} places")
            return int(part) % count
        try:
            listed = np.asarray(part)
        except ValueError:
            listed = np.zeros(0, dtype=object)
        if listed.ndim == 1 and listed.dtype == bool and listed.size == count:
            return np.flatnonzero(listed)
        if listed.ndim == 1 and (listed.dtype.kind in "iu" or not listed.size) and listed.dtype != object:
            if ((listed < -count) | (listed >= count)).any():
                raise self._refused(part, f"is beyond dimension {axis}, which has {count} places")
            return listed.astype(np.int64) % count
        raise self._refused(part, f"names no places of dimension {axis}, which has {count}")

    def _refused(self, key: Any, why: str) -> ArgumentError:
        return ArgumentError(
            f"index {key!r} of an array on disk of shape {self.shape} {why}; give whole numbers, slices, or for one"
            " dimension a list or a mask, or read everything with [:], as a NumPy array."
        )

    def __repr__(self) -> str:
        return f"<array on disk: {self.shape}, {self.dtype}>"


def _forwards(place: Any) -> Any:
    """Return the elements of a backward slice, in the order on disk."""
    if not isinstance(place, slice) or place.step > 0:
        return place
    named = range(place.start, place.stop, place.step)
    return slice(named[-1], named[0] + 1, -place.step) if named else slice(0, 0, 1)
