"""Runs with units: `solve` converts quantities to numbers, and its solution converts them back."""

from dataclasses import fields, replace
from typing import Any, NamedTuple

import numpy as np

from kickdrift.core import units
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.dense import States
from kickdrift.engine.solution import Solution
from kickdrift.systems.system import System
from kickdrift.systems.units import Units

_NONE = Units()


class Entered(NamedTuple):
    """The arguments of `solve` as plain numbers, and the units of its solution.

    Attributes
    ----------
    t_span, x0, v0, step, t_eval
        As for `solve`.
    inside, outside : Units
        The units of the numbers, and those in which users get them back.
    """

    t_span: Any
    x0: Any
    v0: Any
    step: Any
    t_eval: Any
    inside: Units
    outside: Units

    def leave(self, solution: Solution) -> Solution:
        """Attach units to a solution, if there are any."""
        if self.outside is _NONE:
            return solution
        return UnitSolution.of(solution, self.inside, self.outside)


def enter(problem: Any, t_span: Any, x0: Any, v0: Any, step: Any, t_eval: Any) -> Entered:
    """Convert the arguments of `solve` to plain numbers.

    Functions get numbers in the units of t_span and x0, and velocities in the derived unit. Systems that were created from
    quantities keep their units.

    Raises
    ------
    ArgumentError
        If a quantity has the wrong dimension, or none while others have one.
    """
    own = getattr(problem, "quantity_units", None) if isinstance(problem, System) else None
    if own is None and not (units.has_unit(t_span) or units.has_unit((x0, v0, step, t_eval))):
        return Entered(t_span, x0, v0, step, t_eval, _NONE, _NONE)
    if isinstance(problem, System) and own is None:
        raise ArgumentError(
            f"{problem.name!r} has numbers without units; give plain numbers, or create the system from quantities, as"
            " with kd.systems.nbody(masses, x0, v0, G=...)."
        )
    outside_t = _time_unit(t_span, step)
    t = outside_t if own is None else own.t
    x = own.x if own is not None else units.unit_of(x0) if units.has_unit(x0) else None
    v = own.v if own is not None else (x / t if x is not None else 1 / t)
    v = units.unit_of(v) if units.has_unit(v) else v
    outside_v = units.unit_of(v0) if units.has_unit(v0) else v if x is not None else None
    plain_x = x0 if x is None or x0 is None else units.numbers("x0", x0, x)
    plain = (
        units.numbers("t_span", t_span, t),
        plain_x,
        _velocity(v0, v, x is not None),
        None if step is None else units.numbers("step", step, t),
        None if t_eval is None else units.numbers("t_eval", t_eval, t),
    )
    outside_x = units.unit_of(x0) if own is not None and units.has_unit(x0) else x
    return Entered(*plain, Units(t, x, v), Units(outside_t, outside_x, outside_v))


def _time_unit(t_span: Any, step: Any) -> Any:
    for name, value in (("t_span", t_span), ("step", step)):
        if value is not None and not units.has_unit(value):
            raise ArgumentError(f"{name}={value!r} has no unit, but other arguments have; give a time.")
    unit = units.unit_of(t_span)
    if not units.is_time(unit):
        raise ArgumentError(f"t_span={t_span} is in {units.spelt(unit)}, which is not a unit of time; give two times.")
    return unit


def _velocity(v0: Any, unit: Any, needed: bool) -> Any:
    if v0 is None or (not units.has_unit(v0) and (not needed or not np.any(np.asarray(v0)))):
        return v0
    return units.numbers("v0", v0, unit)


class UnitSolution(Solution):
    """A solution whose times and states are quantities.

    `t`, `x`, `v`, the states of events, and ``solution(t)`` have units; everything else is as in `Solution`: invariants, and
    `plain`, the same solution in numbers.
    """

    _inside: Units
    _outside: Units

    @classmethod
    def of(cls, solution: Solution, inside: Units, outside: Units) -> "UnitSolution":
        """Create the solution with units from one of plain numbers."""
        own = object.__new__(cls)
        about = replace(solution.about, units={**solution.about.units, **inside.names})
        vars(own).update({f.name: vars(solution)[f.name] for f in fields(Solution)}, about=about)
        vars(own).update(_inside=inside, _outside=outside)
        return own

    @property
    def plain(self) -> Solution:
        """The solution as plain numbers, in the units given by ``plain.about.units``."""
        return Solution(**{f.name: vars(self)[f.name] for f in fields(Solution)})

    def _quantity(self, name: str, values: Any) -> Any:
        inside, outside = getattr(self._inside, name), getattr(self._outside, name)
        if outside is None:
            return values
        return units.with_unit(values * units.factor(inside, outside) if inside != outside else values, outside)

    def __call__(self, t: Any) -> States:
        """Return positions and velocities at any times of the run, as quantities; see `Solution`."""
        inside = self._inside.t
        x, v = self.plain(units.numbers("t", t, inside))
        return States(self._quantity("x", x), self._quantity("v", v))

    def continue_to(self, t: Any) -> "Solution":
        """Continue to another end, a quantity; see `Solution`."""
        return UnitSolution.of(
            self.plain.continue_to(units.numbers("t", t, self._inside.t)), self._inside, self._outside
        )

    def return_to(self, t: Any) -> "Solution":
        """Go back to an earlier time, a quantity; see `Solution`."""
        return UnitSolution.of(self.plain.return_to(units.numbers("t", t, self._inside.t)), self._inside, self._outside)

    def __repr__(self) -> str:
        return repr(self.plain)


def _in_units(name: str, of: str) -> Any:
    def value(self: UnitSolution) -> Any:
        kept = vars(self)[name]
        if isinstance(kept, tuple):
            return tuple(self._quantity(of, one) for one in kept)
        return self._quantity(of, kept)

    return property(value, doc=getattr(Solution, name, None).__doc__)


# These replace the fields of the same names, which stay in the instance as numbers.
for _name, _of in {
    "t": "t",
    "x": "x",
    "v": "v",
    "step": "t",
    "t_events": "t",
    "x_events": "x",
    "v_events": "v",
}.items():
    setattr(UnitSolution, _name, _in_units(_name, _of))
