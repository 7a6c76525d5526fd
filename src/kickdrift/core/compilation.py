"""The one place that decides how functions are compiled.

Every compiled function of kickdrift goes through `compiled` or `specialise`. Flags:

- ``error_model="numpy"``: division by zero gives infinity, as in NumPy. The default model returns early instead, and a
  loop with an early exit is never vectorised.
- ``nogil``: progress bars and Ctrl-C need the interpreter.
- No fast mathematics by default: a compiled loop gives the bits of the same loop in NumPy. ``fast=True`` lets the
  compiler reorder sums and fuse multiplications, for kernels whose rounding is not specified. It never assumes that
  there is no NaN, so that a run can detect one.
"""

import types
from collections.abc import Callable
from typing import Any, TypeVar, overload

import numba

from kickdrift.core.cache import Cache
from kickdrift.core.dispatcher import Addressed, Dispatcher
from kickdrift.core.users_cache import UsersCache

_REORDERED = {"reassoc", "contract", "nsz", "arcp", "afn"}

Function = Callable[..., Any]
F = TypeVar("F", bound=Function)


@overload
def compiled(function: F) -> F: ...
@overload
def compiled(
    *,
    fast: bool = False,
    parallel: bool = False,
    cached: bool = True,
    users: bool = False,
    inline: bool = False,
    checked: bool = False,
    options: dict[str, Any] | None = None,
    through: Function | None = None,
) -> Callable[[F], F]: ...
def compiled(
    function: F | None = None,
    *,
    fast: bool = False,
    parallel: bool = False,
    cached: bool = True,
    users: bool = False,
    inline: bool = False,
    checked: bool = False,
    options: dict[str, Any] | None = None,
    through: Function | None = None,
) -> F | Callable[[F], F]:
    """Compile a function on first use with the flags of this module; a decorator, with or without arguments.

    ``inline`` forces the function into its callers: for the small steps of a hot loop. ``checked`` raises IndexError
    where an index is out of bounds, which compiled code otherwise does not detect. With `users`, compiled code is stored with
    that of other functions of users. `options` are Numba's own and override the others. If `through` is given, the interpreter
    calls ``through(function, *arguments)``, and no wrapper is compiled.
    """
    flags = {
        "error_model": "numpy",
        "nogil": True,
        "fastmath": _REORDERED if fast else False,
        "parallel": parallel,
        "forceinline": inline,
        "boundscheck": checked,
        **(options or {}),
    }

    def decorate(python_function: F) -> F:
        if numba.config.DISABLE_JIT:
            return python_function
        targetoptions = {**flags, "nopython": True}
        dispatcher: Any
        if through is None:
            dispatcher = Dispatcher(python_function, targetoptions=targetoptions)
        else:
            dispatcher = Addressed(python_function, targetoptions=targetoptions, through=through)
        if cached:
            dispatcher.enable_caching(UsersCache if users else Cache)
        function: F = dispatcher
        return function

    return decorate if function is None else decorate(function)


def load(function: Function, signature: Any) -> None:
    """Compile the entry point of a function for the interpreter, or load it from disk, without calling it."""
    dispatcher: Any = function
    if hasattr(dispatcher, "load"):
        dispatcher.load(signature)


def is_on_disk(function: Function, signature: Any) -> bool:
    """Whether compiled code for a signature is on disk, or was made in this process."""
    dispatcher: Any = function
    compiled_here = id(signature) in dispatcher.addresses or tuple(signature.args) in dispatcher._wholes
    return compiled_here or (
        isinstance(dispatcher._cache, Cache) and dispatcher._cache.holds(signature, dispatcher.targetctx)
    )


def specialise(template: Function, name: str, **bindings: Any) -> Function:
    """Copy a function with some of its global names bound to other values.

    A template such as ``kick`` calls the global name ``acceleration``; each system gets its own copy, into which the
    compiler inlines that system's acceleration. A closure would do the same, but Numba finds closures over compiled
    functions again only in the process that made them; a copy with bound globals is cached on disk under its `name`,
    which must therefore differ for different bindings.
    """
    function = types.FunctionType(template.__code__, {**template.__globals__, **bindings}, name)
    function.__qualname__ = name
    return function


def unbound(*arguments: Any) -> Any:
    """Stand in a template for a name that `specialise` binds."""
    raise NotImplementedError("A template is called before its names are bound; specialise it first.")


def reorders(function: Function) -> bool:
    """Whether a compiled function, or one that it calls, has fast mathematics: its bits depend on where it is inlined."""
    seen: set[int] = set()
    waiting: list[Any] = [function]
    while waiting:
        known = waiting.pop()
        python = getattr(known, "py_func", None)
        if python is None or id(known) in seen:
            continue
        seen.add(id(known))
        if known.targetoptions.get("fastmath"):
            return True
        names = python.__code__.co_names
        used = [python.__globals__.get(name) for name in names]
        used += [cell.cell_contents for cell in python.__closure__ or ()]
        used += [
            getattr(module, name, None) for module in used if isinstance(module, types.ModuleType) for name in names
        ]
        waiting += used
    return False


def is_kept(function: Function) -> bool:
    """Whether compiled code of a function is stored on disk."""
    return isinstance(getattr(function, "_cache", None), Cache)


def is_users(function: Function) -> bool:
    """Whether a function is a user's, and its compiled code is stored on disk."""
    return isinstance(getattr(function, "_cache", None), UsersCache)
