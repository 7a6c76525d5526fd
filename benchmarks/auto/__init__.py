"""Whether ``method="auto"`` takes a method that is fast: time to an error at the end, over that of the fastest method.

Every candidate runs at steps a factor of 1.5 apart, and `auto` does: it is told the step and nothing of the error. Time to
an error is read off between two steps.
"""

import numpy as np

from benchmarks.auto import problems, work
from benchmarks.auto.problems import Problem
from benchmarks.auto.work import Curve
from benchmarks.table import Row, at_most, measured, skipped
from kickdrift.analysis import candidates

WANTED = at_most(2)
ERRORS = (1e-3, 1e-6, 1e-9)
AUTO = "auto"


def compare(rounds: int) -> list[Row]:
    """Time of `auto` over that of the fastest candidate, for each problem and error."""
    return [row for problem in problems.every_problem() for row in rows(problem, rounds)]


def rows(problem: Problem, rounds: int) -> list[Row]:
    """Make the rows of a problem."""
    curves = work.curves(problem, (AUTO, *candidates.of(problem.kind)), rounds)
    return [_row(problem, error, curves) for error in ERRORS]


def _row(problem: Problem, error: float, curves: dict[str, Curve]) -> Row:
    what = f"{problem.name}, error {error:.0e}"
    times = {name: found.time_to(error) for name, found in curves.items()}
    reached = {name: time for name, time in times.items() if time is not None and name != AUTO}
    if not reached:
        return skipped(what, "no candidate gets there")
    fastest = min(reached, key=lambda name: float(np.median(reached[name])))
    mine = times[AUTO]
    if mine is None:
        return skipped(what, f"auto does not get there; {fastest} does")
    note = f"fastest {fastest}, auto {', '.join(curves[AUTO].methods_at(error))}"
    return measured(what, mine / reached[fastest], WANTED, note)
