"""kickdrift as a contestant, and the reference that states at the end are compared with."""

from functools import cache, partial

import numpy as np

import kickdrift as kd
from benchmarks.precision.case import Case, Contestant, Run, Solver
from benchmarks.precision.laws import Floats, writing

KEPT = 500  # states of a run whose error is looked at all the way
_PILOT = 64  # steps, to count the evaluations that one takes
_FIRST, _DOUBLINGS = 512, 9


def contestant(case: Case, method: str, count: int = 7) -> Contestant:
    """Make a contestant of a method of the catalogue."""
    step = 4 * case.span / case.evaluations[1]
    one, two = (_solve(case, method, n * step, n, n).n_force_evaluations for n in (_PILOT, 2 * _PILOT))
    return Contestant(f"kickdrift {method}", partial(_solver, method), (two - one) / _PILOT, count=count)


def _solve(case: Case, method: str, span: float, steps: int, every: int) -> kd.Solution:
    start = () if isinstance(case.problem, kd.System) else (case.x0, case.v0) if case.v0 else (case.x0,)
    return kd.solve(
        case.problem, (0.0, span), *start, step=span / steps, method=method, save_every=every, progress=False
    )


def _solver(method: str, case: Case) -> Solver:
    def run(steps: float, keep: bool) -> Run:
        steps = round(steps)
        solution = _solve(case, method, case.span, steps, max(1, steps // KEPT) if keep else steps)
        rows = solution.t.size
        states = np.concatenate([solution.x.reshape(rows, -1), solution.v.reshape(rows, -1)], axis=1)
        if not solution.success:
            states = np.full_like(states, np.nan)
        return Run(solution.wall_time, states, solution.n_force_evaluations)

    return run


@cache
def reference(case: Case) -> Floats:
    """Compute the state at the end: Gauss's method of order 8, its steps halved until that changes no more.

    Raises
    ------
    AssertionError
        If it goes on changing.
    """
    if case.end:
        return np.array(case.end)
    write = writing(case.law, len(case.x0))

    def rates(t: float, y: Floats, out: Floats) -> None:
        write(t, y, out)

    problem, end, changes = kd.FirstOrder(rates), case.start, []
    for doubling in range(_DOUBLINGS):
        steps = _FIRST * 2**doubling
        solution = kd.solve(
            problem, (0.0, case.span), case.start, step=case.span / steps, method="gauss-8", save_every=steps
        )
        changes.append(float(np.abs(solution.x[-1] - end).max()))
        end = solution.x[-1]
        if doubling and changes[-1] < 1e-11 and changes[-1] > changes[-2] / 4:  # rounding alone is left
            return end
    raise AssertionError(f"{case.name}: the reference still moves by {changes[-1]:.1e}.")
