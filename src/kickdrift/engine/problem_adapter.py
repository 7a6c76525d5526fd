"""From a user's problem to a system."""

import math
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import Function, compiled, is_kept, specialise
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.core.naming import specialised_name
from kickdrift.core.threads import present
from kickdrift.engine.agreement import LARGEST, aside, compare, compared
from kickdrift.engine.flows.layout import FLAT, call_flat
from kickdrift.engine.start import Start
from kickdrift.engine.user_functions import MEANINGS, Layout, argument_names, flatten, interpreted
from kickdrift.engine.user_kicks import LARGE, kick_of
from kickdrift.systems.problem import AT_START, OF_SHAPE, Adapted, Problem, name_of
from kickdrift.systems.second_order import SecondOrder
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]


_NOTHING = nullcontext()
_TAKEN = ("energy", "time", "t", "x", "v")


class Adapter(NamedTuple):
    """An initial state, and methods that adapt functions to it: a `kickdrift.systems.problem.Adapter`."""

    t0: float
    x0: Floats
    v0: Floats
    users_args: Floats
    compile_: bool
    check_bounds: bool
    numbers: list[Floats]

    @property
    def args(self) -> Floats:
        """The params of the functions adapted so far: the user's, and the numbers of the functions themselves."""
        return np.concatenate([self.users_args, *self.numbers]) if self.numbers else self.users_args

    def adapt(
        self,
        function: Any,
        role: str,
        names: Sequence[str] = ("t", "x", "v", "params", "out"),
        shape: tuple[int, ...] | None = None,
    ) -> Adapted:
        """Adapt a function and try it once, see `kickdrift.systems.problem.Adapter`."""
        given = argument_names(function, role, names)
        own = getattr(function, OF_SHAPE, self.x0.shape)
        if own != self.x0.shape:
            raise ArgumentError(f"x0 has shape {self.x0.shape}, but the formulas need shape {own}; give that.")
        if (refuse := getattr(function, AT_START, None)) is not None:
            refuse(self.t0, self.x0, self.v0)
        result = self.x0.shape if shape is None else shape
        layout = Layout(self.x0.shape, result, self.users_args.size, self.args.size)
        flat = flatten(function, given, layout, self.compile_, self.check_bounds)
        if flat.numbers.size:
            self.numbers.append(flat.numbers)
        self._try_once(function, role, flat.function, given, shape)
        if flat.native and self.x0.size <= LARGEST and not compared(flat.function):
            self._compare(function, role, flat.function, given, layout)
        return Adapted(flat.function, frozenset(MEANINGS.get(name, name) for name in given), flat.native)

    def kick(self, function: Any, adapted: Adapted, of_force: bool = False) -> Callable[[bool], Function | None] | None:
        """Return a kick for large states, see `kickdrift.systems.problem.Adapter`."""
        if self.x0.size < LARGE or not adapted.native or "out" not in adapted.names or "v" in adapted.names:
            return None
        given = argument_names(function, "the acceleration", tuple(adapted.names))
        layout = Layout(self.x0.shape, self.x0.shape, self.users_args.size, self.users_args.size)
        state = self.t0, self.x0.reshape(-1), self.v0.reshape(-1), self.args
        return kick_of(function, given, layout, state, self.check_bounds, of_force)

    def shape_of(self, function: Any, role: str, names: Sequence[str]) -> tuple[int, ...]:
        """Return the shape of a function's result, see `kickdrift.systems.problem.Adapter`."""
        state: dict[str, Any] = {
            name: float(array) if array.shape == () else array.copy()
            for name, array in (("x", self.x0), ("v", self.v0), ("params", self.users_args))
        }
        state["t"] = self.t0
        given = {name: state[MEANINGS.get(name, name)] for name in argument_names(function, role, names)}
        try:
            with np.errstate(all="ignore"):
                returned = getattr(function, "py_func", function)(**given)
            if returned is None:
                raise TypeError("it returned None")
            if np.asarray(returned).dtype == np.bool_:
                raise TypeError(f"it returned {returned!r}, which is not a real number")
            return np.shape(returned)
        except Exception as error:
            raise ArgumentError(
                f"{role}, {name_of(function)}, failed at the start, x0 of shape {self.x0.shape}: {type(error).__name__}:"
                f" {error}. It must return numbers."
            ) from error

    def names_of(self, function: Any, role: str, names: Sequence[str]) -> frozenset[str]:
        """Return the names of a function's arguments."""
        return frozenset(argument_names(function, role, names))

    def quantities(self, energy: Function | None, invariants: Mapping[str, Function]) -> dict[str, Quantity]:
        """Adapt conserved quantities: numbers."""
        if not isinstance(invariants, Mapping) or not all(isinstance(name, str) for name in invariants):
            raise ArgumentError(f"invariants={invariants!r} must be a dict of functions by their names.")
        for name in invariants:
            if name in _TAKEN:
                raise ArgumentError(
                    f"invariants has the name {name!r}, which is already in use; give another, or energy=... ."
                )
        given = {"energy": energy, **invariants}
        role = "the function for {!r}".format
        return {name: self.number(role(name), function) for name, function in given.items() if function is not None}

    def number(self, role: str, function: Function) -> Quantity:
        """Adapt a function of the state that returns a number, with numbers of its own in the params."""
        return self._replace(numbers=[])._number(function, role)

    def _number(self, function: Function, role: str) -> Quantity:
        self.shape_of(function, role, self._quantity_names)
        adapted = self.adapt(function, role, self._quantity_names, ())
        return Quantity(adapted.function, params=self.args)

    @property
    def _quantity_names(self) -> tuple[str, ...]:
        return ("t", "x", "v", "params", "q", "p") if self.v0.size else ("t", "y", "x", "params")

    def bind(self, template: Function, **bindings: Function | int) -> Function:
        """Bind functions and numbers to the global names of a template, see `bind`."""
        return bind(template, **bindings)

    def _compare(self, original: Any, role: str, native: Function, names: list[str], layout: Layout) -> None:
        """Compare a compiled function with the same one interpreted."""

        def call(function: Function) -> Floats:
            v = np.zeros(1) if "i" in names else aside(self.v0.reshape(-1))
            out = np.zeros(math.prod(layout.result))
            with np.errstate(all="ignore"):
                function(self.t0, aside(self.x0.reshape(-1)), v, self.args.copy(), out)
            return out

        compare(f"{role}, {name_of(original)},", native, partial(interpreted, original, names, layout), call)

    def _try_once(
        self, original: Any, role: str, function: Function, names: list[str], shape: tuple[int, ...] | None
    ) -> None:
        """Call a function at the start, so that its faults are errors before any work is done."""
        x, v, params = self.x0.reshape(-1), self.v0.reshape(-1), self.args
        size = x.size if shape is None else math.prod(shape)
        out, other = np.zeros(size), np.ones(size) if "out" in names else None
        second = np.zeros(1) if "i" in names else v
        given = x.copy(), second.copy(), params.copy()

        def name() -> str:
            return f"{role}, {name_of(original)},"

        try:
            with _NOTHING if hasattr(function, "py_func") else _as_compiled():
                function(self.t0, *given, out)
                if other is not None:
                    function(self.t0, *given, other)
        except KickdriftError:
            raise
        except IndexError as error:
            number = (
                "" if self.x0.shape else " x is one number: give x0 as a list, in an ensemble as one list per member."
            )
            raise ArgumentError(
                f"{name()} has an index out of bounds at the start, x0 of shape {self.x0.shape} with"
                f" {self.users_args.size} args: IndexError: {str(error).rstrip('.')}.{number} Pass the numbers of params as"
                " args=(...)."
            ) from error
        except Exception as error:
            wanted = "one number" if shape == () or "i" in names else f"an array of shape {shape or self.x0.shape}"
            raise ArgumentError(
                f"{name()} failed at the start, x0 of shape {self.x0.shape}: {type(error).__name__}:"
                f" {str(error).rstrip('.')}. It must return {wanted}."
            ) from error
        if other is not None and out.tobytes() != other.tobytes() and not np.array_equal(out, other, equal_nan=True):
            raise ArgumentError(
                f"{name()} leaves elements of `out` unchanged, or adds to them; it must overwrite all of them."
            )
        for label, kept, array in zip(("x", "v", "params"), (x, second, params), given, strict=True):
            if kept.tobytes() != array.tobytes():
                raise ArgumentError(f"{name()} modifies {label}; work on a copy.")


@contextmanager
def _as_compiled() -> Iterator[None]:
    """Make a function for the interpreter silent about infinities; and raise where it drops an imaginary part into `out`."""
    with np.errstate(all="ignore"), warnings.catch_warnings(action="error", category=np.exceptions.ComplexWarning):
        yield


def bind(template: Function, **bindings: Function | int) -> Function:
    """Bind functions and numbers to the global names of a template: compiled if all functions are."""
    if all(hasattr(bound, "py_func") for bound in bindings.values() if not isinstance(bound, int)):
        return _bound(template, tuple(bindings.items()))
    return specialise(template, template.__name__.lstrip("_"), **bindings)


def _whole_name(function: Any) -> str:
    """Name a function with its module: several systems have an `_acceleration`."""
    return f"{function.py_func.__module__}.{function.__qualname__}"


@lru_cache(maxsize=128)
def _bound(template: Function, bindings: tuple[tuple[str, Function | int], ...]) -> Function:
    kept = all(isinstance(bound, int) or is_kept(bound) for _, bound in bindings)
    details = [str(bound) if isinstance(bound, int) else _whole_name(bound) for _, bound in bindings]
    bound = specialise(template, specialised_name(template, *details), **dict(bindings))
    native: Any = compiled(cached=kept, users=True, through=call_flat)(bound)
    native.compile(FLAT)
    return cast(Function, native)


def describe(
    problem: System | Problem | Function,
    t0: float,
    start: Start,
    params: Floats,
    compile_: bool,
    check_bounds: bool = True,
) -> System:
    """Make a system of a user's functions and start, or give a system another start.

    Raises
    ------
    ArgumentError
        For a function with other argument names, or whose result does not have the shape that it should have; for
        params of a system that has its own.
    """
    if isinstance(problem, System):
        return _started(problem, start, params)
    described = problem if isinstance(problem, Problem) else SecondOrder(problem)
    return described.system(Adapter(t0, start.x, start.v, params, compile_, check_bounds, []))


def _started(system: System, start: Start, params: Floats) -> System:
    if params.size:
        raise ArgumentError(
            f"args={params.tolist()!r} given, but {system.name!r} has its own parameters; leave it out."
        )
    if system.unthreaded is not None and not present():
        system = replace(system, acceleration=system.unthreaded)
    # Another start has another exact solution.
    same = (start.x == system.x0).all() and (start.v == system.v0).all()
    return system if same else replace(system, x0=start.x, v0=start.v, exact=None)
