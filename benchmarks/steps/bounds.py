"""What it costs that indices of users' functions are checked: a step with the check over one without."""

from typing import Any

import numpy as np

import kickdrift as kd
from benchmarks.table import Bound, Row, at_most, measured
from benchmarks.turns import in_turns, nanoseconds, ratio

WANTED = at_most(1.05)
_N = 100


def _kepler(x: Any) -> Any:
    return -x / np.linalg.norm(x) ** 3


def _kepler_by_index(x: Any, out: Any) -> None:
    r2 = x[0] * x[0] + x[1] * x[1]
    share = -1.0 / (r2 * np.sqrt(r2))
    out[0] = share * x[0]
    out[1] = share * x[1]


def _gravity(x: Any, out: Any) -> None:
    """Do the direct sum of equal masses."""
    n = x.shape[0]
    for i in range(n):
        ax = ay = az = 0.0
        for j in range(n):
            dx, dy, dz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
            r2 = dx * dx + dy * dy + dz * dz + 0.01
            share = 1.0 / (r2 * np.sqrt(r2))
            ax += share * dx
            ay += share * dy
            az += share * dz
        out[i, 0], out[i, 1], out[i, 2] = ax, ay, az


def _chain(x: Any, out: Any) -> None:
    n = x.size
    for i in range(n):
        out[i] = x[i - 1] + x[(i + 1) % n] - 2.0 * x[i]


def rows(rounds: int) -> list[Row]:
    """Kepler in two forms, a direct sum, and a loop in which little else is done."""
    orbit = {"x0": [1.0, 0.0], "v0": [0.0, 1.1]}
    i = np.arange(_N)
    cloud = {"x0": np.stack([np.sin(i), np.cos(2 * i), np.sin(3 * i)], axis=1), "v0": np.zeros((_N, 3))}
    chain = {"x0": np.sin(0.1 * np.arange(1000)), "v0": np.zeros(1000)}
    return [
        _row("Kepler by arrays", _kepler, 200_000, rounds, WANTED, **orbit),
        _row("Kepler by indices", _kepler_by_index, 500_000, rounds, WANTED, **orbit),
        _row(f"{_N} bodies by indices", _gravity, 300, rounds, WANTED, **cloud),
        _row("a chain of 1000", _chain, 5000, rounds, None, **chain),  # whose loop is vectorised only without the check
    ]


def _row(what: str, force: Any, steps: int, rounds: int, wanted: Bound | None, **start: Any) -> Row:
    def per_step(check: bool) -> float:
        solution = kd.solve(
            force, (0.0, 1e-3 * steps), step=1e-3, save_every=steps, check_bounds=check, progress=False, **start
        )
        return solution.wall_time * 1e9 / solution.n_steps

    costs = in_turns({"checked": lambda: per_step(True), "check_bounds=False": lambda: per_step(False)}, rounds)
    note = nanoseconds(costs, "checked", "check_bounds=False")
    return measured(
        f"{what}: checked / check_bounds=False", ratio(costs, "checked", "check_bounds=False"), wanted, note
    )
