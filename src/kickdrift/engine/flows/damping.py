"""The flow of linear damping, v' = -c v / m, which is exact.

A template, see `kickdrift.engine.flows.kick_drift`. The damping rates c / m are the last params.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.engine.flows.layout import change_of_v

Floats = NDArray[np.float64]

add_to_v: Callable[..., None] = unbound


def damp(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Multiply v by exp(-h c / m)."""
    change = change_of_v(v.size, work)
    decay(h, params[params.size - v.size :], v, change)
    add_to_v(v, 1.0, change, work)


@compiled
def decay(h: float, rates: Floats, v: Floats, change: Floats) -> None:
    """Write the loss of v in h at these rates."""
    rate, lost = 0.0, 0.0
    for i in range(v.size):
        if rates[i] != rate:  # usually all are equal, and one exponential suffices
            rate = rates[i]
            lost = math.expm1(-h * rate)
        change[i] = lost * v[i]
