"""The flows of Langevin dynamics: friction with noise, and noise alone, which are exact.

Templates, see `kickdrift.engine.flows.kick_drift`. The last params are, n numbers each, frictions gamma and variances
kT / m, and the two halves of the seed. Every call makes one draw, whose number work keeps.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.random import fill_normal
from kickdrift.engine.flows.layout import DRAWN, change_of_v

Floats = NDArray[np.float64]

add_to_v: Callable[..., None] = unbound


def thermostat(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h under friction and noise: v e^{-gamma h} + sqrt(kT/m (1 - e^{-2 gamma h})) xi."""
    change = change_of_v(v.size, work)
    draw(params, work, change)
    relax(h, params, v, change)
    add_to_v(v, 1.0, change, work)


def noise(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h under noise alone: v + sqrt(2 gamma kT/m h) xi."""
    change = change_of_v(v.size, work)
    draw(params, work, change)
    shake(h, params, change)
    add_to_v(v, 1.0, change, work)


def draw(params: Floats, work: Floats, out: Floats) -> None:
    """Write the next normal random numbers: a part of the flows, inlined into them."""
    low, high = np.uint64(params[params.size - 2]), np.uint64(params[params.size - 1])
    fill_normal(low | (high << np.uint64(32)), np.uint64(work[DRAWN]), out)
    work[DRAWN] += 1.0


@compiled
def relax(h: float, params: Floats, v: Floats, change: Floats) -> None:
    """Overwrite normal random numbers with the change of v in h under friction and noise."""
    n = v.size
    frictions, variances = params[params.size - 2 - 2 * n :], params[params.size - 2 - n :]
    friction, lost, spread = 0.0, 0.0, 0.0
    for i in range(n):
        if frictions[i] != friction:  # usually all are equal, and one exponential suffices
            friction = frictions[i]
            lost = math.expm1(-h * friction)
            spread = math.sqrt(-math.expm1(-2.0 * h * friction))
        change[i] = lost * v[i] + spread * math.sqrt(variances[i]) * change[i]


@compiled
def shake(h: float, params: Floats, change: Floats) -> None:
    """Overwrite normal random numbers with the change of v in h under noise alone."""
    n = change.size
    frictions, variances = params[params.size - 2 - 2 * n :], params[params.size - 2 - n :]
    for i in range(n):
        change[i] *= math.sqrt(2.0 * frictions[i] * h * variances[i])
