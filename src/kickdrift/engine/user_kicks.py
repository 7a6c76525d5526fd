"""Kicks of large states by a user's force: the force is added to the velocities while it is written.

A force that fills an array, and a sum that reads it, pass over memory twice and once; here it is once, without the array.
The bits are the same where the force writes each of its numbers once. How often it does is counted once, and is the same
at all times where `kickdrift.engine.writing` can tell; so is whether indices are within bounds, which need not be checked
any more.
"""

from collections.abc import Callable
from functools import lru_cache
from types import FunctionType
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from kickdrift.core import memory
from kickdrift.core.accumulator import added_to
from kickdrift.core.calls import address_of
from kickdrift.core.compilation import Function, compiled
from kickdrift.core.views import part
from kickdrift.engine.flows.layout import FLAT, call_flat
from kickdrift.engine.function_key import Taken, taken_apart
from kickdrift.engine.user_functions import NOT_COMPILED, Layout
from kickdrift.engine.writing import writing_of

Floats = NDArray[np.float64]
LARGE = (
    1 << 16
)  # numbers of a state: three arrays of them fill most caches of one core, and two compilations are worth it

_TEMPLATES = {
    "kick": """
def kick(t, h, x, v, params, work):
    {statement}
""",
    "writings": """
def writings(t, x, v, params, out):
    {statement}
""",
}
_SCOPE = {"shaped": memory.shaped, "read_only": memory.read_only, "added_to": added_to, "part": part}


def kick_of(
    function: Any,
    names: list[str],
    layout: Layout,
    state: tuple[float, Floats, Floats, Floats],
    checked: bool,
    of_force: bool,
) -> Callable[[bool], Function] | None:
    """Return a maker of a kick, with or without compensated sums, from a function that writes each number of `out` once.

    None for other functions. The `state` is t, x, v and params, to test it with. The function gives an acceleration, or a
    force, and then the last params are inverse masses.
    """
    taken = taken_apart(function)
    if not taken.known or taken.options(checked).get("fastmath"):
        return None
    python = getattr(function, "py_func", function)
    writing = writing_of(python, frozenset(names) - {"out", "params"})
    if writing is None:
        return None
    numbers = {name: value for name, value in taken.numbers.items() if name not in names}

    def spelled(values: str, h: str, factors: str = "None", residual: str = "None") -> str:
        into, by, lost = (
            array if array == "None" else layout.shaped(array, layout.result) for array in (values, factors, residual)
        )
        return layout.statement(names, numbers, out=f"added_to({into}, {h}, {by}, {lost})")

    try:
        count = _bound(taken, "writings", spelled("out", "None"), checked)
        address_of(count, FLAT)
    except NOT_COMPILED:
        return None
    out = np.zeros(state[1].size)
    with np.errstate(all="ignore"):
        call_flat(count, *state, out)
    if not (out == 1.0).all():
        return None

    def kick(compensated: bool) -> Function:
        residual = "part(work, 2 * v.size, v.size)" if compensated else "None"
        factors = "part(params, params.size - v.size, v.size)" if of_force else "None"
        return _bound(taken, "kick", spelled("v", "h", factors, residual), checked and not writing.reads_same)

    return kick


@lru_cache(maxsize=256)
def _bound(taken: Taken, name: str, statement: str, checked: bool) -> Function:
    inner = compiled(cached=False, inline=True, options=taken.options(checked))(taken.snapshot(checked))
    scope: dict[str, Any] = {}
    exec(_TEMPLATES[name].format(statement=statement), scope)  # noqa: S102 - our own templates, above
    made = FunctionType(scope[name].__code__, {"__name__": __name__, **_SCOPE, "function": inner}, name)
    made.__qualname__ = f"{name}_{taken.digest(statement, checked)}"
    return compiled(users=True)(cast(Function, made))
