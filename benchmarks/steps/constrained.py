"""A double pendulum in Cartesian coordinates by RATTLE: two rods, their forces from two by two equations."""

from typing import Any

import numpy as np

import kickdrift as kd
from benchmarks.steps.implicit import add
from benchmarks.steps.pair import Floats, Pair, by_hand

G = 9.81
X0 = np.array([[1.0, 0.0], [1.0, 1.0]])


def gravity(x: Any, out: Any) -> None:
    """Force, as a user writes it."""
    for i in range(2):
        out[i, 0], out[i, 1] = 0.0, -G


def rods(x: Any) -> Any:
    """Constraints, as a user writes them."""
    dx, dy = x[1, 0] - x[0, 0], x[1, 1] - x[0, 1]
    return np.array([x[0, 0] ** 2 + x[0, 1] ** 2 - 1.0, dx * dx + dy * dy - 1.0])


def derivatives(x: Any, out: Any) -> None:
    """Their derivatives, as a user writes them."""
    dx, dy = x[1, 0] - x[0, 0], x[1, 1] - x[0, 1]
    out[0, 0, 0], out[0, 0, 1], out[0, 1, 0], out[0, 1, 1] = 2 * x[0, 0], 2 * x[0, 1], 0.0, 0.0
    out[1, 0, 0], out[1, 0, 1], out[1, 1, 0], out[1, 1, 1] = -2 * dx, -2 * dy, 2 * dx, 2 * dy


@by_hand
def jacobian(x: Floats, J: Floats) -> None:
    """Write the derivatives of the constraints, (2, 4)."""
    dx, dy = x[2] - x[0], x[3] - x[1]
    J[0, 0], J[0, 1], J[0, 2], J[0, 3] = 2 * x[0], 2 * x[1], 0.0, 0.0
    J[1, 0], J[1, 1], J[1, 2], J[1, 3] = -2 * dx, -2 * dy, 2 * dx, 2 * dy


@by_hand
def gram(J: Floats) -> tuple[float, float, float]:
    """Return J J^T, which is symmetric."""
    a = b = d = 0.0
    for k in range(4):
        a, b, d = a + J[0, k] * J[0, k], b + J[0, k] * J[1, k], d + J[1, k] * J[1, k]
    return a, b, d


@by_hand
def rattle(x: Floats, v: Floats, h: float, steps: int) -> None:
    """Kick, drift, project, kick, project; positions until the increments stop shrinking, with the matrix kept."""
    J, total, y = np.zeros((2, 4)), np.zeros(4), np.zeros(4)
    lost_x, lost_v = np.zeros(4), np.zeros(4)
    jacobian(x, J)
    for _ in range(steps):
        for k in range(4):
            add(v, k, -0.5 * h * G if k % 2 else 0.0, lost_v)
        for k in range(4):
            add(x, k, h * v[k], lost_x)
        a, b, d = gram(J)
        determinant = a * d - b * b
        size = 0.0
        for k in range(4):
            total[k] = 0.0
            size = max(size, abs(x[k]))
        previous = np.inf
        for _ in range(50):
            for k in range(4):
                y[k] = x[k] + total[k]
            dx, dy = y[2] - y[0], y[3] - y[1]
            g0, g1 = y[0] * y[0] + y[1] * y[1] - 1.0, dx * dx + dy * dy - 1.0
            m0, m1 = (b * g1 - d * g0) / determinant, (b * g0 - a * g1) / determinant
            moved = 0.0
            for k in range(4):
                change = J[0, k] * m0 + J[1, k] * m1
                total[k] += change
                moved = max(moved, abs(change))
            if moved == 0.0 or (moved <= 1e-12 * size and not moved < previous):
                break
            previous = moved
        for k in range(4):
            add(x, k, total[k], lost_x)
            add(v, k, total[k] / h, lost_v)
        jacobian(x, J)
        for k in range(4):
            add(v, k, -0.5 * h * G if k % 2 else 0.0, lost_v)
        a, b, d = gram(J)
        determinant = a * d - b * b
        for _ in range(2):
            g0 = g1 = 0.0
            for k in range(4):
                g0, g1 = g0 + J[0, k] * v[k], g1 + J[1, k] * v[k]
            m0, m1 = (b * g1 - d * g0) / determinant, (b * g0 - a * g1) / determinant
            for k in range(4):
                add(v, k, J[0, k] * m0 + J[1, k] * m1, lost_v)


def loop(steps: int) -> tuple[Floats, Floats]:
    """Let the pendulum fall from above."""
    x, v = X0.reshape(-1).copy(), np.zeros(4)
    rattle(x, v, 0.001, steps)
    return x, v


def pairs() -> list[Pair]:
    """With and without the derivatives; by hand they are written down in both."""
    options = {"x0": X0, "v0": 0 * X0}
    return [
        Pair(f"rattle, double pendulum, {what}", problem, "rattle", loop, 0.001, options=options, tolerance=1e-8)
        for what, problem in (
            ("Jacobian given", kd.Constrained(gravity, rods, jacobian=derivatives)),
            ("Jacobian by differences", kd.Constrained(gravity, rods)),
        )
    ]
