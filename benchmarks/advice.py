"""Whether `kd.advise` is right: what it recommends meets the tolerance over the span, and costs little more than the best.

The best is found by brute force: every candidate runs the whole span at steps a factor of 1.15 apart.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

import kickdrift as kd
from benchmarks.table import Row, at_most, measured
from kickdrift.analysis import candidates
from kickdrift.analysis.reference import Rates, described

WANTED = at_most(2)
_FINER, _MOST_RUNS = 1.15, 60
_CASES = (
    ("harmonic-oscillator", 500.0, 1e-6),
    ("pendulum", 500.0, 1e-6),
    ("kepler", 400.0, 1e-4),
    ("outer-solar-system", 2e5, 1e-5),
    ("solar-system", 2000.0, 1e-6),
    ("benchmarks-game", 300.0, 1e-6),
)


def compare(rounds: int) -> list[Row]:
    """Compare on the catalogue."""
    return [row for case in _CASES for row in rows(*case)]


def rows(name: str, span: float, tolerance: float) -> list[Row]:
    """Make the rows of a system: what the recommendation costs over the best, and its error over the tolerance."""
    system = kd.systems.get(name)
    advice = kd.advise(system, (0.0, span), tolerance)
    end, scales = exact_end(system, span)
    run, error = error_of(system, span, advice.method, advice.step, end, scales)
    method, best = cheapest(system, span, tolerance, end, scales)
    what = f"{name} over {span:g} to {tolerance:g}: {advice.method} / {method}"
    return [
        measured(what, [run.n_force_evaluations / best], WANTED, f"force evaluations, {best} at the least"),
        measured(
            f"{name}: error / tolerance", [error / tolerance], at_most(1), f"expected {advice.trials[0].error:.2g}"
        ),
    ]


def exact_end(system: kd.System, span: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the state at the end, and the largest numbers of x and v along the motion, for each number of it."""
    rates = Rates(described(system, 0.0, system.x0, system.v0, None), system.x0, system.v0)
    options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14 * rates.scales}
    found = solve_ivp(rates, (0.0, span), rates.start, **options).y
    largest = [np.abs(half).max() for half in np.split(found, 2)]
    return found[:, -1], np.repeat(largest, rates.size)


def error_of(system: kd.System, span: float, method: str, step: float, end, scales) -> tuple[kd.Solution, float]:
    """Run a method over the whole span, and return the error at its end."""
    run = kd.solve(system, (0.0, span), step=min(step, span), method=method, save_every=2**60, progress=False)
    state = np.concatenate([run.x[-1].ravel(), run.v[-1].ravel()])
    return run, float(np.abs((state - end) / scales).max()) if run.success else math.inf


def cheapest(system: kd.System, span: float, tolerance: float, end, scales) -> tuple[str, int]:
    """Find the fewest force evaluations with which a candidate meets the tolerance, at its step and the next three."""
    found = {}
    for method in candidates.of(system.kind):
        if method == "velocity-verlet":  # far off at these tolerances, and long
            continue
        step, met = span if method.startswith(("wisdom", "blanes-aba")) else span / 50, []
        for _ in range(_MOST_RUNS):
            run, error = error_of(system, span, method, step, end, scales)
            met = [*met, run.n_force_evaluations] if error <= tolerance else []
            if len(met) > 3 or run.n_force_evaluations > 40 * min(found.values(), default=1e9):
                break
            step /= _FINER
        if met:
            found[method] = met[0]
    method = min(found, key=found.get)
    return method, found[method]
