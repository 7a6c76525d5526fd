"""Checks that a run does not leave the range of a user's tables, before it starts or continues."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from kickdrift.core.errors import ArgumentError
from kickdrift.engine.controller import Controller
from kickdrift.engine.event_functions import Event
from kickdrift.engine.grid import Course, Grid
from kickdrift.methods import Letter, Method
from kickdrift.systems.spline import OUTSIDE, ranges_used
from kickdrift.systems.system import Quantity, System

# In steps: a density is evaluated half a step before the start; steps by one lead beyond the end, where it is evaluated, too.
_BEFORE, _BEYOND = 0.5, 1.5


@dataclass(frozen=True, eq=False)
class Tables:
    """The functions of a run that may call tables.

    Attributes
    ----------
    system : System
        The system with its initial state.
    functions : tuple of Quantity
    spans : str
        First and last time of the tables.
    method : str
        Name of the table.
    before, beyond : float
        How far before the start and beyond the end the functions are evaluated, in steps.
    """

    system: System
    functions: tuple[Quantity, ...]
    spans: str
    method: str
    before: float
    beyond: float

    def check(self, grid: Grid | Course) -> None:
        """Evaluate the functions at both ends of the times at which a run does.

        Raises
        ------
        ArgumentError
            If a table that they call does not go as far.
        """
        for t in (grid.t0 - self.before * grid.step, grid.t1 + self.beyond * grid.step):
            if any(self._leaves(function, t) for function in self.functions):
                raise ArgumentError(
                    f"t_span=({grid.t0!r}, {grid.t1!r}) extends beyond a table of kd.spline (from {self.spans}):"
                    f" {self.method!r} with step={grid.step!r} evaluates it at t={t!r}; shorten the span, or give a"
                    " longer table."
                )

    def _leaves(self, quantity: Quantity, t: float) -> bool:
        system = self.system
        x, v = system.x0.reshape(-1).copy(), system.v0.reshape(-1).copy()
        params = system.params if quantity.params is None else quantity.params
        try:
            with np.errstate(all="ignore"):
                quantity.function(t, x, v, params.copy(), np.zeros(max(x.size, v.size, quantity.size)))
        except ValueError as error:
            return OUTSIDE in str(error)
        except Exception:
            return False  # another error, which the run reports if it occurs
        return False


def tables_of(
    given: tuple[Any, ...], system: System, method: Method, controller: Controller | None, events: tuple[Event, ...]
) -> Tables | None:
    """Return the tables that the functions `given` call, with these functions; None if there are no tables."""
    if not (ranges := ranges_used(*given)):
        return None
    functions = [Quantity(function) for function in (system.acceleration, system.velocity) if function is not None]
    functions += [event.quantity for event in events]
    before, beyond = _clock(method)
    if controller is not None and controller.function is not None:
        functions.append(controller.function)
    if controller is not None and not controller.takes_back:
        before, beyond = max(before, _BEFORE), beyond + _BEYOND
    spans = ", ".join(f"{first!r} to {last!r}" for first, last in ranges)
    return Tables(system, tuple(functions), spans, method.name, before, beyond)


def _clock(method: Method) -> tuple[float, float]:
    """Return how far before and beyond a step its clock goes, in steps."""
    now = low = high = Fraction(0)
    for letter, weight in method.word:
        if letter.plain is Letter.DRIFT:
            now += weight
            low, high = min(low, now), max(high, now)
    return float(-low), float(max(high - 1, Fraction(0)))
