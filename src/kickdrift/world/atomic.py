"""What is done to a world as a whole: by one thread at a time, and not left half done by Ctrl-C."""

import functools
from collections.abc import Callable
from typing import Any, TypeVar, cast

from kickdrift.core.interruption import InterruptionNoted

M = TypeVar("M", bound=Callable[..., Any])  # a method of what has `tables`, those of its world


def alone(method: M) -> M:
    """Make a method wait until no other thread uses the world: for calls made thousands of times a second."""

    @functools.wraps(method)
    def done(self: Any, *args: Any, **kwargs: Any) -> Any:
        with self.tables.lock:
            return method(self, *args, **kwargs)

    return cast(M, done)


def undivided(method: M) -> M:
    """Make a method, besides, end before Ctrl-C counts, which takes some microseconds."""

    @functools.wraps(method)
    def done(self: Any, *args: Any, **kwargs: Any) -> Any:
        with self.tables.lock, InterruptionNoted(passed_on=True):
            return method(self, *args, **kwargs)

    return cast(M, done)
