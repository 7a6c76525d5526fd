"""Files of compiled code, which is executed as it is: read only if intact, and if no other user could have written them."""

import hashlib
import os
import stat
from functools import lru_cache
from pathlib import Path

from kickdrift.core import files

_SEAL = hashlib.sha256().digest_size  # bytes, before all others
_OTHERS = stat.S_IWGRP | stat.S_IWOTH


def read(path: Path) -> bytes:
    """Read a file written by `write`.

    Raises
    ------
    OSError
        If it cannot be read; if its owner, or that of its folder, is not this user, root or the owner of kickdrift's sources;
        or if others can write to them.
    ValueError
        If it is damaged.
    """
    if not (_is_safe(path.parent) and _is_safe(path)):
        raise PermissionError(f"{path} or its folder could have been written by others.")
    with files.opened(path) as file:
        content = file.read()
    if hashlib.sha256(content[_SEAL:]).digest() != content[:_SEAL]:
        raise ValueError(f"{path} is damaged.")
    return content[_SEAL:]


def write(path: Path, content: bytes) -> None:
    """Write a file that no other user can change, nor its folder; OSError if that is impossible."""
    path.parent.mkdir(parents=True, exist_ok=True)
    _close(path.parent)
    if path.exists():
        _close(path)  # the new file takes its mode
    with files.written(path) as unfinished:
        unfinished.write_bytes(hashlib.sha256(content).digest() + content)
        _close(unfinished)


def _close(path: Path) -> None:
    """Forbid others to write there: many systems allow a user's group."""
    mode = path.stat().st_mode
    if os.name == "posix" and mode & _OTHERS:
        path.chmod(stat.S_IMODE(mode) & ~_OTHERS)


def _is_safe(path: Path) -> bool:
    if os.name != "posix":
        return True  # folders of users are private
    found = path.stat()
    return found.st_uid in _trusted() and not found.st_mode & _OTHERS


@lru_cache
def _trusted() -> frozenset[int]:
    """Users who could change the code that this user runs in any case."""
    return frozenset((os.geteuid(), 0, os.stat(__file__).st_uid))
