"""Many Verlet steps under the fast part of the acceleration within one under the slow part.

A template, see `kickdrift.engine.flows.kick_drift`. How many there are is the coefficient of the method. The system's part
``fast`` is the fast part of the acceleration.

Layout of memory::

    0     whether there is a fast acceleration that was that at x
    1     CHANGES when it was
    8     the fast acceleration (n)
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import unbound
from kickdrift.core.views import part
from kickdrift.engine.flows.layout import CHANGES, EVALUATIONS, coefficients_at, memory

Floats = NDArray[np.float64]
_HEAD = 8

fast_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound


def memory_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers."""
    return _HEAD + n


def substeps(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and v by h. Kicks of the slow part between two calls do not change x, nor the fast acceleration."""
    n, own = x.size, memory(work)
    fast, many = part(own, _HEAD, n), int(work[coefficients_at(n)])
    if own[0] == 0.0 or own[1] != work[CHANGES]:
        fast_at(t, x, v, params, work, fast)
        work[EVALUATIONS] += 1.0
        own[0], own[1] = 1.0, work[CHANGES]
    share = h / many
    for i in range(many):
        add_to_v(v, 0.5 * share, fast, work)
        add_to_x(x, share, v, work)
        fast_at(t + (i + 1) * share, x, v, params, work, fast)
        add_to_v(v, 0.5 * share, fast, work)
    work[EVALUATIONS] += many
