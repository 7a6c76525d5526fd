"""What an event costs: a pendulum's passages through its lowest point, beside the same run without; and in SciPy and heyoka."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipk

import kickdrift as kd
from benchmarks.peers import package
from benchmarks.table import Missing, Row, at_most, measured, skipped
from benchmarks.turns import in_turns, nanoseconds, ratio

_STEPS, _STEP = 1_000_000, 0.01
_SPAN, _ERROR = 10_000.0, 1e-6
_START = 1.0, 0.0
_METHOD = {"method": "blanes-moan-srkn11b", "step": 0.08}
_TOLERANCE_OF_HEYOKA = 1e-13


def _lowest(x: float) -> float:
    return np.sin(x)  # type: ignore[no-any-return]


def _position(x: float) -> float:
    return x


def _a_step(*events: Callable[..., Any]) -> float:
    """Nanoseconds a step, everything counted."""
    started = time.perf_counter()
    kd.solve(
        kd.systems.pendulum(),
        (0.0, _STEPS * _STEP),
        *_START,
        step=_STEP,
        method="velocity-verlet",
        events=list(events),
        save_every=_STEPS,
        progress=False,
    )
    return (time.perf_counter() - started) / _STEPS * 1e9


def _passages() -> np.ndarray[Any, np.dtype[np.float64]]:
    half = 2 * ellipk(np.sin(0.5) ** 2)
    return np.asarray(half * (0.5 + np.arange(int(_SPAN / half + 0.5))))


def _by_kickdrift() -> np.ndarray[Any, np.dtype[np.float64]]:
    sol = kd.solve(
        kd.systems.pendulum(), (0.0, _SPAN), *_START, events=_lowest, save_every=10**6, progress=False, **_METHOD
    )
    return sol.t_events[0]


def _by_scipy() -> np.ndarray[Any, np.dtype[np.float64]]:
    def rate(t: float, y: Any) -> list[float]:
        return [y[1], -np.sin(y[0])]

    options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-11, "t_eval": [_SPAN]}
    return np.asarray(solve_ivp(rate, (0.0, _SPAN), _START, events=lambda t, y: np.sin(y[0]), **options).t_events[0])


def _heyoka() -> Callable[[], np.ndarray[Any, np.dtype[np.float64]]]:
    hy = package("heyoka")
    x, v = hy.make_vars("x", "v")
    found: list[float] = []
    event = hy.nt_event(hy.sin(x), lambda ta, t, sign: found.append(t))
    integrator = hy.taylor_adaptive(
        [(x, v), (v, -hy.sin(x))], list(_START), nt_events=[event], tol=_TOLERANCE_OF_HEYOKA
    )

    def run() -> np.ndarray[Any, np.dtype[np.float64]]:
        found.clear()
        integrator.time, integrator.state[:] = 0.0, _START
        integrator.propagate_until(_SPAN)
        return np.array(found)

    return run


def _timed(run: Callable[[], np.ndarray[Any, np.dtype[np.float64]]]) -> Callable[[], float]:
    def seconds() -> float:
        started = time.perf_counter()
        found = run()
        took = time.perf_counter() - started
        wanted = _passages()
        assert found.size == wanted.size, f"{found.size} of {wanted.size} passages"
        assert np.abs(found - wanted).max() < _ERROR, np.abs(found - wanted).max()
        return took / found.size * 1e9

    return seconds


def compare(rounds: int) -> list[Row]:
    """Nanoseconds that an event adds to a step; and the time to all passages of a pendulum, to the same error."""
    costs = in_turns({"plain": _a_step, "x": lambda: _a_step(_position), "sin x": lambda: _a_step(_lowest)}, rounds)
    wanted = at_most(20, "ns")
    rows = [
        measured(f"an event, {name}: a step, beside the run alone", costs[name] - costs["plain"], wanted)
        for name in ("x", "sin x")
    ]
    runs = {"kickdrift": _by_kickdrift, "SciPy": _by_scipy}
    try:
        runs["heyoka"] = _heyoka()
    except Missing as missing:
        rows.append(skipped("heyoka", str(missing)))
    costs = in_turns({name: _timed(run) for name, run in runs.items()}, rounds)
    note = nanoseconds(costs, *runs)
    what = "a passage of a pendulum"
    return rows + [
        measured(f"kickdrift / {other}: {what}", ratio(costs, "kickdrift", other), note=note)
        for other in runs
        if other != "kickdrift"
    ]
