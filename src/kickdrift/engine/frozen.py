"""What a compiled function has frozen, so that the same function is not compiled twice."""

import math
from collections.abc import Hashable
from inspect import getclosurevars
from types import BuiltinFunctionType, FunctionType
from typing import Any, cast

import numpy as np
from numba.core.dispatcher import Dispatcher

_PLAIN = (bool, int, float, complex, str, bytes, type(None))
_NAMED = (BuiltinFunctionType, type, np.ufunc, Dispatcher)
_STEADY = (math, np, np.linalg)  # modules whose contents nobody changes


def frozen(function: Any) -> Hashable | None:
    """Return a key that is equal for two functions only if Numba compiles them to the same.

    Numba freezes the code of a function, its defaults, and the values that its globals and free variables have when it
    is compiled. Numbers and texts are in the key by value, functions by the same rule. None stands for a function that
    uses anything else, such as an array, which may change without anybody noticing.
    """
    try:
        return _of_value(function, ())
    except _CannotTellError:
        return None


class _CannotTellError(Exception):
    pass


def _of_function(function: Any, callers: tuple[Any, ...]) -> Hashable:
    if not isinstance(function, FunctionType):
        raise _CannotTellError
    if function in callers:
        return "recursion"
    around = (*callers, function)
    try:
        used = getclosurevars(function)
    except ValueError:  # a free variable without a value
        raise _CannotTellError from None
    if any(hasattr(constant, "co_code") for constant in function.__code__.co_consts):
        raise _CannotTellError  # a function inside, whose globals would have to be looked up as well
    names = {**used.globals, **used.nonlocals}
    values = tuple((name, _of_value(value, around)) for name, value in sorted(names.items()))
    return function.__code__, _of_value(function.__defaults__, around), values


def _of_value(value: Any, callers: tuple[Any, ...]) -> Hashable:
    if isinstance(value, _PLAIN):
        return type(value), value
    if isinstance(value, tuple):
        return type(value), tuple(_of_value(member, callers) for member in value)
    if isinstance(value, _NAMED) or any(value is module for module in _STEADY):
        return cast(Hashable, value)
    return _of_function(value, callers)
