"""Gauss 4 on the discrete nonlinear Schroedinger equation, a ring of oscillators, by the fixed point of its stages."""

from typing import Any

import numpy as np

import kickdrift as kd
from benchmarks.steps.implicit import add
from benchmarks.steps.pair import Floats, Pair, by_hand

SIZES = {64: 2000, 2000: 100, 20_000: 20}  # numbers of the state, and steps to take
STEPS = 0.1, 0.3  # at the larger one the fixed point contracts slowly


@by_hand
def rate(of: Floats, other: Floats, sign: float, out: Floats) -> None:
    """Write the rate of positions or momenta."""
    n = of.size
    for j in range(n):
        left, right = of[j - 1 if j > 0 else n - 1], of[j + 1 if j < n - 1 else 0]
        out[j] = sign * (2.0 * of[j] - left - right + (of[j] * of[j] + other[j] * other[j]) * of[j])


def by_positions(q: Any, p: Any, out: Any) -> None:
    """Write the derivative of the energy by q, as a user writes it."""
    n = q.size
    for j in range(n):
        left, right = q[j - 1 if j > 0 else n - 1], q[j + 1 if j < n - 1 else 0]
        out[j] = 2.0 * q[j] - left - right + (q[j] * q[j] + p[j] * p[j]) * q[j]


def by_momenta(q: Any, p: Any, out: Any) -> None:
    """Write the derivative of the energy by p, as a user writes it."""
    n = q.size
    for j in range(n):
        left, right = p[j - 1 if j > 0 else n - 1], p[j + 1 if j < n - 1 else 0]
        out[j] = 2.0 * p[j] - left - right + (q[j] * q[j] + p[j] * p[j]) * p[j]


@by_hand
def gauss_4(q: Floats, p: Floats, h: float, steps: int, a: Floats, b: Floats, onward: Floats) -> None:
    """Take steps; the stages end where their increments stop shrinking."""
    s, n = b.size, q.size
    Q, P, dQ, dP = np.zeros((s, n)), np.zeros((s, n)), np.zeros((s, n)), np.zeros((s, n))
    lost_q, lost_p = np.zeros(n), np.zeros(n)
    for _ in range(steps):
        for i in range(s):
            for k in range(n):
                to_q = to_p = 0.0
                for j in range(s):
                    to_q, to_p = to_q + onward[i, j] * dQ[j, k], to_p + onward[i, j] * dP[j, k]
                Q[i, k], P[i, k] = q[k] + h * to_q, p[k] + h * to_p
        previous = np.inf
        for _ in range(50):
            for i in range(s):
                rate(P[i], Q[i], 1.0, dQ[i])
                rate(Q[i], P[i], -1.0, dP[i])
            size, scale = 0.0, 0.0
            for i in range(s):
                for k in range(n):
                    to_q = to_p = 0.0
                    for j in range(s):
                        to_q, to_p = to_q + a[i, j] * dQ[j, k], to_p + a[i, j] * dP[j, k]
                    at_q, at_p = q[k] + h * to_q, p[k] + h * to_p
                    size = max(size, abs(at_q - Q[i, k]), abs(at_p - P[i, k]))
                    scale = max(scale, abs(at_q), abs(at_p))
                    Q[i, k], P[i, k] = at_q, at_p
            if size == 0.0 or (size <= 1e-12 * scale and not size < previous):
                break
            previous = size
        for k in range(n):
            to_q = to_p = 0.0
            for j in range(s):
                to_q, to_p = to_q + b[j] * dQ[j, k], to_p + b[j] * dP[j, k]
            add(q, k, h * to_q, lost_q)
            add(p, k, h * to_p, lost_p)


def _pair(size: int, steps: int, step: float) -> Pair:
    sites = np.arange(size // 2)
    q0, p0 = np.cos(2 * np.pi * sites / sites.size) + 0.2 * np.sin(1.7 * sites), 0.3 * np.sin(2.9 * sites)
    tableau = kd.methods.get("gauss-4").tableau()
    coefficients = tableau._a.copy(), tableau._b.copy(), tableau.onward.copy()

    def loop(steps: int) -> tuple[Floats, Floats]:
        q, p = q0.copy(), p0.copy()
        gauss_4(q, p, step, steps, *coefficients)
        return q, p

    problem = kd.Hamiltonian(dHdq=by_positions, dHdp=by_momenta)
    what = f"gauss-4, chain of {size} unknowns, step {step}"
    return Pair(what, problem, "gauss-4", loop, step, steps, {"x0": q0, "v0": p0})


def pairs() -> list[Pair]:
    """Chains of all sizes."""
    return [_pair(size, steps, step) for size, steps in SIZES.items() for step in STEPS]
