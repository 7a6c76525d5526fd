"""Langevin dynamics: m dv = F(t, x) dt - gamma m v dt + sqrt(2 gamma kT m) dW, dx = v dt, by a Python function."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.arguments import is_whole
from kickdrift.core.compilation import unbound
from kickdrift.core.elementwise import multiply, subtract_product
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.systems.damped import at_least_zero
from kickdrift.systems.problem import Adapter, Floats, Function, Problem, name_of
from kickdrift.systems.second_order import masses_of
from kickdrift.systems.system import System

force: Function = unbound
remainder: Function = unbound

_HALF_WORD = 2**32  # a float64 holds 53 bits: the seed goes into two of them


@dataclass(frozen=True)
class Langevin(Problem):
    """Langevin dynamics: a force, friction, and the noise that balances it at a temperature.

    dx = v dt, m dv = F(t, x) dt - gamma m v dt + sqrt(2 gamma kT m) dW.

    Parameters
    ----------
    force : callable
        F, a function of any of ``x``, ``t``, ``params``, and ``out`` (written in place instead of returned).
    friction : array_like
        gamma, at least 0: a rate, in inverse time; a number, or for states (N, 3) one per body.
    temperature : float
        kT, at least 0, in units of energy.
    mass : array_like
        m, positive: a number, or for states (N, 3) one per body.
    seed : int
        From 0 to 2**64 - 1. The same seed yields the same noise, bit for bit, whatever is saved and on any number of
        threads. Independent runs need different seeds, and so does a run that continues from the end of another: with the
        same seed the noise would repeat.
    energy : callable, optional
        The energy, a function of x, v and so on, as for `kickdrift.SecondOrder`; it is not conserved.

    Raises
    ------
    ArgumentError
        For friction or a temperature below 0, masses that are not positive, shapes that do not fit the state, or a seed
        that is not such an integer.

    Notes
    -----
    ``method="baoab"`` has the most accurate positions: those of a harmonic oscillator have the exact distribution at every
    stable step, up to h omega = 2. The orders of these methods are weak orders, of averages. The random
    numbers are those of Philox4x64-10 [1]_.

    References
    ----------
    .. [1] J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, Parallel random numbers: as easy as 1, 2, 3, SC'11 (2011).

    Examples
    --------
    >>> import kickdrift as kd
    >>> double_well = kd.Langevin(
    ...     lambda x: 4 * x * (1 - x * x), friction=1.0, temperature=0.4, seed=7
    ... )
    >>> sol = kd.solve(
    ...     double_well, (0.0, 20.0), x0=1.0, v0=0.0, step=0.1, method="baoab", compile=False
    ... )
    >>> sol.x.shape
    (201,)
    """

    force: Function
    friction: ArrayLike
    temperature: float
    mass: ArrayLike = 1.0
    seed: int = 0
    energy: Function | None = None

    def system(self, adapter: Adapter) -> System:
        """Make the system.

        Its last params, for n numbers to a state: n inverse masses, n frictions, n variances kT / m of the velocities,
        and the lower and the upper half of the seed.
        """
        adapted = adapter.adapt(self.force, "the force", ("t", "x", "params", "out"))
        shape = adapter.x0.shape
        inverse_masses = 1 / masses_of(self.mass, shape)
        friction = at_least_zero("friction", self.friction, shape)
        variances = at_least_zero("temperature", self.temperature, ()) * inverse_masses
        rest = adapter.bind(_divided_by_mass, force=adapted.function)
        return System(
            name=name_of(self.force),
            acceleration=adapter.bind(_with_friction, remainder=rest),
            x0=adapter.x0,
            v0=adapter.v0,
            params=np.concatenate([adapter.args, inverse_masses, friction, variances, _halves(self.seed)]),
            quantities=adapter.quantities(self.energy, {}),
            kind=Kind.LANGEVIN,
            parts={"remainder": rest},
            native=adapted.native,
        )


def _divided_by_mass(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    force(t, x, v, params, out)
    multiply(out, params[params.size - 2 - 3 * x.size : params.size - 2 - 2 * x.size])


def _with_friction(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    remainder(t, x, v, params, out)
    subtract_product(out, params[params.size - 2 - 2 * x.size : params.size - 2 - x.size], v)


def _halves(seed: int) -> Floats:
    if not is_whole(seed, 0, _HALF_WORD**2 - 1):
        raise ArgumentError(f"seed={seed!r} must be an integer from 0 to 2**64 - 1.")
    high, low = divmod(int(seed), _HALF_WORD)
    return np.array([low, high], dtype=np.float64)
