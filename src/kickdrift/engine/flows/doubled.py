"""Flows of a doubled phase space, which split Hamiltonians H(q, p) that are not separable.

With copies X of q and Y of p, the Hamiltonian H(q, Y) + H(X, p) + omega (|q - X|^2 + |p - Y|^2) / 2 moves both
alike, and each of its parts is solved exactly: the first kicks p and drifts X, the second drifts q and kicks Y, the
third turns the differences (Tao, Phys. Rev. E 94, 043303 (2016), eqs. 2 to 4). The coefficient is omega. Time has a
copy, too, which moves with the first part; the copies are not bound in it.

Templates, see `kickdrift.engine.flows.kick_drift`.

Memory is laid out like work, for the sums: X, the rounding errors of the sums for X and for Y, and Y (n each).
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.layout import VELOCITY, coefficients_at, has_part, memory

Floats = NDArray[np.float64]

acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound


def memory_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers."""
    return 4 * n


def double(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Write the copies, without moving the state."""
    x_copy, v_copy = copies(x.size, work)
    assign(x_copy, x)
    assign(v_copy, v)


def doubled_kick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v and the copy of x by h at their rates at x and the copy of v."""
    n = x.size
    x_copy, v_copy = copies(n, work)
    evaluate(t, x, v_copy, params, work)
    add_to_v(v, h, work[:n], work)
    add_to_x(x_copy, h, work[3 * n : 4 * n], memory(work))


def doubled_drift(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and the copy of v by h at their rates at the copy of x and v."""
    n = x.size
    x_copy, v_copy = copies(n, work)
    evaluate(t, x_copy, v, params, work)
    add_to_x(x, h, work[3 * n : 4 * n], work)
    add_to_v(v_copy, h, work[:n], memory(work))


def doubled_binding(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Rotate the differences between state and copies by 2 omega h, about the means."""
    n = x.size
    x_copy, v_copy = copies(n, work)
    angle = 2.0 * work[coefficients_at(n)] * h
    sine, less = math.sin(angle), -2.0 * math.sin(0.5 * angle) ** 2  # cos(angle) - 1
    v_change, x_change = work[:n], work[3 * n : 4 * n]
    for i in range(n):
        dx, dv = x[i] - x_copy[i], v[i] - v_copy[i]
        x_change[i] = less * dx + sine * dv
        v_change[i] = less * dv - sine * dx
    add_to_x(x, 0.5, x_change, work)
    add_to_v(v, 0.5, v_change, work)
    add_to_x(x_copy, -0.5, x_change, memory(work))
    add_to_v(v_copy, -0.5, v_change, memory(work))


def evaluate(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Write the rates of x and v into work."""
    n = x.size
    if has_part(VELOCITY, work):
        velocity_at(t, x, v, params, work, work[3 * n : 4 * n])
    else:
        assign(work[3 * n : 4 * n], v)
    acceleration_at(t, x, v, params, work, work[:n])


@compiled(inline=True)
def copies(n: int, work: Floats) -> tuple[Floats, Floats]:
    """Return the copies of x and v."""
    own = memory(work)
    return own[:n], own[3 * n : 4 * n]
