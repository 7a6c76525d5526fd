"""Conserved quantities along a solution."""

from contextlib import suppress
from functools import lru_cache
from typing import Any

import numpy as np
from numba import carray
from numpy.typing import NDArray

from kickdrift.core.calls import address_of, call_interpreted, caller
from kickdrift.core.compilation import Function, compiled, is_users, reorders, specialise, unbound
from kickdrift.core.kinds import Kind
from kickdrift.core.memory import floats_at, start_of_array
from kickdrift.core.naming import comes_with_kickdrift, specialised_name
from kickdrift.engine.flows.layout import FLAT, call_flat
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]

call = caller(FLAT)
function: Any = unbound

_MANY = 1 << 13  # rows from which on a user's function is compiled into the loop: 0.3 s once, for 11 to 21 ns a row


@compiled
def _evaluate(quantity: Any, t: Floats, xs: Any, vs: Any, numbers: Any, out: Any, sizes: Any) -> None:
    """Evaluate a quantity at states that lie one after the other at addresses: slices of arrays would cost 100 ns each time.

    Each of the `numbers` are the params of as many states.
    """
    size, size_of_v, size_of_out, members, size_of_params = sizes
    for member in range(members):
        params = carray(floats_at(numbers + 8 * size_of_params * member), (size_of_params,))
        for row in range(member * t.size // members, (member + 1) * t.size // members):
            x = carray(floats_at(xs + 8 * size * row), (size,))
            v = carray(floats_at(vs + 8 * size_of_v * row), (size_of_v,))
            call(quantity, (t[row], x, v, params, carray(floats_at(out + 8 * size_of_out * row), (size_of_out,))))


def _call_inside(quantity: Any, arguments: Any) -> None:
    function(*arguments)


@lru_cache(maxsize=256)
def _evaluate_inside(quantity: Any) -> Function:
    """Return `_evaluate` with a user's function inlined, which needs no address."""
    name = f"{_evaluate.__name__}_{quantity.__qualname__}"
    inside = compiled(cached=False, inline=True)(specialise(_call_inside, f"call_of_{name}", function=quantity))
    return compiled(users=True)(specialise(_evaluate.py_func, name, call=inside))  # type: ignore[attr-defined]


def _call_or_nan(quantity: Function, arguments: tuple[Any, ...]) -> Exception | None:
    """Call a quantity; if it raises, its value is NaN, so that the run is not lost, and the error is returned."""
    try:
        call_interpreted(quantity, arguments)
    except Exception as error:
        arguments[-1][:] = np.nan
        return error
    return None


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
    return evaluate_quantity(system.quantities[name], system, t, x, v)


def evaluate_quantity(
    quantity: Quantity,
    system: System,
    t: Floats,
    x: Floats,
    v: Floats,
    numbers: Floats | None = None,
    raised: dict[int, Exception] | None = None,
) -> Floats:
    """Evaluate any function of the state in the same way; each row of `numbers`, if given, as params of as many states.

    The errors of an interpreted function are added to `raised`, by their rows.
    """
    xs, vs = x.reshape(t.size, system.x0.size), v.reshape(t.size, system.v0.size)
    out = np.zeros((t.size, quantity.size))
    params = (system.params if quantity.params is None else quantity.params)[None] if numbers is None else numbers
    params = np.ascontiguousarray(params)
    if not hasattr(quantity.function, "py_func"):
        with np.errstate(all="ignore"):
            for row in range(t.size):
                own = params[row * len(params) // t.size]
                error = _call_or_nan(quantity.function, (t[row], xs[row], vs[row], own, out[row]))
                if error is not None and raised is not None:
                    raised[row] = error
    else:
        users = is_users(quantity.function)
        native = quantity.function if users else _native(quantity.function, system.packaged)
        xs, vs = np.ascontiguousarray(xs), np.ascontiguousarray(vs)
        sizes = xs.shape[1], vs.shape[1], quantity.size, *params.shape
        addresses = [start_of_array(array) for array in (xs, vs, params, out)]
        inside = (
            users and t.size >= _MANY and not reorders(native)
        )  # or else its bits would depend on how many rows there are
        address = 0 if inside else address_of(native, FLAT)
        run: Any = _evaluate_inside(native) if inside else _evaluate
        run(address, t, *addresses, sizes)
    return out[:, 0] if quantity.size == 1 else out


def energy_lost(system: System, t: Floats, x: Floats, v: Floats) -> str:
    """Return a sentence on an energy that is farther off at the end than it was large, kinetic and potential; or nothing.

    Forces that change with time, friction, noise, impacts and switches do work: there it is not meaningful. A function that
    raises does so when it is accessed, and not here.
    """
    conserved = Kind.HAMILTONIAN.includes(system.kind) or system.kind is Kind.CONSTRAINED
    conserved = conserved and "gaps" not in system.parts
    times = 0.0
    if "energy" in system.quantities and t.size > 1 and conserved:
        with suppress(Exception):
            times = _times_its_size(system, t, x, v)
    if not 1.0 < times < np.inf:
        return ""
    return f" The energy error is {times:.3g} times the energy: the states are wrong; try a smaller step."


def _times_its_size(system: System, t: Floats, x: Floats, v: Floats) -> float:
    """Change of the energy over its parts at the start; 0.0 where forces change with time."""
    rows = [0, 0, -1]
    moving = v[rows]
    moving[0] = 0.0
    potential, first, last = evaluate(system, "energy", t[rows], x[rows], moving).tolist()
    times = abs(last - first) / (abs(potential) + abs(first - potential))
    return times if times > 1.0 and not _is_driven(system, t, x[-1], v[-1]) else 0.0


def _is_driven(system: System, t: Floats, x: Floats, v: Floats) -> bool:
    """Whether a state is accelerated otherwise at the start of the time than at its end."""
    accelerations = np.zeros((2, system.v0.size))
    for when, out in zip(t[[0, -1]], accelerations, strict=True):
        arguments = when, x.reshape(-1).copy(), v.reshape(-1).copy(), system.params, out
        if system.native:
            call_flat(system.acceleration, *arguments)
        else:
            with np.errstate(all="ignore"):
                system.acceleration(*arguments)
    return not np.array_equal(*accelerations)
