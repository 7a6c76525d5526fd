"""Poincare sections: the crossings of a surface by a trajectory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import FunctionType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods
from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.engine.solution import Solution
from kickdrift.engine.solve import solve
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class PoincareSection:
    """Crossings of a surface.

    Attributes
    ----------
    system : str
        Name.
    t : (K,) array
        Times.
    x, v : (K, *shape) array
        The states there.
    """

    system: str
    t: Floats
    x: Floats
    v: Floats

    presenter: ClassVar[Callable[..., Any]]

    def __repr__(self) -> str:
        times = f" from t={self.t[0]:g} to {self.t[-1]:g}" if self.t.size else ""
        return f"<PoincareSection of {self.system}: {self.t.size} crossings{times}>"

    def plot(self, path: Any = None, *, axes: tuple[str, str] | None = None, ax: Any = None) -> Any:
        """Plot the crossings.

        Parameters
        ----------
        path, axes, ax
            As for `kickdrift.plots.plot_poincare_sections`.

        Returns
        -------
        matplotlib.figure.Figure
        """
        return type(self).presenter(self, path, axes=axes, ax=ax)


def poincare_section(
    problem: Solution | System | Problem | Callable[..., Any],
    surface: Callable[..., Any] | int = 0,
    t_span: Sequence[float] | None = None,
    x0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    step: float | None = None,
    method: str | methods.Method | None = None,
    direction: int = 1,
    args: Sequence[float] | None = None,
    compile: bool = True,  # noqa: A002 - as in `solve`
) -> PoincareSection:
    """Return the crossings of a surface, as accurate as the method.

    Parameters
    ----------
    problem : Solution, System, Problem or callable
        A solution with ``events=``; or a problem, with `t_span` and so on as for `kickdrift.solve`.
    surface : callable or int
        A function of the state, like an event, that is zero on the surface; for a solution the index of its event.
    t_span, x0, v0, step, method, args, compile
        As for `kickdrift.solve`.
    direction : int
        1 for crossings where the function increases, -1 for those where it decreases, 0 for all.

    Returns
    -------
    PoincareSection

    Raises
    ------
    ArgumentError
        For a solution without that event, an invalid direction, and whatever `kickdrift.solve` refuses.
    KickdriftError
        If the run does not reach its end.

    Examples
    --------
    >>> import kickdrift as kd
    >>> sol = kd.solve(
    ...     lambda x: -x, (0.0, 20.0), 1.0, 0.0, step=0.01, compile=False, events=lambda x: x
    ... )
    >>> len(kd.analysis.poincare_section(sol).t)
    6
    """
    if isinstance(problem, Solution):
        number = surface
        if not is_whole(number, 0, len(problem.t_events) - 1):
            raise ArgumentError(
                f"surface={surface!r} is not an event of the solution, which has {len(problem.t_events)}; solve with"
                " events=..., and give the index of one, from 0."
            )
        return _section(problem, number)
    if isinstance(surface, int) or t_span is None or step is None:
        raise ArgumentError(
            "to solve a problem, surface, t_span and step are needed: give a function, a span and a step."
        )
    if direction not in (-1, 0, 1):
        raise ArgumentError(f"direction={direction!r} must be 1, -1 or 0.")
    options: dict[str, Any] = {"args": args, "compile": compile, "save_every": 2**60}
    found = solve(problem, t_span, x0, v0, step=step, method=method, events=_directed(surface, direction), **options)
    if not found.success:
        raise KickdriftError(f"the run does not reach the end of t_span: {found.message}")
    return _section(found, 0)


def _section(solution: Solution, event: int) -> PoincareSection:
    kept = solution.t_events[event], solution.x_events[event], solution.v_events[event]
    return PoincareSection(solution.about.system, *kept)


def _directed(surface: Any, direction: int) -> Any:
    """Return a copy of a function, with the direction as an attribute, as events have it."""
    python = getattr(surface, "py_func", surface)
    if not isinstance(python, FunctionType):
        raise ArgumentError(f"surface={surface!r} is not a function; give one of the state, such as lambda x: x[0].")
    copy = FunctionType(python.__code__, python.__globals__, python.__name__, python.__defaults__, python.__closure__)
    copy.__kwdefaults__, copy.__module__, copy.__qualname__ = (
        python.__kwdefaults__,
        python.__module__,
        python.__qualname__,
    )
    copy.__dict__.update(python.__dict__, direction=direction, terminal=False)
    return copy
