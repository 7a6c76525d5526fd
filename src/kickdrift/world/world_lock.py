"""Atomic operations on a world: in one thread at a time, and never left half done by Ctrl-C."""

import functools
from collections.abc import Callable
from typing import Any, TypeVar, cast

from kickdrift.core.interruption import InterruptionNoted

M = TypeVar("M", bound=Callable[..., Any])  # a method of a class whose `tables` are those of its world


def alone(method: M) -> M:
    """Make a method hold the world's lock; cheap enough for calls made thousands of times a second."""

    @functools.wraps(method)
    def done(self: Any, *args: Any, **kwargs: Any) -> Any:
        with self.tables.lock:
            return method(self, *args, **kwargs)

    return cast(M, done)


def undivided(method: M) -> M:
    """Make a method hold the world's lock and defer Ctrl-C until it has returned, which costs some microseconds."""

    @functools.wraps(method)
    def done(self: Any, *args: Any, **kwargs: Any) -> Any:
        with self.tables.lock, InterruptionNoted(passed_on=True):
            return method(self, *args, **kwargs)

    return cast(M, done)
