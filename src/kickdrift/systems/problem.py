"""Problems described by a user's Python functions, and the adapter with which they become a system."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.html import facts
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]
Function = Callable[..., Any]
OF_SHAPE = "of_shape"  # the attribute of a function that is for states of one shape alone
AT_START = "at_start"  # and of one that is not for all starts: a function of t, x and v that raises at the others


class Adapted(NamedTuple):
    """A user's function as the engine calls it, ``function(t, x, v, params, out)`` over one-dimensional arrays.

    Attributes
    ----------
    function : callable
    names : frozenset of str
        What it depends on: ``"t"``, ``"x"``, ``"v"``, ``"params"``, ``"out"``, whatever the user calls x and v.
    native : bool
        Whether it is compiled.
    """

    function: Function
    names: frozenset[str]
    native: bool


class Adapter(Protocol):
    """The engine's side of a problem: an initial state, and methods that adapt functions to it."""

    @property
    def t0(self) -> float:
        """Time of the start."""

    @property
    def x0(self) -> Floats:
        """Position of the start."""

    @property
    def v0(self) -> Floats:
        """Velocity of the start."""

    @property
    def args(self) -> Floats:
        """The params of the user's functions."""

    def adapt(
        self,
        function: Any,
        role: str,
        names: Sequence[str] = ("t", "x", "v", "params", "out"),
        shape: tuple[int, ...] | None = None,
    ) -> Adapted:
        """Adapt a function that gives an array of a shape, that of the state if none is given, and try it once.

        The names are those that its arguments may have; q and y stand for x, p for v.
        """

    def kick(self, function: Any, adapted: Adapted, of_force: bool = False) -> Callable[[bool], Function | None] | None:
        """Return what `System.kick` is for an acceleration, if adding it up where it is written saves time.

        Or for a force, where the last params are the inverse masses. The function is the first that was adapted.
        """

    def shape_of(self, function: Any, role: str, names: Sequence[str]) -> tuple[int, ...]:
        """Call a function at the start, and return the shape of its result."""

    def names_of(self, function: Any, role: str, names: Sequence[str]) -> frozenset[str]:
        """Return the names of a function's arguments."""

    def quantities(self, energy: Function | None, invariants: Mapping[str, Function]) -> dict[str, Quantity]:
        """Adapt conserved quantities."""

    def bind(self, template: Function, **bindings: Function | int) -> Function:
        """Bind functions and numbers to the global names of a template: compiled if all functions are."""


class Problem(ABC):
    """The base class of the descriptions of problems by Python functions, such as `kickdrift.SecondOrder`.

    Attributes
    ----------
    has_velocity : bool
        Whether there are velocities, or momenta.
    start_in_params : bool
        Whether the params of its system depend on the initial state.

    Examples
    --------
    >>> import kickdrift as kd
    >>> issubclass(kd.SecondOrder, kd.systems.Problem)
    True
    """

    has_velocity: ClassVar[bool] = True
    start_in_params: ClassVar[bool] = False

    def _repr_html_(self) -> str:
        """Return the HTML that notebooks show: the kind, and the arguments that it was made from."""
        given = [(name, value) for name, value in vars(self).items() if not name.startswith("_")]
        empty = [value is None or (isinstance(value, Mapping) and not value) for _, value in given]
        rows = [(name, _shown(value)) for (name, value), none in zip(given, empty, strict=True) if not none]
        return facts(type(self).__name__, rows)

    @abstractmethod
    def system(self, adapter: Adapter) -> System:
        """Make the system."""


def _shown(value: Any) -> str:
    return name_of(value) if callable(value) else str(value)


def name_of(function: Any) -> str:
    """Name a function, or the type of another callable."""
    return str(getattr(function, "__name__", type(function).__name__)).strip("<>")
