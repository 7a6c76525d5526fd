"""Tables of a user's that a run would leave: said before it starts."""

from fractions import Fraction
from typing import Any

import numpy as np

from kickdrift.core.errors import ArgumentError
from kickdrift.engine.grid import Course, Grid
from kickdrift.methods import Letter, Method
from kickdrift.systems.spline import OUTSIDE, ranges_used
from kickdrift.systems.system import System


def check_tables(problem: Any, system: System, method: Method, grid: Grid | Course) -> None:
    """Ask the functions of a problem at all ends of time to which a run goes.

    Raises
    ------
    ArgumentError
        If a table that they call does not go as far.
    """
    if isinstance(problem, System) or not (ranges := ranges_used(problem)):
        return
    before, beyond = _clock(method)
    for t in (grid.t0 + before * grid.step, grid.t1 + beyond * grid.step):
        for function in (system.acceleration, system.velocity):
            if function is not None and _leaves(function, system, t):
                spans = ", ".join(f"{first!r} to {last!r}" for first, last in ranges)
                raise ArgumentError(
                    f"t_span=({grid.t0!r}, {grid.t1!r}) leaves a table of kd.spline (from {spans}): {method.name!r} with"
                    f" step={grid.step!r} asks it as for t={t!r}; shorten the span, or give a longer table."
                )


def _clock(method: Method) -> tuple[float, float]:
    """Return how far before a step and beyond it its clock goes, in terms of the step."""
    now = low = high = Fraction(0)
    for letter, weight in method.word:
        if letter.plain is Letter.DRIFT:
            now += weight
            low, high = min(low, now), max(high, now)
    return float(low), float(max(high - 1, Fraction(0)))


def _leaves(function: Any, system: System, t: float) -> bool:
    x, v = system.x0.reshape(-1).copy(), system.v0.reshape(-1).copy()
    try:
        with np.errstate(all="ignore"):
            function(t, x, v, system.params.copy(), np.zeros(max(x.size, v.size)))
    except ValueError as error:
        return OUTSIDE in str(error)
    except Exception:
        return False  # of something else, which the run shows if it comes to it
    return False
