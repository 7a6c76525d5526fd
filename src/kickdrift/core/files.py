"""Reading and writing of files named by users: only regular files are opened, and files are written whole or not at all."""

import errno
import os
import stat
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from kickdrift.core.errors import ArgumentError

_NO_FILE = "it is a pipe, a socket or a device, not a regular file"


def path_of(path: str | Path, example: str) -> Path:
    """Return the path of a file to be written, given as text or as a path.

    Raises
    ------
    ArgumentError
        For anything else, which `example` shows how to name.
    """
    if not isinstance(path, str | os.PathLike):
        raise ArgumentError(f"path={path!r} is not a path; give a string such as {example!r}, or a pathlib.Path.")
    return Path(path)


def opened(path: str | Path) -> BinaryIO:
    """Open a file to be read.

    Raises
    ------
    OSError
        If it cannot be read, or is not a regular file: reading a pipe could wait for ever, and a device has no end.
    """
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    try:
        _check_file(os.fstat(descriptor).st_mode)
    except OSError:
        os.close(descriptor)
        raise
    return os.fdopen(descriptor, "rb")


@contextmanager
def written(target: Path) -> Iterator[Path]:
    """Yield an empty temporary file, which replaces `target` at the end and takes its mode; after an error it is removed.

    It is in the same folder, under a random name with the same suffix.

    Raises
    ------
    OSError
        If no file can be created there, or the path is not a regular file.
    """
    mode = None
    with suppress(FileNotFoundError):
        mode = target.stat().st_mode
        _check_file(mode)
    partial = target.with_name(f".{target.stem[:100]}.{uuid.uuid4().hex}.partial{target.suffix}")
    try:
        os.close(os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        yield partial
        if mode is not None:
            partial.chmod(stat.S_IMODE(mode))
        partial.replace(target)
    except BaseException:
        with suppress(OSError):
            partial.unlink(missing_ok=True)
        raise


def _check_file(mode: int) -> None:
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, _NO_FILE)
