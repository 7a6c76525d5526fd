"""Conserved quantities along a solution."""

from contextlib import suppress
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.calls import address_of, call_interpreted, caller
from kickdrift.core.compilation import Function, compiled, is_users, specialise, unbound
from kickdrift.core.kinds import Kind
from kickdrift.core.naming import comes_with_kickdrift, specialised_name
from kickdrift.engine.flows.layout import FLAT, call_flat
from kickdrift.systems.system import System

Floats = NDArray[np.float64]

call = caller(FLAT)
function: Any = unbound


@compiled
def _evaluate(quantity: Any, t: Floats, xs: Floats, vs: Floats, params: Floats, out: Floats) -> None:
    for row in range(t.size):
        call(quantity, (t[row], xs[row], vs[row], params, out[row]))


def _call_or_nan(quantity: Function, arguments: tuple[Any, ...]) -> None:
    """Call a quantity; where it raises it has no value, and the run before is not lost for that."""
    try:
        call_interpreted(quantity, arguments)
    except Exception:
        arguments[-1][:] = np.nan


_evaluate_interpreted = specialise(_evaluate.py_func, "evaluate_interpreted", call=_call_or_nan)  # type: ignore[attr-defined]


def _entry(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    function(t, x, v, params, out)


@lru_cache(maxsize=256)
def _native(quantity: Function, packaged: bool) -> Function:
    return compiled(cached=packaged and comes_with_kickdrift(quantity))(
        specialise(_entry, specialised_name(quantity), function=quantity)
    )


def evaluate(system: System, name: str, t: Floats, x: Floats, v: Floats) -> Floats:
    """Evaluate a conserved quantity of a system at each of T states.

    Returns
    -------
    array
        Shape (T,) for a scalar, (T, size) for a vector.
    """
    quantity = system.quantities[name]
    xs, vs = x.reshape(t.size, system.x0.size), v.reshape(t.size, system.v0.size)
    out = np.zeros((t.size, quantity.size))
    params = system.params if quantity.params is None else quantity.params
    if not hasattr(quantity.function, "py_func"):
        with np.errstate(all="ignore"):
            _evaluate_interpreted(quantity.function, t, xs, vs, params, out)
    else:
        native = quantity.function if is_users(quantity.function) else _native(quantity.function, system.packaged)
        _evaluate(address_of(native, FLAT), t, xs, vs, params, out)
    return out[:, 0] if quantity.size == 1 else out


def energy_lost(system: System, t: Floats, x: Floats, v: Floats) -> str:
    """Return a sentence on an energy that is farther off at the end than it was large, kinetic and potential; or nothing.

    Forces that change with time, friction and noise do work: there it says nothing. A function that raises does so when it is
    asked for, and not for this.
    """
    conserved = Kind.HAMILTONIAN.includes(system.kind) or system.kind is Kind.CONSTRAINED
    times = 0.0
    if "energy" in system.quantities and t.size > 1 and conserved:
        with suppress(Exception), np.errstate(all="ignore"):
            times = _times_its_size(system, t, x, v)
    if not 1.0 < times < np.inf:
        return ""
    return f" The energy is off by {times:.3g} times its size: the states are wrong; try a smaller step."


def _times_its_size(system: System, t: Floats, x: Floats, v: Floats) -> float:
    """Change of the energy over its parts at the start; 0.0 where forces change with time."""
    rows, start, end = [0, 0, -1], x[:1], x[-1:]
    states = np.concatenate((start, start, end)), np.concatenate((np.zeros_like(v[:1]), v[:1], v[-1:]))
    potential, first, last = evaluate(system, "energy", t[rows], *states)
    times = float(abs(last - first) / (abs(potential) + abs(first - potential)))
    return times if times > 1.0 and not _is_driven(system, t, x[-1], v[-1]) else 0.0


def _is_driven(system: System, t: Floats, x: Floats, v: Floats) -> bool:
    """Whether a state is accelerated otherwise at the start of the time than at its end."""
    accelerations = np.zeros((2, system.v0.size))
    for when, out in zip(t[[0, -1]], accelerations, strict=True):
        arguments = when, x.reshape(-1).copy(), v.reshape(-1).copy(), system.params, out
        if system.native:
            call_flat(system.acceleration, *arguments)
        else:
            system.acceleration(*arguments)
    return not np.array_equal(*accelerations)
