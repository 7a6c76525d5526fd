"""A step of each of 100,000 Kepler orbits, by the semi-implicit Euler method."""

import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

import kickdrift as kd
from benchmarks.ensemble.orbits import orbits
from benchmarks.kepler import writing
from benchmarks.peers import STEP, package
from benchmarks.table import Missing, Row, at_least, at_most, measured, skipped
from benchmarks.turns import in_turns, nanoseconds, ratio

Floats = NDArray[np.float64]
_MEMBERS, _STEPS = 100_000, 1000
_SAVED = (1, 10, 100)  # times that are kept, beside the start
_TURNS = 100_000  # of the loop in registers
_OURS = ("kickdrift", "kickdrift plain", "kickdrift, a user's function")


def compare(rounds: int) -> list[Row]:
    """Compare the time of a step of a member on one thread, on two, and with diffrax' on all cores."""
    contestants: dict[str, Callable[[], float]] = {
        "kickdrift": partial(_kickdrift, kd.systems.kepler()),
        "kickdrift plain": partial(_kickdrift, kd.systems.kepler(), compensated=False),
        "kickdrift, a user's function": partial(_kickdrift, writing),
        "kickdrift, two threads": partial(_kickdrift, kd.systems.kepler(), threads=2),
        "a loop in registers": partial(_in_registers, 1),
        "a loop in registers, two threads": partial(_in_registers, 2),
    }
    rows, pairs = [], []
    try:
        for saved in _SAVED:
            pair = f"diffrax vmap, {saved} times", f"kickdrift, all cores, {saved} times"
            contestants[pair[0]] = diffrax(saved)
            contestants[pair[1]] = partial(_kickdrift, kd.systems.kepler(), threads=None, saved=saved)
            pairs.append(pair)
    except Missing as missing:
        rows.append(skipped("diffrax vmap", str(missing)))
    costs = in_turns(contestants, rounds)
    rows += [measured(f"{name}, one thread", costs[name], at_most(5, "ns")) for name in _OURS]
    if (os.cpu_count() or 1) > 1:
        pair = "kickdrift", "kickdrift, two threads"
        rows.append(measured(" / ".join(pair), ratio(costs, *pair), at_least(1.8), nanoseconds(costs, *pair)))
        pair = "a loop in registers", "a loop in registers, two threads"
        rows.append(measured(" / ".join(pair), ratio(costs, *pair), note="what two threads can be worth here"))
    rows += [measured(" / ".join(pair), ratio(costs, *pair), at_least(10), nanoseconds(costs, *pair)) for pair in pairs]
    return rows


def _kickdrift(problem: Any, compensated: bool = True, threads: int | None = 1, saved: int = 1) -> float:
    x, v = orbits(_MEMBERS, 0.3)
    sol = kd.solve_ensemble(
        problem,
        (0.0, _STEPS * STEP),
        x,
        v,
        step=STEP,
        save_every=_STEPS // saved,
        compensated=compensated,
        threads=threads,
        progress=False,
    )
    _check(sol.x[:, -1])
    return sol.wall_time * 1e9 / (_MEMBERS * _STEPS)


def _in_registers(threads: int) -> float:
    """Time a loop that needs no memory, on threads that share it."""
    parts = [_TURNS // threads] * threads
    with ThreadPoolExecutor(threads) as pool:
        started = time.perf_counter()
        list(pool.map(_roots, parts))
        return time.perf_counter() - started


@njit(nogil=True)  # type: ignore[untyped-decorator]
def _roots(turns: int) -> float:
    numbers = np.ones(64)
    for _ in range(turns):
        for i in range(64):
            numbers[i] = 1.0 / np.sqrt(numbers[i] + 1.0)
    return float(numbers.sum())


def diffrax(saved: int) -> Callable[[], float]:
    """Use diffrax' SemiImplicitEuler under vmap, jitted; it keeps the end alone, or so many times."""
    library, jax = package("diffrax"), package("jax")
    jax.config.update("jax_enable_x64", True)
    jnp = jax.numpy

    def acceleration(t: Any, x: Any, args: Any) -> Any:
        r2 = jnp.dot(x, x)
        return -x / (r2 * jnp.sqrt(r2))

    end = _STEPS * STEP
    terms = library.ODETerm(acceleration), library.ODETerm(lambda t, v, args: v)
    saveat = library.SaveAt(t1=True) if saved == 1 else library.SaveAt(ts=jnp.linspace(0.0, end, saved + 1))
    solver, adjoint = library.SemiImplicitEuler(), library.ForwardMode()

    def solve(v: Any, x: Any) -> Any:
        return library.diffeqsolve(
            terms, solver, 0.0, end, STEP, (v, x), saveat=saveat, max_steps=None, adjoint=adjoint, throw=False
        ).ys

    jitted = jax.jit(jax.vmap(solve))
    x, v = orbits(_MEMBERS, 0.3)
    start = jnp.array(v), jnp.array(x)

    def run() -> float:
        started = time.perf_counter()
        _, ends = jax.block_until_ready(jitted(*start))
        seconds = time.perf_counter() - started
        _check(np.asarray(ends[:, -1]))
        return seconds * 1e9 / (_MEMBERS * _STEPS)

    return run


@cache
def _reference() -> Floats:
    x, v = (array[0] for array in orbits(_MEMBERS, 0.3))
    return kd.solve(kd.systems.kepler(), (0.0, _STEPS * STEP), x, v, step=STEP).x[-1]


def _check(ends: Floats) -> None:
    if not np.allclose(ends[0], _reference(), rtol=0, atol=1e-9):
        raise AssertionError(
            f"The first member ends at {ends[0]}, alone at {_reference()}: they do not do the same work."
        )
