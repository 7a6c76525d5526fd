"""Time and error of a method over steps."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.auto.problems import Problem

Floats = NDArray[np.float64]
_FINEST = 0.05  # seconds that a run may take
_REPEATED = 3
_SMALLEST = 1e-11  # an error below which no smaller step is tried


@dataclass(frozen=True)
class Curve:
    """Errors at the end and seconds in the loop, (steps, rounds), of runs at ever smaller steps."""

    errors: Floats
    seconds: Floats
    methods: tuple[str, ...]

    def time_to(self, error: float) -> Floats | None:
        """Seconds to an error, a number a round: between the last step with a larger error and the next; None if none has."""
        i = self._first(error)
        if i is None:
            return None
        if i == 0 or not np.isfinite(self.errors[i - 1]):
            return self.seconds[i]
        share = np.log(self.errors[i - 1] / error) / np.log(self.errors[i - 1] / self.errors[i])
        found: Floats = self.seconds[i - 1] ** (1 - share) * self.seconds[i] ** share
        return found

    def methods_at(self, error: float) -> tuple[str, ...]:
        """Return what was taken on both sides of an error."""
        i = self._first(error)
        return () if i is None else tuple(dict.fromkeys(self.methods[max(i - 1, 0) : i + 1]))

    def _first(self, error: float) -> int | None:
        """Find the first step from which on no error is larger."""
        larger = np.flatnonzero(~(self.errors <= error))
        i = int(larger[-1]) + 1 if larger.size else 0
        return i if i < self.errors.size else None


def curves(problem: Problem, methods: Sequence[str], rounds: int) -> dict[str, Curve]:
    """Run a problem by methods at ever smaller steps, until an error is small or a run long, and then time them in turns."""
    tried = {method: _try(problem, method) for method in methods}
    seconds: dict[str, list[list[float]]] = {method: [] for method in methods}
    for round_ in range(rounds):
        for method in methods if round_ % 2 == 0 else reversed(methods):
            seconds[method].append([_best_of(problem, method, step) for step, _, _ in tried[method]])
    return {
        method: Curve(
            np.array([error for _, error, _ in runs]), np.array(seconds[method]).T, tuple(taken for _, _, taken in runs)
        )
        for method, runs in tried.items()
    }


def _best_of(problem: Problem, method: str, step: float) -> float:
    """Return the least of some runs: what else the machine does makes them longer, and one of 100 microseconds many times."""
    return min(problem.run(method, step).wall_time for _ in range(_REPEATED))


def _try(problem: Problem, method: str) -> list[tuple[float, float, str]]:
    """Return steps, errors, and the names of what was taken."""
    runs = []
    step, error, long = problem.largest, np.inf, False
    while error > _SMALLEST and not long:
        run = problem.run(method, step)
        error, long = problem.error(run), run.wall_time > _FINEST
        runs.append((step, error, run.about.method))
        step /= 1.5
    return runs
