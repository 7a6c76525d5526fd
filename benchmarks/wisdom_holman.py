"""The outer solar system by Wisdom-Holman, the step a thousandth of Jupiter's period, against REBOUND's WHFast."""

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kickdrift as kd
from benchmarks.peers import package
from benchmarks.steps import massless
from benchmarks.table import Missing, Row, at_most, measured, skipped
from benchmarks.turns import in_turns, nanoseconds, ratio

Floats = NDArray[np.float64]
STEP = 4.33259  # days
_STEPS = 100_000  # a hundred periods of Jupiter, about 0.05 s
_SAMPLES = 1000  # of the energy along them
OURS = {
    "kickdrift": {},
    "kickdrift, heliocentric": {"splitting": "democratic-heliocentric"},
    "kickdrift, corrected": {"corrector": "-corrected-3"},
}
_CHECKED_STEPS = 1000
_MASSLESS = 1000
_STEPS_WITH_MASSLESS = 500


def kickdrift(steps: int, **options: Any) -> tuple[float, Floats]:
    """Seconds in the loop, and the positions."""
    solution = _run(steps, steps, **options)
    return solution.wall_time, solution.x[-1]


def _run(steps: int, save_every: int, corrector: str = "", splitting: str = "jacobi", **options: Any) -> kd.Solution:
    return kd.solve(
        kd.systems.outer_solar_system(splitting),
        (0.0, steps * STEP),
        step=STEP,
        method=f"wisdom-holman{corrector}",
        save_every=save_every,
        progress=False,
        **options,
    )


def _simulation(safe: bool) -> Any:
    """REBOUND's simulation; not `safe` is its fast setting, which joins Kepler steps as kickdrift does."""
    system = kd.systems.outer_solar_system()
    simulation = package("rebound").Simulation()
    simulation.G = system.params[0]
    for m, (x, y, z), (vx, vy, vz) in zip(system.params[2:8] / system.params[0], system.x0, system.v0, strict=True):
        simulation.add(m=m, x=x, y=y, z=z, vx=vx, vy=vy, vz=vz)
    simulation.integrator, simulation.dt = "whfast", STEP
    settings = getattr(simulation, "ri_whfast", simulation.integrator)  # its place before REBOUND 5, and since
    settings.safe_mode = int(safe)
    return simulation


def rebound(steps: int, safe: bool = False) -> tuple[float, Floats]:
    """Seconds of the steps, and the positions."""
    simulation = _simulation(safe)
    started = time.perf_counter()
    simulation.steps(steps)
    simulation.synchronize()
    return time.perf_counter() - started, np.array([(p.x, p.y, p.z) for p in simulation.particles])


def _per_step(run: Callable[..., tuple[float, Floats]], **options: Any) -> float:
    return run(_STEPS, **options)[0] * 1e9 / _STEPS


def _energy_of_kickdrift(**options: str) -> float:
    energy = _run(_STEPS, _STEPS // _SAMPLES, **options).energy
    return float(np.abs(energy / energy[0] - 1).max())


def _energy_of_rebound() -> float:
    simulation = _simulation(safe=False)
    energies = [simulation.energy()]
    for _ in range(_SAMPLES):
        simulation.steps(_STEPS // _SAMPLES)
        simulation.synchronize()
        energies.append(simulation.energy())
    return float(np.abs(np.array(energies) / energies[0] - 1).max())


def _with_massless(steps: int) -> tuple[float, Floats]:
    made, _, _, _ = massless.system(_MASSLESS)
    solution = kd.solve(
        made,
        (0.0, steps * STEP),
        step=STEP,
        method="wisdom-holman",
        save_every=steps,
        compensated=False,
        progress=False,
    )
    return solution.wall_time, solution.x[-1]


def _rebound_with_massless(steps: int) -> tuple[float, Floats]:
    """REBOUND's, in the same coordinates, which it takes for test particles that feel the planets and not each other."""
    _, gm, x0, v0 = massless.system(_MASSLESS)
    simulation = package("rebound").Simulation()
    for m, (x, y, z), (vx, vy, vz) in zip(gm, x0, v0, strict=True):
        simulation.add(m=m, x=x, y=y, z=z, vx=vx, vy=vy, vz=vz)
    simulation.N_active = np.count_nonzero(gm)
    simulation.integrator, simulation.dt = "whfast", STEP
    settings = getattr(simulation, "ri_whfast", simulation.integrator)
    settings.safe_mode, settings.coordinates = 0, "democraticheliocentric"
    started = time.perf_counter()
    simulation.steps(steps)
    simulation.synchronize()
    return time.perf_counter() - started, np.array([(p.x, p.y, p.z) for p in simulation.particles])


def _massless(rounds: int) -> Row:
    if not np.allclose(_rebound_with_massless(100)[1], _with_massless(100)[1], rtol=0, atol=1e-9):
        raise AssertionError("REBOUND's massless bodies are elsewhere: they do not do the same work.")
    steps = _STEPS_WITH_MASSLESS
    contestants: dict[str, Callable[[], float]] = {
        "kickdrift plain": lambda: _with_massless(steps)[0] * 1e9 / steps,
        "REBOUND fast": lambda: _rebound_with_massless(steps)[0] * 1e9 / steps,
    }
    costs = in_turns(contestants, rounds)
    what = f"{_MASSLESS} massless bodies, heliocentric: kickdrift plain / REBOUND fast"
    return measured(what, ratio(costs, *contestants), at_most(1), nanoseconds(costs, *contestants))


def compare(rounds: int) -> list[Row]:
    """Time of a step and largest error of the energy; ours has compensated sums unless it says plain."""
    limit = at_most(1e-9, "of the energy")
    rows = [
        measured(f"{name}: energy error", [_energy_of_kickdrift(**options)], limit) for name, options in OURS.items()
    ]
    contestants: dict[str, Callable[[], float]] = {
        name: partial(_per_step, kickdrift, **options) for name, options in OURS.items()
    }
    contestants["kickdrift plain"] = partial(_per_step, kickdrift, compensated=False)
    try:
        # Rounding differs; over two orbits of Jupiter its growth along the orbits stays below 1e-11.
        if not np.allclose(rebound(_CHECKED_STEPS)[1], kickdrift(_CHECKED_STEPS)[1], rtol=0, atol=1e-11):
            raise AssertionError("REBOUND's positions differ from kickdrift's: they do not do the same work.")
    except Missing as missing:
        return [*rows, skipped("REBOUND WHFast", str(missing))]
    rows.append(measured("REBOUND WHFast: energy error", [_energy_of_rebound()], unit="of the energy"))
    contestants["REBOUND fast"] = partial(_per_step, rebound)
    contestants["REBOUND default"] = partial(_per_step, rebound, safe=True)
    costs = in_turns(contestants, rounds)
    for name, other, wanted in (
        ("kickdrift", "REBOUND fast", at_most(1)),
        ("kickdrift plain", "REBOUND fast", None),
        ("kickdrift, heliocentric", "REBOUND fast", at_most(1)),
        ("kickdrift, corrected", "REBOUND fast", at_most(1)),
        ("kickdrift", "REBOUND default", at_most(1)),
    ):
        rows.append(measured(f"{name} / {other}", ratio(costs, name, other), wanted, nanoseconds(costs, name, other)))
    return [*rows, _massless(rounds)]
