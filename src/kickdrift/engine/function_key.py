"""What a function's compiled code is made of, so that it is compiled once for ever.

Numba freezes the code of a function, its defaults, and the values that its globals and free variables have when it is
compiled. Here floats and arrays of floats among them become arguments of the compiled code instead: the same code with
other numbers is compiled once. All the rest is in the function's key by content, so that equal keys, in whatever
process, mean equal compiled code.
"""

import sys
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, field
from types import BuiltinFunctionType, CellType, FunctionType, ModuleType
from typing import Any

import numba
import numpy as np
from numba.core.registry import CPUDispatcher
from numpy.typing import NDArray

from kickdrift.core.cache import written
from kickdrift.core.compilation import Function
from kickdrift.core.naming import source_digest
from kickdrift.engine.function_names import CannotTellError, Names, digest_of, names_of

_PLAIN = (bool, int, float, complex, str, bytes, type(None))
_LIBRARIES = ("builtins", "math", "cmath", "operator", "numpy", "numba", "kickdrift")  # nobody changes their contents


@dataclass(frozen=True)
class Taken:
    """A function taken apart; equal to another if both have the same compiled code.

    Attributes
    ----------
    key : hashable
        All that the compiled code is made of, as text; an object of its own for a function of which one cannot tell.
    function : callable
        The function itself.
    numbers : mapping of str to float or array
        Those of its globals, free variables and defaults that compiled code takes as arguments.
    constants : mapping of str to object
        The others.
    """

    key: Hashable
    function: Any = field(compare=False)
    numbers: Mapping[str, float | NDArray[np.float64]] = field(compare=False, default_factory=dict)
    constants: Mapping[str, Any] = field(compare=False, default_factory=dict)

    @property
    def known(self) -> bool:
        """Whether the key tells all, so that compiled code may be kept for other processes."""
        return isinstance(self.key, tuple)

    def options(self, checked: bool) -> dict[str, Any]:
        """Return what its decorator, if it has one, asks of Numba, with indices `checked` for bounds."""
        asked = getattr(self.function, "targetoptions", {})
        return {**asked, "boundscheck": checked if asked.get("boundscheck") is None else asked["boundscheck"]}

    def digest(self, *details: Any) -> str:
        """Name the compiled code, with further details of it, so that no other one has the name."""
        return digest_of(repr((self.key, details, source_digest())))

    def snapshot(self, checked: bool) -> Function:
        """Copy the function, with its constants as they are now; its numbers are left for `numbers_as_arguments`.

        Indices of compiled functions that it calls are `checked`, too.
        """
        python = getattr(self.function, "py_func", self.function)
        values = {
            **{name: _snapshot(value, checked) for name, value in self.constants.items()},
            **dict.fromkeys(self.numbers, 0.0),
        }
        cells = tuple(CellType(values[name]) for name in python.__code__.co_freevars)
        own = {"__name__": python.__module__, "__builtins__": __builtins__, **values}
        copy = FunctionType(python.__code__, own, python.__name__, python.__defaults__, cells)
        copy.__kwdefaults__ = python.__kwdefaults__
        copy.__qualname__ = (
            f"{python.__qualname__}_{self.digest(checked)}"  # of two of a name, Numba may take one for the other
        )
        return copy


def taken_apart(function: Any) -> Taken:
    """Take a function apart."""
    try:
        return _taken_apart(function, ())
    except CannotTellError:
        return Taken(object(), function)


def _taken_apart(function: Any, callers: tuple[Any, ...]) -> Taken:
    python, options = function, ""
    if isinstance(function, CPUDispatcher):
        python, options = function.py_func, written(function.targetoptions)
        if function.targetoptions.get("parallel") or function.locals or not function._can_compile:
            raise CannotTellError
    if not isinstance(python, FunctionType) or function in callers:
        raise CannotTellError
    names, around = names_of(python.__code__), (*callers, function)
    numbers, constants = {}, {}
    for name, value in (*_values(python, names), *_defaults(python)):
        frozen = name in names.inner or (name in names.exponents and _makes_roots_and_products(value))
        if callers or frozen or not _is_number(value):
            constants[name] = value
        else:
            numbers[name] = value
    described = tuple((name, _constant(value, names, around)) for name, value in sorted(constants.items()))
    shapes = tuple((name, np.shape(value)) for name, value in sorted(numbers.items()))
    return Taken((names.digest, options, described, shapes), function, numbers, constants)


def _is_number(value: Any) -> bool:
    if type(value) in (float, np.float64):
        return True
    return (
        type(value) is np.ndarray
        and value.dtype == np.float64
        and value.dtype.isnative
        and value.ndim > 0
        and value.size > 0
        and value.flags.c_contiguous
    )


def _makes_roots_and_products(value: Any) -> bool:
    """Whether a power with this exponent, if the compiler knows it, is as quick and rounded as NumPy's: x * x for x**2.0."""
    return type(value) in (float, np.float64) and float(2 * value).is_integer()


def _values(function: FunctionType, names: Names) -> Iterator[tuple[str, Any]]:
    own, builtins = function.__globals__, sys.modules["builtins"].__dict__
    for name in names.globals:
        if name in own:
            yield name, own[name]
        elif name in builtins:
            yield name, builtins[name]
        else:
            raise CannotTellError
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        try:
            yield name, cell.cell_contents
        except ValueError:  # it has no value yet
            raise CannotTellError from None


def _defaults(function: FunctionType) -> Iterator[tuple[str, Any]]:
    code, defaults = function.__code__, function.__defaults__ or ()
    yield from zip(code.co_varnames[code.co_argcount - len(defaults) : code.co_argcount], defaults, strict=True)
    yield from (function.__kwdefaults__ or {}).items()


def _constant(value: Any, names: Names, around: tuple[Any, ...]) -> Hashable:
    """Write down a constant so that it is the same in every process."""
    if type(value) in _PLAIN:
        return type(value).__name__, repr(value)
    if isinstance(value, np.generic) and value.dtype.kind in "biufc":
        return value.dtype.str, value.tobytes()
    if type(value) is tuple:
        return "tuple", *(_constant(member, names, around) for member in value)
    if type(value) is np.ndarray and value.dtype.kind in "biufc":
        return "array", value.dtype.str, value.shape, value.strides, digest_of(value.tobytes())
    if isinstance(value, ModuleType):
        return _of_module(value, names, around)
    if (name := _name_in_library(value)) is not None:
        return name
    if isinstance(value, CPUDispatcher):
        return _taken_apart(value, around).key
    if isinstance(value, numba.types.Type | np.dtype):
        return type(value).__name__, repr(value)
    raise CannotTellError


def _of_module(module: ModuleType, names: Names, around: tuple[Any, ...]) -> Hashable:
    """Write down what a function may use of a module: whatever has a name that the function mentions."""
    if module.__name__.partition(".")[0] in _LIBRARIES:
        return module.__name__
    used = {name: getattr(module, name) for name in sorted(names.all) if hasattr(module, name)}
    if any(value is module for value in used.values()):
        raise CannotTellError
    return module.__name__, *((name, _constant(value, names, around)) for name, value in used.items())


def _name_in_library(value: Any) -> str | None:
    """Return where a function, type or ufunc is found in a library, None if it is not."""
    module, name = getattr(value, "__module__", None), getattr(value, "__qualname__", getattr(value, "__name__", None))
    if isinstance(value, np.ufunc):
        module = "numpy"
    elif not isinstance(value, type | FunctionType | BuiltinFunctionType | CPUDispatcher) and not callable(value):
        return None
    if not isinstance(name, str) or str(module).partition(".")[0] not in _LIBRARIES:
        return None
    return f"{module}.{name}" if getattr(sys.modules.get(str(module)), name, None) is value else None


def _snapshot(value: Any, checked: bool) -> Any:
    """Copy what may change: arrays, and compiled functions with all that they use."""
    if type(value) is np.ndarray:
        return value.copy(order="K")
    if isinstance(value, CPUDispatcher) and _name_in_library(value) is None:
        taken = _taken_apart(value, (None,))
        return CPUDispatcher(taken.snapshot(checked), value.locals, taken.options(checked))
    return value
