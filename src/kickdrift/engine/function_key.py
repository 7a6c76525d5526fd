"""Keys of users' functions: digests of everything that their compiled code depends on, so that it is compiled only once.

Numba freezes the code of a function, its defaults, and the values that its globals and free variables have when it is
compiled. Here floats and arrays of floats among them become arguments of the compiled code instead: the same code with
other numbers is compiled once. Everything else is in the function's key by content, so that equal keys, in any process,
imply equal compiled code.
"""

import sys
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, field
from types import BuiltinFunctionType, CellType, FunctionType, ModuleType
from typing import Any
from weakref import WeakKeyDictionary

import numba
import numpy as np
from numba.core.registry import CPUDispatcher
from numpy.typing import NDArray

from kickdrift.core.cache import written
from kickdrift.core.compilation import Function
from kickdrift.core.free_numbers import numbers_as_arguments
from kickdrift.core.naming import digest, source_digest
from kickdrift.core.returned_lists import tuples_for_lists
from kickdrift.engine.function_names import CannotTellError, Names, names_of, overloaded_elsewhere

_PLAIN = (bool, int, float, complex, str, bytes, type(None))
_LIBRARIES = ("builtins", "math", "cmath", "operator", "numpy", "numba")  # assumed not to be changed
_OURS = ("kickdrift.core.", "kickdrift.systems.", "kickdrift.engine.")  # their sources are in every name


@dataclass(frozen=True)
class Taken:
    """A function separated into code, numbers and constants; equal to another if both have the same compiled code.

    Attributes
    ----------
    key : hashable
        Everything that the compiled code depends on, as text; if that cannot be determined, the function itself, if it is
        compiled, or a new object.
    function : callable
        The function itself.
    numbers : mapping of str to float or array
        The globals, free variables and defaults that compiled code takes as arguments, and those of the functions that it
        calls, as ``function__number``.
    constants : mapping of str to object
        The other globals, free variables and defaults.
    callees : mapping of str to Taken
        The compiled functions among the constants.
    """

    key: Hashable
    function: Any = field(compare=False)
    numbers: Mapping[str, float | NDArray[np.float64]] = field(compare=False, default_factory=dict)
    constants: Mapping[str, Any] = field(compare=False, default_factory=dict)
    callees: Mapping[str, "Taken"] = field(compare=False, default_factory=dict)

    @property
    def known(self) -> bool:
        """Whether the key is complete, so that compiled code may be kept for other processes."""
        return isinstance(self.key, tuple)

    def options(self, checked: bool) -> dict[str, Any]:
        """Return the Numba options of its decorator, if it has one, with bounds checks if `checked`.

        By default a division by zero gives infinity, also in the functions that it calls.
        """
        asked = getattr(self.function, "targetoptions", {})
        bounds = checked if asked.get("boundscheck") is None else asked["boundscheck"]
        return {"error_model": "numpy", **asked, "boundscheck": bounds}

    def digest(self, *details: Any) -> str:
        """Return a unique name for the compiled code, with further details of it."""
        return digest((self.key, details, source_digest()))

    def snapshot(self, checked: bool, tuples: bool = False) -> Function:
        """Copy the function, with its constants as they are now, for compiled code that takes its numbers as arguments.

        With `checked`, bounds are checked in the compiled functions that it calls, too. With `tuples`, it returns tuples in
        place of arrays made from lists.
        """
        python = getattr(self.function, "py_func", self.function)
        values = {
            **dict.fromkeys(self.numbers, 0.0),
            **{name: _copied(value) for name, value in self.constants.items()},
            **{name: callee.dispatcher(checked) for name, callee in self.callees.items()},
        }
        cells = tuple(CellType(values[name]) for name in python.__code__.co_freevars)
        # Numba cannot load code that it has compiled for a module that cannot be imported, such as code executed from text.
        module = python.__module__ if python.__module__ in sys.modules else __name__
        own = {"__name__": module, "__builtins__": __builtins__, **values}
        copy = FunctionType(python.__code__, own, python.__name__, python.__defaults__, cells)
        copy.__kwdefaults__ = python.__kwdefaults__
        # Numba may confuse two functions of the same name.
        copy.__qualname__ = f"{python.__qualname__}_{self.digest(checked, tuples)}"
        numbers_as_arguments(copy, self.numbers, {name: tuple(callee.numbers) for name, callee in self.callees.items()})
        if tuples:
            tuples_for_lists(copy)
        return copy

    def dispatcher(self, checked: bool) -> Any:
        """Return a compiled function as Numba would compile it now."""
        from kickdrift.core.passes import Pipeline  # takes 0.1 s, and is needed only to compile

        return CPUDispatcher(
            self.snapshot(checked), self.function.locals, self.options(checked), pipeline_class=Pipeline
        )


def taken_apart(function: Any, free: bool = True) -> Taken:
    """Separate a function into code, numbers and constants; unless `free`, its numbers are among the constants."""
    try:
        return _taken_apart(function, (), free)
    except CannotTellError:
        # A compiled function does not change any more; a Python function may have changed since it was last seen.
        return Taken(function if isinstance(function, CPUDispatcher) else object(), function)


def _taken_apart(function: Any, callers: tuple[Any, ...], free: bool) -> Taken:
    """Do the work of `taken_apart`, for a function called by `callers`."""
    python, options = function, ""
    if isinstance(function, CPUDispatcher):
        python, options = function.py_func, written(function.targetoptions)
        signed = not function._can_compile and (callers or not _is_of_doubles(function))
        if function.targetoptions.get("parallel") or function.locals or signed:
            raise CannotTellError
    if not isinstance(python, FunctionType) or function in callers:
        raise CannotTellError
    names, around = names_of(python.__code__), (*callers, function)
    if (overloaded := overloaded_elsewhere()) and not overloaded.isdisjoint((*names.all, *names.globals)):
        raise CannotTellError  # the behaviour of overloaded functions is not determined by their names
    numbers: dict[str, Any] = {}
    constants: dict[str, Any] = {}
    callees: dict[str, Taken] = {}
    for name, value in (*_values(python, names), *_defaults(python)):
        fixed = name in names.inner or (name in names.exponents and _makes_roots_and_products(value))
        if free and not fixed and _is_number(value):
            numbers[name] = value
        elif isinstance(value, CPUDispatcher) and _name_in_library(value) is None:
            callees[name] = _taken_apart(value, around, free and _is_simply_called(name, value, names))
        else:
            constants[name] = value
    for name, callee in callees.items():
        numbers |= {f"{name}__{number}": value for number, value in callee.numbers.items()}
    if len(numbers) > len({*numbers} - {*constants}):
        raise CannotTellError  # one of the function's own names equals that of a callee's number
    described = tuple((name, _constant(value, names, around)) for name, value in sorted(constants.items()))
    called = tuple((name, callee.key) for name, callee in sorted(callees.items()))
    shapes = tuple((name, shape_of(value)) for name, value in numbers.items())  # in the order of their places
    return Taken((names.digest, options, described, called, shapes), function, numbers, constants, callees)


def _is_of_doubles(function: Any) -> bool:
    """Whether all signatures of a function are of doubles, so that compiling it for other arguments would not change rounding.

    This holds only if no compiled function calls it, which might pass integers to convert.
    """
    types_ = [each for signature in function.nopython_signatures for each in (*signature.args, signature.return_type)]
    return all(getattr(each, "dtype", each) in (numba.types.float64, numba.types.none) for each in types_)


def _is_simply_called(name: str, function: Any, names: Names) -> bool:
    """Whether a function is only called, never passed on, so that arguments can be added to every call."""
    return name in names.callees and name not in names.inner and not any(True for _ in _defaults(function.py_func))


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


def shape_of(number: float | NDArray[np.float64]) -> tuple[int, ...]:
    """Return the shape of one of the `Taken.numbers`; `np.shape` makes an array of a float, at 2 us."""
    return number.shape if isinstance(number, np.ndarray) else ()


def _makes_roots_and_products(value: Any) -> bool:
    """Whether a power with this exponent, as a constant, is as fast and rounded as NumPy's: x * x for x**2.0."""
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
    if defaults := function.__defaults__:
        code = function.__code__
        yield from zip(code.co_varnames[code.co_argcount - len(defaults) : code.co_argcount], defaults, strict=True)
    if named := function.__kwdefaults__:
        yield from named.items()


def _constant(value: Any, names: Names, around: tuple[Any, ...]) -> Hashable:
    """Return a description of a constant that is the same in every process."""
    if type(value) in _PLAIN:
        return type(value).__name__, repr(value)
    if isinstance(value, np.generic) and value.dtype.kind in "biufc":
        return value.dtype.str, value.tobytes()
    if type(value) is tuple or hasattr(type(value), "_fields"):
        fields = getattr(value, "_fields", ())
        return type(value).__qualname__, fields, *(_constant(member, names, around) for member in value)
    if type(value) is np.ndarray and value.dtype.kind in "biufc":
        return "array", value.dtype.str, value.shape, value.strides, digest(value.tobytes())
    if isinstance(value, ModuleType):
        return _of_module(value, names, around)
    if (name := _name_in_library(value)) is not None:
        return name
    if isinstance(value, CPUDispatcher):
        return _as_before(value, _taken_apart(value, around, False).key)
    if isinstance(value, numba.types.Type | np.dtype):
        return type(value).__name__, repr(value)
    raise CannotTellError


_keys: WeakKeyDictionary[Any, Hashable] = WeakKeyDictionary()


def _as_before(function: Any, key: Hashable) -> Hashable:
    """Refuse a function that is used in place, and may have been compiled before its constants changed."""
    if _keys.setdefault(function, key) != key:
        raise CannotTellError
    return key


def _of_module(module: ModuleType, names: Names, around: tuple[Any, ...]) -> Hashable:
    """Describe the attributes of a module that a function may use: all whose names occur in the function."""
    if _is_library(module.__name__):
        return module.__name__
    used = {name: getattr(module, name) for name in sorted(names.all) if hasattr(module, name)}
    if any(value is module for value in used.values()):
        raise CannotTellError
    return module.__name__, *((name, _constant(value, names, around)) for name, value in used.items())


def _is_library(module: str) -> bool:
    return module.partition(".")[0] in _LIBRARIES or module.startswith(_OURS)


def _name_in_library(value: Any) -> str | None:
    """Return the qualified name of a function, type or ufunc of a library; None if it is not from one."""
    module, name = getattr(value, "__module__", None), getattr(value, "__qualname__", getattr(value, "__name__", None))
    if isinstance(value, np.ufunc):
        module = "numpy"
    elif not isinstance(value, type | FunctionType | BuiltinFunctionType | CPUDispatcher) and not callable(value):
        return None
    if not isinstance(name, str) or not _is_library(str(module)):
        return None
    return f"{module}.{name}" if getattr(sys.modules.get(str(module)), name, None) is value else None


def _copied(value: Any) -> Any:
    """Copy a mutable value."""
    return value.copy(order="K") if type(value) is np.ndarray else value
