"""m x'' = F(t, x) - c v, by Python functions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.compilation import unbound
from kickdrift.core.elementwise import multiply, subtract_product
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.systems.problem import Adapter, Floats, Function, Problem, name_of
from kickdrift.systems.second_order import fitted, masses_of
from kickdrift.systems.system import System

force: Function = unbound
remainder: Function = unbound


@dataclass(frozen=True)
class Damped(Problem):
    """m x'' = F(t, x) - c v: a force by a Python function, and linear damping that is solved exactly.

    Parameters
    ----------
    force : callable
        F, a function of any of ``x``, ``t`` (time-dependent forcing), ``params``, and ``out`` (written in place instead of
        returned).
    damping : array_like
        c, at least 0: force per velocity; a number, or for states (N, 3) one per body.
    mass : array_like
        m, positive: a number, or for states (N, 3) one per body.
    energy, invariants
        As for `kickdrift.SecondOrder`; the energy of a damped motion decreases.

    Raises
    ------
    ArgumentError
        For damping below 0, masses that are not positive, or shapes that do not fit the state.

    Notes
    -----
    ``method="conformal-verlet"`` and ``"blanes-moan-conformal-4"`` multiply v by exp(-c h / m) for the damping, and kick and
    drift for the rest. With the same c / m everywhere they contract the symplectic form by exactly exp(-c t / m), as the
    exact flow does: they are conformally symplectic [1]_. They are for weak damping, where the step times c / m is at most
    about 1: beyond that, the splitting error stops the motion, and the negative weights of orders 4 and 6 make v grow. For
    strong damping use ``"implicit-damping"`` or ``"gauss-4"``; methods for any acceleration can be used, too.

    References
    ----------
    .. [1] R. McLachlan, M. Perlmutter, Conformal Hamiltonian systems, J. Geom. Phys. 39 (2001) 276.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> pendulum = kd.Damped(lambda x: -np.sin(x), damping=0.2)
    >>> sol = kd.solve(
    ...     pendulum,
    ...     (0.0, 50.0),
    ...     3.0,
    ...     0.0,
    ...     step=0.1,
    ...     method="conformal-verlet",
    ...     compile=False,
    ... )
    >>> bool(abs(sol.x[-1]) < 0.1)
    True
    """

    force: Function
    damping: ArrayLike
    mass: ArrayLike = 1.0
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)

    def system(self, adapter: Adapter) -> System:
        """Make the system. Its last params are the inverse masses and then the damping rates c / m."""
        adapted = adapter.adapt(self.force, "the force", ("t", "x", "params", "out"))
        shape = adapter.x0.shape
        masses = masses_of(self.mass, shape)
        rates = at_least_zero("damping", self.damping, shape) / masses
        rest = adapter.bind(_divided_by_mass, force=adapted.function)
        return System(
            name=name_of(self.force),
            acceleration=adapter.bind(_with_damping, remainder=rest),
            x0=adapter.x0,
            v0=adapter.v0,
            params=np.concatenate([adapter.args, 1 / masses, rates]),
            quantities=adapter.quantities(self.energy, self.invariants),
            kind=Kind.DAMPED,
            parts={"remainder": rest},
            native=adapted.native,
        )


def _divided_by_mass(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    force(t, x, v, params, out)
    multiply(out, params[params.size - 2 * x.size : params.size - x.size])


def _with_damping(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    remainder(t, x, v, params, out)
    subtract_product(out, params[params.size - x.size :], v)


def at_least_zero(name: str, value: ArrayLike, shape: tuple[int, ...]) -> Floats:
    """Return one number, at least 0, to each number of a state of this shape.

    Raises
    ------
    ArgumentError
        For negative or infinite numbers, or a shape that does not broadcast.
    """
    numbers = fitted(name, value, shape)
    if not (np.isfinite(numbers).all() and (numbers >= 0).all()):
        raise ArgumentError(f"{name}={value!r} must be at least 0 and finite.")
    return numbers
