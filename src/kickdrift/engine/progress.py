"""What a run says on standard error while it goes: that it compiles, and how far it is."""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from tqdm import tqdm

from kickdrift.core.dispatcher import told_of_compiling

_SHORT_RUN_SECONDS = 2.0  # runs expected to be shorter show no bar


class Bar:
    """A progress bar: always, never, or (None) on a terminal once a run turns out to be long."""

    def __init__(self, n_steps: int, wanted: bool | None, unit: str = "step") -> None:
        self._n_steps, self._unit = n_steps, unit
        self._possible = announces(wanted)
        self._from_seconds = 0.0 if wanted else _SHORT_RUN_SECONDS
        self._bar: Any = None

    def show(self, step: int, seconds: float) -> None:
        """Say that `step` steps took so many seconds."""
        if self._possible and self._bar is None and seconds * self._n_steps / step > self._from_seconds:
            self._bar = tqdm(total=self._n_steps, unit=self._unit, unit_scale=True, leave=False, file=sys.stderr)
        if self._bar is not None:
            self._bar.update(step - self._bar.n)

    def close(self) -> None:
        """Take the bar away."""
        if self._bar is not None:
            self._bar.close()


_A_MOMENT = 1.0  # seconds; what is found compiled on disk is read in 0.3


def announces(wanted: bool | None) -> bool:
    """Whether a run says how far it is: as wanted, or where None, on a terminal."""
    return sys.stderr.isatty() if wanted is None else wanted


@contextmanager
def compiling_announced(wanted: bool | None) -> Iterator[None]:
    """Say so where compiling takes longer than a moment, and then how long it took.

    It is said in pipes and notebooks, too: a wait without a word looks like a hang.
    """
    if wanted is False:
        yield
        return
    compiling = _Compiling()
    try:
        with told_of_compiling(compiling.begin):
            yield
    finally:
        compiling.end()


class _Compiling:
    """What is said of compiling: nothing, unless there is something to compile."""

    def __init__(self) -> None:
        self._timer: threading.Timer | None = None
        self._started, self._said = 0.0, False

    def begin(self) -> None:
        """Note that something is compiled."""
        if self._timer is None:
            self._started, self._timer = time.perf_counter(), threading.Timer(_A_MOMENT, self._announce)
            self._timer.daemon = True
            self._timer.start()

    def _announce(self) -> None:
        self._said = True
        print("kickdrift: compiling; it takes some seconds ...", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Say how long it took, if anything was said."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer.join()
        if self._said:
            seconds = time.perf_counter() - self._started
            print(f"kickdrift: compiled in {seconds:.1f} s.", file=sys.stderr, flush=True)


_wanted: ContextVar[bool | None] = ContextVar("_wanted", default=None)


@contextmanager
def announcements(wanted: bool | None) -> Iterator[None]:
    """Have worlds say that they compile, unless that is not wanted (False)."""
    before = _wanted.set(wanted)
    try:
        yield
    finally:
        _wanted.reset(before)


def announce_compiling(what: str, seconds: float) -> None:
    """Say what is compiled now, and about how long that takes, if it is longer than a moment."""
    if seconds > _A_MOMENT and _wanted.get() is not False:
        line = f"kickdrift: compiling {what} once on this machine, about {seconds:.0f} s ..."
        print(line, file=sys.stderr, flush=True)


def is_cached(kernel: Any) -> bool:
    """Whether compiled code of a kernel lies in the cache on disk."""
    folder = kernel.stats.cache_path  # None where Numba finds no folder that it can write to
    return folder is not None and any(Path(folder).glob(f"*{kernel.__name__}*.nbc"))
