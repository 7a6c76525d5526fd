"""Values of event functions after steps that tell that zeros cannot be found: NaN, and those that refute a bound."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import KickdriftError
from kickdrift.engine.event_functions import Event
from kickdrift.engine.quantities import evaluate_quantity
from kickdrift.engine.zeros import too_fast
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]
Raised = dict[int, Exception]  # errors of a function, by the rows at which it raised them
# Zeros, and zeros a step: a function that oscillates within steps changes its sign in half of them.
_MANY, _OFTEN = 20, 0.4


def values_of(quantity: Quantity, system: System, t: Floats, x: Floats, v: Floats, raised: Raised) -> Floats:
    """Evaluate a function of the state; where it raises, its value is NaN, and of a compiled one all later values are."""
    try:
        return evaluate_quantity(quantity, system, t, x, v, raised=raised)
    except Exception:  # compiled code does not tell at which state
        values = np.full(t.size, np.nan)
        for row in range(t.size):
            at = slice(row, row + 1)
            try:
                values[at] = evaluate_quantity(quantity, system, t[at], x[at], v[at])
            except Exception as error:
                raised[row] = error
                break
        return values


def check_numbers(event: Event, t: Floats, values: Floats, raised: Raised) -> None:
    """Refuse values that are NaN.

    Raises
    ------
    KickdriftError
    """
    if (bad := np.isnan(values)).any():
        row = int(np.argmax(bad))
        raise KickdriftError(_cause_of_nan(event, float(t[row]), raised.get(row)))


def _cause_of_nan(event: Event, t: float, error: Exception | None) -> str:
    """Tell what an event did at a time at which its value is NaN: raise an error, or return NaN."""
    if error is None:
        return f"{event.name}, returned NaN at t={t!r}"
    return f"{event.name}, raised {type(error).__name__} at t={t!r}" + (f": {error}" if str(error) else "")


def first_bad(
    events: Sequence[Event], t: Floats, values: Sequence[Floats], raised: Sequence[Raised], jumps: bool
) -> tuple[int | None, str]:
    """Return the first row at which a value is NaN, or refutes the bound of its rate, and a sentence on it.

    Where impacts change velocities at once (`jumps`), no bound holds.
    """
    found: int | None = None
    why = ""
    for event, value, errors in zip(events, values, raised, strict=True):
        if event.rate_bound is None and not np.isnan(value.min()):  # NaN if any value is
            continue
        nan = np.isnan(value)
        bad = nan.copy()
        if event.rate_bound is not None and not jumps:
            bad[1:] |= too_fast(t, value, event.rate_bound)
        if bad.any() and (found is None or int(np.argmax(bad)) < found):
            found = int(np.argmax(bad))
            if nan[found]:
                why = f" {_cause_of_nan(event, float(t[found]), errors.get(found))}."
            else:
                why = (
                    f" {event.name}, changes by {abs(value[found] - value[found - 1]):.3g} in the step of"
                    f" {abs(t[found] - t[found - 1]):.3g} to t={float(t[found])!r}, faster than its"
                    f" rate_bound={event.rate_bound!r}; give a larger one."
                )
    return found, why


def chattering(events: Sequence[Event], counts: Sequence[int], n_steps: int) -> str:
    """Return a sentence on events that change their sign so often that zeros between steps may have been missed."""
    said = ""
    for event, count in zip(events, counts, strict=True):
        if event.rate_bound is None and count >= _MANY and count > _OFTEN * n_steps:
            said += (
                f" {event.name}, changed its sign in {count} of {n_steps} steps: it may have chattered, and zeros within the"
                " same step are missed; take smaller steps, or give it a rate_bound."
            )
    return said
