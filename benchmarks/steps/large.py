"""Semi-implicit Euler on states that do not fit into the cache, by loops that pass over memory as rarely as they can."""

from typing import Any

import numpy as np

from benchmarks.steps.pair import Floats, Pair, by_hand

OSCILLATORS, SIDE = 1_000_000, 1000
STEPS = 100


def springs(x: Any, out: Any) -> None:
    """Acceleration of oscillators, as a user writes it."""
    for i in range(x.size):
        out[i] = -x[i]


def membrane(x: Any, out: Any) -> None:
    """Wave equation, the edges fixed, as a user writes it."""
    rows, columns = x.shape
    for j in range(columns):
        out[0, j] = out[rows - 1, j] = 0.0
    for i in range(1, rows - 1):
        out[i, 0] = out[i, columns - 1] = 0.0
        for j in range(1, columns - 1):
            out[i, j] = x[i - 1, j] + x[i + 1, j] + x[i, j - 1] + x[i, j + 1] - 4.0 * x[i, j]


@by_hand
def oscillate(x: Floats, v: Floats, h: float, steps: int) -> None:
    """Kick and drift in one pass."""
    for _ in range(steps):
        for i in range(x.size):
            v[i] += h * -x[i]
            x[i] += h * v[i]


@by_hand
def oscillate_compensated(x: Floats, v: Floats, h: float, steps: int) -> None:
    """Kick and drift in one pass, with compensated sums."""
    lost_x, lost_v = np.zeros_like(x), np.zeros_like(v)
    for _ in range(steps):
        for i in range(x.size):
            change = h * -x[i] - lost_v[i]
            total = v[i] + change
            lost_v[i] = (total - v[i]) - change
            v[i] = total
            change = h * total - lost_x[i]
            total = x[i] + change
            lost_x[i] = (total - x[i]) - change
            x[i] = total


@by_hand
def wave(x: Floats, v: Floats, h: float, steps: int) -> None:
    """Kick a row and drift the row before it, whose neighbours no longer need it."""
    rows, columns = x.shape
    for _ in range(steps):
        for i in range(1, rows):  # row i - 1 drifts after row i was kicked, which sees its old positions
            if i < rows - 1:
                for j in range(1, columns - 1):
                    v[i, j] += h * (x[i - 1, j] + x[i + 1, j] + x[i, j - 1] + x[i, j + 1] - 4.0 * x[i, j])
            if i > 1:
                for j in range(1, columns - 1):
                    x[i - 1, j] += h * v[i - 1, j]


@by_hand
def wave_compensated(x: Floats, v: Floats, h: float, steps: int) -> None:
    """Do the same with compensated sums."""
    lost_x, lost_v = np.zeros_like(x), np.zeros_like(v)
    rows, columns = x.shape
    for _ in range(steps):
        for i in range(1, rows):
            if i < rows - 1:
                for j in range(1, columns - 1):
                    a = x[i - 1, j] + x[i + 1, j] + x[i, j - 1] + x[i, j + 1] - 4.0 * x[i, j]
                    change = h * a - lost_v[i, j]
                    total = v[i, j] + change
                    lost_v[i, j] = (total - v[i, j]) - change
                    v[i, j] = total
            if i > 1:
                for j in range(1, columns - 1):
                    change = h * v[i - 1, j] - lost_x[i - 1, j]
                    total = x[i - 1, j] + change
                    lost_x[i - 1, j] = (total - x[i - 1, j]) - change
                    x[i - 1, j] = total


def pairs() -> list[Pair]:
    """Both with plain and with compensated sums."""
    x0 = np.linspace(1.0, 2.0, OSCILLATORS)
    surface = np.sin(np.linspace(0, 30, SIDE))[:, None] * np.sin(np.linspace(0, 20, SIDE))
    surface[[0, -1]] = surface[:, [0, -1]] = 0.0
    cases = (
        (f"{OSCILLATORS:.0e} oscillators", springs, x0, oscillate, oscillate_compensated),
        (f"wave equation {SIDE} x {SIDE}", membrane, surface, wave, wave_compensated),
    )
    found = []
    for what, force, start, plain, compensated in cases:
        for sums, run in (("plain", plain), ("compensated", compensated)):

            def loop(steps: int, run: Any = run, start: Floats = start) -> tuple[Floats, Floats]:
                x, v = start.copy(), 0 * start
                run(x, v, 0.1, steps)
                return x, v

            options = {"x0": start, "v0": 0 * start, "compensated": sums == "compensated"}
            found.append(Pair(f"{what}, {sums}", force, "semi-implicit-euler", loop, 0.1, STEPS, options))
    return found
