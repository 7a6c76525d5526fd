"""A kick under a force modified by the gradient of its square, for methods of order 4 without negative coefficients.

A template, see `kickdrift.engine.flows.kick_drift`.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import unbound
from kickdrift.engine.flows.layout import change_of_v, coefficients_at

Floats = NDArray[np.float64]

acceleration_at: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound


def gradient_kick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h under a + c h^2 grad |a|^2 at (t, x), with the method's coefficient c.

    Where a = F / m, grad |a|^2 stands for 2 (da/dx) a, which is the gradient of F . F / m divided by m. Displaced along
    a, as a(x + 2 c h^2 a), the acceleration has it to the order h^4, without derivatives (Wisdom, Holman, Touma, Fields
    Inst. Commun. 10, 217 (1996), section 10). The kick is then the gradient of something to that order only.
    """
    n = x.size
    a, displaced = work[:n], change_of_v(n, work)
    acceleration_at(t, x, v, params, work, a)
    shift = 2.0 * work[coefficients_at(n)] * h * h
    for i in range(n):
        displaced[i] = x[i] + shift * a[i]
    acceleration_at(t, displaced, v, params, work, a)
    add_to_v(v, h, a, work)
