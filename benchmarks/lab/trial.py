"""What a row of the lab is: a scene or a family of scenes, how long it runs, and what it is judged by."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched

Measure = Callable[[Scene, Watched], float]


@dataclass(frozen=True)
class Criterion:
    """A number of a run, and where it has to lie; the same for all engines.

    Attributes
    ----------
    label, unit : str
        As they are printed.
    measure : callable
        Of a scene and what was watched.
    least, most : float
        Bounds; none make it information.
    exact : float, optional
        Value that mechanics gives, within the bounds.
    """

    label: str
    unit: str
    measure: Measure
    least: float = -np.inf
    most: float = np.inf
    exact: float | None = None

    def holds(self, value: float) -> bool:
        """Whether a value lies within the bounds, or is unknown (nan): what has no means to measure it does not judge."""
        return bool(np.isnan(value)) or self.least <= value <= self.most

    @property
    def wanted(self) -> str:
        """What is wanted, in words."""
        if self.exact is not None:
            part = 100 * (self.most - self.least) / 2 / abs(self.exact)
            return f"{self.label} {_short(self.exact, 4)} {self.unit}".rstrip() + f" ± {part:.2g} %"
        if np.isinf(self.most):
            return f"{self.label} >= {_short(self.least)} {self.unit}".rstrip() if np.isfinite(self.least) else ""
        return f"{self.label} <= {_short(self.most)} {self.unit}".rstrip()

    def said(self, value: float) -> str:
        """Print a value; one out of bounds in bold."""
        text = f"{self.label} {_short(value, 2 if self.exact is None else 4)} {self.unit}".rstrip()
        return text if self.holds(value) else f"**{text}**"


def _short(value: float, digits: int = 2) -> str:
    size = abs(value)
    if 0 < size < 1e-3 or 1e4 <= size < np.inf:
        return f"{value:.0e}"
    return f"{value:.0f}" if 100 <= size < np.inf else f"{value:.{digits}g}"


@dataclass(frozen=True)
class Trial:
    """A row.

    Attributes
    ----------
    name : str
    scenes : tuple of Scene
        All have to hold; what is printed is the worst of them.
    duration : float
        s.
    criteria : tuple of Criterion
    looks : int
        How often the run is looked at.
    quick : bool
        Whether the tests run it, too.
    refusable : bool
        Whether an error that says why it cannot be done holds, too: of steps too long for what turns that fast.
    """

    name: str
    scenes: tuple[Scene, ...]
    duration: float
    criteria: tuple[Criterion, ...]
    looks: int = 40
    quick: bool = True
    refusable: bool = False
