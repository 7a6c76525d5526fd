"""Ctrl-C that waits until what must not be left half done is whole."""

import signal
import threading
from types import FrameType
from typing import Any, Self

_CHUNK_SECONDS = 0.1  # how long Ctrl-C waits for compiled code


def next_chunk(steps: int, seconds: float, least: float = 0.0) -> int:
    """Return how many steps to do before Ctrl-C is looked for again, as so many took so long; `least` seconds of them."""
    return max(1, min(10 * steps, int(steps * max(_CHUNK_SECONDS, least) / max(seconds, 1e-9))))


class InterruptionNoted:
    """A context in which Ctrl-C is noted instead of raising KeyboardInterrupt.

    Nothing is noted in other threads than the main one, to which Ctrl-C goes, and where nobody minds it in Python.

    Parameters
    ----------
    passed_on : bool
        Whether what was noted is done at the end: whoever minded Ctrl-C before does so then. Otherwise only the default is
        replaced, and whoever asks for `noted` sees to it.
    """

    def __init__(self, *, passed_on: bool) -> None:
        self.noted = False
        self._passed_on = passed_on
        self._before: Any = None

    def __enter__(self) -> Self:
        if threading.current_thread() is not threading.main_thread():
            return self
        before = signal.getsignal(signal.SIGINT)
        nested = isinstance(getattr(before, "__self__", None), InterruptionNoted)
        if callable(before) and not nested and (self._passed_on or before is signal.default_int_handler):
            self._before = before
            signal.signal(signal.SIGINT, self._note)
        return self

    def __exit__(self, *_: object) -> None:
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)
            if self.noted and self._passed_on:
                self._before(signal.SIGINT, None)

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.noted = True
