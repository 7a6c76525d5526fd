"""The file format of kickdrift: an ``.npz`` of plain arrays and one JSON text, which NumPy alone can open. No pickle.

The JSON text names the format and contains a digest of everything else, so that a changed or damaged file is detected when it
is read.
"""

import hashlib
import json
import os
import tokenize
import zipfile
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import FileFormatError
from kickdrift.core.files import opened, path_of, written

Arrays = Mapping[str, NDArray[Any]]
T = TypeVar("T")

# Formats, as headers name them
SOLUTION, RECORDING, WORLD = "kickdrift solution 1", "kickdrift recording 4", "kickdrift world 10"
ENSEMBLE = "kickdrift ensemble 2"
CHECKPOINT = "kickdrift checkpoint 1"

_HEADER = "header"
# Archives of more than _LARGE bytes in memory are refused if that is more than _MOST_TIMES their size on disk.
_LARGE, _MOST_TIMES = 1 << 30, 100
# Exceptions of NumPy, zip and JSON on files that are damaged or foreign.
_FOREIGN = (
    *(ArithmeticError, AttributeError, EOFError, LookupError, MemoryError, NotImplementedError, RecursionError),
    *(RuntimeError, SyntaxError, TypeError, ValueError, zipfile.BadZipFile, zlib.error, tokenize.TokenError),
)


def write(path: str | Path, header: Mapping[str, Any], arrays: Arrays, compressed: bool = True) -> Path:
    """Write a file, whole or not at all.

    Parameters
    ----------
    path : path
        ``.npz`` is appended if it is missing. The folder must exist.
    header : mapping
        JSON data; under "format" the name of the format.
    arrays : mapping of str to array
    compressed : bool
        Whether to compress, which takes ten times as long.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    FileFormatError
        If the file cannot be written there.
    """
    target = _target(path)
    text = json.dumps({**header, "digest": digest(header, arrays)})
    members = {_HEADER: np.array(text), **arrays}
    try:
        with written(target) as partial:
            if compressed:
                with partial.open("wb") as file:
                    np.savez_compressed(file, allow_pickle=False, **members)
            if not compressed or _is_swollen(partial.open("rb")):  # `read` would refuse it
                with partial.open("wb") as file:
                    np.savez(file, allow_pickle=False, **members)
    except OSError as error:
        raise FileFormatError(
            f"path={str(path)!r} cannot be written: {error.strerror}; choose another folder."
        ) from None
    return target


def _target(path: str | Path) -> Path:
    target = path_of(path, "run.npz")
    if target.name in ("", "..") or "\0" in str(path):
        raise FileFormatError(f"path={str(path)!r} does not name a file; give a name such as 'run.npz'.")
    return target if target.suffix == ".npz" else target.with_name(target.name + ".npz")


def _source(path: str | Path) -> str | Path:
    written_as = Path(f"{path}.npz")
    return written_as if not os.path.exists(path) and written_as.exists() else path


def read(path: str | Path, what: str, writer: str, assemble: Callable[[dict[str, Any], dict[str, Any]], T]) -> T:
    """Read a file.

    Parameters
    ----------
    path : path
        If there is no such file, ``.npz`` is appended, as `write` does.
    what, writer : str
        Name of the format, and function that writes it, for errors.
    assemble : callable
        Makes the object from header and arrays. `LookupError`, `TypeError`, `ValueError` and the like mean that the file is
        not of this format.

    Raises
    ------
    FileFormatError
        If there is no such file, or it is of another format, changed or damaged.
    """
    try:
        path = _source(path)
        if _is_swollen(opened(path)):
            raise FileFormatError(
                f"path={str(path)!r} would take {_LARGE >> 30} GiB or more in memory, more than {_MOST_TIMES} times"
                f" its size on disk, unlike any file written by {writer}; it is not read."
            )
        with opened(path) as handle, np.load(handle, allow_pickle=False) as file:
            header = json.loads(str(file[_HEADER]))
            arrays = {name: file[name] for name in file.files if name != _HEADER}
        other = header["format"] not in (
            SOLUTION,
            RECORDING,
            WORLD,
            ENSEMBLE,
            CHECKPOINT,
        )  # the digest of another version may be another
        if not other and header["digest"] != digest(header, arrays):
            raise ValueError("it was changed after it was written")
        return assemble(header, arrays)
    except OSError as error:
        raise FileFormatError(f"path={str(path)!r} cannot be read: {error.strerror or error}.") from None
    except _FOREIGN as error:
        # NumPy takes every file that is not its own for a pickle, and advises to load it.
        pickle = isinstance(error, ValueError) and "pickle" in str(error)
        reason = "not an npz file of plain arrays" if pickle else f"{type(error).__name__}: {error}"
        raise FileFormatError(
            f"path={str(path)!r} is not {what} ({reason}); give a file that {writer} wrote."
        ) from None


def format_of(path: str | Path) -> str:
    """Return the format that a file names; an empty text if it names none or cannot be read."""
    with suppress(OSError, *_FOREIGN), opened(path) as handle, np.load(handle, allow_pickle=False) as file:
        return str(json.loads(str(file[_HEADER]))["format"])
    return ""


def _is_swollen(file: BinaryIO) -> bool:
    """Whether an archive would take far more memory than its size on disk, as decompression bombs do; close the file."""
    with file, suppress(*_FOREIGN), zipfile.ZipFile(file) as members:
        size = sum(member.file_size for member in members.infolist())
        return size > max(_LARGE, _MOST_TIMES * os.fstat(file.fileno()).st_size)
    return False


def digest(header: Mapping[str, Any], arrays: Arrays) -> str:
    """Return the SHA-256 of a header, without its digest, and arrays."""
    known = hashlib.sha256(json.dumps({k: v for k, v in header.items() if k != "digest"}, sort_keys=True).encode())
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        known.update(f"{name} {array.dtype.str} {array.shape}".encode())
        known.update(array.tobytes())
    return known.hexdigest()
