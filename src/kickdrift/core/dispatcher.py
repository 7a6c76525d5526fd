"""Numba's dispatcher with changes that make compiling three times as fast, and a cache on disk."""

import gc
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import numba
from numba.core.compiler import Flags, compile_extra
from numba.core.compiler_lock import global_compiler_lock
from numba.core.cpu_options import FastMathOptions
from numba.core.dispatcher import _FunctionCompiler  # type: ignore[attr-defined]
from numba.core.registry import CPUDispatcher
from numba.core.sigutils import normalize_signature
from numba.core.typing.templates import make_concrete_template

from kickdrift.core.cache import Cache
from kickdrift.core.linking import Part, Whole
from kickdrift.core.llvm_builder import calling

Function = Callable[..., Any]

told_of_compiling: ContextVar[Function | None] = ContextVar("told_of_compiling", default=None)
"""The function that is called whenever another is compiled."""


class _Flags(Flags):  # type: ignore[misc]
    """Compiler flags with a fast comparison: Numba uses them as keys of its caches, for each operation."""

    def __eq__(self, other: object) -> Any:
        """Whether the same flags are set in both."""
        return self._values == other._values if isinstance(other, _Flags) else super().__eq__(other)

    def __hash__(self) -> int:
        """Return the same number for all flags: there are too few to need more."""
        return _ANY_FLAGS


_ANY_FLAGS = hash(Flags())


class _Compiler(_FunctionCompiler):  # type: ignore[misc]
    """Compiles functions to parts, with which callers are linked; parallel loops, which need code that runs, as Numba does."""

    def _compile_core(self, args: Any, return_type: Any) -> Any:
        if (tell := told_of_compiling.get()) is not None:
            tell()
        if self.targetoptions["parallel"]:
            return super()._compile_core(args, return_type)
        from kickdrift.core.passes import Pipeline  # takes 0.1 s, and is needed only to compile

        flags = _Flags()
        self.targetdescr.options.parse_as_flags(flags, self.targetoptions)
        flags.no_compile = True
        reordered, flags.fastmath = flags.fastmath, FastMathOptions(False)
        target = self.targetdescr.target_context
        result = compile_extra(
            self.targetdescr.typing_context,
            target,
            self.py_func,
            args=args,
            return_type=return_type,
            flags=flags,
            locals=self.locals,
            library=Part(target.codegen(), self.py_func.__qualname__, reordered),
            pipeline_class=Pipeline,
        )
        call = calling(result.library, result.fndesc)
        target.insert_func_defn([(call, result.library, call.signature)])
        return result._replace(entry_point=result.library)


class Dispatcher(CPUDispatcher):  # type: ignore[misc]
    """A compiled function without the features of Numba's that kickdrift rarely needs: compiling is three times as fast.

    Numba compiles a function again for every constant integer that it is called with, with wrappers for calls from Python
    and from C, and to machine code even if only other compiled functions call it. Here a constant is a number like any other,
    functions called by compiled code become parts of their callers (see `kickdrift.core.linking`), and the wrapper for the
    interpreter is compiled at the first call from there.
    """

    def __init__(self, py_func: Function, variables: Any = None, targetoptions: Any = None, **more: Any) -> None:
        super().__init__(py_func, variables or {}, targetoptions, **more)
        self._compiler.__class__ = _Compiler  # a new one would inspect the signature again: 8 ms of the import
        self._compiler.targetoptions = {**targetoptions, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
        # A function and its arguments that make it in another process, if no module contains it.
        self.recipe: tuple[Function, tuple[Any, ...]] | None = None
        self._called: Any = None
        self._wholes: dict[Any, Any] = {}
        self._loaded: dict[int, Any] = {}  # signatures by identity, since their hashes take 30 us
        self.addresses: dict[int, tuple[Any, int]] = {}  # of machine code, with signatures, likewise; see `core.calls`

    def __reduce__(self) -> Any:
        """Pickle by name where a module contains the function: Numba pickles its code, without the options of intrinsics."""
        name = self.py_func.__qualname__
        known = getattr(sys.modules.get(self.py_func.__module__), name, None)
        return name if known is self else super().__reduce__()

    def enable_caching(self, kind: type[Cache] = Cache) -> None:
        """Keep compiled code on disk."""
        self._cache = kind(self.py_func, "inner", self.targetoptions)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile as a part of a caller, for the types of the arguments, even if their values are known."""
        args = tuple(numba.types.unliteral(type_) for type_ in args)
        kws = {name: numba.types.unliteral(type_) for name, type_ in kws.items()}
        pysig, args = self._compiler.fold_argument_types(args, kws)
        self._part(args, None)
        name = self.py_func.__name__
        template = make_concrete_template(f"CallTemplate({name})", key=name, signatures=self.nopython_signatures)
        return template, pysig, args, {}

    def _part(self, args: Any, return_type: Any) -> Any:
        """Return the part with which callers are linked, for types of arguments."""
        if tuple(args) not in self.overloads:
            with global_compiler_lock, no_collector(), self._compiling_counter:
                self.add_overload(self._compiler.compile(args, return_type))
        return self.overloads[tuple(args)]

    def compile(self, sig: Any) -> Any:
        """Compile to machine code, or load it from disk."""
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
        """Return the compiled code for a signature; compile it first if necessary."""
        self.compile(sig)
        return self._wholes[tuple(normalize_signature(sig)[0])]

    def add_overload(self, result: Any) -> None:
        """Keep a part for other compiled code; the interpreter cannot call it."""
        self.overloads[tuple(result.signature.args)] = result

    def load(self, sig: Any) -> None:
        """Compile the entry point that the interpreter calls for a signature, or load it from disk."""
        if id(sig) in self._loaded:
            return
        caller, args = self._caller(), tuple(normalize_signature(sig)[0])
        if args not in caller.overloads:
            with no_collector():
                caller.compile(args)
            self._insert_new(caller, [args])
            self._loaded[id(sig)] = sig  # equal signatures are not kept: there may be any number of them

    def _caller(self) -> Any:
        """Return Numba's own dispatcher of the function, for the interpreter."""
        if self._called is None:
            self._called = CPUDispatcher(self.py_func, self.locals, {**self.targetoptions, "no_cfunc_wrapper": True})
            if isinstance(self._cache, Cache):
                self._called._cache = type(self._cache)(self.py_func, "called", self.targetoptions)
        return self._called

    def _insert_new(self, caller: Any, signatures: Iterable[Any]) -> None:
        for types_ in signatures:
            result = caller.overloads[types_]
            self._insert([type_._code for type_ in types_], result.entry_point, result.objectmode)

    def _compile_for_args(self, *args: Any, **kws: Any) -> Any:
        """Compile, register and return the entry point for types of arguments that are new."""
        caller = self._caller()
        before = len(caller.overloads)
        with no_collector():
            entry = caller._compile_for_args(*args, **kws)
        self._insert_new(caller, list(caller.overloads)[before:])
        return entry


class Addressed(Dispatcher):
    """A compiled function that the interpreter calls by its address."""

    def __init__(self, py_func: Function, variables: Any = None, targetoptions: Any = None, **more: Any) -> None:
        self._through = more.pop("through")
        super().__init__(py_func, variables, targetoptions, **more)

    def __call__(self, *arguments: Any) -> Any:
        """Call the compiled function."""
        return self._through(self, *arguments)


@contextmanager
def no_collector() -> Iterator[None]:
    """Pause the garbage collector, which takes a tenth of the time of compiling and finds next to nothing."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()
