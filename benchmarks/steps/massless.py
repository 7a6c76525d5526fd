"""Wisdom-Holman with massless bodies by hand: they feel the planets, and nothing feels them."""

import math
from typing import Any

import numpy as np

import kickdrift as kd
from benchmarks.steps.pair import Floats, Pair, by_hand
from kickdrift.engine.flows.kepler import gauss_functions

MASSLESS = (0, 100, 1000)
STEP = 20.0  # days
Vector = tuple[float, float, float]


@by_hand
def attraction(gm: float, x: float, y: float, z: float) -> float:
    """Return gm over the cube of a distance."""
    r2 = x * x + y * y + z * z
    return gm / (r2 * math.sqrt(r2))


@by_hand
def remainder(x: Floats, gm: Floats, planets: int, a: Floats) -> None:
    """Write what the planets do to all, positions relative to the star: democratic heliocentric coordinates."""
    for i in range(1, len(x)):
        ax = ay = az = 0.0
        for j in range(1, planets):
            if j != i:
                dx, dy, dz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
                w = attraction(gm[j], dx, dy, dz)
                ax, ay, az = ax + w * dx, ay + w * dy, az + w * dz
        a[i, 0], a[i, 1], a[i, 2] = ax, ay, az


@by_hand
def jump(h: float, x: Floats, v: Floats, gm: Floats, planets: int) -> None:
    """Move all by the motion of the star."""
    for k in range(3):
        total = 0.0
        for i in range(1, planets):
            total += gm[i] / gm[0] * v[i, k]
        for i in range(1, len(x)):
            x[i, k] += h * total


@by_hand
def wisdom_holman(x: Floats, v: Floats, gm: Floats, planets: int, h: float, steps: int) -> None:
    """Take steps of a Kepler flow over half, a kick, and a Kepler flow over half; the halves between are one."""
    a = np.zeros_like(x)
    for step in range(steps + 1):
        share = 0.5 * h if step in (0, steps) else h
        for i in range(1, len(x)):
            rx, ry, rz, ux, uy, uz = x[i, 0], x[i, 1], x[i, 2], v[i, 0], v[i, 1], v[i, 2]
            r, eta, u2 = (
                math.sqrt(rx * rx + ry * ry + rz * rz),
                rx * ux + ry * uy + rz * uz,
                ux * ux + uy * uy + uz * uz,
            )
            f, g, df, dg, _ = gauss_functions(gm[0], share, r, eta, u2)
            x[i, 0], x[i, 1], x[i, 2] = rx + (f * rx + g * ux), ry + (f * ry + g * uy), rz + (f * rz + g * uz)
            v[i, 0], v[i, 1], v[i, 2] = ux + (df * rx + dg * ux), uy + (df * ry + dg * uy), uz + (df * rz + dg * uz)
        if step < steps:
            jump(0.5 * h, x, v, gm, planets)
            remainder(x, gm, planets, a)
            for i in range(1, len(x)):
                for k in range(3):
                    v[i, k] += h * a[i, k]
            jump(0.5 * h, x, v, gm, planets)


def system(count: int) -> tuple[Any, Floats, Floats, Floats]:
    """Make the giant planets with massless bodies between 45 and 60 au, and return their G m, x and v, too."""
    outer = kd.systems.outer_solar_system()
    gm = np.concatenate([outer.params[2:7], np.zeros(count)])  # without Pluto
    radius, angle = np.linspace(45.0, 60.0, count), 2.4 * np.arange(count)
    around = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    across = np.stack([-np.sin(angle), np.cos(angle), 0 * angle], axis=1)
    x = np.concatenate([outer.x0[:5], outer.x0[0] + radius[:, None] * around])
    v = np.concatenate([outer.v0[:5], outer.v0[0] + np.sqrt(gm[0] / radius)[:, None] * across])
    G = outer.params[0]
    made = kd.systems.planetary(gm / G, x, v, G, splitting="democratic-heliocentric")
    return made, gm, made.x0.copy(), made.v0.copy()


def _pair(count: int) -> Pair:
    made, gm, x0, v0 = system(count)

    def loop(steps: int) -> tuple[Floats, Floats]:
        x, v = made.frame.enter(x0, v0)
        wisdom_holman(x, v, gm, 5, STEP, steps)
        x[0] += steps * STEP * v[0]
        x, v = made.frame.leave(x, v)
        return x, v

    what, steps = f"wisdom-holman, {count} massless bodies", 200_000 // (count + 10)
    options = {"compensated": False}
    return Pair(what, made, "wisdom-holman", loop, STEP, steps, options, tolerance=1e-7)


def pairs() -> list[Pair]:
    """Few and many of them."""
    return [_pair(count) for count in MASSLESS]
