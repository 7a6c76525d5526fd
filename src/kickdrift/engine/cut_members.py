"""Impacts and switches of the members of an ensemble: the numbers of a controller that is made for the first of them."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.controller import Controller
from kickdrift.engine.flows import surfaces as layout
from kickdrift.engine.impact_checks import BEYOND
from kickdrift.engine.quantities import evaluate_quantity
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


def cut_numbers(
    controller: Controller, system: System, t0: float, x: Floats, v: Floats, of_function: Floats
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Return the params of the controller of each member, the sides of its switches, and which may start there.

    The members start from x and v, (M, n), and `of_function`, (M, p), are the params of the function of gaps.
    """
    assert controller.function is not None
    count = controller.function.size
    gaps = evaluate_quantity(controller.function, system, np.full(len(x), t0), x, v, of_function).reshape(-1, count)
    numbers = np.tile(controller.params, (len(x), 1))
    rows = numbers[:, layout.HEAD : layout.HEAD + layout.ROWS * count].reshape(len(x), layout.ROWS, count)
    lengths, switch = np.abs(x).max(axis=1), rows[0, layout.SWITCH] != 0.0
    lengths[lengths == 0.0] = 1.0
    sides = np.where(gaps[:, switch] < 0.0, -1.0, 1.0)
    rows[:, layout.SIDE, switch] = sides
    numbers[:, layout.HEAD : layout.HEAD + layout.ROWS * count] = rows.reshape(len(x), -1)
    numbers[:, layout.LENGTH] = lengths
    numbers[:, numbers.shape[1] - of_function.shape[1] :] = of_function
    closed = gaps[:, ~switch] < -BEYOND * lengths[:, None]
    return numbers, sides, np.isfinite(gaps).all(axis=1) & ~closed.any(axis=1)
