"""The one place that decides how functions are compiled.

Every compiled function of kickdrift goes through `compiled` or `specialise`. Flags:

- ``error_model="numpy"``: division by zero gives infinity, as in NumPy. The default model returns early instead, and a
  loop with an early exit is never vectorised.
- ``nogil``: progress bars and Ctrl-C need the interpreter.
- No fast mathematics by default: a compiled loop gives the bits of the same loop in NumPy. ``fast=True`` lets the
  compiler reorder sums and fuse multiplications, for kernels whose rounding no one promises. It never assumes that
  there is no NaN, so that a run can see one.
"""

import gc
import hashlib
import types
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, overload

import numba
from numba.core.registry import CPUDispatcher

from kickdrift.core.cache import Cache

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
        if numba.config.DISABLE_JIT:
            return python_function
        dispatcher: Any = _Dispatcher(python_function, targetoptions={**options, "nopython": True})
        if cached:
            dispatcher.enable_caching()
        function: F = dispatcher
        return function

    return decorate if function is None else decorate(function)


class _Dispatcher(CPUDispatcher):  # type: ignore[misc]
    """A compiled function without what most of ours have no use for, which makes compiling a third faster.

    Numba compiles a function again for every integer that it is called with as a constant, and with wrappers for calls
    from Python and from C. Here a constant is a number like any other, and what the interpreter calls is compiled with
    a wrapper for it when that happens for the first time.
    """

    def __init__(self, py_func: Function, variables: Any = None, targetoptions: Any = None, **more: Any) -> None:
        super().__init__(py_func, variables or {}, targetoptions, **more)
        self._compiler.targetoptions = {**targetoptions, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
        self._called: Any = None

    def enable_caching(self) -> None:
        """Keep compiled code on disk."""
        self._cache = Cache(self.py_func, "inner", self.targetoptions)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile for the types of arguments, whatever is known of their values."""
        args = tuple(numba.types.unliteral(type_) for type_ in args)
        return super().get_call_template(args, {name: numba.types.unliteral(type_) for name, type_ in kws.items()})

    def compile(self, sig: Any) -> Any:
        """Compile without stops of the garbage collector, which finds next to nothing and takes a tenth of the time."""
        collects = gc.isenabled()
        gc.disable()
        try:
            return super().compile(sig)
        finally:
            if collects:
                gc.enable()

    def add_overload(self, result: Any) -> None:
        """Keep what was compiled for other compiled code; the interpreter cannot call it."""
        self.overloads[tuple(result.signature.args)] = result

    def _compile_for_args(self, *args: Any, **kws: Any) -> Any:
        """Return what the interpreter calls for types of arguments that are new, now and from now on."""
        if self._called is None:
            self._called = CPUDispatcher(self.py_func, self.locals, {**self.targetoptions, "no_cfunc_wrapper": True})
            if isinstance(self._cache, Cache):
                self._called._cache = Cache(self.py_func, "called", self.targetoptions)
        before = len(self._called.overloads)
        entry = self._called._compile_for_args(*args, **kws)
        for types_, result in list(self._called.overloads.items())[before:]:
            self._insert([type_._code for type_ in types_], result.entry_point, result.objectmode)
        return entry


def is_on_disk(function: Function, signature: Any) -> bool:
    """Whether a function need not be compiled for a signature, because it is on disk or was compiled in this process."""
    dispatcher: Any = function
    compiled_here = tuple(signature.args) in dispatcher.overloads
    return compiled_here or (
        isinstance(dispatcher._cache, Cache) and dispatcher._cache.holds(signature, dispatcher.targetctx)
    )


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
