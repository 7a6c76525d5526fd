"""The flows of linear damping, v' = -c v / m, alone and with the drift x' = v, which are exact.

Templates, see `kickdrift.engine.flows.kick_drift`. The damping rates c / m are the last params.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import multiply
from kickdrift.engine.flows.layout import change_of_v

Floats = NDArray[np.float64]

_NEGLIGIBLE = 2.0**-54  # damping in a step, beside 1

add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound


def damp(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Multiply v by exp(-h c / m)."""
    change = change_of_v(v.size, work)
    decay(h, params[params.size - v.size :], v, change)
    add_to_v(v, 1.0, change, work)


def damped_drift(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x at v, while v decays: x by v (1 - exp(-h c / m)) m / c, and v by -c / m times as much."""
    change, rates = change_of_v(v.size, work), params[params.size - v.size :]
    coast(h, rates, v, change)
    add_to_x(x, 1.0, change, work)
    multiply(change, rates)
    add_to_v(v, -1.0, change, work)


@compiled
def decay(h: float, rates: Floats, v: Floats, change: Floats) -> None:
    """Write the loss of v in h at these rates."""
    rate, lost = 0.0, 0.0
    for i in range(v.size):
        if rates[i] != rate:  # usually all are equal, and one exponential suffices
            rate = rates[i]
            lost = math.expm1(-h * rate)
        change[i] = lost * v[i]


@compiled
def coast(h: float, rates: Floats, v: Floats, change: Floats) -> None:
    """Write the change of x in h, as v decays at these rates."""
    rate, time = 0.0, h
    for i in range(v.size):
        if rates[i] != rate:
            rate = rates[i]
            time = -math.expm1(-h * rate) / rate if abs(h * rate) > _NEGLIGIBLE else h
        change[i] = time * v[i]
