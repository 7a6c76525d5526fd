"""Progress of a run, shown on standard error."""

import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

_SHORT_RUN_SECONDS = 2.0  # runs expected to be shorter show no bar
_JUDGED_AFTER = 0.1  # s: the first step alone may take as long as ten thousand later ones
_MANY = 10_000  # from which steps are counted in thousands and millions; fewer would be "3.00/51.0"


class Bar:
    """A progress bar: always, never, or (None) on a terminal and in a notebook if a run is expected to be long.

    Within `told_of_steps` there is none, and the function given there is called instead. Where steps are not `alike`, it does
    not show how long the remaining ones will take.
    """

    def __init__(self, n_steps: int, wanted: bool | None, unit: str = "step", alike: bool = True) -> None:
        self._n_steps, self._unit, self._tell = n_steps, unit, _told.get()
        self._format = None if alike else "{l_bar}{bar}| {n_fmt}/{total_fmt} {unit}s [{elapsed}]"
        self._possible = (sys.stderr.isatty() or _in_notebook() if wanted is None else wanted) and self._tell is None
        self._from_seconds = 0.0 if wanted else _SHORT_RUN_SECONDS
        self._bar: Any = None

    def show(self, step: int, seconds: float) -> None:
        """Show the number of steps done, and the seconds that they took."""
        if self._tell is not None:
            self._tell(step)
        late_enough = seconds > min(_JUDGED_AFTER, self._from_seconds)
        if self._possible and self._bar is None and late_enough and seconds * self._n_steps / step > self._from_seconds:
            many = self._n_steps >= _MANY
            shown = {"unit": self._unit, "unit_scale": many, "bar_format": self._format}
            self._bar = _tqdm()(total=self._n_steps, leave=False, file=sys.stderr, **shown)
        if self._bar is not None:
            self._bar.update(step - self._bar.n)

    def close(self) -> None:
        """Remove the bar."""
        if self._bar is not None:
            self._bar.close()


def _in_notebook() -> bool:
    """Whether this runs in a Jupyter kernel."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return getattr(shell, "kernel", None) is not None


def _tqdm() -> Any:
    """Return tqdm, which is a widget in notebooks that have widgets."""
    if _in_notebook():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # tqdm warns if widgets are not installed, and prints a line of text
            from tqdm.auto import tqdm as automatic

            return automatic
    from tqdm import tqdm  # takes 10 ms

    return tqdm


_told: ContextVar[Callable[[int], None] | None] = ContextVar("_told", default=None)


@contextmanager
def told_of_steps(tell: Callable[[int], None]) -> Iterator[None]:
    """Call a function with the number of steps done so far; a KeyboardInterrupt from it interrupts the run."""
    before = _told.set(tell)
    try:
        yield
    finally:
        _told.reset(before)
