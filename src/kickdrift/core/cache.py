"""Compiled code on disk: one file for each function and types of arguments, named by a digest of everything that it depends on.

Numba's own cache checks only whether the source file of a function has changed, and goes on using code into which old versions
of functions of other files were inlined; and where several processes fill it at once, it may use the code of one signature for
another (Numba's issues 4807 and 10128). Here the name depends on the function, all functions and constants that it uses, the
types of its arguments, the processor, Numba's version, and the sources of the compiler itself.
"""

import io
import pickle
import types
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache, cached_property, lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.caching import CompileResultCacheImpl
from numba.core.environment import _rebuild_env
from numba.core.runtime import rtsys
from numba.core.serialize import dumps

from kickdrift.core import sealed
from kickdrift.core.naming import digest

_Function = Callable[..., Any]
_COMPILERS = (b"numba.core", b"numba.extending", b"llvmlite")
_HASHES = b"_numba_hashsecret"  # in the code of dictionaries and sets of texts


class Cache:
    """The cache of one function: Numba loads compiled code from it, or saves what it has compiled."""

    def __init__(self, function: _Function, kind: str, options: dict[str, Any]) -> None:
        self._function, self._kind, self._options = function, kind, options

    @cached_property
    def _method(self) -> Any:
        """Numba's serialiser, with the folder of the cache; None where Numba finds no folder that it can write to."""
        try:
            return CompileResultCacheImpl(self._function)
        except RuntimeError:
            return None

    @property
    def cache_path(self) -> str | None:
        """The folder."""
        return None if self._method is None else str(self._method.locator.get_cache_path())

    def holds(self, signature: Any, target: Any) -> bool:
        """Whether there is compiled code for a signature."""
        return self._method is not None and self._file(signature, target).exists()

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Return the compiled code for a signature, or None."""
        if self._method is None:
            return None
        rtsys.initialize(target)  # `target.refresh` would import all of Numba, and SciPy: half a second
        try:
            content = sealed.read(self._file(signature, target))
            if _HASHES in content:
                import_module("numba.cpython.hashing")  # defines the symbol, in 30 ms
            packed = _Unpickler(io.BytesIO(content)).load()
            return self._method.rebuild(target, packed)
        except Exception:
            return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Save the compiled code for a signature, and remove that of older sources."""
        if self._method is None or not self._method.check_cachable(result):
            return
        file = self._file(signature, result.target_context)
        packed = dumps(self._method.reduce(result))
        with suppress(OSError):  # a full disk, a folder that has gone: code is compiled again the next time
            sealed.write(file, packed)
            self._make_room(file)

    def _make_room(self, file: Path) -> None:
        """Remove the files that were compiled from other sources."""
        for older in file.parent.glob(f"{file.stem.rpartition('-')[0]}-*.nbc"):
            if older != file:
                older.unlink()

    def flush(self) -> None:
        """Remove all files of the function."""
        if self._method is not None:
            for file in Path(str(self.cache_path)).glob(f"{self._method.filename_base}-{self._kind}-*.nbc"):
                file.unlink(missing_ok=True)

    def _file(self, signature: Any, target: Any) -> Path:
        use = (repr(signature), written(self._options), machine(target))
        name = f"{self._method.filename_base}-{self._kind}-{digest(use)}-{fingerprint(self._function)}.nbc"
        return Path(str(self.cache_path)) / name


class _Unpickler(pickle.Unpickler):
    """Loads compiled code without the modules of Numba that it was made from, which take 0.1 s, and with SciPy 0.25."""

    def find_class(self, module: str, name: str) -> Any:
        """Return a class or function by its name."""
        return _environment if name == _rebuild_env.__name__ else super().find_class(module, name)


def _environment(module: str, constants: Any, name: str) -> Any:
    """Return a function's environment, whose globals are for object mode only: neither Numba's functions nor ours use it."""
    package = module.partition(".")[0]
    return _rebuild_env(package if package in ("numba", "kickdrift") else module, constants, name)


def machine(target: Any) -> tuple[Any, ...]:
    """Return what else compiled code depends on: the processor, LLVM, Numba, and our part of the compiler."""
    return _machine(target.codegen())  # there is one, while each function may have a target of its own


@cache
def _machine(codegen: Any) -> tuple[Any, ...]:
    return (*codegen.magic_tuple(), numba.__version__, _compiler_digest())


def _compiler_digest() -> str:
    """Digest of the modules here that change how Numba compiles, or what it compiles calls to.

    With `source_digest`, a change of any other module here would have everything compiled again.
    """
    sources = (file.read_bytes() for file in sorted(Path(__file__).parent.glob("*.py")))
    return digest(tuple(source for source in sources if any(module in source for module in _COMPILERS)))


@lru_cache(maxsize=4096)
def fingerprint(function: _Function) -> str:
    """Digest of a function and of all functions and constants that it uses."""
    return digest(tuple(_described(used) for used in reached(function)))


def reached(function: _Function) -> list[_Function]:
    """Return a function and all functions that its compiled code uses, each once, in the order in which they are found."""
    found: dict[int, _Function] = {}
    waiting = [function]
    while waiting:
        current = waiting.pop()
        if id(current) not in found:
            found[id(current)] = current
            waiting += [inner for inner in map(_function_of, _used(current)) if inner is not None]
    return list(found.values())


@lru_cache(maxsize=4096)
def _described(function: _Function) -> tuple[Any, ...]:
    values = [written(value) for value in _used(function)]
    return (function.__module__, function.__qualname__, _code(function.__code__), tuple(values))


def _used(function: _Function) -> Iterator[Any]:
    """Yield all values that a function and its inner functions use: globals, attributes of modules, closure and defaults."""
    names: list[str] = []
    waiting = [function.__code__]
    while waiting:
        code = waiting.pop()
        names += code.co_names
        waiting += [constant for constant in code.co_consts if isinstance(constant, types.CodeType)]
    for name in names:
        value = function.__globals__.get(name)
        yield value
        if isinstance(value, types.ModuleType):
            yield from (getattr(value, attribute) for attribute in names if hasattr(value, attribute))
    for cell in function.__closure__ or ():
        with suppress(ValueError):  # not yet bound
            yield cell.cell_contents
    yield function.__defaults__
    yield function.__kwdefaults__


def _function_of(value: Any) -> Any:
    """Return the Python function of a compiled function or an intrinsic, unless it is Numba's or NumPy's."""
    function = getattr(value, "py_func", None) or getattr(value, "_defn", None) or value
    ours = isinstance(function, types.FunctionType) and function.__module__.partition(".")[0] not in ("numba", "numpy")
    return function if ours else None


def _code(code: types.CodeType) -> tuple[Any, ...]:
    inner = (_code(c) if isinstance(c, types.CodeType) else written(c) for c in code.co_consts)
    return (code.co_code, code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars, *inner)


def written(value: Any) -> str:
    """Return a text for a constant that is the same in every process."""
    if isinstance(value, bool | int | float | complex | str | bytes | np.generic | numba.types.Type | None):
        return repr(value)
    if isinstance(value, tuple | list):
        return f"{type(value).__name__}({', '.join(map(written, value))})"
    if isinstance(value, frozenset | set):
        return f"set({sorted(map(written, value))})"
    if isinstance(value, dict):
        return f"dict({sorted((written(key), written(item)) for key, item in value.items())})"
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {digest(value.tobytes())}"
    options = written(getattr(value, "targetoptions", None))
    names = (getattr(value, name, "") for name in ("__module__", "__qualname__", "__name__"))
    return " ".join((type(value).__qualname__, *map(str, names), options))
