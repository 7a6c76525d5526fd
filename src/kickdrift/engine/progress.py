"""How far a run is, on standard error while it goes."""

import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

_SHORT_RUN_SECONDS = 2.0  # runs expected to be shorter show no bar


class Bar:
    """A progress bar: always, never, or (None) on a terminal and in a notebook once a run turns out to be long.

    Within `told_of_steps` there is none, and another is told instead.
    """

    def __init__(self, n_steps: int, wanted: bool | None, unit: str = "step") -> None:
        self._n_steps, self._unit, self._tell = n_steps, unit, _told.get()
        self._possible = (sys.stderr.isatty() or _in_notebook() if wanted is None else wanted) and self._tell is None
        self._from_seconds = 0.0 if wanted else _SHORT_RUN_SECONDS
        self._bar: Any = None

    def show(self, step: int, seconds: float) -> None:
        """Show that `step` steps took so many seconds."""
        if self._tell is not None:
            self._tell(step)
        if self._possible and self._bar is None and seconds * self._n_steps / step > self._from_seconds:
            self._bar = _tqdm()(total=self._n_steps, unit=self._unit, unit_scale=True, leave=False, file=sys.stderr)
        if self._bar is not None:
            self._bar.update(step - self._bar.n)

    def close(self) -> None:
        """Take the bar away."""
        if self._bar is not None:
            self._bar.close()


def _in_notebook() -> bool:
    """Whether a kernel of Jupyter runs this."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return getattr(shell, "kernel", None) is not None


def _tqdm() -> Any:
    """Return tqdm, as a widget in a notebook that has widgets."""
    if _in_notebook():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of widgets that are not installed: then it is a line of text
            from tqdm.auto import tqdm as automatic

            return automatic
    from tqdm import tqdm  # 10 ms

    return tqdm


_told: ContextVar[Callable[[int], None] | None] = ContextVar("_told", default=None)


@contextmanager
def told_of_steps(tell: Callable[[int], None]) -> Iterator[None]:
    """Have a function called with the steps that a run has done so far; a KeyboardInterrupt from it interrupts the run."""
    before = _told.set(tell)
    try:
        yield
    finally:
        _told.reset(before)
