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
import types
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, TypeVar, overload

import numba
from numba.core.compiler import Flags, compile_extra
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import _FunctionCompiler  # type: ignore[attr-defined]
from numba.core.registry import CPUDispatcher
from numba.core.sigutils import normalize_signature
from numba.core.typing.templates import make_concrete_template

from kickdrift.core.cache import Cache
from kickdrift.core.free_numbers import Pipeline
from kickdrift.core.linking import Part, Whole
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
    where an index is out of bounds, which compiled code otherwise does not see. Code of a `users` function is kept with
    that of other users' functions. `options` are Numba's own, which override the others. The interpreter calls the
    function by ``through(function, *arguments)``, if given, instead of having a wrapper compiled.
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
            dispatcher = _Dispatcher(python_function, targetoptions=targetoptions)
        else:
            dispatcher = _Addressed(python_function, targetoptions=targetoptions, through=through)
        if cached:
            dispatcher.enable_caching(UsersCache if users else Cache)
        function: F = dispatcher
        return function

    return decorate if function is None else decorate(function)


class _Flags(Flags):  # type: ignore[misc]
    """Flags of the compiler that are quickly compared: Numba looks up by them what it knows, for each operation anew."""

    def __eq__(self, other: object) -> Any:
        """Whether the same is set in both."""
        return self._values == other._values if isinstance(other, _Flags) else super().__eq__(other)

    def __hash__(self) -> int:
        """Return what all flags have in common."""
        return _ANY_FLAGS


_ANY_FLAGS = hash(Flags())


class _Compiler(_FunctionCompiler):  # type: ignore[misc]
    """Compiles to parts, which others are linked with; loops on threads as Numba does, since they run while they compile."""

    def _compile_core(self, args: Any, return_type: Any) -> Any:
        if (tell := _told.get()) is not None:
            tell()
        if self.targetoptions["parallel"]:
            return super()._compile_core(args, return_type)
        flags = _Flags()
        self.targetdescr.options.parse_as_flags(flags, self.targetoptions)
        flags.no_compile = True
        target = self.targetdescr.target_context
        result = compile_extra(
            self.targetdescr.typing_context,
            target,
            self.py_func,
            args=args,
            return_type=return_type,
            flags=flags,
            locals=self.locals,
            library=Part(target.codegen(), self.py_func.__qualname__),
            pipeline_class=Pipeline,
        )
        target.insert_user_function(result.library, result.fndesc, [result.library])
        return result._replace(entry_point=result.library)


class _Dispatcher(CPUDispatcher):  # type: ignore[misc]
    """A compiled function without what most of ours have no use for, which makes compiling three times as fast.

    Numba compiles a function again for every integer that it is called with as a constant, with wrappers for calls
    from Python and from C, and to machine code even if it is only ever called by other functions. Here a constant is a
    number like any other, what compiled code calls is a part of its callers (see `kickdrift.core.linking`), and what the
    interpreter calls is compiled with a wrapper for it when that happens for the first time.
    """

    def __init__(self, py_func: Function, variables: Any = None, targetoptions: Any = None, **more: Any) -> None:
        super().__init__(py_func, variables or {}, targetoptions, **more)
        options = {**targetoptions, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
        pipeline = self._compiler.pipeline_class  # type: ignore[has-type]
        self._compiler = _Compiler(py_func, self.targetdescr, options, self.locals, pipeline)
        self._called: Any = None
        self._wholes: dict[Any, Any] = {}

    def enable_caching(self, kind: type[Cache] = Cache) -> None:
        """Keep compiled code on disk."""
        self._cache = kind(self.py_func, "inner", self.targetoptions)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile for the types of arguments, whatever is known of their values, as a part of a caller."""
        args = tuple(numba.types.unliteral(type_) for type_ in args)
        kws = {name: numba.types.unliteral(type_) for name, type_ in kws.items()}
        pysig, args = self._compiler.fold_argument_types(args, kws)
        self._part(args, None)
        name = self.py_func.__name__
        template = make_concrete_template(f"CallTemplate({name})", key=name, signatures=self.nopython_signatures)
        return template, pysig, args, {}

    def _part(self, args: Any, return_type: Any) -> Any:
        """Return what callers are linked with, for types of arguments."""
        if tuple(args) not in self.overloads:
            with global_compiler_lock, _no_collector(), self._compiling_counter:
                self.add_overload(self._compiler.compile(args, return_type))
        return self.overloads[tuple(args)]

    def compile(self, sig: Any) -> Any:
        """Compile to machine code, or take it from disk."""
        with global_compiler_lock:
            return self._whole(sig)

    def _whole(self, sig: Any) -> Any:
        args, return_type = normalize_signature(sig)
        if tuple(args) in self._wholes:
            return
        result = self._cache.load_overload(sig, self.targetctx)
        if result is None:
            result = self._part(args, return_type)
            if isinstance(result.library, Part):
                returned = self.targetctx.data_model_manager[result.signature.return_type]
                whole = Whole(result.library, returns_no_array=not returned.contains_nrt_meminfo())
                result = result._replace(library=whole, entry_point=whole, reload_init=list(whole._reload_init))
            self._cache.save_overload(sig, result)
        self._wholes[tuple(args)] = result

    def get_compile_result(self, sig: Any) -> Any:
        """Return what was compiled for a signature, and compile it first if need be."""
        self.compile(sig)
        return self._wholes[tuple(normalize_signature(sig)[0])]

    def add_overload(self, result: Any) -> None:
        """Keep what was compiled for other compiled code; the interpreter cannot call it."""
        self.overloads[tuple(result.signature.args)] = result

    def _compile_for_args(self, *args: Any, **kws: Any) -> Any:
        """Return what the interpreter calls for types of arguments that are new, now and from now on."""
        if self._called is None:
            self._called = CPUDispatcher(self.py_func, self.locals, {**self.targetoptions, "no_cfunc_wrapper": True})
            if isinstance(self._cache, Cache):
                self._called._cache = type(self._cache)(self.py_func, "called", self.targetoptions)
        before = len(self._called.overloads)
        entry = self._called._compile_for_args(*args, **kws)
        for types_, result in list(self._called.overloads.items())[before:]:
            self._insert([type_._code for type_ in types_], result.entry_point, result.objectmode)
        return entry


class _Addressed(_Dispatcher):
    """A compiled function that the interpreter calls by its address."""

    def __init__(self, py_func: Function, variables: Any = None, targetoptions: Any = None, **more: Any) -> None:
        self._through = more.pop("through")
        super().__init__(py_func, variables, targetoptions, **more)

    def __call__(self, *arguments: Any) -> Any:
        """Call the compiled function."""
        return self._through(self, *arguments)


@contextmanager
def _no_collector() -> Iterator[None]:
    """Let the garbage collector rest, which finds next to nothing and takes a tenth of the time."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


_told: ContextVar[Function | None] = ContextVar("_told", default=None)


@contextmanager
def told_of_compiling(tell: Function) -> Iterator[None]:
    """Have a function called whenever one is compiled."""
    before = _told.set(tell)
    try:
        yield
    finally:
        _told.reset(before)


def is_on_disk(function: Function, signature: Any) -> bool:
    """Whether a function need not be compiled for a signature, because it is on disk or was compiled in this process."""
    dispatcher: Any = function
    compiled_here = tuple(signature.args) in dispatcher._wholes
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


def is_kept(function: Function) -> bool:
    """Whether a function's compiled code is kept on disk."""
    return isinstance(getattr(function, "_cache", None), Cache)


def is_users(function: Function) -> bool:
    """Whether a function is a user's whose compiled code is kept on disk."""
    return isinstance(getattr(function, "_cache", None), UsersCache)
