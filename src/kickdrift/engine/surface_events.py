"""Events of a run with impacts, where velocities jump, and gaps reach zero and grow again.

A function is also evaluated just before an impact. Up to there it changes as in any other step; from there to the state after
the impact it jumps. Where bodies touch, a function that is zero up to the rounding of the state counts as zero: a closed gap
is -1e-17 as often as 1e-17.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.flows.surfaces import TOUCHES
from kickdrift.engine.quantities import evaluate_quantity
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]
Ask = Callable[[Floats, Floats, Floats], Floats]  # values of a function at times and states, (T,)

_VELOCITIES = 1e-10  # of their largest: they are led along gradients that are differences, good to 1e-12 or so
_MOMENTS = 1e-3  # of a size in a step: a velocity that is small beside it


class Surfaces(NamedTuple):
    """The gaps of a run with impacts, the first `of_impacts` of a function's, and the size of x for roundings.

    And whether impacts are located, in steps of equal sizes apart from these.
    """

    gaps: Quantity
    of_impacts: int
    length: float
    step: float
    located: bool

    def touched(self, system: System, t: Floats, x: Floats, v: Floats) -> NDArray[np.bool_]:
        """Return the states in which a gap is closed."""
        gaps = evaluate_quantity(self.gaps, system, t, x, v).reshape(t.size, -1)[:, : self.of_impacts]
        return np.asarray((np.abs(gaps) <= TOUCHES * self._sizes(x)[:, None]).any(axis=1))

    def struck(self, t: Floats, touched: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return which steps between times may end with an impact."""
        cut = np.abs(np.abs(np.diff(t)) - abs(self.step)) > 1e-9 * abs(self.step)
        return np.asarray(touched[1:] & (~touched[:-1] | cut | (not self.located)))

    def rounded(self, ask: Ask, values: Floats, t: Floats, x: Floats, v: Floats) -> Floats:
        """Return values of a function, with 0.0 for those that are zero within the rounding of x or v."""
        if not t.size:
            return values
        of_x, rounding = TOUCHES * self._sizes(x), np.zeros(t.size)
        of_v = _VELOCITIES * np.abs(v.reshape(t.size, -1)).max(axis=1) + TOUCHES * _MOMENTS * self._sizes(x) / abs(
            self.step
        )
        for which, size in ((0, of_x), (1, of_v)):
            for i in range((x, v)[which].reshape(t.size, -1).shape[1]):
                states = [x.copy(), v.copy()]
                states[which].reshape(t.size, -1)[:, i] += size
                rounding = np.maximum(rounding, np.abs(ask(t, *states) - values))
        return np.where(np.abs(values) <= rounding, 0.0, values)

    def _sizes(self, x: Floats) -> Floats:
        sizes: Floats = np.maximum(np.abs(x.reshape(len(x), -1)).max(axis=1), self.length)
        return sizes
