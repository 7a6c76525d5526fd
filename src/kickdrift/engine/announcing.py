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


def compiling_announced(wanted: bool | None = None, what: str = "") -> AbstractContextManager[object]:
    """Announce compilation in a block that takes longer than a moment, unless `wanted` is False.

    Of nested blocks the outermost prints the messages, if they are wanted there.

    Parameters
    ----------
    wanted : bool or None
    what : str
        What will be compiled, if that is known in advance. How long it takes is not: an estimate by the size of the code was
        a fifth of what a busy machine took.
    """
    around = _around.get()
    wait = _Wait(wanted is not False) if around is None else around
    if what:
        wait.begin(what)
    return wait if around is None else nullcontext()


class _Wait:
    """The messages of one block: none, unless something is compiled."""

    def __init__(self, wanted: bool) -> None:
        self._wanted, self._said, self._started, self._what = wanted, False, 0.0, ""
        self._timer: threading.Timer | None = None

    def __enter__(self) -> None:
        self._tokens = _around.set(self), told_of_compiling.set(self.begin)

    def __exit__(self, *raised: object) -> None:
        around, told = self._tokens
        told_of_compiling.reset(told)
        _around.reset(around)
        self.end()

    def begin(self, what: str = "") -> None:
        """Note that compilation has begun, and of what; announce it if it takes longer than a moment."""
        self._what = self._what or what
        if self._wanted and self._timer is None:
            self._started = time.perf_counter()
            self._timer = threading.Timer(_A_MOMENT, self._say)
            self._timer.daemon = True
            self._timer.start()

    def end(self) -> None:
        """Print how long it took, if anything was printed."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer.join()
        if self._said:
            _print(f"compiled in {time.perf_counter() - self._started:.1f} s.")

    def _say(self) -> None:
        self._said = True
        _print(
            f"compiling {self._what} once on this machine ..."
            if self._what
            else "compiling; this takes a few seconds ..."
        )


_around: ContextVar[_Wait | None] = ContextVar("_around", default=None)


def _print(sentence: str) -> None:
    print(f"kickdrift: {sentence}", file=sys.stderr, flush=True)
