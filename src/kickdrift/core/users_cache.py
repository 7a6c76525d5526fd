"""Compiled code of users' functions on disk: in one folder, the files used last.

A script, a notebook and a command line may each have a function of the same name, so that none is older than another.
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

_MOST_FILES = 1000  # of 20 to 200 kB each
_DAY = 86400.0


class UsersCache(Cache):
    """What `kickdrift.core.cache.Cache` is to functions of kickdrift; the key tells what the function is made of."""

    @cached_property
    def _method(self) -> Any:
        """How results are packed, and where they go: beside the code of kickdrift's own functions."""
        try:
            return CompileResultCacheImpl(_beside)
        except RuntimeError:
            return None

    @property
    def cache_path(self) -> str | None:
        """The folder."""
        return None if self._method is None else str(Path(self._method.locator.get_cache_path()) / "users")

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Return what was compiled for a signature, or None; note that it was of use."""
        result = super().load_overload(signature, target)
        if result is not None:
            file = self._file(signature, target)
            with suppress(OSError):
                if time.time() - file.stat().st_mtime > _DAY:
                    os.utime(file)
        return result

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep what was compiled, unless it has addresses of this process in it."""
        if not result.library.has_dynamic_globals:
            super().save_overload(signature, result)

    def _file(self, signature: Any, target: Any) -> Path:
        use = (repr(signature), written(self._options), machine(target), sys.implementation.cache_tag, np.__version__)
        return Path(str(self.cache_path)) / f"{digest(self._function.__qualname__)}-{self._kind}-{digest(use)}.nbc"

    def _make_room(self, file: Path) -> None:
        """Remove the files that have been of no use for the longest time."""
        files = sorted(file.parent.glob("*.nbc"), key=lambda other: other.stat().st_mtime)
        for unused in files[: max(0, len(files) - _MOST_FILES)]:
            unused.unlink()


def _beside() -> None:
    """Lie in the folder beside which users' functions are kept."""
