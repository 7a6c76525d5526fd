"""Semi-implicit against implicit Euler: at the same step, and at the same error in position."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kickdrift as kd
from benchmarks.table import Row, at_least, measured, skipped
from benchmarks.turns import in_turns, nanoseconds, ratio

Floats = NDArray[np.float64]
SEMI, IMPLICIT = "semi-implicit-euler", "implicit-euler"
_SAVED = 20  # times at which the error is looked at
_MOST_TRIALS = 30


@dataclass(frozen=True)
class Case:
    """A nonlinear problem.

    Attributes
    ----------
    problem, x0, v0
        As `kickdrift.solve` takes them.
    step : float
        At which both are compared. Over 50,000 such steps implicit Euler damps by some per cent; at ten times the step
        it lets the planets of `kepler` and `solar-system` fall into their suns.
    span : float
        Over which the error is compared: about one turn of the fastest body.
    error : float
        To be reached in position, as the largest of any coordinate and time.
    """

    problem: Any
    x0: Any = None
    v0: Any = None
    step: float = 1e-3
    span: float = 2 * math.pi
    error: float = 1e-3


def duffing(x: Any) -> Any:
    """Acceleration in a double well, a user's function."""
    return x - x * x * x


_LINEAR = ("harmonic-oscillator",)
# Errors that take both methods so many steps that the start of a run does not show.
_CHOICES: dict[str, dict[str, float]] = {
    "pendulum": {"error": 1e-4},
    "solar-system": {"step": 2e-3, "span": 27.5, "error": 1e-5},
    "benchmarks-game": {"span": 12.0},
    "outer-solar-system": {"step": 0.1, "span": 4332.6, "error": 1e-2},
}


def cases() -> dict[str, Case]:
    """Every nonlinear system of the catalogue, and a user's function."""
    systems = {name: make for name, make in kd.systems.catalogue().items() if name not in _LINEAR}
    found = {name: Case(make(), **_CHOICES.get(name, {})) for name, make in systems.items()}
    return found | {"duffing": Case(duffing, 1.5, 0.0, error=1e-4)}


def _solve(case: Case, span: float, steps: int, method: str, saved: int = 1) -> kd.Solution:
    return kd.solve(
        case.problem,
        (0.0, span),
        case.x0,
        case.v0,
        step=span / steps,
        save_every=steps // saved,
        method=method,
        progress=False,
    )


def compare(rounds: int) -> list[Row]:
    """Compare the cost of implicit Euler with that of semi-implicit Euler; five rounds do, the ratios are large."""
    rounds, found = min(rounds, 5), cases()
    rows = [_at_same_step(name, case, rounds) for name, case in found.items()]
    return rows + [_at_same_error(name, case, rounds) for name, case in found.items()]


def _at_same_step(name: str, case: Case, rounds: int, steps: int = 50_000) -> Row:
    evaluations: dict[str, float] = {}

    def cost(method: str) -> float:
        solution = _solve(case, steps * case.step, steps, method)
        evaluations[method] = solution.n_force_evaluations / max(solution.n_steps, 1)
        return solution.wall_time * 1e9 / steps if solution.success else math.nan

    costs = in_turns({"implicit": lambda: cost(IMPLICIT), "semi-implicit": lambda: cost(SEMI)}, rounds)
    what = f"{name}, same step {case.step:g}: implicit / semi-implicit"
    if np.isnan(costs["implicit"]).any():
        return skipped(what, "implicit Euler does not get through")
    note = f"{nanoseconds(costs, *costs)}; {evaluations[IMPLICIT]:.2f} evaluations a step against 1"
    return measured(what, ratio(costs, "implicit", "semi-implicit"), at_least(5), note)


def _at_same_error(name: str, case: Case, rounds: int) -> Row:
    what = f"{name}, same error {case.error:g}: implicit / semi-implicit"
    error = partial(_error, case, _reference(case))
    try:
        steps = {method: _steps_for(case.error, partial(error, method)) for method in (SEMI, IMPLICIT)}
    except ValueError as problem:
        return skipped(what, str(problem))
    contestants = {
        method: lambda method=method, n=n: _solve(case, case.span, n, method).wall_time for method, n in steps.items()
    }
    costs = in_turns(contestants, rounds)
    note = f"{steps[IMPLICIT]} steps against {steps[SEMI]}"
    return measured(what, ratio(costs, IMPLICIT, SEMI), note=note)


def _reference(case: Case) -> Floats:
    if getattr(case.problem, "exact", None) is not None:
        positions: Floats = case.problem.exact(np.linspace(0.0, case.span, _SAVED + 1))[0]
        return positions
    return _solve(case, case.span, 1000 * _SAVED, "blanes-moan-srkn6b", _SAVED).x


def _error(case: Case, reference: Floats, method: str, steps: int) -> float:
    solution = _solve(case, case.span, steps, method, _SAVED)
    return float(np.max(np.abs(solution.x - reference.reshape(solution.x.shape)))) if solution.success else math.inf


def _steps_for(wanted: float, error: Callable[[int], float]) -> int:
    """Find a number of steps whose error is at most `wanted` and, where it falls smoothly, within 5 % of that.

    Raises
    ------
    ValueError
        If none is found.
    """
    steps = 10 * _SAVED
    for _ in range(_MOST_TRIALS):
        found = error(steps)
        if 0.95 * wanted <= found <= wanted:
            return steps
        # Both methods are of order one; where the steps are too large to show it, go on by factors.
        factor = min(max(found / wanted / 0.975, 1 / 8), 8.0)
        steps = math.ceil(steps * factor / _SAVED) * _SAVED
    raise ValueError(f"no step with an error of {wanted:g} found in {_MOST_TRIALS} trials")
