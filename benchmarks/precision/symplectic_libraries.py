"""Peers that keep the structure, with equal steps: pyhamsys, symplecta, desolver's symplectic methods, REBOUND.

Each makes a solver for a case. Where they call Python, the functions are compiled with Numba.
"""

import math
import time
from collections.abc import Callable
from typing import Any

import numba
import numpy as np

from benchmarks.peers import package
from benchmarks.precision.case import Case, Run, Solver
from benchmarks.precision.laws import Floats, compiled, returning
from benchmarks.precision.libraries import FAILED, Maker
from benchmarks.precision.ours import KEPT


def pyhamsys(method: str, first: str = "kick") -> Maker:
    """Use `solve_ivp_symp` for the flows of the two parts; which of them comes first depends on the method.

    Its documented command keeps the states: with more times in `t_eval` it would search them all in each step.
    """

    def make(case: Case) -> Solver:
        library, n, made = package("pyhamsys"), len(case.x0), case.law(math)
        velocity, force = compiled(made.velocity), compiled(made.force)

        @numba.njit
        def kick_drift(h: float, t: float, y: Floats) -> Floats:
            new, rate = y.copy(), np.empty(n)
            force(t, new[:n], new[n:], rate)
            new[n:] += h * rate
            velocity(t, new[:n], new[n:], rate)
            new[:n] += h * rate
            return new

        @numba.njit
        def drift_kick(h: float, t: float, y: Floats) -> Floats:
            new, rate = y.copy(), np.empty(n)
            velocity(t, new[:n], new[n:], rate)
            new[:n] += h * rate
            force(t, new[:n], new[n:], rate)
            new[n:] += h * rate
            return new

        flows = (kick_drift, drift_kick) if first == "kick" else (drift_kick, kick_drift)

        def solve(step: float, command: Any) -> Any:
            parameters = library.Parameters(step=step, solver=method, display=False)
            return library.solve_ivp_symp(
                *flows, (0.0, case.span), case.start, t_eval=[0.0, step], params=parameters, command=command
            )

        return _keeping(case, solve, _CHIS[method])

    return make


def pyhamsys_extended(method: str, omega: float | None = None) -> Maker:
    """Use `solve_ivp_sympext`, two copies of phase space; without omega they are brought together after each step."""

    def make(case: Case) -> Solver:
        library, rates = package("pyhamsys"), returning(case.law, len(case.x0))
        system = library.HamSys(ndof=len(case.x0), y_dot=rates)

        def solve(step: float, command: Any) -> Any:
            parameters = library.Parameters(step=step, solver=method, extension=True, omega=omega, display=False)
            return library.solve_ivp_sympext(
                system, (0.0, case.span), case.start, parameters, t_eval=[0.0, step], command=command
            )

        return _keeping(case, solve, 2 * _CHIS[method])

    return make


_CHIS = {"Verlet": 2, "BM4": 12, "BM6": 20, "RKN4b": 12, "RKN6b": 22, "RKN6a": 28}  # flows to a step


def _keeping(case: Case, solve: Callable[[float, Any], Any], evaluations: int) -> Solver:
    def run(steps: float, keep: bool) -> Run:
        rows: list[Floats] = []
        last = [case.start]

        def remember(t: float, y: Floats) -> None:
            last[0] = y

        # It takes one step more than the span needs; half a step keeps rounding from adding another.
        step = case.span / (round(steps) - 1.5)
        started = time.perf_counter()
        result = solve(step, (lambda t, y: rows.append(y.copy())) if keep else remember)
        seconds = time.perf_counter() - started
        taken = round(case.span / result.step)
        return Run(seconds, np.array(rows if keep else last), taken * evaluations)

    return run


def symplecta(method: str) -> Maker:
    """Use `solve_symplectic_ivp` with a force; it always keeps every step."""

    def make(case: Case) -> Solver:
        library, n, written = package("symplecta"), len(case.x0), compiled(case.law(math).force)

        @numba.njit
        def force(t: float, q: Floats) -> Floats:
            out = np.empty(n)
            written(t, q, q, out)
            return out

        return _symplecta(case, library, method, {"force": force})

    return make


def symplecta_general(method: str) -> Maker:
    """Use `solve_symplectic_ivp` with the gradients of the Hamiltonian."""

    def make(case: Case) -> Solver:
        library, n, law = package("symplecta"), len(case.x0), case.law(math)
        velocity, force = compiled(law.velocity), compiled(law.force)

        @numba.njit
        def dHdp(t: float, q: Floats, p: Floats) -> Floats:  # noqa: N802 - the derivative's own name
            out = np.empty(n)
            velocity(t, q, p, out)
            return out

        @numba.njit
        def dHdq(t: float, q: Floats, p: Floats) -> Floats:  # noqa: N802
            out = np.empty(n)
            force(t, q, p, out)
            return -out

        return _symplecta(case, library, method, {"dHdq": dHdq, "dHdp": dHdp})

    return make


def symplecta_constrained(method: str, constraint: Any, jacobian: Any, force: Any) -> Maker:
    """Use `solve_symplectic_ivp` with a constraint g(q), its Jacobian and a force f(t, q)."""

    def make(case: Case) -> Solver:
        constraints = {"g": numba.njit(constraint), "jac": numba.njit(jacobian)}
        functions = {"force": numba.njit(force), "constraints": constraints}
        return _symplecta(case, package("symplecta"), method, functions)

    return make


def _symplecta(case: Case, library: Any, method: str, functions: dict[str, Any]) -> Solver:
    def run(steps: float, keep: bool) -> Run:
        started = time.perf_counter()
        result = library.solve_symplectic_ivp(
            (0.0, case.span), case.x0, case.v0, method=method, n_steps=round(steps), **functions
        )
        seconds = time.perf_counter() - started
        evaluations = result.nfev / (
            2 if "dHdq" in functions else 1
        )  # the two gradients are the force and the velocity
        return Run(seconds, result.y.T if result.success else FAILED, evaluations)

    return run


def desolver(method: str) -> Maker:
    """Use `solve_ivp` with a symplectic method, which evaluates all rates in each stage."""

    def make(case: Case) -> Solver:
        library, rates = package("desolver"), returning(case.law, len(case.x0))

        def plain(t: Any, y: Any) -> Any:  # it looks for the names of the arguments
            return rates(float(t), y)

        def run(steps: float, keep: bool) -> Run:
            started = time.perf_counter()
            result = library.solve_ivp(
                plain, (0.0, case.span), case.start, method=method, first_step=case.span / round(steps)
            )
            seconds = time.perf_counter() - started
            return Run(seconds, np.asarray(result.y).T if result.success else FAILED, result.nfev)

        return run

    return make


def rebound(integrator: str, stages: int = 1, **settings: Any) -> Maker:
    """Use REBOUND; the settings are those of its integrator. Without `stages` it takes a tolerance, its epsilon."""

    def make(case: Case) -> Solver:
        library = package("rebound")

        def simulation(value: float) -> Any:
            made = library.Simulation()
            for body in _bodies(case):
                made.add(**body)
            if not case.masses:
                made.N_active = 1  # the second body attracts nothing
            made.integrator = integrator
            # The place of the settings before REBOUND 5, and since.
            own = getattr(made, f"ri_{integrator}", made.integrator)
            for name, setting in settings.items():
                setattr(own, name, setting)
            if stages:
                made.dt = case.span / value
            else:
                own.epsilon = value
            return made

        def advance(made: Any, steps: int, part: float) -> None:
            if stages:
                made.steps(steps)
                made.synchronize()
            else:
                made.integrate(part * case.span, exact_finish_time=int(part == 1))

        def run(value: float, keep: bool) -> Run:
            value = round(value) if stages else value
            rows, made, done = [], simulation(value), 0
            started = time.perf_counter()
            for row in range(1, KEPT + 1) if keep else (KEPT,):
                steps = int(value * row / KEPT) - done if stages else 0
                advance(made, steps, row / KEPT)
                rows.append(_state(made, case))
                done += steps
            seconds = time.perf_counter() - started
            return Run(seconds, np.array(rows), stages * value if stages else np.nan)

        return run

    return make


def _bodies(case: Case) -> list[dict[str, float]]:
    d = 3 if case.masses else len(case.x0)
    axes = ("x", "y", "z")[:d], ("vx", "vy", "vz")[:d]
    bodies = [] if case.masses else [{"m": 1.0}]
    for i in range(len(case.x0) // d):
        part = slice(d * i, d * i + d)
        body = dict(zip(axes[0] + axes[1], case.x0[part] + case.v0[part], strict=True))
        bodies.append(body | {"m": case.masses[i] if case.masses else 0.0})
    return bodies


def _state(simulation: Any, case: Case) -> Floats:
    d, first = (3, 0) if case.masses else (len(case.x0), 1)
    particles = [simulation.particles[i] for i in range(first, simulation.N)]
    x = [p.xyz[:d] for p in particles]
    v = [p.vxyz[:d] for p in particles]
    return np.concatenate([np.ravel(x), np.ravel(v)])
