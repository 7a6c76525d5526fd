"""What is said of compiling on standard error: that one waits for it, and then how long it took.

It is said in pipes and notebooks, too: a wait without a word looks like a hang.
"""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from kickdrift.core.dispatcher import told_of_compiling

_A_MOMENT = 1.0  # seconds; what is found compiled on disk is read in 0.3


@contextmanager
def compiling_announced(wanted: bool | None = None, what: str = "", seconds: float = 0.0) -> Iterator[None]:
    """Announce the compiling in a block that takes longer than a moment, unless that is not wanted (False).

    Of blocks in each other the outermost speaks, and only if it is wanted there.

    Parameters
    ----------
    wanted : bool or None
    what : str
        What will be compiled in any case, if that is known.
    seconds : float
        About how long that takes; if it is longer than a moment, that is said at once.
    """
    around = _around.get()
    if around is not None:
        around.expect(what, seconds)
        yield
        return
    wait = _Wait(wanted is not False)
    token = _around.set(wait)
    try:
        with told_of_compiling(wait.begin):
            wait.expect(what, seconds)
            yield
    finally:
        _around.reset(token)
        wait.end()


class _Wait:
    """What is said of one wait: nothing, unless there is something to compile."""

    def __init__(self, wanted: bool) -> None:
        self._wanted, self._said, self._started = wanted, False, 0.0
        self._timer: threading.Timer | None = None

    def expect(self, what: str, seconds: float) -> None:
        """Note that something will take so long."""
        if seconds > _A_MOMENT:
            self._begin()
            self._say(f"compiling {what} once on this machine, about {seconds:.0f} s ...")

    def begin(self) -> None:
        """Note that something is compiled."""
        if self._wanted and self._timer is None:
            self._begin()
            self._timer = threading.Timer(_A_MOMENT, self._say, ["compiling; this takes some seconds ..."])
            self._timer.daemon = True
            self._timer.start()

    def end(self) -> None:
        """Print how long it took, if anything was printed."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer.join()
        if self._said:
            _print(f"compiled in {time.perf_counter() - self._started:.1f} s.")

    def _begin(self) -> None:
        self._started = self._started or time.perf_counter()

    def _say(self, sentence: str) -> None:
        if self._wanted and not self._said:
            self._said = True
            _print(sentence)


_around: ContextVar[_Wait | None] = ContextVar("_around", default=None)


def _print(sentence: str) -> None:
    print(f"kickdrift: {sentence}", file=sys.stderr, flush=True)
