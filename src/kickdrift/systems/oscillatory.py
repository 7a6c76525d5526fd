"""x'' = -omega^2 x + g(t, x), by Python functions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.compilation import unbound
from kickdrift.core.kinds import Kind
from kickdrift.systems.damped import at_least_zero
from kickdrift.systems.problem import Adapter, Floats, Function, Problem, name_of
from kickdrift.systems.system import System

remainder: Function = unbound
oscillation: Function = unbound


@dataclass(frozen=True)
class Oscillatory(Problem):
    """x'' = -omega^2 x + g(t, x): fast linear oscillations, which are solved exactly, and other accelerations.

    Parameters
    ----------
    force : callable
        g, a function of any of ``x``, ``t`` (time-dependent forcing), ``params``, and ``out`` (written in place instead of
        returned).
    omega : array_like
        Angular frequencies, at least 0: a number, for states (N, 3) one per body, or of a shape that broadcasts to x0. For
        x'' = -A x + g with a symmetric matrix A, transform x and g to the eigenbasis of A; omega^2 are its eigenvalues.
    energy, invariants
        As for `kickdrift.SecondOrder`; the energy includes that of the oscillations.

    Raises
    ------
    ArgumentError
        For frequencies below 0, or a shape that does not fit the state.

    Notes
    -----
    The trigonometric methods allow steps far beyond 2 / omega, where other methods of kicks and drifts are unstable. Which
    one is best depends on the aim and on h omega [1]_. ``"mollified-impulse"`` is symplectic, and a good first choice.
    ``"deuflhard-2"`` has the smallest errors for small h omega; close to a multiple of pi its error grows. The slowly
    varying energies of the oscillators, and the total oscillatory energy, are nearly conserved over long times as long as no
    h omega is within about sqrt(h) of a multiple of pi. Any other method for accelerations can be used, too.

    References
    ----------
    .. [1] E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, 2nd ed. (2006), chapter XIII.

    Examples
    --------
    >>> import kickdrift as kd
    >>> spring = kd.Oscillatory(lambda x: -(x**3), omega=50.0)
    >>> sol = kd.solve(
    ...     spring,
    ...     (0.0, 10.0),
    ...     0.02,
    ...     0.0,
    ...     step=0.1,
    ...     method="mollified-impulse",
    ...     compile=False,
    ... )
    >>> bool(abs(sol.x).max() < 0.0201)
    True
    """

    force: Function
    omega: ArrayLike
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)

    def system(self, adapter: Adapter) -> System:
        """Make the system. Its last params are the frequencies."""
        adapted = adapter.adapt(self.force, "the force", ("t", "x", "params", "out"))
        fast = adapter.bind(oscillation_alone) if adapted.native else oscillation_alone
        return System(
            name=name_of(self.force),
            acceleration=adapter.bind(_with_oscillation, remainder=adapted.function),
            x0=adapter.x0,
            v0=adapter.v0,
            params=np.concatenate([adapter.args, at_least_zero("omega", self.omega, adapter.x0.shape)]),
            quantities=adapter.quantities(self.energy, self.invariants),
            kind=Kind.OSCILLATORY,
            parts={"remainder": adapted.function, "fast": fast},
            native=adapted.native,
        )


def oscillation_alone(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    """Write -omega^2 x."""
    start = params.size - x.size
    for k in range(x.size):
        out[k] = -params[start + k] * params[start + k] * x[k]


def _with_oscillation(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    remainder(t, x, v, params, out)
    start = params.size - x.size
    for k in range(x.size):
        out[k] -= params[start + k] * params[start + k] * x[k]
