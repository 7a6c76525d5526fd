"""Outer solar systems, 32 of them with starts 1e-6 AU apart, against heyoka's ensemble of batches, on all cores."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kickdrift as kd
from benchmarks.ensemble.works import Work, row, seconds
from benchmarks.peers import package
from benchmarks.table import Missing, Row, skipped
from kickdrift.systems.outer_solar_system import BODIES, GRAVITY

Floats = NDArray[np.float64]
_MEMBERS, _YEARS = 32, 100_000
_END = 365.25 * _YEARS
_ERRORS = (1e-6, 1e-7, 1e-9, 1e-11)
_RUNS = (
    *(("wisdom-holman", step) for step in (150.0, 30.0)),
    *(("wisdom-holman-corrected-3", step) for step in (216.0, 108.0)),
    *(("blanes-aba-1064", step) for step in (433.0, 216.0)),
)
_TOLERANCES = (1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-15)


def compare() -> list[Row]:
    """Compare the cheapest runs to errors of the energy."""
    try:
        theirs = list(_heyoka())
    except Missing as missing:
        return [skipped("heyoka's ensemble of batches", str(missing))]
    ours = [_kickdrift(method, step) for method, step in _RUNS]
    what = f"outer solar system, {_MEMBERS} members, {_YEARS:,} years"
    return [row(what, "energy", error, theirs, ours, None) for error in _ERRORS]


def _starts() -> tuple[Floats, Floats]:
    planets = kd.systems.outer_solar_system()
    x = planets.x0 + 1e-6 * np.random.default_rng(0).normal(size=(_MEMBERS, *planets.x0.shape))
    return x, np.broadcast_to(planets.v0, x.shape)


def _kickdrift(method: str, step: float) -> Work:
    solutions = []

    def run() -> None:
        keep = int(_END / step / 100)
        planets = kd.systems.outer_solar_system()
        solutions.append(kd.solve_ensemble(planets, (0.0, _END), *_starts(), step=step, method=method, save_every=keep))

    cost = seconds(run, 1) / _MEMBERS * 1e6
    energies = solutions[-1].energy
    return Work(f"{method}, step {step:g} d", cost, {"energy": float(abs(energies / energies[:, :1] - 1).max())})


def _heyoka() -> Iterator[Work]:
    library = package("heyoka")
    masses = np.array([body[0] for body in BODIES.values()])
    equations = library.model.nbody(len(masses), masses=masses, Gconst=GRAVITY)
    batch = library.recommended_simd_size()
    size = 6 * len(masses)
    x, v = _starts()
    starts = np.concatenate([x, v], axis=-1).reshape(_MEMBERS, size)

    def begin(stepper: Any, k: int) -> Any:
        stepper.set_time(0.0)
        stepper.state[:] = starts[batch * k : batch * (k + 1)].T
        return stepper

    for tolerance in _TOLERANCES:
        stepper = library.taylor_adaptive_batch(equations, np.ones((size, batch)), tol=tolerance, compact_mode=True)
        ends = []

        def run(stepper: Any = stepper, ends: list[Any] = ends) -> None:
            ends[:] = library.ensemble_propagate_until_batch(stepper, _END, _MEMBERS // batch, begin)

        cost = seconds(run, 1) / _MEMBERS * 1e6
        states = np.concatenate([end[0].state.T for end in ends]).reshape(_MEMBERS, -1, 6)
        error = abs(_energy(masses, states) / _energy(masses, starts.reshape(states.shape)) - 1).max()
        yield Work(f"tol={tolerance:.0e}", cost, {"energy": float(error)})


def _energy(masses: Floats, states: Floats) -> Floats:
    x, v = states[..., :3], states[..., 3:]
    values: Floats = 0.5 * (masses[:, None] * v**2).sum(axis=(-1, -2))
    for i in range(len(masses)):
        for j in range(i):
            values -= GRAVITY * masses[i] * masses[j] / np.linalg.norm(x[..., i, :] - x[..., j, :], axis=-1)
    return values
