"""Step densities by name: the number of steps in a unit of time, up to a factor."""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import Function, compiled, unbound
from kickdrift.core.views import part
from kickdrift.engine.problem_adapter import bind
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]

acceleration: Function = unbound


@compiled
def _by_distance(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    """Write the square root of the sum of 1 / r^3 over all pairs of bodies, or for the distance from the origin.

    The last of the params is the number of coordinates of a body; the others are those of the system, as members of an ensemble
    have them.
    """
    size = int(params[params.size - 1])
    total = 0.0
    for i in range(0, x.size, size):
        for j in range(i):
            if j % size == 0:
                r2 = 0.0
                for k in range(size):
                    r2 += (x[i + k] - x[j + k]) ** 2
                total += 1.0 / (r2 * math.sqrt(r2))
    if x.size == size:
        r2 = 0.0
        for k in range(size):
            r2 += x[k] * x[k]
        total = 1.0 / (r2 * math.sqrt(r2))
    out[0] = math.sqrt(total)


def _by_acceleration(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    """Write the square root of the norm of the acceleration; the last params are scratch space for it."""
    n = v.size
    a = part(params, params.size - n, n)
    acceleration(t, x, v, part(params, 0, params.size - n), a)
    squares = 0.0
    for i in range(n):
        squares += a[i] * a[i]
    out[0] = math.sqrt(math.sqrt(squares))


def by_distance(system: System) -> Quantity:
    """Return the density by the distances between bodies in a state (N, d), or from the origin of a state (d,)."""
    size = system.x0.shape[-1] if system.x0.ndim > 1 else system.x0.size
    return Quantity(_by_distance, params=np.append(system.params, float(size)))


def by_acceleration(system: System) -> Quantity:
    """Return the density by the acceleration."""
    function = bind(_by_acceleration, acceleration=system.acceleration)
    return Quantity(function, params=np.concatenate([system.params, np.zeros(system.v0.size)]))
