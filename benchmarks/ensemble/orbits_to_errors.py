"""A hundred turns of Kepler orbits to an error, against heyoka's batches, on one thread."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kickdrift as kd
from benchmarks.ensemble.orbits import energy, orbits
from benchmarks.ensemble.works import Work, row, seconds
from benchmarks.peers import package
from benchmarks.table import Missing, Row, at_least, skipped

Floats = NDArray[np.float64]
_MEMBERS, _TURNS = 1024, 100
_END = 2 * math.pi * _TURNS
_ERRORS = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
_METHODS = ("velocity-verlet", "blanes-moan-srkn6b", "blanes-moan-srkn11b", "kahan-li-8")
_STEPS = (15, 20, 30, 45, 65, 100, 150, 220, 330, 500, 800, 1600, 3200)  # a turn
_TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-12, 1e-14, 1e-16)
_LOOKS = 211  # times at which the energy is looked at, which a symplectic method gives back at the pericentres


def compare() -> list[Row]:
    """Compare the cheapest runs to errors of the energy, at any time, and of the position at the end."""
    rows = []
    for most in (0.3, 0.9):
        try:
            theirs = list(_heyoka(most))
        except Missing as missing:
            return [skipped("heyoka's batches", str(missing))]
        ours = [_kickdrift(most, method, steps) for method in _METHODS for steps in _STEPS]
        for of in ("energy", "position"):
            for error in _ERRORS:
                bound = at_least(1) if (most, of, error) == (0.3, "energy", 1e-4) else None
                what = f"{_TURNS} turns, eccentricities up to {most}"
                rows.append(row(what, of, error, theirs, ours, bound))
    return rows


def _kickdrift(most: float, method: str, steps: int) -> Work:
    x, v = orbits(_MEMBERS, most)

    def run(save_every: int) -> kd.EnsembleSolution:
        return kd.solve_ensemble(
            kd.systems.kepler(),
            (0.0, _END),
            x,
            v,
            step=2 * math.pi / steps,
            method=method,
            save_every=save_every,
            threads=1,
            progress=False,
        )

    looked = run(max(1, steps * _TURNS // _LOOKS))
    energies = abs(looked.energy / looked.energy[:, :1] - 1).max()
    cost = seconds(lambda: run(steps * _TURNS)) / _MEMBERS * 1e6
    return Work(f"{method}, {steps} steps a turn", cost, _errors(energies, looked.x[:, -1], x))


def _heyoka(most: float) -> Iterator[Work]:
    """Use heyoka's Taylor series in batches of as many members as there are lanes."""
    library = package("heyoka")
    x, y, vx, vy = library.make_vars("x", "y", "vx", "vy")
    pull = (x * x + y * y) ** -1.5
    equations = [(x, vx), (y, vy), (vx, -x * pull), (vy, -y * pull)]
    batch = library.recommended_simd_size()
    starts, velocities = orbits(_MEMBERS, most)
    ends = np.empty((4, _MEMBERS))

    def run(stepper: Any) -> None:
        for first in range(0, _MEMBERS, batch):
            members = slice(first, first + batch)
            stepper.set_time(0.0)
            stepper.state[:2], stepper.state[2:] = starts[members].T, velocities[members].T
            stepper.propagate_until(_END)
            ends[:, members] = stepper.state

    for tolerance in _TOLERANCES:
        stepper = library.taylor_adaptive_batch(equations, np.ones((4, batch)), tol=tolerance)
        cost = seconds(lambda stepper=stepper: run(stepper)) / _MEMBERS * 1e6  # type: ignore[misc]
        energies = abs(energy(ends[:2].T, ends[2:].T) / energy(starts, velocities) - 1).max()
        yield Work(f"tol={tolerance:.0e}", cost, _errors(energies, ends[:2].T, starts))


def _errors(energies: float, ends: Floats, starts: Floats) -> dict[str, float]:
    """Return the errors of the worst member; after whole turns it should be where it began."""
    return {"energy": float(energies), "position": float(np.linalg.norm(ends - starts, axis=1).max())}
