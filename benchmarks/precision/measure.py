"""Runs of a case in turns: what each costs and how far it is off."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from benchmarks.precision import ours
from benchmarks.precision.case import Case, Contestant, Solver
from benchmarks.precision.laws import Floats
from benchmarks.table import Missing
from benchmarks.turns import in_turns
from kickdrift.analysis.work_curve import Curve

_ENOUGH_SECONDS, _ENOUGH_RUNS = 0.01, 10


@dataclass
class _Point:
    """A run of a contestant, again and again; the first time, its error is looked at."""

    solver: Solver
    value: float
    error_of: Callable[..., float]
    error: float = np.nan
    evaluations: float = np.nan

    def __call__(self) -> float:
        if np.isnan(self.error):
            self.error = self.error_of(self.solver(self.value, True))
        fastest, total = np.inf, 0.0
        for _ in range(_ENOUGH_RUNS):
            run = self.solver(self.value, False)
            self.evaluations = run.evaluations
            fastest, total = min(fastest, run.seconds), total + run.seconds
            if total > _ENOUGH_SECONDS:
                break
        return fastest


def values(case: Case, contestant: Contestant) -> Floats:
    """Numbers of steps, or tolerances, from the least work to the most."""
    if contestant.cost is None:
        largest, least = case.tolerances
        return np.geomspace(largest, contestant.limit or least, contestant.count)
    fewest, most = case.evaluations
    evaluations = np.geomspace(fewest, min(most, contestant.limit or most), contestant.count)
    return np.unique(np.maximum(np.round(evaluations / contestant.cost), 2))


def curves(case: Case, contestants: Iterable[Contestant], rounds: int) -> tuple[list[Curve], dict[str, str]]:
    """Let the contestants run in turns; return also who is missing, and why.

    Raises
    ------
    AssertionError
        If a contestant never comes near the solution: it does other work.
    """
    reference = ours.reference(case) if case.needs_reference else None
    points: dict[str, list[_Point]] = {}
    missing = {}
    for contestant in contestants:
        try:
            solver = contestant.make(case)
        except Missing as reason:
            missing[contestant.label] = str(reason)
            continue
        points[contestant.label] = [
            _Point(solver, value, lambda run: case.error_of(run, reference)) for value in values(case, contestant)
        ]
    costs = in_turns({f"{label} {i}": point for label, of in points.items() for i, point in enumerate(of)}, rounds)
    found = []
    for label, of in points.items():
        errors = np.array([point.error for point in of])
        if not errors.min() < 0.1:
            raise AssertionError(f"{case.name}: {label} ends {errors.min():.2g} off; it does not do the same work.")
        seconds = np.array([costs[f"{label} {i}"] for i in range(len(of))]).T
        found.append(Curve(label, errors, np.array([point.evaluations for point in of]), seconds))
    return found, missing
