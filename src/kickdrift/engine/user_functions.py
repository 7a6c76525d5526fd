"""From a user's Python functions to a system: by the names of their arguments, compiled where Numba can."""

import inspect
import warnings
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, cast

import numba
import numpy as np
from numba import types
from numba.core.errors import NumbaError
from numpy.typing import NDArray

from kickdrift.core import memory
from kickdrift.core.compilation import Function, compiled
from kickdrift.core.errors import ArgumentError, InterpretedWarning, KickdriftError
from kickdrift.engine.frozen import frozen
from kickdrift.systems.system import Quantity, SecondOrder, System

Floats = NDArray[np.float64]
_NAMES = ("t", "x", "v", "params", "out")
_VECTOR = types.Array(types.float64, 1, "C")
FLAT = types.none(types.float64, _VECTOR, _VECTOR, _VECTOR, _VECTOR)


def adopt(problem: SecondOrder | Function, t0: float, x0: Floats, v0: Floats, params: Floats, compile_: bool) -> System:
    """Make a system of a user's functions and start.

    Raises
    ------
    ArgumentError
        For a function with other argument names, or whose result does not have the shape of x0.
    """
    described = problem if isinstance(problem, SecondOrder) else SecondOrder(problem)
    names = _argument_names(described.acceleration, "the acceleration", allowed=_NAMES)
    function, native = _flat(described.acceleration, names, x0.shape, compile_)
    _try_once(described.acceleration, function, t0, x0, v0, params, writes="out" in names)
    quantities = {}
    given = {"energy": described.energy, **described.invariants}
    for name, quantity in given.items():
        if quantity is not None:
            quantity_names = _argument_names(quantity, f"the function for {name!r}", allowed=_NAMES[:4])
            flat, _ = _flat(quantity, quantity_names, x0.shape, compile_, result_shape=())
            _try_once(quantity, flat, t0, x0, v0, params, size=1)
            quantities[name] = Quantity(flat)
    return System(
        name=name_of(described.acceleration).strip("<>"),
        acceleration=function,
        x0=x0,
        v0=v0,
        params=params,
        quantities=quantities,
        velocity_dependent="v" in names,
        native=native,
    )


def _argument_names(function: Any, role: str, allowed: tuple[str, ...]) -> list[str]:
    if not callable(function):
        raise ArgumentError(
            f"{role} is {function!r}, which is not a function; give a function of {', '.join(allowed)}."
        )
    python = getattr(function, "py_func", function)
    try:
        parameters = inspect.signature(python).parameters.values()
    except (TypeError, ValueError):
        raise ArgumentError(
            f"{role} {function!r} does not tell the names of its arguments; wrap it: lambda x: ..."
        ) from None
    required = [p.name for p in parameters if p.default is p.empty or p.name in allowed]
    unknown = [name for name in required if name not in allowed]
    if unknown or any(p.kind in (p.VAR_POSITIONAL, p.VAR_KEYWORD) for p in parameters):
        raise ArgumentError(
            f"{role} {name_of(python)}({', '.join(str(p) for p in parameters)}) has arguments that kickdrift does not"
            f" know; name them {', '.join(allowed)} (any of them, in any order), and pass numbers as args=(...)."
        )
    if not required:
        raise ArgumentError(f"{role} {name_of(python)}() has no arguments; give it at least x.")
    return required


_TEMPLATE = """
def adapted(t, x, v, params, out):
    {statement}
"""


def _flat(
    function: Function, names: list[str], shape: tuple[int, ...], compile_: bool, result_shape: Any = None
) -> tuple[Function, bool]:
    """Adapt a function to ``(t, x, v, params, out)`` over one-dimensional arrays; also whether it is compiled."""
    result_shape = shape if result_shape is None else result_shape
    views = {name: name for name in _NAMES}
    if shape == ():
        views |= {"x": "x[0]", "v": "v[0]"}
    elif len(shape) > 1:
        views |= {name: f"shaped({name}, SHAPE)" for name in ("x", "v", "out")}
    call = f"function({', '.join(f'{name}={views[name]}' for name in names)})"
    if "out" in names:
        statement = call
    elif result_shape == ():
        statement = f"out[0] = {call}"
    elif len(shape) > 1:
        statement = f"shaped(out, SHAPE)[...] = asarray({call})"
    else:
        statement = f"out[:] = asarray({call})"
    python = getattr(function, "py_func", function)
    if compile_:
        try:
            return _compiled(Frozen(frozen(function) or object(), function), statement, shape), True
        except (NumbaError, NotImplementedError, TypeError, ValueError, AttributeError, KeyError, IndexError) as error:
            _warn_interpreted(python, error)
    reshape = np.reshape
    return _adapted(statement, function=python, SHAPE=shape, shaped=reshape, asarray=_returned), False


def _adapted(statement: str, **names: Any) -> Function:
    scope: dict[str, Any] = {"__name__": __name__, **names}
    exec(_TEMPLATE.format(statement=statement), scope)  # noqa: S102 - our own template, above
    adapted: Function = scope["adapted"]
    return adapted


@dataclass(frozen=True)
class Frozen:
    """A function, equal to another if Numba compiles both to the same."""

    key: Hashable
    function: Function = field(compare=False)


@lru_cache(maxsize=128)
def _compiled(function: Frozen, statement: str, shape: tuple[int, ...]) -> Function:
    given = function.function
    inner = given if hasattr(given, "py_func") else compiled(cached=False)(given)
    adapted = _adapted(statement, function=inner, SHAPE=shape, shaped=memory.shaped, asarray=np.asarray)
    native: Any = compiled(cached=False)(adapted)
    native.compile(FLAT)
    return cast(Function, native)


def name_of(function: Any) -> str:
    """Name a function, or the type of another callable."""
    return str(getattr(function, "__name__", type(function).__name__))


def _returned(value: Any) -> Any:
    """Refuse None, which NumPy takes for a NaN: the function forgot to return, or lacks the argument `out`."""
    if value is None:
        raise TypeError("it returned None")
    return np.asarray(value)


def _warn_interpreted(function: Function, error: Exception) -> None:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    reason = next(
        (line for line in lines if not line.startswith(("Failed in", "During:", "File "))), type(error).__name__
    )
    warnings.warn(
        f"{name_of(function)} runs interpreted, about a hundred times slower, because Numba {numba.__version__} cannot"
        f" compile it: {reason} Use only NumPy and math functions and numbers passed as args=(...), or pass"
        " compile=False to run it interpreted without this warning.",
        InterpretedWarning,
        stacklevel=6,
    )


def _try_once(
    original: Any,
    function: Callable[..., None],
    t: float,
    x: Floats,
    v: Floats,
    params: Floats,
    size: int | None = None,
    writes: bool = False,
) -> None:
    """Call a function at the start, so that what is wrong with it is an error before any work is done."""
    out = np.zeros(x.size if size is None else size)
    name, given = name_of(original), [x.reshape(-1).copy(), v.reshape(-1).copy(), params.copy()]
    try:
        with np.errstate(all="ignore"):
            function(t, *given, out)
            other = np.ones_like(out)
            if writes:
                function(t, *given, other)
    except KickdriftError:
        raise
    except Exception as error:
        raise ArgumentError(
            f"{name} failed at the start, x0 of shape {x.shape}: {type(error).__name__}: {error}. It must return"
            f" {'an array of that shape' if size is None else 'one number'}."
        ) from error
    if writes and not np.array_equal(out, other, equal_nan=True):
        raise ArgumentError(
            f"{name} leaves numbers of `out` as they were, or adds to them; it must overwrite all of them."
        )
    for label, kept, array in zip(("x", "v", "params"), (x.reshape(-1), v.reshape(-1), params), given, strict=True):
        if not np.array_equal(kept, array):
            raise ArgumentError(f"{name} changes {label}; compute the acceleration from a copy.")
