"""Locks for folders that only one run at a time may use; the system releases them when the process ends, however it ends."""

import errno
import os
import socket
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import Self

_LOCKED = {errno.EACCES, errno.EAGAIN, errno.EDEADLK}
_FAR = 1 << 30  # the byte that is locked: beyond the text, since Windows would forbid others to read it


class LockedError(Exception):
    """The lock is already held; the message names the holder."""


class FileLock:
    """A lock on a file, which is created for it and removed afterwards.

    It is the system's lock of a process: forked children do not inherit it, and a process that is killed loses it, though the
    file stays. Threads of one process exclude each other here. Where no file can be created, or the file system has no locks,
    nothing is locked.

    Raises
    ------
    LockedError
        If another process, or another thread of this one, holds it.
    """

    def __init__(self, path: Path) -> None:
        self._path, self._key = path, (os.getpid(), str(path.resolve()))
        with _changing:
            if self._key in _held:
                raise LockedError("this process")
            self._descriptor = _locked(path)
            _held.add(self._key)

    def release(self) -> None:
        """Release it."""
        with _changing:
            if self._key not in _held:
                return
            _held.discard(self._key)
            if self._descriptor is not None:
                with suppress(OSError):
                    self._path.unlink()
                os.close(self._descriptor)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()


_held: set[tuple[int, str]] = set()  # process and file: a fork copies this set, but not the locks
_changing = threading.Lock()


def _locked(path: Path) -> int | None:
    """Return the descriptor of the locked file; None where there are no locks."""
    while True:
        try:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0), 0o666)
        except OSError:
            return None
        try:
            _lock(descriptor)
        except OSError as error:
            holder = os.read(descriptor, 200).decode(errors="replace").strip()
            os.close(descriptor)
            if error.errno in _LOCKED:
                raise LockedError(holder or "another process") from None
            return None
        if _is_still(path, descriptor):
            with suppress(OSError):  # a full disk
                os.ftruncate(descriptor, 0)
                os.write(descriptor, f"process {os.getpid()} on {socket.gethostname()}".encode())
            return descriptor
        os.close(descriptor)  # the holder has removed it meanwhile


def _is_still(path: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except OSError:
        return False


if sys.platform == "win32":
    import msvcrt

    def _lock(descriptor: int) -> None:
        os.lseek(descriptor, _FAR, os.SEEK_SET)
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        os.lseek(descriptor, 0, os.SEEK_SET)

else:
    import fcntl

    def _lock(descriptor: int) -> None:
        fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, _FAR)
