"""Explicit steps by hand: Runge-Kutta 4, Boris, and the sweeps of the composition diagonal method."""

from typing import Any

import numpy as np

import kickdrift as kd
from benchmarks.steps.implicit import add, kepler, pendulum
from benchmarks.steps.pair import Floats, Pair, by_hand


def runge_kutta(acceleration: Any, n: int) -> Any:
    """Make the loop of the classical method for n numbers, a constant of the compilation."""

    @by_hand
    def run(x: Floats, v: Floats, h: float, steps: int) -> None:
        X, V, A = np.zeros((4, n)), np.zeros((4, n)), np.zeros((4, n))
        lost_x, lost_v = np.zeros(n), np.zeros(n)
        for _ in range(steps):
            for i in range(4):
                share = 0.0 if i == 0 else h if i == 3 else 0.5 * h
                for k in range(n):
                    X[i, k] = x[k] + share * V[max(i - 1, 0), k]
                    V[i, k] = v[k] + share * A[max(i - 1, 0), k]
                acceleration(i, X, A)
            for k in range(n):
                add(x, k, h * (V[0, k] / 6 + V[1, k] / 3 + V[2, k] / 3 + V[3, k] / 6), lost_x)
                add(v, k, h * (A[0, k] / 6 + A[1, k] / 3 + A[2, k] / 3 + A[3, k] / 6), lost_v)

    return run


@by_hand
def oscillators(i: int, x: Floats, a: Floats) -> None:
    """Acceleration of stage i."""
    for k in range(x.shape[1]):
        a[i, k] = -x[i, k]


def force_of_oscillators(x: Any, out: Any) -> None:
    """Acceleration, as a user writes it."""
    for k in range(x.size):
        out[k] = -x[k]


def _runge_kutta_pairs() -> list[Pair]:
    found = []
    for name, system, acceleration in (
        ("pendulum", kd.systems.pendulum(), pendulum),
        ("kepler", kd.systems.kepler(eccentricity=0.1), kepler),
    ):
        x0, v0 = system.x0.reshape(-1), system.v0.reshape(-1)
        found.append(
            Pair(f"runge-kutta-4, {name}", system, "runge-kutta-4", _from(runge_kutta(acceleration, x0.size), x0, v0))
        )
    many = np.linspace(1, 2, 100_000)
    loop = _from(runge_kutta(oscillators, many.size), many, 0 * many)
    options = {"x0": many, "v0": 0 * many}
    found.append(
        Pair("runge-kutta-4, 1e5 oscillators", force_of_oscillators, "runge-kutta-4", loop, steps=50, options=options)
    )
    return found


def _from(run: Any, x0: Floats, v0: Floats, h: float = 0.01) -> Any:
    def loop(steps: int) -> tuple[Floats, Floats]:
        x, v = x0.copy(), v0.copy()
        run(x, v, h, steps)
        return x, v

    return loop


def magnetic_field(x: Any, out: Any) -> None:
    """Field that grows along x, as a user writes it."""
    for i in range(x.shape[0]):
        out[i, 0], out[i, 1], out[i, 2] = 0.0, 0.0, 1.0 + 0.1 * x[i, 0]


def electric_field(x: Any, out: Any) -> None:
    """Field towards the middle, as a user writes it."""
    for i in range(x.shape[0]):
        for k in range(3):
            out[i, k] = -0.1 * x[i, k]


@by_hand
def boris(x: Floats, v: Floats, h: float, steps: int) -> None:
    """Drift, kick, turn, kick, drift of particles (N, 3), each of which stays in registers."""
    for p in range(x.shape[0]):
        lost_x, lost_v = np.zeros(3), np.zeros(3)
        r, u = x[p], v[p]
        for _ in range(steps):
            for k in range(3):
                add(r, k, 0.5 * h * u[k], lost_x)
            for k in range(3):
                add(u, k, 0.5 * h * (-0.1 * r[k]), lost_v)
            w = 1.0 + 0.1 * r[0]
            weight = h / (1.0 + 0.25 * h * h * w * w)
            cx, cy = u[1] * w, -u[0] * w
            change_x, change_y = weight * cx + 0.5 * h * weight * cy * w, weight * cy - 0.5 * h * weight * cx * w
            add(u, 0, change_x, lost_v)
            add(u, 1, change_y, lost_v)
            for k in range(3):
                add(u, k, 0.5 * h * (-0.1 * r[k]), lost_v)
            for k in range(3):
                add(r, k, 0.5 * h * u[k], lost_x)


@by_hand
def boris_together(x: Floats, v: Floats, h: float, steps: int) -> None:
    """Do the same step by step: all particles have to be known before the next one, as where they interact."""
    lost_x, lost_v = np.zeros_like(x), np.zeros_like(v)
    for _ in range(steps):
        for p in range(x.shape[0]):
            r, u = x[p], v[p]
            for k in range(3):
                add(r, k, 0.5 * h * u[k], lost_x[p])
            for k in range(3):
                add(u, k, 0.5 * h * (-0.1 * r[k]), lost_v[p])
            w = 1.0 + 0.1 * r[0]
            weight = h / (1.0 + 0.25 * h * h * w * w)
            cx, cy = u[1] * w, -u[0] * w
            change_x, change_y = weight * cx + 0.5 * h * weight * cy * w, weight * cy - 0.5 * h * weight * cx * w
            add(u, 0, change_x, lost_v[p])
            add(u, 1, change_y, lost_v[p])
            for k in range(3):
                add(u, k, 0.5 * h * (-0.1 * r[k]), lost_v[p])
            for k in range(3):
                add(r, k, 0.5 * h * u[k], lost_x[p])


def _boris_pairs() -> list[Pair]:
    found = []
    for count, steps, run in ((1, 20_000, boris), (10_000, 50, boris_together)):
        rng = np.random.default_rng(1)
        x0, v0 = rng.normal(size=(count, 3)), rng.normal(size=(count, 3))
        problem = kd.ChargedParticle(1.0, magnetic_field, electric_field)
        what = f"boris, {count} particle{'s' * (count > 1)}"
        options = {"x0": x0, "v0": v0}
        found.append(Pair(what, problem, "boris", _from(run, x0, v0), steps=steps, options=options))
    return found


def lotka_volterra(i: int, y: Any) -> float:
    """Rate of one component, as a user writes it."""
    return float(y[0] * (1.0 - y[1])) if i == 0 else float(y[1] * (y[0] - 1.0))


@by_hand
def rate(i: int, y: Floats) -> float:
    """Rate of one component."""
    return y[0] * (1.0 - y[1]) if i == 0 else y[1] * (y[0] - 1.0)


@by_hand
def sweeps(y: Floats, unused: Floats, h: float, steps: int) -> None:
    """Sweep over half a step, and back by secants, until the increments stop shrinking at rounding."""
    lost = np.zeros(2)
    for _ in range(steps):
        for i in range(2):
            add(y, i, 0.5 * h * rate(i, y), lost)
        for i in range(1, -1, -1):
            start = y[i]
            slope, earlier, earlier_residual, previous, f = -1.0, np.nan, np.nan, np.inf, 0.0
            for _ in range(50):
                f = rate(i, y)
                residual = (start - y[i]) + 0.5 * h * f
                size = max(abs(start), abs(y[i]), abs(h * f))
                if abs(y[i] - earlier) > 1e-8 * size:
                    slope = (residual - earlier_residual) / (y[i] - earlier)
                increment = -residual / slope
                if residual == 0.0 or (abs(increment) <= 1e-12 * size and not abs(increment) < previous):
                    break
                earlier, earlier_residual, previous = y[i], residual, abs(increment)
                y[i] += increment
            y[i] = start
            add(y, i, 0.5 * h * f, lost)


def pairs() -> list[Pair]:
    """All of them."""
    y0 = np.array([1.5, 0.7])
    diagonal = Pair(
        "composition-diagonal-2, Lotka-Volterra",
        kd.FirstOrder(lotka_volterra),
        "composition-diagonal-2",
        _from(sweeps, y0, y0[:0]),
        options={"x0": y0},
    )
    return [*_runge_kutta_pairs(), *_boris_pairs(), diagonal]
