"""Conserved quantities along a solution."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import (
    compile_for,
    compiled,
    first_class_functions,
    specialise,
    specialised_name,
    unbound,
)
from kickdrift.engine.user_functions import FLAT
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]

function: Any = unbound


@compiled
def _evaluate(quantity: Any, t: Floats, xs: Floats, vs: Floats, params: Floats, out: Floats) -> None:
    for row in range(t.size):
        quantity(t[row], xs[row], vs[row], params, out[row])


def _entry(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    function(t, x, v, params, out)


def evaluate(system: System, name: str, t: Floats, x: Floats, v: Floats) -> Floats:
    """Evaluate a conserved quantity of a system at each of T states.

    Returns
    -------
    array
        Shape (T,) for a scalar, (T, size) for a vector.
    """
    quantity: Quantity = system.quantities[name]
    xs, vs = x.reshape(t.size, -1), v.reshape(t.size, -1)
    out = np.zeros((t.size, quantity.size))
    function, loop = quantity.function, _evaluate
    if system.packaged:
        entry = specialise(_entry, specialised_name(function), function=function)
        function = compile_for(FLAT, entry, cached=True)
    elif not hasattr(function, "py_func"):
        loop = _evaluate.py_func  # type: ignore[attr-defined]
    with first_class_functions():
        loop(function, t, xs, vs, system.params, out)
    return out[:, 0] if quantity.size == 1 else out
