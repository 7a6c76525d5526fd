"""Values of event functions after steps that tell that zeros cannot be found: NaN, and those that refute a bound."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.event_functions import Event
from kickdrift.engine.zeros import too_fast

Floats = NDArray[np.float64]


def first_bad(events: Sequence[Event], t: Floats, values: Sequence[Floats], jumps: bool) -> tuple[int | None, str]:
    """Return the first row at which a value is NaN, or refutes the bound of its rate, and a sentence on it.

    Where impacts change velocities at once (`jumps`), no bound holds.
    """
    found: int | None = None
    why = ""
    for event, value in zip(events, values, strict=True):
        nan = np.isnan(value)
        bad = nan.copy()
        if event.rate_bound is not None and not jumps:
            bad[1:] |= too_fast(t, value, event.rate_bound)
        if bad.any() and (found is None or int(np.argmax(bad)) < found):
            found = int(np.argmax(bad))
            now = f"t={float(t[found])!r}"
            why = f" {event.name}, returned NaN at {now}."
            if not nan[found]:
                why = (
                    f" {event.name}, changes by {abs(value[found] - value[found - 1]):.3g} in the step of"
                    f" {abs(t[found] - t[found - 1]):.3g} to {now}, faster than its rate_bound={event.rate_bound!r};"
                    " give a larger one."
                )
    return found, why
