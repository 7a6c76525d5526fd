"""What moves: the record of a system, and the description of one by a user's functions."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError

Floats = NDArray[np.float64]
Function = Callable[..., Any]


@dataclass(frozen=True)
class Quantity:
    """Something that the exact motion conserves.

    Attributes
    ----------
    function : callable
        ``function(t, x, v, params, out)`` over one-dimensional arrays; writes `size` numbers.
    size : int
        1 for a scalar such as the energy, 3 for a vector in space.
    unit : str
        Its unit, empty for none.
    """

    function: Function
    size: int = 1
    unit: str = ""


@dataclass(frozen=True, eq=False)
class System:
    """A mechanical system x'' = a(t, x, v), with a start.

    Attributes
    ----------
    name : str
        Kebab-case name.
    acceleration : callable
        ``acceleration(t, x, v, params, out)`` over one-dimensional arrays, however the state is shaped.
    x0, v0 : array
        Start, in the shape that the solution has.
    params : (P,) array
        What `acceleration` and the conserved quantities get as `params`.
    quantities : mapping of str to Quantity
        What is conserved; ``"energy"`` among them where there is one.
    exact : callable, optional
        ``exact(t)`` for an array of times, shape (T,), returns x and v, shape (T, *shape).
    kick : callable, optional
        A flow ``kick(t, h, x, v, params, work)`` that adds h times the acceleration to v faster than through an array
        of accelerations; used where neither the sums are compensated nor the accelerations needed again.
    velocity_dependent : bool
        Whether the acceleration depends on the velocity.
    native : bool
        Whether `acceleration` can be compiled; False for Python functions that Numba cannot compile.
    packaged : bool
        Whether the compiled code may be cached on disk: for systems that come with kickdrift.
    dimensions : tuple of str
        Names of the axes of the state.
    coordinates : mapping of str to sequence
        Labels along those axes, such as the names of the bodies.
    units : mapping of str to str
        Units of ``"t"``, ``"x"`` and ``"v"``.
    source : str
        Where equations and numbers are from.
    """

    name: str
    acceleration: Function
    x0: Floats
    v0: Floats
    params: Floats = field(default_factory=lambda: np.zeros(0))
    quantities: Mapping[str, Quantity] = field(default_factory=dict)
    exact: Callable[[Floats], tuple[Floats, Floats]] | None = None
    kick: Function | None = None
    velocity_dependent: bool = False
    native: bool = True
    packaged: bool = False
    dimensions: tuple[str, ...] = ()
    coordinates: Mapping[str, Any] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    source: str = ""

    def __post_init__(self) -> None:
        for name in ("x0", "v0", "params"):
            object.__setattr__(self, name, start(getattr(self, name)))  # compiled code is given their addresses
        if self.x0.shape != self.v0.shape or self.params.ndim != 1:
            raise ArgumentError(
                f"x0, v0 and params of {self.name!r} have shapes {self.x0.shape}, {self.v0.shape} and"
                f" {self.params.shape}; the first two must be equal, and params a list."
            )
        if self.native and not hasattr(self.acceleration, "py_func"):
            raise ArgumentError(
                f"acceleration={self.acceleration!r} of {self.name!r} is not compiled; decorate it with numba.njit, or"
                " describe the system by Python functions as kd.SecondOrder."
            )


@dataclass(frozen=True)
class SecondOrder:
    """x'' = f by Python functions: an acceleration and, if there are, what it conserves.

    The names of a function's arguments declare its structure: ``x`` (position), ``t`` (time: forced), ``v``
    (velocity-dependent), ``params`` (a float array), and, for the acceleration, ``out`` (written in place instead of
    returning). Arrays arrive in the shape of x0; a scalar state arrives as a float.

    Parameters
    ----------
    acceleration : callable
        Returns the acceleration, of the shape of x0 or one that broadcasts to it, or writes it into `out`.
    energy : callable, optional
        Returns the energy, a number.
    invariants : mapping of str to callable, optional
        Other conserved numbers by name.

    Examples
    --------
    >>> import kickdrift as kd
    >>> spring = kd.SecondOrder(lambda x: -x, energy=lambda x, v: 0.5 * (v * v + x * x))
    >>> kd.solve(spring, t_span=(0.0, 1.0), x0=1.0, v0=0.0, step=0.01, compile=False).energy[0]
    np.float64(0.5)
    """

    acceleration: Function
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)


def start(value: ArrayLike) -> Floats:
    """Copy a position or velocity into an array that nobody else changes."""
    return np.array(value, dtype=np.float64, order="C")
