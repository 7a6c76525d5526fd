"""Work-precision diagrams: the errors of methods against their cost."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods as catalogue
from kickdrift.analysis.reference import end_of_reference
from kickdrift.analysis.tables import Column, frame, markdown
from kickdrift.analysis.work_curve import Curve
from kickdrift.core.arguments import is_whole, reals
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.solution import Solution
from kickdrift.engine.solve import solve
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class WorkPrecision:
    """Errors of methods against force evaluations and seconds; its repr is a table.

    Attributes
    ----------
    system : str
        Name.
    t_span : (float, float)
    curves : tuple of Curve
        The runs of each method: `label`, `steps`, `errors`, `evaluations`, `seconds` of each round, and their `median`.
    """

    system: str
    t_span: tuple[float, float]
    curves: tuple[Curve, ...]

    presenter: ClassVar[Callable[..., Any]]

    @property
    def columns(self) -> dict[str, Column]:
        """The columns of the table by name, with one row per run."""
        return {
            "method": [curve.label for curve in self.curves for _ in curve.errors],
            "step": np.concatenate([curve.steps for curve in self.curves if curve.steps is not None]),
            "error": np.concatenate([curve.errors for curve in self.curves]),
            "force evaluations": np.concatenate([curve.evaluations for curve in self.curves]).astype(np.int64),
            "seconds": np.concatenate([curve.median for curve in self.curves]),
        }

    def to_pandas(self) -> Any:
        """Return the table for pandas.

        Returns
        -------
        pandas.DataFrame
            With one row per run.

        Raises
        ------
        MissingExtraError
            If pandas is not installed.
        """
        return frame(self.columns, "WorkPrecision.to_pandas")

    def plot(self, path: Any = None, *, ax: Any = None) -> Any:
        """Plot errors against force evaluations and time.

        Parameters
        ----------
        path, ax
            As for `kickdrift.plots.plot_work_precision`.

        Returns
        -------
        matplotlib.figure.Figure
        """
        return type(self).presenter(self, path, ax=ax)

    def __repr__(self) -> str:
        return markdown(self.columns)

    _repr_markdown_ = __repr__


def work_precision(
    problem: System | Problem | Callable[..., Any],
    t_span: Sequence[float],
    methods: Sequence[str | catalogue.Method],
    steps: Sequence[float] | Mapping[str, Sequence[float]],
    x0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    reference: tuple[ArrayLike, ArrayLike] | None = None,
    rounds: int = 3,
    args: Sequence[float] | None = None,
    compile: bool = True,  # noqa: A002 - as in `solve`
) -> WorkPrecision:
    """Run methods at several steps, and measure errors at the end against force evaluations and time.

    Parameters
    ----------
    problem, t_span, x0, v0, args, compile
        As for `kickdrift.solve`.
    methods : sequence of str or Method
    steps : sequence of float, or mapping of str to such
        Largest steps allowed; or the steps of each method, by its name as given.
    reference : (x, v), optional
        State at the end. By default the exact one, where a system has an exact solution from its own initial state at 0, or
        else that of DOP853 at a relative tolerance of 1e-13: errors should lie above 1e-11.
    rounds : int
        How often each run is timed; the methods take turns. A first, uncounted round compiles and fills caches.

    Returns
    -------
    WorkPrecision

    Raises
    ------
    ArgumentError
        Without methods or steps, and for what `kickdrift.solve` refuses.

    Examples
    --------
    >>> import kickdrift as kd
    >>> orbit = kd.systems.kepler()
    >>> table = kd.analysis.work_precision(
    ...     orbit, (0.0, 20.0), ["leapfrog", "kahan-li-8"], [0.05, 0.02], rounds=1
    ... )
    >>> [curve.label for curve in table.curves], table.curves[0].evaluations
    (['velocity-verlet', 'kahan-li-8'], array([ 401., 1001.]))
    """
    if isinstance(methods, str) or not np.iterable(methods) or not methods:
        raise ArgumentError(f"methods={methods!r} must be a list of at least one method.")
    if not is_whole(rounds, 1):
        raise ArgumentError(f"rounds={rounds!r} must be a whole number of at least 1.")
    wanted = {catalogue.get(method).name: _steps_of(method, steps) for method in methods}
    chosen = {catalogue.get(method).name: method for method in methods}

    def run(name: str, step: float) -> Solution:
        own = partial(solve, problem, t_span, x0, v0, save_every=2**60, progress=False)
        return own(step=step, method=chosen[name], args=args, compile=compile)

    runs = {name: [run(name, step) for step in of] for name, of in wanted.items()}
    seconds = {name: np.empty((rounds, len(of))) for name, of in wanted.items()}
    for round_ in range(rounds):  # back and forth: a machine that slows down favours none
        for name in wanted if round_ % 2 == 0 else reversed(wanted):
            seconds[name][round_] = [run(name, step).wall_time for step in wanted[name]]
    every = [own for of in runs.values() for own in of]
    complete = next((own for own in every if own.success), every[0])  # those that stopped early end at another time
    end = reference if reference is not None else end_of_reference(problem, complete, x0 is None and v0 is None, args)
    curves = tuple(
        Curve(
            label=name,
            errors=np.array([error_at_end(own, *end) for own in of]),
            evaluations=np.array([float(own.n_force_evaluations) for own in of]),
            seconds=seconds[name],
            steps=np.array([abs(own.step) for own in of]),
        )
        for name, of in runs.items()
    )
    return WorkPrecision(complete.about.system, (float(t_span[0]), float(t_span[1])), curves)


def error_at_end(run: Solution, x: ArrayLike, v: ArrayLike) -> float:
    """Return the largest error of the numbers of x and v where a run ends; infinite where it did not reach its end."""
    if not run.success:
        return np.inf
    return float(max(np.abs(run.x[-1] - x).max(), np.abs(run.v[-1] - v).max(initial=0.0)))


def _steps_of(method: str | catalogue.Method, steps: Any) -> list[float]:
    given = steps
    if isinstance(steps, Mapping):
        given = next((steps[name] for name in (method, catalogue.get(method).name) if name in steps), ())
    try:
        own = sorted((float(step) for step in np.atleast_1d(reals(given))), reverse=True)
    except TypeError:
        own = []
    if not own:
        raise ArgumentError(f"steps={steps!r} has no step for {catalogue.get(method).name!r}; give at least one.")
    return own
