"""A user's Python functions as the engine calls them: by the names of their arguments, compiled where Numba can."""

import inspect
import math
import warnings
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, cast

import numba
import numpy as np
from numba.core.errors import NumbaError

from kickdrift.core import memory
from kickdrift.core.compilation import Function, compiled
from kickdrift.core.errors import ArgumentError, InterpretedWarning, depth_of_caller
from kickdrift.engine.flows.layout import FLAT
from kickdrift.engine.frozen import frozen
from kickdrift.engine.results import write_result
from kickdrift.systems.problem import name_of


def argument_names(
    function: Any, role: str, allowed: Sequence[str], numbers: str = "pass numbers as args=(...)"
) -> list[str]:
    """Return the names of a function's arguments.

    Raises
    ------
    ArgumentError
        If it is not a function, does not tell them, or has others than those allowed.
    """
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
            f" know; name them {', '.join(allowed)} (any of them, in any order), and {numbers}."
        )
    if not required:
        raise ArgumentError(f"{role} {name_of(python)}() has no arguments; give it at least {allowed[1]}.")
    return required


MEANINGS = {"q": "x", "y": "x", "p": "v"}


@dataclass(frozen=True)
class Layout:
    """The shapes of a state and of a result, and how many of the params are the user's."""

    state: tuple[int, ...]
    result: tuple[int, ...]
    n_args: int

    def statement(self, names: list[str]) -> str:
        """Spell the call of a function of these arguments."""
        views = {name: self._view(name) for name in names}
        call = f"function({', '.join(f'{name}={view}' for name, view in views.items())})"
        if "out" in names:
            return call
        if "i" in names:
            return f"out[int(v[0])] = {call}"
        if self.result == ():
            return f"out[0] = {call}"
        return f"write_result({self._view('out')}, {call})"

    def _view(self, name: str) -> str:
        meaning = MEANINGS.get(name, name)
        shape = {"x": self.state, "v": self.state, "out": self.result}.get(meaning, (0,))
        if meaning == "i":
            return "int(v[0])"
        if meaning == "params":
            return "params[:N_ARGS]"
        if meaning in ("x", "v") and shape == ():
            return f"{meaning}[0]"
        if len(shape) > 1:
            return f"shaped({meaning}, {'RESULT' if meaning == 'out' else 'STATE'})"
        return meaning

    def adapted(self, statement: str, **names: Any) -> Function:
        """Define the function of this statement."""
        scope: dict[str, Any] = {
            "__name__": __name__,
            "STATE": self.state,
            "RESULT": self.result,
            "N_ARGS": self.n_args,
            "write_result": write_result,
            **names,
        }
        exec(_TEMPLATE.format(statement=statement), scope)  # noqa: S102 - our own template, below
        adapted: Function = scope["adapted"]
        return adapted


_TEMPLATE = """
def adapted(t, x, v, params, out):
    {statement}
"""


def flatten(function: Function, names: list[str], layout: Layout, compile_: bool) -> tuple[Function, bool]:
    """Adapt a function to ``(t, x, v, params, out)`` over one-dimensional arrays; also whether it is compiled."""
    statement = layout.statement(names)
    if compile_:
        try:
            return _compiled(Frozen(frozen(function) or object(), function), statement, layout), True
        except (NumbaError, NotImplementedError, TypeError, ValueError, AttributeError, LookupError) as error:
            _warn_interpreted(function, error)
    python = getattr(function, "py_func", function)
    return layout.adapted(statement, function=python, shaped=np.reshape), False


def with_bounds_checked(function: Function, names: list[str], layout: Layout) -> Function:
    """Adapt a function so that an index out of bounds is an error, which compiled code does not see."""
    statement, python = layout.statement(names), getattr(function, "py_func", function)
    if math.prod(layout.state) <= _SOON_INTERPRETED:
        return layout.adapted(statement, function=python, shaped=np.reshape)
    inner = compiled(cached=False, checked=True)(python)
    adapted = layout.adapted(statement, function=inner, shaped=memory.shaped)
    return compiled(cached=False, checked=True)(adapted)


_SOON_INTERPRETED = 100  # numbers of a state up to which a double loop over them is soon done by the interpreter


@dataclass(frozen=True)
class Frozen:
    """A function, equal to another if Numba compiles both to the same."""

    key: Hashable
    function: Function = field(compare=False)


@lru_cache(maxsize=128)
def _compiled(function: Frozen, statement: str, layout: Layout) -> Function:
    given = function.function
    inner = given if hasattr(given, "py_func") else compiled(cached=False)(given)
    adapted = layout.adapted(statement, function=inner, shaped=memory.shaped)
    native: Any = compiled(cached=False)(adapted)
    native.compile(FLAT)
    return cast(Function, native)


def _warn_interpreted(function: Function, error: Exception) -> None:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    reason = next(
        (line for line in lines if not line.startswith(("Failed in", "During:", "File "))), type(error).__name__
    )
    warnings.warn(
        f"{name_of(getattr(function, 'py_func', function))} runs interpreted, about a hundred times slower, because"
        f" Numba {numba.__version__} cannot compile it: {reason} Use only NumPy and math functions and numbers passed"
        " as args=(...), or pass compile=False to run it interpreted without this warning.",
        InterpretedWarning,
        stacklevel=depth_of_caller(),
    )
