"""Implicit Runge-Kutta methods by hand: x'' = a(x), a fixed point for the velocities of the stages.

They start from the polynomial through the accelerations of the step before, and go on until the increments stop
shrinking at rounding, as kickdrift's do.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

import kickdrift as kd
from benchmarks.steps.pair import Floats, Pair, by_hand

METHODS = ("implicit-euler", "implicit-midpoint", "gauss-4", "gauss-6", "gauss-8")


@by_hand
def pendulum(i: int, x: Floats, a: Floats) -> None:
    """Acceleration of stage i."""
    a[i, 0] = -math.sin(x[i, 0])


@by_hand
def kepler(i: int, x: Floats, a: Floats) -> None:
    """Acceleration of stage i."""
    r2 = x[i, 0] * x[i, 0] + x[i, 1] * x[i, 1]
    w = -1.0 / (r2 * math.sqrt(r2))
    a[i, 0], a[i, 1] = w * x[i, 0], w * x[i, 1]


@by_hand
def add(y: Floats, k: int, change: float, lost: Floats) -> None:
    """Add to y[k] with compensation."""
    increment = change - lost[k]
    total = y[k] + increment
    lost[k] = (total - y[k]) - increment
    y[k] = total


def loop(acceleration: Callable[..., None], n: int, s: int) -> Callable[..., None]:
    """Make the loop for n numbers and s stages, both constants of the compilation."""

    @by_hand
    def run(x: Floats, v: Floats, h: float, steps: int, a: Floats, b: Floats, onward: Floats) -> None:
        V, X, A, U = np.zeros((s, n)), np.zeros((s, n)), np.zeros((s, n)), np.zeros((s, n))
        lost_x, lost_v = np.zeros(n), np.zeros(n)
        for _ in range(steps):
            for i in range(s):
                for k in range(n):
                    total = 0.0
                    for j in range(s):
                        total += onward[i, j] * A[j, k]
                    V[i, k] = v[k] + h * total
            previous = np.inf
            for _ in range(50):
                for i in range(s):
                    for k in range(n):
                        total = 0.0
                        for j in range(s):
                            total += a[i, j] * V[j, k]
                        X[i, k] = x[k] + h * total
                    acceleration(i, X, A)
                size, scale = 0.0, 0.0
                for i in range(s):
                    for k in range(n):
                        total = 0.0
                        for j in range(s):
                            total += a[i, j] * A[j, k]
                        U[i, k] = (v[k] - V[i, k]) + h * total
                        size, scale = max(size, abs(U[i, k])), max(scale, abs(V[i, k]), 4e-4 * abs(X[i, k]) / h)
                if size == 0.0 or (size <= 1e-12 * scale and not size < previous):
                    break
                previous = size
                for i in range(s):
                    for k in range(n):
                        V[i, k] += U[i, k]
            for k in range(n):
                to_x = to_v = 0.0
                for j in range(s):
                    to_x, to_v = to_x + b[j] * V[j, k], to_v + b[j] * A[j, k]
                add(x, k, h * to_x, lost_x)
                add(v, k, h * to_v, lost_v)

    return run


def by_hand_from(acceleration: Callable[..., None], system: Any, method: str, h: float) -> Callable[[int], Any]:
    """Make the loop from the start of a system."""
    tableau = kd.methods.get(method).tableau()
    s, n = tableau.stages, system.x0.size
    a, b, onward = tableau._a.copy(), tableau._b.copy(), tableau.onward.copy()
    compiled = loop(acceleration, n, s)

    def run(steps: int) -> tuple[Floats, Floats]:
        x, v = system.x0.reshape(-1).copy(), system.v0.reshape(-1).copy()
        compiled(x, v, h, steps, a, b, onward)
        return x, v

    return run


def pairs() -> list[Pair]:
    """Pendulum and Kepler by all of them, at steps at which they are used."""
    found = []
    for name, system, acceleration, h in (
        ("pendulum", kd.systems.pendulum(), pendulum, 0.01),
        ("kepler", kd.systems.kepler(eccentricity=0.1), kepler, 0.01),
    ):
        for method in METHODS:
            step = h / 10 if method == "implicit-euler" else h  # at which it damps little
            loop = by_hand_from(acceleration, system, method, step)
            found.append(Pair(f"{method}, {name}", system, method, loop, step))
    return found
