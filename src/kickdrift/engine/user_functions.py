"""Adaptation of users' functions to the engine, by the names of their arguments, compiled if Numba can."""

import inspect
import math
import warnings
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from types import CodeType, FunctionType
from typing import Any, NamedTuple, cast

import numba
import numpy as np
from numba.core.errors import NumbaError, UnsupportedBytecodeError
from numpy.typing import NDArray

from kickdrift.core import memory
from kickdrift.core.compilation import Function, compiled
from kickdrift.core.errors import ArgumentError, InterpretedWarning, depth_of_caller
from kickdrift.core.memory import read_only
from kickdrift.engine.flows.layout import FLAT, call_flat
from kickdrift.engine.function_key import Taken, shape_of, taken_apart
from kickdrift.engine.results import returned, write_result
from kickdrift.systems.problem import name_of

Floats = NDArray[np.float64]

NOT_COMPILED = (
    *(NumbaError, UnsupportedBytecodeError, NotImplementedError),
    *(TypeError, ValueError, AttributeError, LookupError),
)
"""Errors by which Numba says that it cannot compile a function."""

# Bits of functions that take any number of arguments, or are coroutines or generators
_NOT_PLAIN = (
    inspect.CO_VARARGS
    | inspect.CO_VARKEYWORDS
    | inspect.CO_GENERATOR
    | inspect.CO_COROUTINE
    | inspect.CO_ASYNC_GENERATOR
)


def _plain_names(python: Any) -> list[str]:
    """Return the names of arguments from the code object, 15 us faster than by a signature; none if it lacks them."""
    if (
        type(python) is not FunctionType
        or python.__defaults__
        or not {"__wrapped__", "__signature__"}.isdisjoint(vars(python))
    ):
        return []
    code = python.__code__
    others = code.co_kwonlyargcount or code.co_flags & _NOT_PLAIN
    return [] if others else list(code.co_varnames[: code.co_argcount])


def argument_names(
    function: Any, role: str, allowed: Sequence[str], numbers: str = "pass numbers as args=(...)"
) -> list[str]:
    """Return the names of a function's arguments.

    Raises
    ------
    ArgumentError
        If it is not a function, returns no numbers, has no signature, or has other arguments than those allowed.
    """
    if not callable(function):
        raise ArgumentError(
            f"{role} is {function!r}, which is not a function; give a function of {', '.join(allowed)}."
        )
    python = getattr(function, "py_func", function)
    if (plain := _plain_names(python)) and set(plain) <= set(allowed):
        return plain
    kinds = inspect.iscoroutinefunction, inspect.isgeneratorfunction, inspect.isasyncgenfunction
    if any(is_kind(python) for is_kind in kinds):
        raise ArgumentError(
            f"{role} {name_of(python)} is an async function or a generator, whose calls return no numbers; give a function"
            " defined with def that returns them."
        )
    try:
        parameters = inspect.signature(python).parameters.values()
    except (TypeError, ValueError):
        raise ArgumentError(
            f"{role} {function!r} does not reveal the names of its arguments; wrap it: lambda x: ..."
        ) from None
    required = [p.name for p in parameters if p.default is p.empty or p.name in allowed]
    unknown = [name for name in required if name not in allowed]
    if unknown or any(p.kind in (p.VAR_POSITIONAL, p.VAR_KEYWORD) for p in parameters):
        raise ArgumentError(
            f"{role} {name_of(python)}({', '.join(str(p) for p in parameters)}) has arguments that kickdrift does not"
            f" know; name them {', '.join(allowed)} (any of them, in any order), and {numbers}."
        )
    if not required:
        raise ArgumentError(f"{role} {name_of(python)}() has no arguments; give it at least {allowed[1]}.")
    return required


_NONE = np.zeros(0)
_SMALL = (
    100  # numbers of a state up to which the interpreter soon does a double loop, and shapes are worth a compilation
)

MEANINGS = {"q": "x", "y": "x", "p": "v"}


class Layout(NamedTuple):
    """The shapes of a state and of a result, and the place of a function's own numbers in the params.

    The first `n_args` params are the user's; the function's own numbers are from `first` on.
    """

    state: tuple[int, ...]
    result: tuple[int, ...]
    n_args: int
    first: int

    def statement(self, names: Sequence[str], numbers: Mapping[str, Any], number: str = "", **others: str) -> str:
        """Return the source of the call of a function with these arguments, and with its numbers from the params.

        A number that it returns goes through the function named `number`, if any. Expressions in `others` replace the usual
        ones for arguments of these names.
        """
        views = {name: self._view(name) for name in names} | number_views(numbers, "params", self.first) | others
        call = f"function({', '.join(f'{name}={view}' for name, view in views.items())})"
        if "out" in names:
            return call
        if "i" in names:
            return f"out[int(v[0])] = {number}({call})"
        if self.result == ():
            return f"out[0] = {number}({call})"
        return f"write_result({self._view('out')}, {call})"

    def _view(self, name: str) -> str:
        meaning = MEANINGS.get(name, name)
        shape = {"x": self.state, "v": self.state, "out": self.result}.get(meaning, (0,))
        if meaning == "i":
            return "int(v[0])"
        if meaning == "params":
            return f"params[:{self.n_args}]"
        if meaning in ("x", "v") and shape == ():
            return f"{meaning}[0]"
        return self.shaped(meaning, shape)

    def shaped(self, array: str, shape: tuple[int, ...]) -> str:
        """Return the source of a view of a one-dimensional array in a shape."""
        return f"shaped({array}, {self._shape(array, shape)})" if len(shape) > 1 else array

    @staticmethod
    def _shape(array: str, shape: tuple[int, ...]) -> str:
        """Return the source of a shape, which does not contain the length of a large array."""
        if math.prod(shape) <= _SMALL:
            return str(shape)
        return f"({array}.size // {math.prod(shape[1:])}, {', '.join(map(str, shape[1:]))})"


def number_views(numbers: Mapping[str, Any], array: str, first: int) -> dict[str, str]:
    """Return the source of views of a function's numbers, from `first` on in an array, see `Taken.numbers`."""
    views, at = {}, first
    for name, value in numbers.items():
        shape = shape_of(value)
        size = math.prod(shape)
        views[name] = f"read_only(shaped({array}[{at}:{at + size}], {shape}))" if shape else f"{array}[{at}]"
        at += size
    return views


def in_a_row(numbers: Mapping[str, Any]) -> Floats:
    """Return a function's numbers in the order of `number_views`."""
    values = [value.reshape(-1) if shape_of(value) else (value,) for value in numbers.values()]
    return np.concatenate(values) if values else _NONE


_TEMPLATE = """
def adapted(t, x, v, params, out):
    {statement}
"""


def _adapted(statement: str, **names: Any) -> Function:
    """Define a function whose body is a statement."""
    scope = {"__name__": __name__, "write_result": write_result, "read_only": read_only, **names}
    return FunctionType(_code(statement), scope, "adapted")


@lru_cache(maxsize=256)
def _code(statement: str) -> CodeType:
    scope: dict[str, Any] = {}
    exec(_TEMPLATE.format(statement=statement), scope)  # noqa: S102 - our own template, above
    code: CodeType = scope["adapted"].__code__
    return code


class Flat(NamedTuple):
    """A function of ``(t, x, v, params, out)`` over one-dimensional arrays.

    Attributes
    ----------
    function : callable
    native : bool
        Whether it is compiled.
    numbers : array
        Its numbers, to be placed in the params at `Layout.first`.
    """

    function: Function
    native: bool
    numbers: Floats


def flatten(function: Function, names: list[str], layout: Layout, compile_: bool, checked: bool) -> Flat:
    """Adapt a function; if compiled, with bounds checks if `checked`."""
    if compile_:
        taken = taken_apart(function)
        try:
            return Flat(_laid_out(taken, tuple(names), layout, checked), True, in_a_row(_own(taken, names)))
        except NOT_COMPILED as error:
            _warn_interpreted(function, error)
    return Flat(interpreted(function, names, layout), False, _NONE)


def interpreted(function: Function, names: list[str], layout: Layout) -> Function:
    """Adapt a function for the interpreter."""
    python = getattr(function, "py_func", function)
    return _adapted(layout.statement(names, {}, "returned"), function=python, shaped=np.reshape, returned=returned)


def _own(taken: Taken, names: Collection[str]) -> Mapping[str, Any]:
    """Return a function's own numbers, those that are not arguments of these names."""
    if taken.numbers.keys().isdisjoint(names):
        return taken.numbers
    return {name: value for name, value in taken.numbers.items() if name not in names}


@lru_cache(maxsize=256)
def _laid_out(taken: Taken, names: tuple[str, ...], layout: Layout, checked: bool) -> Function:
    """Compile a function for a layout; for layouts of the same statement it is the same one."""
    return _compiled(taken, layout.statement(names, _own(taken, names)), checked, len(layout.result) == 1)


@lru_cache(maxsize=256)
def _compiled(taken: Taken, statement: str, checked: bool, tuples: bool) -> Function:
    inner = taken.function
    if taken.known:
        inner = taken.snapshot(checked, tuples)
    if not hasattr(inner, "py_func"):
        inner = compiled(cached=False, options=taken.options(checked))(inner)
    adapted = _adapted(statement, function=inner, shaped=memory.shaped)
    adapted.__qualname__ = f"adapted_{taken.digest(statement, checked)}" if taken.known else "adapted"
    native: Any = compiled(cached=taken.known, users=True, through=call_flat)(adapted)
    native.compile(FLAT)
    return cast(Function, native)


def _warn_interpreted(function: Function, error: Exception) -> None:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    reason = next(
        (line for line in lines if not line.startswith(("Failed in", "During:", "File "))), type(error).__name__
    )
    warnings.warn(
        f"{name_of(getattr(function, 'py_func', function))} runs interpreted, about a hundred times slower, because"
        f" Numba {numba.__version__} cannot compile it ({reason}). Use only NumPy and math functions and numbers passed"
        " as args=(...), or pass compile=False to run it interpreted without this warning.",
        InterpretedWarning,
        stacklevel=depth_of_caller(),
    )
