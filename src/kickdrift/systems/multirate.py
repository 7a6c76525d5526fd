"""m x'' = F_fast(t, x) + F_slow(t, x), by Python functions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.compilation import unbound
from kickdrift.core.kinds import Kind
from kickdrift.systems.problem import Adapter, Floats, Function, Problem, name_of
from kickdrift.systems.second_order import divided_by_mass, masses_of
from kickdrift.systems.system import System

fast: Function = unbound
slow: Function = unbound


@dataclass(frozen=True)
class Multirate(Problem):
    """m x'' = F_fast(t, x) + F_slow(t, x): a cheap force that varies fast, and an expensive one that varies slowly.

    Parameters
    ----------
    slow_force, fast_force : callable
        Functions of any of ``x``, ``t`` (time-dependent forcing), ``params``, and ``out`` (written in place instead of
        returned).
    mass : array_like
        m, positive: a number, or for states (N, 3) one per body.
    energy, invariants
        As for `kickdrift.SecondOrder`.

    Raises
    ------
    ArgumentError
        For masses that are not positive, or shapes that do not fit the state.

    Notes
    -----
    ``method=kd.methods.respa(substeps=20)`` evaluates the fast force twenty times per step, and the slow one once;
    evaluations of both are counted alike. Any method for accelerations can also be used, on their sum.

    Examples
    --------
    >>> import kickdrift as kd
    >>> bond = kd.Multirate(slow_force=lambda x: -x, fast_force=lambda x: -400 * x**3)
    >>> sol = kd.solve(
    ...     bond, (0.0, 1.0), x0=0.5, v0=0.0, step=0.05, method="respa-2", compile=False
    ... )
    >>> sol.n_force_evaluations
    222
    """

    slow_force: Function
    fast_force: Function
    mass: ArrayLike = 1.0
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)

    def system(self, adapter: Adapter) -> System:
        """Make the system. Its last params are the inverse masses."""
        names = ("t", "x", "params", "out")
        slowly = adapter.adapt(self.slow_force, "the slow force", names)
        quickly = adapter.adapt(self.fast_force, "the fast force", names)
        parts = {
            "remainder": adapter.bind(divided_by_mass, force=slowly.function),
            "fast": adapter.bind(divided_by_mass, force=quickly.function),
        }
        return System(
            name=name_of(self.slow_force),
            acceleration=adapter.bind(_sum, slow=parts["remainder"], fast=parts["fast"]),
            x0=adapter.x0,
            v0=adapter.v0,
            params=np.concatenate([adapter.args, 1 / masses_of(self.mass, adapter.x0.shape)]),
            quantities=adapter.quantities(self.energy, self.invariants),
            kind=Kind.MULTIRATE,
            parts=parts,
            native=slowly.native and quickly.native,
        )


def _sum(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    part = np.empty(out.size)
    slow(t, x, v, params, out)
    fast(t, x, v, params, part)
    for k in range(out.size):
        out[k] += part[k]
