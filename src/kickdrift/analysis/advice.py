"""Which method and step to take, by measurement: `advise`."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods
from kickdrift.analysis import candidates
from kickdrift.analysis.pilot import ROWS, Pilot, fly
from kickdrift.analysis.reference import Rates, described
from kickdrift.analysis.tables import Column, frame, markdown
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.core.kinds import Kind
from kickdrift.engine.solution import Solution
from kickdrift.engine.solve import solve
from kickdrift.engine.start import start_of
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System

Floats = NDArray[np.float64]

_SAFETY = 0.5  # of the tolerance
_FINER = 1.5
_MOST_RUNS = 24  # of a method
_MOST_STEPS = 400_000
_TIMES, _FEW = 20, 2000  # of the best's evaluations, more than which are not tried, if they are not few
_DISSIPATIVE = (Kind.FIRST_ORDER, Kind.VELOCITY_DEPENDENT, Kind.DAMPED, Kind.PARTITIONED)


@dataclass(frozen=True)
class Trial:
    """What a method needs for a tolerance.

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
        What is expected at the end of the span.
    energy_error : float
        The largest relative one in the pilot; NaN where there is no energy.
    growth : float
        The power of time with which errors are taken to grow.
    runs : int
        How many pilot runs there were.
    """

    method: str
    step: float
    evaluations: float
    seconds: float
    error: float
    energy_error: float
    growth: float
    runs: int


@dataclass(frozen=True, eq=False, repr=False)
class Advice:
    """The recommendation, and what it rests on; it shows itself as a table.

    Attributes
    ----------
    method : str
        The method recommended: of those that meet the tolerance the one with the fewest force evaluations.
    step : float
        Its step.
    tolerance : float
    system : str
        Name.
    span, pilot : float
        Lengths of the whole span, and of the runs.
    trials : tuple of Trial
        The methods that get there, by their force evaluations.
    left_out : mapping of str to str
        The others, and why.
    """

    method: str
    step: float
    tolerance: float
    system: str
    span: float
    pilot: float
    trials: tuple[Trial, ...]
    left_out: dict[str, str]

    @property
    def columns(self) -> dict[str, Column]:
        """The table, a row a method."""
        return {
            "method": [trial.method for trial in self.trials],
            "step": np.array([trial.step for trial in self.trials]),
            "force evaluations": np.array([trial.evaluations for trial in self.trials]),
            "seconds": np.array([trial.seconds for trial in self.trials]),
            "error expected": np.array([trial.error for trial in self.trials]),
            "energy error": np.array([trial.energy_error for trial in self.trials]),
            "growth": np.array([trial.growth for trial in self.trials]),
            "runs": np.array([trial.runs for trial in self.trials]),
        }

    def to_pandas(self) -> Any:
        """Return the table as a `pandas.DataFrame`, a row a method."""
        return frame(self.columns, "Advice.to_pandas")

    def __repr__(self) -> str:
        share = abs(self.pilot / self.span)
        known = "the whole span" if share >= 1 else f"{share:.3g} of the span, extrapolated"
        lines = [
            f"{self.system} over {self.span:g} to an error of {self.tolerance:g}: method={self.method!r}, step={self.step:.6g}",
            f"(measured on {known}; errors of the state in terms of its size)",
            "",
            markdown(self.columns),
        ]
        if self.left_out:
            lines += ["", *(f"{name}: {why}" for name, why in self.left_out.items())]
        return "\n".join(lines)

    _repr_markdown_ = __repr__


def advise(
    problem: System | Problem | Callable[..., Any],
    t_span: Sequence[float],
    tolerance: float,
    x0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    methods: Sequence[str | methods.Method] | None = None,
    args: Sequence[float] | None = None,
    compile: bool = True,  # noqa: A002 - as in `solve`
    seconds: float = 30.0,
) -> Advice:
    """Measure short runs of the methods that suit a problem, and recommend a method and a step.

    As much of the span as DOP853 solves to 1e-13 within two seconds is a pilot; each method runs it with smaller and smaller
    steps, until the error to expect at the end of the span, by how errors grow in the pilot, meets the tolerance. Chaos
    makes errors grow faster than that; where it sets in after the pilot nothing of it is seen.

    Parameters
    ----------
    problem, t_span, x0, v0, args, compile
        As for `kickdrift.solve`.
    tolerance : float
        The largest error of the state, in x in terms of the largest number of x along the motion, in v in that of v.
    methods : sequence of str or Method, optional
        Which to try. By default those that were the fastest on some problem of the kind.
    seconds : float
        After which no further method is tried.

    Returns
    -------
    Advice

    Raises
    ------
    ArgumentError
        For a tolerance that is not between 1e-13 and 1, and for Langevin dynamics.
    KickdriftError
        If the motion cannot be followed, or no method meets the tolerance.

    Examples
    --------
    >>> import kickdrift as kd
    >>> advice = kd.advise(kd.systems.pendulum(), (0.0, 100.0), 1e-6)
    >>> sol = kd.solve(kd.systems.pendulum(), (0.0, 100.0), method=advice.method, step=advice.step)
    >>> sol.success
    True
    """
    if not (isinstance(tolerance, float | int) and 1e-13 <= tolerance < 1):
        raise ArgumentError(f"tolerance={tolerance!r} must lie between 1e-13 and 1.")
    began = time.perf_counter()
    t0, t1 = (float(end) for end in t_span)
    start = start_of(problem, x0, v0)
    if not (math.isfinite(t0) and math.isfinite(t1) and t0 != t1):
        raise ArgumentError(f"t_span={t_span!r} must be two finite times, (start, end).")
    system = described(problem, t0, start.x, start.v, args)
    tried = _chosen(methods, system)
    pilot = fly(Rates(system, start.x, start.v), t0, t1 - t0)
    run = partial(solve, problem, x0=x0, v0=v0, args=args, compile=compile, progress=False)
    found, left_out = [], {}
    for method in tried:
        if time.perf_counter() - began > seconds:
            left_out[method.name] = f"not tried within seconds={seconds!r}"
            continue
        try:
            best = min((trial.evaluations for trial in found), default=math.inf)
            most = _TIMES * best / abs(pilot.span)
            found.append(_tried(run, method, pilot, float(tolerance), system.kind, most))
        except KickdriftError as error:
            left_out[method.name] = str(error)
    if not found:
        reasons = "; ".join(f"{name}: {why}" for name, why in left_out.items())
        raise KickdriftError(f"no method meets tolerance={tolerance!r} on {system.name!r}: {reasons}")
    found.sort(key=lambda trial: (trial.evaluations, trial.error))
    lengths = t1 - t0, pilot.length
    return Advice(found[0].method, found[0].step, float(tolerance), system.name, *lengths, tuple(found), left_out)


def _chosen(given: Any, system: System) -> list[methods.Method]:
    names = candidates.of(system.kind) if given is None else given
    if not names:
        raise ArgumentError(
            f"{system.name!r} has no methods to choose from by its error: noise drives it, or methods={given!r}."
        )
    return sorted((methods.get(name) for name in names), key=lambda method: -method.order)  # the quick ones first


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


def _tried(run: Any, method: methods.Method, pilot: Pilot, tolerance: float, kind: Kind, most: float) -> Trial:
    """Return what a method needs, of at most so many evaluations per unit of time.

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
            raise KickdriftError(f"it needs more than {_MOST_STEPS} steps in the pilot")
        span = pilot.t0, pilot.t0 + pilot.length
        sol = run(t_span=span, step=length / n_steps, method=method, save_every=n_steps // rows)
        if sol.n_force_evaluations > max(most * length, _FEW):
            raise KickdriftError(f"it needs more than {_TIMES} times the force evaluations of the best")
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
            raise KickdriftError(f"an error of {last.expected:.2g} is left with a step of {last.step:.3g}")
    else:
        last = confirmed
    return _trial(method, step, last, pilot, wanted, len(runs) + 1)


def _trial(method: methods.Method, step: float, last: _Run, pilot: Pilot, wanted: float, runs: int) -> Trial:
    scale = abs(pilot.span) * last.step / step
    expected = last.expected if last.error > pilot.exact_to else wanted
    cost = last.evaluations * scale, last.seconds * scale
    return Trial(method.name, step, *cost, expected, last.energy_error, last.growth, runs)


def _at_the_floor(runs: Sequence[_Run], pilot: Pilot) -> bool:
    """Whether smaller steps show nothing: rounding, or the error of the reference, is left."""
    return runs[-1].error < pilot.exact_to


def _step_for(runs: Sequence[_Run], wanted: float, pilot: Pilot, method: methods.Method) -> float:
    """Return the step with a wanted error, between two runs or, where the pilot is too short to show it, by the order."""
    good = [own for own in runs if math.isfinite(own.expected)]
    if not good:
        raise KickdriftError("its runs do not reach the end of the pilot")
    fine = next((own for own in runs if own.expected <= wanted), None)
    if fine is None:
        told = [own for own in good if own.error > pilot.exact_to]
        if not _at_the_floor(runs, pilot) or not told:
            raise KickdriftError(f"an error of {runs[-1].expected:.2g} is left with a step of {runs[-1].step:.3g}")
        return float(told[-1].step * (wanted / told[-1].expected) ** (1 / method.order))
    coarser = [own for own in good if own.step > fine.step]
    if not coarser or fine.error < pilot.exact_to:
        return float(fine.step)
    before = coarser[-1]
    share = math.log(before.expected / wanted) / math.log(before.expected / fine.expected)
    return float(before.step ** (1 - share) * fine.step**share)
