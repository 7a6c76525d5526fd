"""Compiled code of users' functions on disk: one folder, in which the most recently used files are kept.

A script, a notebook and a command line may each have a function of the same name, so that none replaces another.
"""

import os
import sys
import time
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numba.core.caching import CompileResultCacheImpl

from kickdrift.core.cache import Cache, machine, written
from kickdrift.core.naming import digest

_MOST_FILES = 5000  # of 14 kB on average
_DAY = 86400.0


class UsersCache(Cache):
    """The cache of a user's function; its name is the key of everything that the function is made of."""

    @cached_property
    def _method(self) -> Any:
        """Numba's serialiser, with the folder beside that of kickdrift's own functions."""
        try:
            return CompileResultCacheImpl(_beside)
        except RuntimeError:
            return None

    @property
    def cache_path(self) -> str | None:
        """The folder."""
        return None if self._method is None else str(Path(self._method.locator.get_cache_path()) / "users")

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Return the compiled code for a signature, or None, and mark the file as used."""
        result = super().load_overload(signature, target)
        if result is not None:
            file = self._file(signature, target)
            with suppress(OSError):
                if time.time() - file.stat().st_mtime > _DAY:
                    os.utime(file)
        return result

    def save_overload(self, signature: Any, result: Any) -> None:
        """Save compiled code, unless it contains addresses of this process."""
        if not result.library.has_dynamic_globals:
            super().save_overload(signature, result)

    def _file(self, signature: Any, target: Any) -> Path:
        use = (repr(signature), written(self._options), machine(target), sys.implementation.cache_tag, np.__version__)
        return Path(str(self.cache_path)) / f"{digest(self._function.__qualname__)}-{self._kind}-{digest(use)}.nbc"

    def _make_room(self, file: Path) -> None:
        """Remove the least recently used files."""
        # Names of a thousand files take 0.6 ms, their times 9.
        excess = sum(name.endswith(".nbc") for name in os.listdir(file.parent)) - _MOST_FILES
        if excess > 0:
            files = sorted(file.parent.glob("*.nbc"), key=lambda other: other.stat().st_mtime)
            for unused in files[:excess]:
                unused.unlink()


def _beside() -> None:
    """Locate the cache folder of kickdrift's own functions, by being one of them."""
