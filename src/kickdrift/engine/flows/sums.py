"""The sums of the flows, plain and compensated, compiled and for the interpreter, with the same operations and bits."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import Function, compiled
from kickdrift.core.views import part

Floats = NDArray[np.float64]


@compiled(inline=True)
def add(y: Floats, h: float, rate: Floats, work: Floats) -> None:
    """Y += h rate."""
    for i in range(y.size):
        y[i] += h * rate[i]


@compiled(inline=True)
def _add_compensated(y: Floats, h: float, rate: Floats, residual: Floats) -> None:
    # Kahan, Comm. ACM 8, 40 (1965): the rounding error of a sum is passed to the next.
    for i in range(y.size):
        increment = h * rate[i] - residual[i]
        total = y[i] + increment
        residual[i] = (total - y[i]) - increment
        y[i] = total


@compiled(inline=True)
def add_to_x_compensated(x: Floats, h: float, rate: Floats, work: Floats) -> None:
    """X += h rate, with the rounding kept in work."""
    _add_compensated(x, h, rate, part(work, x.size, x.size))


@compiled(inline=True)
def add_to_v_compensated(v: Floats, h: float, rate: Floats, work: Floats) -> None:
    """V += h rate, with the rounding kept in work."""
    _add_compensated(v, h, rate, part(work, 2 * v.size, v.size))


def add_interpreted(y: Any, h: float, rate: Any, work: Any) -> None:
    """`add` for the interpreter, on whole arrays."""
    y += h * rate


def _add_compensated_interpreted(y: Any, h: float, rate: Any, residual: Any) -> None:
    increment = h * rate - residual
    total = y + increment
    residual[:] = (total - y) - increment
    y[:] = total


def add_to_x_compensated_interpreted(x: Any, h: float, rate: Any, work: Any) -> None:
    """`add_to_x_compensated` for the interpreter."""
    _add_compensated_interpreted(x, h, rate, work[x.size : 2 * x.size])


def add_to_v_compensated_interpreted(v: Any, h: float, rate: Any, work: Any) -> None:
    """`add_to_v_compensated` for the interpreter."""
    _add_compensated_interpreted(v, h, rate, work[2 * v.size : 3 * v.size])


def sums(native: bool, compensated: bool) -> dict[str, Function]:
    """Return the functions to which ``add_to_x`` and ``add_to_v`` of the flows are bound."""
    if compensated and native:
        return {"add_to_x": add_to_x_compensated, "add_to_v": add_to_v_compensated}
    if compensated:
        return {"add_to_x": add_to_x_compensated_interpreted, "add_to_v": add_to_v_compensated_interpreted}
    plain = add if native else add_interpreted
    return {"add_to_x": plain, "add_to_v": plain}
