"""Values of event functions after steps that tell that zeros cannot be found: NaN, and those that refute a bound."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.calls import call_interpreted
from kickdrift.engine.event_functions import Event
from kickdrift.engine.quantities import evaluate_quantity
from kickdrift.engine.zeros import too_fast
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]


def values_of(quantity: Quantity, system: System, t: Floats, x: Floats, v: Floats) -> Floats:
    """Evaluate a function of the state; where it raises, its value is NaN, and of a compiled one all later values are."""
    try:
        return evaluate_quantity(quantity, system, t, x, v)
    except Exception:  # compiled code does not tell at which state
        values = np.full(t.size, np.nan)
        for row in range(t.size):
            try:
                values[row] = evaluate_quantity(quantity, system, *(each[row : row + 1] for each in (t, x, v)))[0]
            except Exception:
                break
        return values


def cause_of_nan(event: Event, system: System, row: int, t: Floats, x: Floats, v: Floats) -> str:
    """Tell what an event does at a row at which its value is NaN: raise an error, or return NaN."""
    at, quantity = f"at t={float(t[row])!r}", event.quantity
    try:
        if hasattr(quantity.function, "py_func"):
            evaluate_quantity(quantity, system, *(each[row : row + 1] for each in (t, x, v)))
        else:
            params = system.params if quantity.params is None else quantity.params
            with np.errstate(all="ignore"):
                call_interpreted(
                    quantity.function, (t[row], x[row].reshape(-1), v[row].reshape(-1), params, np.zeros(1))
                )
    except Exception as error:
        return f"{event.name}, raised {type(error).__name__} {at}" + (f": {error}" if str(error) else "")
    return f"{event.name}, returned NaN {at}"


def first_bad(
    events: Sequence[Event], system: System, t: Floats, x: Floats, v: Floats, values: Sequence[Floats], jumps: bool
) -> tuple[int | None, str]:
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
            if nan[found]:
                why = f" {cause_of_nan(event, system, found, t, x, v)}."
            else:
                why = (
                    f" {event.name}, changes by {abs(value[found] - value[found - 1]):.3g} in the step of"
                    f" {abs(t[found] - t[found - 1]):.3g} to t={float(t[found])!r}, faster than its"
                    f" rate_bound={event.rate_bound!r}; give a larger one."
                )
    return found, why
