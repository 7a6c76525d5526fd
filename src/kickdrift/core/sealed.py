"""Files of compiled code, which run as they are: read only if they are whole, and no one else could have written them."""

import hashlib
import os
import stat
from functools import lru_cache
from pathlib import Path

from kickdrift.core import files

_SEAL = hashlib.sha256().digest_size  # bytes, before all others
_OTHERS = stat.S_IWGRP | stat.S_IWOTH


def read(path: Path) -> bytes:
    """Read what `write` has written.

    Raises
    ------
    OSError
        If it cannot be read, or others than this user, root and who has the sources of kickdrift own it or its folder, or can
        write to them.
    ValueError
        If it is not what was written.
    """
    if not (_is_safe(path.parent) and _is_safe(path)):
        raise PermissionError(f"{path} or its folder could have been written by others.")
    with files.opened(path) as file:
        content = file.read()
    if hashlib.sha256(content[_SEAL:]).digest() != content[:_SEAL]:
        raise ValueError(f"{path} is damaged.")
    return content[_SEAL:]


def write(path: Path, content: bytes) -> None:
    """Write a file that nobody else can change, in a folder that is so too; OSError if that cannot be."""
    path.parent.mkdir(parents=True, exist_ok=True)
    _close(path.parent)
    if path.exists():
        _close(path)  # whose mode the new one takes
    with files.written(path) as unfinished:
        unfinished.write_bytes(hashlib.sha256(content).digest() + content)
        _close(unfinished)


def _close(path: Path) -> None:
    """Forbid others to write there: many systems let a user's group."""
    mode = path.stat().st_mode
    if os.name == "posix" and mode & _OTHERS:
        path.chmod(stat.S_IMODE(mode) & ~_OTHERS)


def _is_safe(path: Path) -> bool:
    if os.name != "posix":
        return True  # folders of users are theirs alone
    found = path.stat()
    return found.st_uid in _trusted() and not found.st_mode & _OTHERS


@lru_cache
def _trusted() -> frozenset[int]:
    """Users who could change what this one runs in any case."""
    return frozenset((os.geteuid(), 0, os.stat(__file__).st_uid))
