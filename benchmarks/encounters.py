"""Three planets of Jupiter's mass that scatter each other, for 100,000 periods, against REBOUND's TRACE and IAS15."""

import sys
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import kickdrift as kd
from benchmarks.peers import package
from benchmarks.table import Missing, Row, at_most, measured, skipped
from benchmarks.turns import ratio

_PERIODS, _MOST_SYSTEMS, _SAMPLES = 100_000, 5, 50
_PERIOD = 2 * np.pi
_STEP = _PERIOD / 20
_TOLERANCE = 1e-12
_SPACING = 3.3  # in mutual Hill radii: they meet within some hundred periods


def simulation(seed: int) -> Any:
    """Make REBOUND's simulation of a star and three planets, whose angles are drawn at random."""
    random, made, axis = np.random.default_rng(seed), package("rebound").Simulation(), 1.0
    made.add(m=1.0)
    for _ in range(3):
        e, inclination, *angles = random.random(5) * [0.01, 0.02, *[_PERIOD] * 3]
        made.add(m=1e-3, a=axis, e=e, inc=inclination, Omega=angles[0], omega=angles[1], M=angles[2])
        axis *= 1.0 + _SPACING * (2e-3 / 3.0) ** (1.0 / 3.0)
    made.move_to_com()
    return made


def _by_rebound(integrator: str, periods: float, seed: int) -> tuple[float, float]:
    """Seconds, and the largest error of the energy."""
    made = simulation(seed)
    made.integrator = integrator
    if integrator == "trace":
        made.dt = _STEP
    start, worst, seconds = made.energy(), 0.0, 0.0
    for k in range(1, _SAMPLES + 1):
        started = time.perf_counter()
        made.integrate(periods * _PERIOD * k / _SAMPLES, exact_finish_time=0)
        seconds += time.perf_counter() - started
        worst = max(worst, abs(made.energy() / start - 1))
    return seconds, worst


def _by_kickdrift(options: dict[str, Any], periods: float, seed: int) -> tuple[float, float]:
    particles = simulation(seed).particles
    masses = [p.m for p in particles]
    system = kd.systems.planetary(masses, [p.xyz for p in particles], [p.vxyz for p in particles])
    times = np.linspace(0.0, periods * _PERIOD, _SAMPLES + 1)
    sol = kd.solve(system, times[[0, -1]], t_eval=times, progress=False, **options)
    assert sol.success, sol.message
    return sol.wall_time, float(np.abs(sol.energy / sol.energy[0] - 1).max())


def compare(rounds: int) -> list[Row]:
    """Energy errors, the medians of some systems, at most five and one a round; and times. A system takes minutes."""
    systems = min(rounds, _MOST_SYSTEMS)
    runs: dict[str, Callable[[float, int], tuple[float, float]]] = {
        "kickdrift": partial(_by_kickdrift, {"method": "close-encounters", "step": _STEP}),
        "dop853": partial(_by_kickdrift, {"method": "dop853", "rtol": _TOLERANCE, "atol": _TOLERANCE}),
    }
    try:
        package("rebound")
    except Missing as missing:
        return [skipped("REBOUND", str(missing))]
    runs |= {name: partial(_by_rebound, name.lower()) for name in ("TRACE", "IAS15")}
    for run in runs.values():
        run(10, 0)
    found = {name: np.zeros((systems, 2)) for name in runs}
    for seed in range(systems):  # in turns
        for name, run in runs.items():
            found[name][seed] = run(_PERIODS, seed)
            print(f"encounters, system {seed + 1} of {systems}, {name}: {found[name][seed, 0]:.0f} s", file=sys.stderr)
    costs, errors = ({name: values[:, k] for name, values in found.items()} for k in (0, 1))
    limit = at_most(1e-6, "of the energy")
    rows = [measured("kickdrift, close-encounters: energy error", errors["kickdrift"], limit)]
    others = {"kickdrift, dop853": "dop853", "TRACE": "TRACE", "IAS15": "IAS15"}
    rows += [measured(f"{label}: energy error", errors[name], unit="of the energy") for label, name in others.items()]
    for name, wanted in (("TRACE", at_most(1)), ("IAS15", at_most(0.2)), ("dop853", None)):
        rows.append(measured(f"kickdrift, close-encounters / {name}", ratio(costs, "kickdrift", name), wanted))
    return rows
