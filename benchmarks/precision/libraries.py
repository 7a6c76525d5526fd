"""Peers for any equations, with steps of their own choice: SciPy, heyoka, diffrax, desolver's Runge-Kutta methods.

Each makes a solver for a case. The equations are compiled by the library itself, or else by Numba. A run that is timed
keeps the end alone where a library can; the states on the way are from the same run once more.
"""

import time
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import scipy.integrate

from benchmarks.peers import package
from benchmarks.precision.case import Case, Run, Solver
from benchmarks.precision.laws import expressed, returning
from benchmarks.precision.ours import KEPT

Maker = Callable[[Case], Solver]
FAILED = np.full((1, 1), np.nan)
_MOST_STEPS, _KEPT_STEPS = 1_000_000, 200_000  # of diffrax


def scipy_dop853(case: Case) -> Solver:
    """Use `solve_ivp`; it always keeps every step."""
    rates, start = returning(case.law, len(case.x0)), case.start

    def run(tolerance: float, keep: bool) -> Run:
        started = time.perf_counter()
        result = scipy.integrate.solve_ivp(
            rates, (0.0, case.span), start, method="DOP853", rtol=tolerance, atol=tolerance
        )
        seconds = time.perf_counter() - started
        return Run(seconds, result.y.T if result.success else FAILED, result.nfev)

    return run


def heyoka(case: Case) -> Solver:
    """Use `taylor_adaptive`, compiled once for each tolerance."""
    library = package("heyoka")
    n, start = len(case.x0), case.start
    names = [f"y{i}" for i in range(start.size)]
    variables = [library.expression(name) for name in names]
    rates = expressed(case.law, library, n, library.time, variables)
    rates = [rate if isinstance(rate, library.expression) else library.expression(float(rate)) for rate in rates]

    @cache
    def integrator(tolerance: float) -> Any:
        return library.taylor_adaptive(list(zip(variables, rates, strict=True)), state=list(start), tol=tolerance)

    def run(tolerance: float, keep: bool) -> Run:
        made = integrator(tolerance)
        made.time, made.state[:] = 0.0, start
        if keep:
            return Run(0.0, made.propagate_grid(np.linspace(0.0, case.span, KEPT))[-1])
        started = time.perf_counter()
        outcome = made.propagate_until(case.span)
        seconds = time.perf_counter() - started
        reached = outcome[0] == library.taylor_outcome.time_limit
        return Run(seconds, made.state[None].copy() if reached else FAILED)

    return run


def diffrax(solver: str) -> Maker:
    """Use a Runge-Kutta method, jitted for all tolerances at once, 64 bits, forward mode."""

    def make(case: Case) -> Solver:
        library, jax = package("diffrax"), package("jax")
        jax.config.update("jax_enable_x64", True)
        jnp, n = jax.numpy, len(case.x0)
        law, method = case.law, getattr(library, solver)()
        stages = method.tableau.num_stages - bool(method.tableau.fsal)

        def rates(t: Any, y: Any, args: Any) -> Any:
            return jnp.stack(expressed(law, jnp, n, t, y))

        def solve(tolerance: Any, start: Any, keep: bool) -> Any:
            saveat = library.SaveAt(steps=True) if keep else library.SaveAt(t1=True)
            solution = library.diffeqsolve(
                library.ODETerm(rates),
                method,
                0.0,
                case.span,
                None,
                start,
                saveat=saveat,
                stepsize_controller=library.PIDController(rtol=tolerance, atol=tolerance),
                adjoint=library.ForwardMode(),
                max_steps=_KEPT_STEPS if keep else _MOST_STEPS,
                throw=False,
            )
            return solution.ys, solution.stats["num_steps"], solution.stats["num_accepted_steps"]

        jitted, start = jax.jit(solve, static_argnums=2), jnp.array(case.start)

        def run(tolerance: float, keep: bool) -> Run:
            started = time.perf_counter()
            states, steps, accepted = jax.block_until_ready(jitted(tolerance, start, False))
            seconds = time.perf_counter() - started
            if keep and case.energy:
                states = jitted(tolerance, start, True)[0][: int(accepted)]
            states = np.asarray(states) if int(steps) < _MOST_STEPS else FAILED
            return Run(seconds, states, stages * int(steps))

        return run

    return make


_MOST_STEPS = 200_000


def diffrax_langevin(
    solver: str, area: str, stages: int, force: Callable[[Any], Any], friction: float, temperature: float
) -> Maker:
    """Use a solver for underdamped Langevin dynamics with unit masses, jitted for all steps, on its fastest noise.

    `area` names what the solver wants to know about the noise besides its increments.
    """

    def make(case: Case) -> Solver:
        library, jax = package("diffrax"), package("jax")
        jax.config.update("jax_enable_x64", True)
        jnp, n = jax.numpy, len(case.x0)
        start = jnp.array(case.x0), jnp.array(case.v0)
        shape, of_energy = jax.ShapeDtypeStruct((n,), jnp.float64), jnp.full(n, temperature)

        def solve(step: Any, keep: bool) -> Any:
            path = library.UnsafeBrownianPath(shape, jax.random.PRNGKey(1), levy_area=getattr(library, area))
            drift = library.UnderdampedLangevinDriftTerm(
                jnp.full(n, friction), of_energy, lambda x, args: -force(x) / temperature
            )
            noise = library.UnderdampedLangevinDiffusionTerm(jnp.full(n, friction), of_energy, path)
            return library.diffeqsolve(
                library.MultiTerm(drift, noise),
                getattr(library, solver)(),
                0.0,
                case.span,
                step,
                start,
                saveat=library.SaveAt(ts=jnp.linspace(0.0, case.span, KEPT)) if keep else library.SaveAt(t1=True),
                max_steps=_MOST_STEPS,
                adjoint=library.ForwardMode(),
                throw=False,
            ).ys

        jitted = jax.jit(solve, static_argnums=1)

        def run(steps: float, keep: bool) -> Run:
            step = case.span / round(steps)
            started = time.perf_counter()
            states = jax.block_until_ready(jitted(step, keep))
            seconds = time.perf_counter() - started
            return Run(seconds, np.concatenate(states, axis=1), stages * round(steps))

        return run

    return make
