"""Deferred handling of Ctrl-C, for operations that must not be left half done."""

import signal
import threading
from types import FrameType
from typing import Any, Self

_CHUNK_SECONDS = 0.1  # how long Ctrl-C waits for compiled code


def next_chunk(steps: int, seconds: float, least: float = 0.0) -> int:
    """Return the number of steps before the next check for Ctrl-C, of at least `least` s, given the time of the last ones."""
    return max(1, min(10 * steps, int(steps * max(_CHUNK_SECONDS, least) / max(seconds, 1e-9))))


class InterruptionNoted:
    """A context in which Ctrl-C is noted instead of raising KeyboardInterrupt.

    Only the main thread receives Ctrl-C: in others nothing is noted, nor where Python does not handle the signal.

    Parameters
    ----------
    passed_on : bool
        Whether the previous handler is called at the end if Ctrl-C was noted. Otherwise only the default handler is replaced,
        and the caller checks `noted`.
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
