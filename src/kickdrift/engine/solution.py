"""The result of a run: the states, the conserved quantities, and how the run went."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.deferred import Deferred
from kickdrift.core.errors import KickdriftError
from kickdrift.core.kinds import Kind
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.dense import DenseOutput, States
from kickdrift.engine.description import Description
from kickdrift.engine.motion import Motion
from kickdrift.engine.presented import Presented

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Solution(Motion, Presented):
    """States of a system at the times kept, and how the run went.

    Attributes
    ----------
    t : (T,) array
        Times kept.
    x, v : (T, *shape) array
        Positions and velocities, in the shape of x0. For Hamiltonians they are q and p, and have these names, too;
        first-order equations have x alone, which is y.
    invariants : mapping of str to array
        Conserved quantities at those times, (T,) or (T, size).
    status : Outcome
        How the run ended.
    message : str
        The status as a sentence, with time and step if the end was not reached.
    step : float
        The step used, with its sign; at most the step requested. With variable steps, the first one.
    step_range : (float, float)
        The sizes of the smallest and of the largest step.
    n_rejected : int
        Steps that were tried and rejected.
    n_steps : int
        Number of steps.
    n_force_evaluations : int
        Evaluations of the acceleration.
    wall_time : float
        Seconds in the loop, compilation not counted.
    about : Description
        Names and labels of the run, such as ``about.method`` and ``about.units``.
    derived : mapping of str to array
        Other quantities derived from the states, by name, each evaluated on first access.
    error_estimate : array or None
        The largest estimated error of a step in each component of x, in the shape of x0; None where the method has no
        estimate. It is the error of a method of lower order, and so larger than the actual one.
    t_events, x_events, v_events : tuple of array
        For each event, the times of its zeros, (K,), and the states there, (K, *shape).
    dense : DenseOutput or None
        The interpolant behind ``solution(t)``; None for loaded solutions, and for Langevin dynamics.
    continuation : callable or None
        The function behind `continue_to` and `return_to`; None for loaded solutions.
    saved_to : str
        Folder with the rows, of which this solution has only the first and the last; empty if it has all.

    Examples
    --------
    >>> import kickdrift as kd
    >>> sol = kd.solve(kd.systems.kepler(), (0.0, 20.0), step=0.01, method="leapfrog")
    >>> sol.x.shape, sol.n_steps, sol.success
    ((2001, 2), 2000, True)
    >>> sol.invariants["angular momentum"].shape
    (2001,)
    >>> x, v = sol(1.2345)
    >>> x.shape
    (2,)
    """

    t: Floats
    x: Floats
    v: Floats
    invariants: Mapping[str, Floats]
    status: Outcome
    message: str
    step: float
    n_steps: int
    n_force_evaluations: int
    wall_time: float
    about: Description
    derived: Mapping[str, Floats] = field(default_factory=dict)
    error_estimate: Floats | None = None
    step_range: tuple[float, float] = (0.0, 0.0)
    n_rejected: int = 0
    t_events: tuple[Floats, ...] = ()
    x_events: tuple[Floats, ...] = ()
    v_events: tuple[Floats, ...] = ()
    dense: DenseOutput | None = field(default=None, repr=False)
    continuation: Callable[..., Solution] | None = field(default=None, repr=False)
    saved_to: str = ""

    def __getstate__(self) -> dict[str, Any]:
        """Return what copies and other processes get: values in place of the functions that compute them."""
        return vars(self) | {name: getattr(self, name) for name in _DEFERRED}

    @property
    def success(self) -> bool:
        """Whether the run reached the end of t_span, or a terminal event."""
        return self.status.success

    @property
    def multipliers(self) -> Floats:
        """Multipliers lambda of the constraints at the times kept, shape (T, m), from the states at those times.

        The force of the constraints g(x) = 0 is ``-G.T @ lambda`` with the Jacobian G = dg/dx: lambda is positive where
        they pull towards smaller g. Redundant constraints share a force with the smallest multipliers, each measured
        by the length of its gradient.

        Raises
        ------
        KickdriftError
            If the system has no constraints.
        """
        if "multipliers" not in self.derived:
            raise KickdriftError(
                f"{self.about.system!r} has no constraints, and so no multipliers; kd.Constrained(force, constraint)"
                " describes a problem with constraints."
            )
        return self.derived["multipliers"]

    @property
    def plain(self) -> Solution:
        """The solution in plain numbers: itself, unless its arguments were quantities with units."""
        return self

    def __call__(self, t: ArrayLike) -> States:
        """Return positions and velocities at any times of the run, by steps of the method from the rows kept.

        Parameters
        ----------
        t : float or array_like
            Times between the start of the run and its end, in any order.

        Returns
        -------
        x, v : array
            One state, or (T, *shape) of T times. Their error is that of the method, of its order.

        Raises
        ------
        ArgumentError
            For times outside the run and, where steps vary, for times more than a step after a row.
        KickdriftError
            If the solution does not know its equations: it was loaded from a file, or comes from another process; and for
            Langevin dynamics, of whose path a step knows its ends alone.
        """
        if self.saved_to:
            raise KickdriftError(
                f"the rows are in {self.saved_to!r}: open them with xarray.open_zarr, and interpolate there."
            )
        if self.dense is None:
            if self.about.kind == Kind.LANGEVIN.name:
                raise KickdriftError(
                    "the path is stochastic, and not known between steps; use smaller steps, and keep them."
                )
            raise KickdriftError(
                "this solution was read from a file or sent from another process, without its equations; solve again,"
                " or interpolate between sol.t."
            )
        return self.dense(t)

    def continue_to(self, t: float) -> Solution:
        """Continue to another end: with equal steps that divide the whole span, bit-identically to an uninterrupted run.

        It continues from the last state of the loop, at the same step, whether the run reached its end, was interrupted, or
        was ended by an event. `terminal` events count afresh from there. Where steps vary, or are cut by impacts or switches,
        the last ones depend on the end of the run, so a later end means repeating the run from its start, with the same first
        step. `max_steps` of `kickdrift.solve` bounds each call anew: beyond the steps of this solution, where steps vary; the
        number of equal steps to the new end is not bounded.

        Parameters
        ----------
        t : float
            The new end; of equal steps, a whole number of steps from the start.

        Returns
        -------
        Solution
            From the start to the new end, with the rows that one run would have kept; with `t_eval`, the new end is added to
            them. This solution is not changed, and may be continued again.

        Raises
        ------
        ArgumentError
            For an end that is not beyond the present one or, with equal steps, not a whole number of steps from the start;
            and for a solution that `return_to` has returned.
        KickdriftError
            If the solution was loaded from a file or comes from another process, without its equations.

        Examples
        --------
        >>> import kickdrift as kd
        >>> sol = kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.01)
        >>> longer = sol.continue_to(2.0)
        >>> longer.n_steps, longer.t[-1]
        (200, np.float64(2.0))
        """
        return self._continuation()(t)

    def return_to(self, t: float) -> Solution:
        """Go back to an earlier time, by the steps of this run in reverse.

        For reversible variable steps. They begin at the end of the last step, with the step density that the run has
        reached there, and lead back to the start up to rounding. A new run of `kickdrift.solve` from there would begin with
        another density, and take other steps. With equal steps it would take the same ones: use `kickdrift.solve` there.

        Parameters
        ----------
        t : float
            A time of the run.

        Returns
        -------
        Solution
            From the end of the last step, which may lie a fraction of a step beyond that of the run, back to the time, with
            one row in as many steps, or at the same times.

        Raises
        ------
        ArgumentError
            For a time outside the run, for equal steps, and for steps that do not lead back: by local error, or cut by
            impacts or switches.
        KickdriftError
            If the solution was loaded from a file or comes from another process, without its equations.

        Examples
        --------
        >>> import kickdrift as kd
        >>> comet = kd.systems.kepler(eccentricity=0.9)
        >>> sol = kd.solve(comet, (0.0, 20.0), step=1e-3, step_control="distance")
        >>> back = sol.return_to(0.0)
        >>> bool(abs(back.x[-1] - comet.x0).max() < 1e-12)
        True
        """
        return self._continuation()(t, back=True)

    def _continuation(self) -> Callable[..., Solution]:
        if self.saved_to:
            raise KickdriftError(
                f"the rows are in {self.saved_to!r}: solve to the later end with the same save_to and checkpoint."
            )
        if self.continuation is None:
            raise KickdriftError(
                "this solution was read from a file or sent from another process, without its equations; to continue a run in"
                " another process, solve with checkpoint='folder'."
            )
        return self.continuation

    def __repr__(self) -> str:
        return f"<Solution of {self.about.system} by {self.about.method}: {self._in_words()}>"

    def _in_words(self) -> str:
        return (
            f"{self.t.size} times from {self.t[0]:g} to {self.t[-1]:g}, {self.n_steps} steps of {sizes_of_steps(self)},"
            f" {self.status.name.lower()}"
        )


def sizes_of_steps(solution: Solution, digits: int = 6) -> str:
    """Return the size of the steps of a run, or the smallest and the largest."""
    smallest, largest = solution.step_range
    return f"{solution.step:.{digits}g}" if smallest == largest else f"{smallest:.4g} to {largest:.4g}"


_DEFERRED = ("message", "about", "dense")  # what most runs in a loop are never asked for
for _name in _DEFERRED:
    setattr(Solution, _name, Deferred(_name))
