"""The flows of a magnetic field, v' = (q/m) v x B(t, x): v rotates about B at constant x.

Templates, see `kickdrift.engine.flows.kick_drift`. The system's part ``magnetic_field`` is w = (q/m) B, and v turns by
the angle -|w| h about it.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.engine.flows.layout import change_of_v

Floats = NDArray[np.float64]

magnetic_field_at: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound


def rotate(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Rotate v by the exact angle."""
    change = change_of_v(v.size, work)
    magnetic_field_at(t, x, v, params, work, change)
    turn(h, v, change)
    add_to_v(v, 1.0, change, work)


def boris_rotate(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Rotate v by 2 atan(|w| h / 2), which needs no trigonometric functions."""
    change = change_of_v(v.size, work)
    magnetic_field_at(t, x, v, params, work, change)
    boris_turn(h, v, change)
    add_to_v(v, 1.0, change, work)


@compiled
def turn(h: float, v: Floats, change: Floats) -> None:
    """Overwrite w, in `change`, with the change of v in h.

    Rodrigues' formula: sin(a) (v x u) + (1 - cos(a)) ((v x u) x u) for the angle a = |w| h and the axis u = w / |w|.
    """
    for i in range(0, v.size, 3):
        rate = math.sqrt(_square(i, change))
        if rate > 0.0:
            half = math.sin(0.5 * h * rate) / rate
            _rotated(i, v, change, 2.0 * half * math.cos(0.5 * h * rate), 2.0 * half * half)
        else:
            change[i] = change[i + 1] = change[i + 2] = rate  # nothing, or not a number


@compiled
def boris_turn(h: float, v: Floats, change: Floats) -> None:
    """Overwrite w, in `change`, with the change of v in Boris' step, (v + v x w h/2) x w h / (1 + |w h/2|^2)."""
    for i in range(0, v.size, 3):
        weight = h / (1.0 + 0.25 * h * h * _square(i, change))
        _rotated(i, v, change, weight, 0.5 * h * weight)


@compiled(inline=True)
def _square(i: int, w: Floats) -> float:
    return float(w[i] * w[i] + w[i + 1] * w[i + 1] + w[i + 2] * w[i + 2])


@compiled(inline=True)
def _rotated(i: int, v: Floats, change: Floats, first: float, second: float) -> None:
    """Write first (v x w) + second ((v x w) x w) over w for the particle whose numbers start at i."""
    wx, wy, wz = change[i], change[i + 1], change[i + 2]
    x = v[i + 1] * wz - v[i + 2] * wy
    y = v[i + 2] * wx - v[i] * wz
    z = v[i] * wy - v[i + 1] * wx
    change[i] = first * x + second * (y * wz - z * wy)
    change[i + 1] = first * y + second * (z * wx - x * wz)
    change[i + 2] = first * z + second * (x * wy - y * wx)
