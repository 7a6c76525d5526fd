"""References for runs: the exact motion if it is known, otherwise DOP853 at a tight tolerance."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.core.kinds import Kind
from kickdrift.engine.multipliers import constraint_acceleration
from kickdrift.engine.problem_adapter import describe
from kickdrift.engine.solution import Solution
from kickdrift.engine.start import Start
from kickdrift.systems.system import System, start

Floats = NDArray[np.float64]

HUGE = 1e100


def end_of_reference(problem: Any, run: Solution, own_start: bool, args: Sequence[float] | None) -> tuple[Any, Any]:
    """Return x and v where a run ends, exactly or by DOP853 at a relative tolerance of 1e-13.

    Parameters
    ----------
    problem : System, Problem or callable
    run : Solution
        One of its runs, of which the first row is the start.
    own_start : bool
        Whether that is the start that a system brings.
    args : sequence of float or None
        Of the run.

    Raises
    ------
    ArgumentError
        For Langevin dynamics.
    KickdriftError
        If DOP853 does not reach the end.
    """
    if isinstance(problem, System) and problem.exact is not None and own_start and run.t[0] == 0:
        x, v = problem.exact(run.t[-1:])
        return x[0], v[0]
    if run.about.kind == Kind.LANGEVIN.name:
        raise ArgumentError(
            "reference=None cannot be computed for Langevin dynamics: a stochastic path has none; compare averages, or"
            " give a reference."
        )
    return _dop853(described(problem, float(run.t[0]), run.x[0], run.v[0], args), run)


def described(problem: Any, t0: float, x0: Floats, v0: Floats, args: Sequence[float] | None) -> System:
    """Return the system of a problem with a start, with functions that run in the interpreter."""
    if isinstance(problem, System):
        return problem
    return describe(problem, t0, Start(x0, v0), start(() if args is None else args).reshape(-1), compile_=False)


class Rates:
    """The rates of all numbers of a state, for SciPy's solvers, and how large those numbers are."""

    def __init__(self, system: System, x0: Floats, v0: Floats) -> None:
        self._system, self.size = system, x0.size
        parts = x0.reshape(-1), v0.reshape(-1)
        self.start = np.concatenate(parts)
        # An absolute tolerance for each of x and v: their units differ.
        self.scales = np.concatenate([np.full(part.size, np.abs(part).max(initial=0.0) or 1.0) for part in parts])

    def __call__(self, t: float, y: Floats) -> Floats:
        """Return the rates."""
        system, x, v, out = self._system, y[: self.size], y[self.size :], np.empty(y.size)
        if system.velocity is None:
            out[: self.size] = v
        else:
            system.velocity(t, x, v, system.params, out[: self.size])
        if v.size > 0:
            system.acceleration(t, x, v, system.params, out[self.size :])
        if system.kind is Kind.CONSTRAINED:
            out[self.size :] += constraint_acceleration(system, t, x, v)
        # Where rates are not a number, SciPy's step control goes on for ever; where they are huge, it shortens the step.
        return np.nan_to_num(out, copy=False, nan=HUGE, posinf=HUGE, neginf=-HUGE)


def _dop853(system: System, run: Solution) -> tuple[Floats, Floats]:
    from scipy.integrate import solve_ivp

    rates, n = Rates(system, run.x[0], run.v[0]), run.x[0].size
    times = {"t_span": (run.t[0], run.t[-1]), "t_eval": run.t[-1:]}
    end = solve_ivp(rates, y0=rates.start, method="DOP853", rtol=1e-13, atol=1e-14 * rates.scales, **times)
    if not end.success:
        raise KickdriftError(f"reference=None could not be computed by DOP853: {end.message} Give a reference.")
    return end.y[:n, -1].reshape(run.x[0].shape), end.y[n:, -1].reshape(run.v[0].shape)
