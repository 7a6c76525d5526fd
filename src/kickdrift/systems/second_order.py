"""x'' = f, by Python functions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.arguments import reals
from kickdrift.core.compilation import unbound
from kickdrift.core.elementwise import multiply
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.core.units import has_unit, numbers, unit_of
from kickdrift.systems.problem import Adapter, Floats, Function, Problem, name_of
from kickdrift.systems.system import System
from kickdrift.systems.velocity_jacobian import adapt_velocity_jacobian, jacobian_divided_by_mass

force: Function = unbound


@dataclass(frozen=True)
class SecondOrder(Problem):
    """x'' = f: an acceleration as a Python function, optionally with its conserved quantities.

    The argument names of a function declare its dependences: ``x`` (position), ``t`` (time), ``v`` (velocity), ``params`` (a
    float array), and, for the acceleration, ``out`` (written in place instead of returned). Arrays have the shape of x0; a
    scalar state is a float.

    Parameters
    ----------
    acceleration : callable
        Returns the acceleration, of the shape of x0 or one that broadcasts to it, or writes it into `out`.
    energy : callable, optional
        Returns the energy, a number.
    invariants : mapping of str to callable, optional
        Other conserved quantities by name.
    velocity_jacobian : callable, optional
        Returns the derivatives of the acceleration with respect to v, shape (n, n) for states of n numbers, row i those of
        number i of the acceleration; it has the arguments of the acceleration. Without it, linearly implicit methods use
        finite differences, at n evaluations per step.

    Raises
    ------
    ArgumentError
        For a `velocity_jacobian` that disagrees with finite differences at the initial state.

    Examples
    --------
    >>> import kickdrift as kd
    >>> spring = kd.SecondOrder(lambda x: -x, energy=lambda x, v: 0.5 * (v * v + x * x))
    >>> kd.solve(spring, (0.0, 1.0), x0=1.0, v0=0.0, step=0.01, compile=False).energy[0]
    np.float64(0.5)
    """

    acceleration: Function
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)
    velocity_jacobian: Function | None = None

    def system(self, adapter: Adapter) -> System:
        """Make the system."""
        acceleration = adapter.adapt(self.acceleration, "the acceleration")
        parts, native = {}, acceleration.native
        if self.velocity_jacobian is not None:
            jacobian = adapt_velocity_jacobian(self.velocity_jacobian, acceleration, adapter)
            parts, native = {"velocity_jacobian": jacobian.function}, native and jacobian.native
        return System(
            name=name_of(self.acceleration),
            acceleration=acceleration.function,
            x0=adapter.x0,
            v0=adapter.v0,
            params=adapter.args,
            quantities=adapter.quantities(self.energy, self.invariants),
            kind=Kind.VELOCITY_DEPENDENT if "v" in acceleration.names else Kind.NEWTONIAN,
            parts=parts,
            kick=adapter.kick(self.acceleration, acceleration),
            native=native,
        )


@dataclass(frozen=True)
class Newtonian(Problem):
    """m x'' = F: a force as a Python function, and the masses.

    Parameters
    ----------
    force : callable
        Returns the force, or writes it into ``out``; its arguments are those of `SecondOrder`.
    mass : array_like
        Positive: a number, or for states (N, 3) one per body; otherwise of a shape that broadcasts to x0. For a quantity,
        the force is in its unit of mass and the units of length and time of `solve`.
    energy, invariants
        As for `SecondOrder`.
    velocity_jacobian : callable, optional
        As for `SecondOrder`, with the derivatives of the force.

    Raises
    ------
    ArgumentError
        For masses that are not positive, or do not fit the state, or a wrong `velocity_jacobian`.

    Examples
    --------
    >>> import kickdrift as kd
    >>> spring = kd.Newtonian(lambda x: -8 * x, mass=2.0)
    >>> kd.solve(spring, (0.0, 1.0), 1.0, 0.0, step=0.5, method="leapfrog", compile=False).x
    array([ 1. ,  0.5, -0.5])
    """

    force: Function
    mass: ArrayLike = 1.0
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)
    velocity_jacobian: Function | None = None

    def system(self, adapter: Adapter) -> System:
        """Make the system."""
        adapted = adapter.adapt(self.force, "the force")
        parts, native = {}, adapted.native
        if self.velocity_jacobian is not None:
            given = adapt_velocity_jacobian(self.velocity_jacobian, adapted, adapter)
            divided = adapter.bind(jacobian_divided_by_mass, jacobian=given.function)
            parts, native = {"velocity_jacobian": divided}, native and given.native
        return System(
            name=name_of(self.force),
            acceleration=adapter.bind(divided_by_mass, force=adapted.function),
            x0=adapter.x0,
            v0=adapter.v0,
            params=np.concatenate([adapter.args, 1 / masses_of(self.mass, adapter.x0.shape)]),
            quantities=adapter.quantities(self.energy, self.invariants),
            kind=Kind.VELOCITY_DEPENDENT if "v" in adapted.names else Kind.NEWTONIAN,
            parts=parts,
            kick=adapter.kick(self.force, adapted, of_force=True),
            native=native,
        )


def divided_by_mass(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    """Write the acceleration under a force; the inverse masses are the last params."""
    force(t, x, v, params, out)
    multiply(out, params[params.size - x.size :])


def to_each_number(values: ArrayLike, shape: tuple[int, ...]) -> Floats:
    """Give a value to each number of a state; N values to a state of N bodies, (N, d), are one per body."""
    given = reals(values)
    if len(shape) == 2 and given.shape == shape[:1]:
        given = given[:, None]
    return np.broadcast_to(given, shape).reshape(-1).copy()


def fitted(name: str, value: ArrayLike, shape: tuple[int, ...]) -> Floats:
    """Broadcast a value of this name to each number of a state of this shape, or refuse it with the reason.

    Raises
    ------
    ArgumentError
        For anything but numbers, or a shape that does not broadcast.
    """
    try:
        return to_each_number(value, shape)
    except (TypeError, ValueError) as error:
        raise ArgumentError(
            f"{name}={value!r} does not fit states of shape {shape}: {error}; give a number, or for states (N, 3) N of"
            " them."
        ) from None


def masses_of(mass: ArrayLike, shape: tuple[int, ...]) -> Floats:
    """Return one mass to each number of a state of this shape.

    Raises
    ------
    ArgumentError
        For masses that are not positive and finite numbers, or whose shape does not broadcast.
    """
    if has_unit(mass):
        mass = numbers("mass", mass, unit_of(mass))
    masses = fitted("mass", mass, shape)
    with np.errstate(divide="ignore", over="ignore"):
        inverse = 1.0 / masses
    if not (np.isfinite(masses).all() and (masses > 0).all() and np.isfinite(inverse).all()):
        raise ArgumentError(f"mass={mass!r} must be positive and finite, and so must 1 / mass.")
    return masses
