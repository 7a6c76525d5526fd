"""The cost of a method for a tolerance, by runs of a pilot."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kickdrift import methods
from kickdrift.analysis.pilot import ROWS, Pilot
from kickdrift.core.errors import KickdriftError
from kickdrift.core.kinds import Kind
from kickdrift.engine.solution import Solution

_SAFETY = 0.5  # of the tolerance
_FINER = 1.5
_MOST_RUNS = 24  # of a method
_MOST_STEPS = 400_000
_TIMES, _FEW = 20, 2000  # of the best's evaluations, more than which are not tried, if they are not few
_DISSIPATIVE = (Kind.FIRST_ORDER, Kind.VELOCITY_DEPENDENT, Kind.DAMPED, Kind.PARTITIONED)


@dataclass(frozen=True)
class Trial:
    """The cost of a method for a tolerance.

    Attributes
    ----------
    method : str
    step : float
        Its step.
    evaluations : float
        Of the force, over the whole span.
    seconds : float
        Over the whole span, as the pilot ran.
    error : float
        The error expected at the end of the span.
    energy_error : float
        The largest relative one in the pilot; NaN where there is no energy.
    growth : float
        The power of time with which errors are assumed to grow.
    runs : int
        Number of pilot runs.
    """

    method: str
    step: float
    evaluations: float
    seconds: float
    error: float
    energy_error: float
    growth: float
    runs: int


class _Run:
    """One run of the pilot: its step, what it costs a unit of time, and what it leads to."""

    def __init__(self, sol: Solution, pilot: Pilot, conserving: bool, steady: bool) -> None:
        self.step, length = abs(sol.step), abs(pilot.length)
        self.evaluations = sol.n_force_evaluations / length
        self.seconds = sol.wall_time / length
        self.error, self.expected, self.growth, self.energy_error = math.inf, math.inf, 1.0, math.nan
        if not sol.success:
            return
        errors = pilot.errors(sol.x[1:], sol.v[1:])
        self.error = float(errors[-1])
        self.expected, self.growth = pilot.at_the_end(errors, conserving, steady)
        if "energy" in sol.invariants:
            energy = sol.energy
            self.energy_error = float(np.abs(energy - energy[0]).max() / (abs(float(energy[0])) or 1.0))


def tried(run: Any, method: methods.Method, pilot: Pilot, tolerance: float, kind: Kind, least: float) -> Trial:
    """Return what a method needs, where others need so many evaluations per unit of time at the `least`.

    Raises
    ------
    KickdriftError
        If it does not get there.
    """
    wanted, length = _SAFETY * tolerance, abs(pilot.length)
    conserving = method.symmetric or (method.explicit and method.tableau is None)
    steady = not any(kind is each for each in _DISSIPATIVE)

    def at(step: float) -> _Run:
        n_steps = max(1, math.ceil(length / step * (1 - 1e-9)))
        rows = min(ROWS, 1 << (n_steps.bit_length() - 1))
        n_steps = rows * math.ceil(n_steps / rows)
        if n_steps > _MOST_STEPS:
            raise KickdriftError(f"needs more than {_MOST_STEPS} steps in the pilot run")
        span = pilot.t0, pilot.t0 + pilot.length
        sol = run(t_span=span, step=length / n_steps, method=method, save_every=n_steps // rows)
        if sol.n_force_evaluations > max(_TIMES * least * length, _FEW):
            raise KickdriftError(f"needs more than {_TIMES} times the force evaluations of the best method")
        return _Run(sol, pilot, conserving, steady)

    runs = [at(min(2 * pilot.step, length))]
    while runs[0].expected <= wanted and runs[0].step < length / 1.01 and len(runs) < _MOST_RUNS:
        runs.insert(0, at(min(2 * runs[0].step, length)))
    while runs[-1].expected > wanted and len(runs) < _MOST_RUNS and not _at_the_floor(runs, pilot):
        runs.append(at(runs[-1].step / _FINER))
    if runs[0].step > 0.99 * length and runs[0].error < pilot.exact_to:  # one step over all of it: it is the exact flow
        return _trial(method, abs(pilot.span), runs[0], pilot, wanted, len(runs))
    step = _step_for(runs, wanted, pilot, method)
    last = min(runs, key=lambda own: abs(math.log(own.step / step)))
    confirmed = at(min(step, length))
    if confirmed.expected > tolerance and confirmed.error > pilot.exact_to:
        step, last = min(own.step for own in runs), runs[-1]
        if last.expected > tolerance and last.error > pilot.exact_to:
            raise KickdriftError(f"has an error of {last.expected:.2g} even with a step of {last.step:.3g}")
    else:
        last = confirmed
    return _trial(method, step, last, pilot, wanted, len(runs) + 1)


def _trial(method: methods.Method, step: float, last: _Run, pilot: Pilot, wanted: float, runs: int) -> Trial:
    scale = abs(pilot.span) * last.step / step
    finer = (step / last.step) ** method.order  # its steps were of a whole number of rows
    expected = last.expected * finer if last.error > pilot.exact_to else wanted
    cost = last.evaluations * scale, last.seconds * scale
    return Trial(method.name, step, *cost, expected, last.energy_error, last.growth, runs)


def _at_the_floor(runs: Sequence[_Run], pilot: Pilot) -> bool:
    """Whether smaller steps show nothing: rounding, or the error of the reference, is left."""
    return runs[-1].error < pilot.exact_to


def _step_for(runs: Sequence[_Run], wanted: float, pilot: Pilot, method: methods.Method) -> float:
    """Return the step with a wanted error, between two runs or, where the pilot is too short to show it, by the order."""
    good = [own for own in runs if math.isfinite(own.expected)]
    if not good:
        raise KickdriftError("does not reach the end of the pilot run")
    fine = next((own for own in runs if own.expected <= wanted), None)
    if fine is None:
        told = [own for own in good if own.error > pilot.exact_to]
        if not _at_the_floor(runs, pilot) or not told:
            raise KickdriftError(f"has an error of {runs[-1].expected:.2g} even with a step of {runs[-1].step:.3g}")
        return float(told[-1].step * (wanted / told[-1].expected) ** (1 / method.order))
    coarser = [own for own in good if own.step > fine.step]
    if not coarser or fine.error < pilot.exact_to:
        return float(fine.step)
    before = coarser[-1]
    share = math.log(before.expected / wanted) / math.log(before.expected / fine.expected)
    return float(before.step ** (1 - share) * fine.step**share)
