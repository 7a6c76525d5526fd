"""`advise`: the choice of method and step by measurement."""

from __future__ import annotations

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
from kickdrift.analysis.pilot import fly
from kickdrift.analysis.reference import Rates, described
from kickdrift.analysis.spans import ends_of
from kickdrift.analysis.tables import Column, frame, markdown
from kickdrift.analysis.trial import Trial, tried
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.engine.solve import solve
from kickdrift.engine.start import start_of
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Advice:
    """The recommendation and the measurements behind it; its repr is a table.

    Attributes
    ----------
    method : str
        The recommended method: the one with the fewest force evaluations of those that meet the tolerance.
    step : float
        Its step.
    tolerance : float
    system : str
        Name.
    span, pilot : float
        Lengths of the whole span, and of the runs.
    trials : tuple of Trial
        The methods that meet the tolerance, ordered by force evaluations; `growth` is the power of time with which errors are
        assumed to grow.
    left_out : mapping of str to str
        The other methods, and the reasons.
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
        """The columns of the table by name, with one row per method."""
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
        """Return the table for pandas.

        Returns
        -------
        pandas.DataFrame
            With one row per method.

        Raises
        ------
        MissingExtraError
            If pandas is not installed.
        """
        return frame(self.columns, "Advice.to_pandas")

    def __repr__(self) -> str:
        share = abs(self.pilot / self.span)
        known = "the whole span" if share >= 1 else f"{share:.3g} of the span, extrapolated"
        lines = [
            f"{self.system} over {self.span:g} to an error of {self.tolerance:g}: method={self.method!r}, step={self.step:.6g}",
            f"(measured on {known}; errors are relative to the size of the state, and growth is the power of time in them)",
            "",
            markdown(self.columns),
        ]
        if self.left_out:
            lines += ["", *(f"- {name}: {why}" for name, why in self.left_out.items())]
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

    The part of the span that DOP853 solves to 1e-13 within two seconds is the pilot run; each method repeats it with smaller
    and smaller steps, until the error at the end of the span, extrapolated from the growth of errors in the pilot run, meets
    the tolerance. In chaotic motion errors grow faster than that; chaos that sets in after the pilot run goes unnoticed.

    Parameters
    ----------
    problem, t_span, x0, v0, args, compile
        As for `kickdrift.solve`.
    tolerance : float
        The largest error of the state, of x relative to the largest component of x along the motion, of v relative to that
        of v.
    methods : sequence of str or Method, optional
        The methods to try. By default those that were the fastest on some problem of the kind.
    seconds : float
        Time limit after which no further method is tried.

    Returns
    -------
    Advice

    Raises
    ------
    ArgumentError
        For a tolerance that is not between 1e-13 and 1, for Langevin dynamics, for constraints, and for bodies that merge.
    KickdriftError
        If DOP853 cannot compute the motion, or no method meets the tolerance.

    Examples
    --------
    >>> import kickdrift as kd
    >>> advice = kd.advise(kd.systems.pendulum(), (0.0, 100.0), 1e-6)
    >>> sol = kd.solve(
    ...     kd.systems.pendulum(), (0.0, 100.0), method=advice.method, step=advice.step
    ... )
    >>> sol.success
    True
    """
    if not (isinstance(tolerance, float | int) and 1e-13 <= tolerance < 1):
        raise ArgumentError(f"tolerance={tolerance!r} must lie between 1e-13 and 1.")
    began = time.perf_counter()
    t0, t1 = ends_of(t_span)
    start = start_of(problem, x0, v0)
    system = described(problem, t0, start.x, start.v, args)
    if system.radii is not None:
        raise ArgumentError(
            f"the bodies of {system.name!r} have radii, and only method='close-encounters' merges bodies on contact,"
            " so there is nothing to choose from. Leave the radii out to compare methods."
        )
    wanted = _chosen(methods, system)
    with np.errstate(all="ignore"):  # steps that are tried, and too long
        pilot = fly(Rates(system, start.x, start.v), t0, t1 - t0)
    run = partial(solve, problem, x0=x0, v0=v0, args=args, compile=compile, progress=False)
    found: list[Trial] = []
    left_out: dict[str, str] = {}
    for method in wanted:
        if time.perf_counter() - began > seconds:
            left_out[method.name] = f"not tried within seconds={seconds!r}"
            continue
        try:
            best = min((trial.evaluations for trial in found), default=math.inf)
            least = best / abs(pilot.span)
            found.append(tried(run, method, pilot, float(tolerance), system.kind, least))
        except KickdriftError as error:
            left_out[method.name] = str(error)
    if not found:
        reasons = "; ".join(f"{name}: {why}" for name, why in left_out.items())
        raise KickdriftError(f"no method meets tolerance={tolerance!r} on {system.name!r}: {reasons}")
    found.sort(key=lambda trial: (trial.evaluations, trial.error))
    lengths = t1 - t0, pilot.length
    return Advice(found[0].method, found[0].step, float(tolerance), system.name, *lengths, tuple(found), left_out)


def _chosen(given: Any, system: System) -> list[methods.Method]:
    names = candidates.of(system.kind) if given is None else [given] if isinstance(given, str) else given
    if not names:
        raise ArgumentError(
            f"{system.name!r} has no methods to compare by their errors: it is stochastic, it has constraints (use"
            f" 'rattle'), or methods={given!r}."
        )
    return sorted((methods.get(name) for name in names), key=lambda method: -method.order)  # the quick ones first
