"""Time and error of a method over steps."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.auto.problems import Problem

Floats = NDArray[np.float64]
_FINEST = 0.4  # seconds that a run may take
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


def curve(problem: Problem, method: str, rounds: int) -> Curve:
    """Run a problem by a method at ever smaller steps, until the error is small or the run is long."""
    errors, seconds, methods = [], [], []
    step = problem.largest
    while True:
        runs = [problem.run(method, step) for _ in range(min(rounds, 3) + 1)]
        errors.append(problem.error(runs[0]))
        seconds.append([run.wall_time for run in runs[1:]])
        methods.append(runs[0].about.method)
        if errors[-1] < _SMALLEST or min(seconds[-1]) > _FINEST:
            break
        step /= 1.5
    return Curve(np.array(errors), np.min(np.array(seconds), axis=1, keepdims=True), tuple(methods))
