"""The record of a system."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import all_finite, reals
from kickdrift.core.errors import ArgumentError
from kickdrift.core.html import dots, facts
from kickdrift.core.kinds import Kind

Floats = NDArray[np.float64]
Function = Callable[..., Any]
_NUMBERS = ("x0", "v0", "params")


@dataclass(frozen=True, eq=False)
class Quantity:
    """A quantity that the exact motion conserves.

    Attributes
    ----------
    function : callable
        ``function(t, x, v, params, out)`` over one-dimensional arrays; writes `size` numbers.
    size : int
        1 for a scalar such as the energy, 3 for a vector in space.
    unit : str
        Its unit, empty if unknown.
    params : (P,) array, optional
        What the function gets as `params`, where they are not those of the system.
    scale : float, optional
        The size against which its error is judged, where it is a sum that may be zero; by default its own at the start.

    Examples
    --------
    >>> import kickdrift as kd
    >>> kd.systems.kepler().quantities["energy"].size
    1
    """

    function: Function
    size: int = 1
    unit: str = ""
    params: Floats | None = None
    scale: float | None = None


@dataclass(frozen=True)
class Frame:
    """Linear coordinates in which the parts of a split are solved; nobody outside of the loop sees them.

    Attributes
    ----------
    enter, leave : callable
        Take and return positions and velocities, arrays of shape (..., *shape of x0); one undoes the other.
    """

    enter: Callable[[Floats, Floats], tuple[Floats, Floats]]
    leave: Callable[[Floats, Floats], tuple[Floats, Floats]]


@dataclass(frozen=True, eq=False)
class System:
    """A mechanical system x' = velocity, v' = acceleration, with an initial state.

    All functions are ``function(t, x, v, params, out)`` over one-dimensional arrays, however the state is shaped.

    Attributes
    ----------
    name : str
        Kebab-case name.
    acceleration : callable
        Writes v'.
    x0, v0 : array
        Initial state, in the shape that the solution has. For Hamiltonians they are q and p; a first-order system has no v.
    params : (P,) array
        The argument `params` of the functions.
    quantities : mapping of str to Quantity
        Conserved quantities; ``"energy"`` is one of them if the system has an energy.
    exact : callable, optional
        ``exact(t)`` for an array of times, shape (T,), returns x and v, shape (T, *shape).
    kick : callable, optional
        ``kick(compensated)`` returns a flow ``kick(t, h, x, v, params, work)`` that adds h times the acceleration to v,
        with compensated sums or without, faster than through an array of accelerations, or None if there is none; used
        where the accelerations are not needed again.
    kind : Kind
        The form of the equations.
    velocity : callable, optional
        Writes x', if it is not v.
    parts : mapping of str to callable
        Further functions that flows call, by the names in `kickdrift.engine.flows.layout`; ``"remainder"`` among them
        is the acceleration of the kicks where another flow has the rest of the dynamics, and ``"jump"`` the rate of x that
        belongs to them, under which that acceleration does not change.
    frame : Frame, optional
        The coordinates of the remainder and of the other flow, if they are not those of x0.
    density : callable, optional
        Writes the step density, one number: the steps per unit of time, up to a factor; positive, and even in v.
    unthreaded : callable, optional
        The acceleration for processes without threads, if `acceleration` uses threads.
    native : bool
        Whether all these functions are compiled; False for Python functions that Numba cannot compile.
    packaged : bool
        Whether the compiled code may be cached on disk: for systems that come with kickdrift.
    dimensions : tuple of str
        Names of the axes of the state.
    coordinates : mapping of str to sequence
        Labels along those axes, such as the names of the bodies.
    units : mapping of str to str
        Units of ``"t"``, ``"x"`` and ``"v"``.
    source : str
        Source of the equations and numbers.
    gm : (N,) array, optional
        G times the masses of bodies that attract each other; for a body around a fixed centre, that of the centre.
    radii : (N,) array, optional
        Radii of bodies that merge on contact.
    quantity_units : Units, optional
        The units of its numbers, if it was created from quantities.

    Examples
    --------
    >>> import kickdrift as kd
    >>> system = kd.systems.kepler(eccentricity=0.6)
    >>> system.x0, system.kind
    (array([0.4, 0. ]), <Kind.NEARLY_KEPLERIAN: 'light bodies around a heavy one'>)
    >>> list(system.quantities)
    ['energy', 'angular momentum']
    """

    name: str
    acceleration: Function
    x0: Floats
    v0: Floats
    params: Floats = field(default_factory=lambda: np.zeros(0))
    quantities: Mapping[str, Quantity] = field(default_factory=dict)
    exact: Callable[[Floats], tuple[Floats, Floats]] | None = None
    kick: Callable[[bool], Function | None] | None = None
    kind: Kind = Kind.NEWTONIAN
    velocity: Function | None = None
    parts: Mapping[str, Function] = field(default_factory=dict)
    frame: Frame | None = None
    density: Function | None = None
    unthreaded: Function | None = None
    native: bool = True
    packaged: bool = False
    dimensions: tuple[str, ...] = ()
    coordinates: Mapping[str, Any] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    source: str = ""
    gm: Floats | None = None
    radii: Floats | None = None
    quantity_units: Any = None

    def _repr_html_(self) -> str:
        """Return the HTML that notebooks show."""
        rows = {
            "for": self.kind.value,
            "state": f"of shape {self.x0.shape}" if self.x0.shape else "a number",
            "conserved": ", ".join(self.quantities) or "nothing that is known",
            "exact motion": "known" if self.exact is not None else "not known",
            "units": ", ".join(f"{name} in {unit}" for name, unit in self.units.items() if unit) or "none",
            "source": self.source or "-",
        }
        places = self.x0[:, :2].tolist() if self.x0.ndim == 2 and self.x0.shape[0] > 1 < self.x0.shape[1] else []
        return facts(self.name, rows.items(), drawing=dots(places, "the bodies at the start") if places else "")

    def __post_init__(self) -> None:
        for name in _NUMBERS:
            object.__setattr__(self, name, reals(getattr(self, name)))  # copies, which nobody else changes
        fitting = self.v0.size == 0 if self.kind is Kind.FIRST_ORDER else self.x0.shape == self.v0.shape
        if not fitting or self.params.ndim != 1:
            raise ArgumentError(
                f"x0, v0 and params of {self.name!r} have shapes {self.x0.shape}, {self.v0.shape} and"
                f" {self.params.shape}; the first two must be equal (v0 empty for first-order equations), and params a"
                " list."
            )
        for name in _NUMBERS if self.packaged else ():
            if not all_finite(numbers := getattr(self, name)):
                bad = float(numbers[~np.isfinite(numbers)][0])
                raise ArgumentError(
                    f"{name} of {self.name!r} would contain {bad!r}: an argument is not finite, or so large that numbers made"
                    " of it are not; choose other units."
                )
        if self.kind is Kind.NEARLY_KEPLERIAN and "remainder" not in self.parts:
            raise ArgumentError(
                f"parts={sorted(self.parts)!r} of {self.name!r} has no 'remainder', the acceleration that the Kepler"
                " flow leaves to the kicks; give it, or set the kind to NEWTONIAN."
            )
        named = {"acceleration": self.acceleration, "velocity": self.velocity, **self.parts} if self.native else {}
        for name, function in named.items():
            if function is not None and not hasattr(function, "py_func"):
                raise ArgumentError(
                    f"{name} of {self.name!r} is not compiled, unlike its other functions; leave compile=False out,"
                    " decorate it with numba.njit, or describe the system with Python functions, as with"
                    " kd.SecondOrder."
                )


def start(value: ArrayLike) -> Floats:
    """Copy a position or velocity into an array that nobody else changes."""
    return reals(value)
