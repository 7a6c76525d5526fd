"""Messages about compilation on standard error: that it goes on, and then how long it took.

They are printed in pipes and notebooks, too: silent waiting looks like a hang.
"""

import sys
import threading
import time
from contextlib import AbstractContextManager, nullcontext
from contextvars import ContextVar

from kickdrift.core.dispatcher import told_of_compiling

_A_MOMENT = 1.0  # s; loading compiled code from disk takes 0.3


def compiling_announced(
    wanted: bool | None = None, what: str = "", seconds: float = 0.0
) -> AbstractContextManager[object]:
    """Announce compilation in a block that takes longer than a moment, unless `wanted` is False.

    Of nested blocks the outermost prints the messages, if they are wanted there.

    Parameters
    ----------
    wanted : bool or None
    what : str
        What will be compiled, if that is known in advance.
    seconds : float
        Estimate of the time that this takes; if it is longer than a moment, it is announced at once.
    """
    around = _around.get()
    wait = _Wait(wanted is not False) if around is None else around
    wait.expect(what, seconds)
    return wait if around is None else nullcontext()


class _Wait:
    """The messages of one block: none, unless something is compiled."""

    def __init__(self, wanted: bool) -> None:
        self._wanted, self._said, self._started = wanted, False, 0.0
        self._timer: threading.Timer | None = None

    def __enter__(self) -> None:
        self._tokens = _around.set(self), told_of_compiling.set(self.begin)

    def __exit__(self, *raised: object) -> None:
        around, told = self._tokens
        told_of_compiling.reset(told)
        _around.reset(around)
        self.end()

    def expect(self, what: str, seconds: float) -> None:
        """Announce something that is expected to take some time."""
        if seconds > _A_MOMENT:
            self._begin()
            self._say(f"compiling {what} once on this machine, about {seconds:.0f} s ...")

    def begin(self) -> None:
        """Note that compilation has begun; announce it if it takes longer than a moment."""
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
