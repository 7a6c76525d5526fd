"""Two that do the same work: kickdrift, and a loop by hand."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

import kickdrift as kd

Floats = NDArray[np.float64]
by_hand = numba.njit(error_model="numpy", boundscheck=False)


@dataclass(frozen=True)
class Pair:
    """A problem in two hands.

    Attributes
    ----------
    what : str
        Its name in the table.
    problem, method : Any, str
        As `kickdrift.solve` takes them.
    loop : callable
        ``loop(steps)`` goes from the start as many steps, and returns positions and velocities.
    step : float
        How long a step is.
    steps : int
        How many a measurement takes.
    options : dict
        Whatever else `solve` is given.
    tolerance : float
        How far apart positions and velocities of both may end, in units of the largest.
    """

    what: str
    problem: Any
    method: str
    loop: Callable[[int], tuple[Floats, Floats]]
    step: float = 0.01
    steps: int = 20_000
    options: dict[str, Any] = field(default_factory=dict)
    tolerance: float = 1e-9

    def ours(self, steps: int) -> kd.Solution:
        """Run kickdrift."""
        end = steps * self.step
        given = {"method": self.method, "step": self.step, "save_every": steps, "progress": False, **self.options}
        return kd.solve(self.problem, (0.0, end), **given)

    def ours_per_step(self) -> float:
        """Nanoseconds of a step in kickdrift's loop."""
        solution = self.ours(self.steps)
        return solution.wall_time * 1e9 / solution.n_steps

    def by_hand_per_step(self) -> float:
        """Nanoseconds of a step by hand."""
        started = time.perf_counter()
        self.loop(self.steps)
        return (time.perf_counter() - started) * 1e9 / self.steps

    def check(self) -> None:
        """Have both arrive in the same place."""
        steps = min(self.steps, 100)
        solution, (x, v) = self.ours(steps), self.loop(steps)
        if not solution.success or solution.n_steps != steps:
            raise AssertionError(f"{self.what}: {solution.message}")
        for ours, theirs in ((solution.x[-1], x), (solution.v[-1], v)):
            size = np.abs(theirs).max(initial=1e-300)
            if not np.allclose(ours.ravel(), theirs.ravel(), rtol=0, atol=self.tolerance * size):
                raise AssertionError(f"{self.what}: the loop by hand does not do the same work.")
