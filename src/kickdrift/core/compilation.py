"""The one place that decides how functions are compiled.

Every compiled function of kickdrift goes through `compiled` or `specialise`. Flags:

- ``error_model="numpy"``: division by zero gives infinity, as in NumPy. The default model returns early instead, and a
  loop with an early exit is never vectorised.
- ``nogil``: progress bars and Ctrl-C need the interpreter.
- No fast mathematics by default: a compiled loop gives the bits of the same loop in NumPy. ``fast=True`` lets the
  compiler reorder sums and fuse multiplications, for kernels whose rounding no one promises. It never assumes that
  there is no NaN, so that a run can see one.
"""

import hashlib
import types
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, overload

import numba

_REORDERED = {"reassoc", "contract", "nsz", "arcp", "afn"}

Function = Callable[..., Any]
F = TypeVar("F", bound=Function)


@overload
def compiled(function: F) -> F: ...
@overload
def compiled(
    *, fast: bool = False, parallel: bool = False, cached: bool = True, inline: bool = False, checked: bool = False
) -> Callable[[F], F]: ...
def compiled(
    function: F | None = None,
    *,
    fast: bool = False,
    parallel: bool = False,
    cached: bool = True,
    inline: bool = False,
    checked: bool = False,
) -> F | Callable[[F], F]:
    """Compile a function on first use with the flags of this module; a decorator, with or without arguments.

    ``inline`` forces the function into its callers: for the small steps of a hot loop. ``checked`` raises IndexError
    where an index is out of bounds, which compiled code otherwise does not see.
    """
    options = {
        "error_model": "numpy",
        "nogil": True,
        "fastmath": _REORDERED if fast else False,
        "parallel": parallel,
        "forceinline": inline,
        "boundscheck": checked,
    }

    def decorate(python_function: F) -> F:
        try:
            dispatcher: F = numba.njit(cache=cached, **options)(python_function)
        except RuntimeError:  # Numba finds no folder that it can write its cache to
            dispatcher = numba.njit(**options)(python_function)
        return dispatcher

    return decorate if function is None else decorate(function)


def specialise(template: Function, name: str, **bindings: Any) -> Function:
    """Copy a function with some of its global names bound to other values.

    A template such as ``kick`` calls the global name ``acceleration``; each system gets its own copy, into which the
    compiler inlines that system's acceleration. A closure would do the same, but Numba finds closures over compiled
    functions again only in the process that made them; a copy with bound globals is cached on disk under its `name`,
    which therefore has to tell apart whatever the bindings tell apart.
    """
    function = types.FunctionType(template.__code__, {**template.__globals__, **bindings}, name)
    function.__qualname__ = name
    return function


def unbound(*arguments: Any) -> Any:
    """Stand in a template for a name that `specialise` binds."""
    raise NotImplementedError("A template is called before its names are bound; specialise it first.")


def specialised_name(function: Function, *details: str) -> str:
    """Name a specialisation for `function` so that no other one, and none of changed sources, is taken for it."""
    python_function = getattr(function, "py_func", function)
    parts = (python_function.__module__, python_function.__qualname__, *details, _source_digest())
    return "_".join(parts).replace(".", "_").replace("-", "_").replace("<", "").replace(">", "")


def comes_with_kickdrift(function: Function) -> bool:
    """Whether a function's source is in `_source_digest`, so that its specialisations may be cached on disk."""
    return str(getattr(function, "py_func", function).__module__).startswith("kickdrift.systems.")


@cache
def _source_digest() -> str:
    """Digest of the sources of the floors that hold compiled code."""
    package = Path(__file__).parent.parent
    digest = hashlib.sha256()
    for floor in ("core", "systems", "engine"):
        for path in sorted((package / floor).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
