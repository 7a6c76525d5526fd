"""Direct N-body: pairwise interactions per second, against REBOUND, on two threads, and against C by hand."""

import time
from collections.abc import Callable
from functools import partial

import llvmlite.binding
import numba
import numpy as np
from numpy.typing import NDArray

import kickdrift as kd
from benchmarks import c_programs
from benchmarks.peers import package
from benchmarks.table import Bound, Missing, Row, at_least, measured, skipped
from benchmarks.turns import in_turns, nanoseconds, ratio

Floats = NDArray[np.float64]
STEP, SOFTENING = 1e-3, 0.01
_SHARES = (0.6180339887498949, 0.7548776662466927, 0.8191725133961645)  # of a golden section and its kin: no two alike
STEPS = {1000: {"kickdrift": 300, "REBOUND": 80}, 10_000: {"kickdrift": 5, "REBOUND": 2}}


def cloud(n: int) -> tuple[Floats, Floats, Floats]:
    """Masses, positions and velocities of n bodies, normally distributed; the same ones each time."""
    random = np.random.default_rng(1)
    return np.full(n, 1.0 / n), random.normal(size=(n, 3)), 0.3 * random.normal(size=(n, 3))


def kickdrift(n: int, steps: int, threads: int) -> tuple[float, Floats]:
    """Seconds in the loop, and the positions."""
    masses, x, v = cloud(n)
    system = kd.systems.nbody(masses, x, v, softening=SOFTENING, threads=threads > 1)
    numba.set_num_threads(threads)
    # Position Verlet is what REBOUND calls leapfrog: one evaluation of the forces a step.
    method, span = "position-verlet", (0.0, steps * STEP)
    solution = kd.solve(system, span, step=STEP, method=method, save_every=steps, progress=False)
    return solution.wall_time, solution.x[-1]


def rebound(n: int, steps: int) -> tuple[float, Floats]:
    """Seconds in the loop, and the positions."""
    simulation = package("rebound").Simulation()
    simulation.integrator, simulation.gravity, simulation.dt = "leapfrog", "basic", STEP
    simulation.softening = SOFTENING
    for m, (x, y, z), (vx, vy, vz) in zip(*cloud(n), strict=True):
        simulation.add(m=m, x=x, y=y, z=z, vx=vx, vy=vy, vz=vz)
    started = time.perf_counter()
    simulation.steps(steps)
    return time.perf_counter() - started, np.array([(p.x, p.y, p.z) for p in simulation.particles])


def _per_interaction(run: Callable[..., tuple[float, Floats]], n: int, steps: int, *more: int) -> float:
    return run(n, steps, *more)[0] / (steps * n * (n - 1))


def wanted_rate() -> Bound | None:
    """Interactions per second that the vector units of this core should give."""
    if has_avx512():
        return at_least(2e9, "/s")
    return at_least(1e9, "/s") if llvmlite.binding.get_host_cpu_features().get("avx2") else None


def has_avx512() -> bool:
    """Whether this processor has vector registers of 512 bits."""
    return bool(llvmlite.binding.get_host_cpu_features().get("avx512f"))


def compare(rounds: int) -> list[Row]:
    """Rates and ratios for a thousand and for ten thousand bodies."""
    return [row for n in STEPS for row in _compare(n, rounds)] + [row for n in STEPS for row in by_hand(n, rounds)]


def by_hand(n: int, rounds: int) -> list[Row]:
    """Compare an evaluation of the forces with one by a C kernel for AVX-512."""
    what = f"N = {n}: C for AVX-512 by hand / kickdrift"
    if not has_avx512():
        return [skipped(what, "this processor has no AVX-512")]
    try:
        path = c_programs.build("gravity")["C"]
    except Missing as missing:
        return [skipped(what, str(missing))]
    x = np.stack([np.fmod(np.arange(n) * share, 1.0) for share in _SHARES], axis=1)  # as in C
    system = kd.systems.nbody(np.full(n, 1.0 / n), x, 0 * x, softening=SOFTENING)
    state, out, evaluations = (x.reshape(-1), x.reshape(-1), system.params), np.zeros(3 * n), STEPS[n]["kickdrift"]

    def ours() -> float:
        started = time.perf_counter()
        for _ in range(evaluations):
            system.acceleration(0.0, *state, out)
        return (time.perf_counter() - started) * 1e9 / (evaluations * n * (n - 1))

    ours()
    if not np.allclose([*out[:3], *out[-3:]], c_programs.run(path, n, 1).results, rtol=1e-12, atol=1e-14):
        raise AssertionError(f"N = {n}: the accelerations of the C kernel differ from kickdrift's.")
    costs = in_turns({"C": lambda: c_programs.run(path, n, evaluations).ns_per_step, "kickdrift": ours}, rounds)
    note = nanoseconds(costs, "kickdrift", "C")
    return [measured(what, ratio(costs, "C", "kickdrift"), at_least(0.9), note)]


def _compare(n: int, rounds: int) -> list[Row]:
    steps, few = STEPS[n], 2
    contestants = {"one thread": partial(_per_interaction, kickdrift, n, steps["kickdrift"], 1)}
    one = kickdrift(n, few, 1)[1]
    rows = []
    two_threads = numba.config.NUMBA_NUM_THREADS >= 2
    if two_threads:
        if not np.array_equal(kickdrift(n, few, 2)[1], one):
            raise AssertionError(f"N = {n}: two threads give other bits than one.")
        contestants["two threads"] = partial(_per_interaction, kickdrift, n, steps["kickdrift"], 2)
    else:
        rows.append(skipped(f"N = {n}: two threads", "this machine has one core"))
    try:
        if not np.allclose(rebound(n, few)[1], one, rtol=0, atol=1e-12):
            raise AssertionError(f"N = {n}: REBOUND's positions differ from kickdrift's.")
        contestants["REBOUND"] = partial(_per_interaction, rebound, n, steps["REBOUND"])
    except Missing as missing:
        rows.append(skipped(f"N = {n}: REBOUND", str(missing)))
    costs = in_turns(contestants, rounds)
    rows.append(measured(f"N = {n}: interactions on one thread", 1 / costs["one thread"], wanted_rate(), unit="/s"))
    if "REBOUND" in costs:
        note = f"REBOUND {1 / np.median(costs['REBOUND']):.2e}/s"
        rows.append(
            measured(f"N = {n}: REBOUND / one thread", ratio(costs, "REBOUND", "one thread"), at_least(4), note)
        )
    if two_threads:
        speedup = ratio(costs, "one thread", "two threads")
        rows.append(measured(f"N = {n}: one thread / two threads", speedup, at_least(1.8)))
    return rows
