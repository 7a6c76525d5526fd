"""Dense output: states between the rows that a run kept, by the method itself.

From the last row before a time, whole steps of the run lead to the last grid point before it, and one shorter step of the same
method to the time itself. Its error is that of a step, so that states between rows have the order of the method, whatever that
is, and satisfy the constraints. A whole step leads to the next row.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import reals
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.core.kinds import Kind
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.processing import Processing
from kickdrift.engine.stepper import NO_NUMBERS, rows_of
from kickdrift.systems.system import System

Floats = NDArray[np.float64]

# Fraction of a step, and multiple of the spacing of floats at the farthest time, within which a time is on the grid.
_ROUNDING, _SPACINGS = 1e-9, 4.0


class States(NamedTuple):
    """Positions and velocities at the times asked for: (T, *shape) for T times, or one state of the shape of x0.

    For Hamiltonians they are q and p; for first-order equations x is y, and v is empty.
    """

    x: Floats
    v: Floats


@dataclass(frozen=True, eq=False, repr=False)
class DenseOutput:
    """States at any time between the start and the end of a run.

    Attributes
    ----------
    t : (T,) array
        Times of the rows, in the order of the run.
    x, v : (T, *shape) array
        The rows.
    end : float
        End of the run, at the last row or later.
    steps : (T,) array
        Signed size of the steps from each row on.
    varies : bool
        Whether the sizes of steps vary: then only the step after each row is known.
    compile : callable
        Returns the method, compiled for the system, with its own state.
    """

    t: Floats
    x: Floats
    v: Floats
    end: float
    steps: Floats
    varies: bool
    compile: Callable[[], Processing]

    @classmethod
    def of_rows(
        cls,
        grid: Grid | Course,
        start: States,
        rows: tuple[Floats, Floats, Floats, Floats],
        end: float,
        compile: Callable[[], Processing],  # noqa: A002 - the name of the field
    ) -> DenseOutput:
        """Create the dense output of rows (times, x, v and steps), preceded by the start if it is not a row."""
        t, xs, vs, steps = rows
        if not t.size or t[0] != grid.t0:
            t, steps = np.append(grid.t0, t), np.append(grid.step, steps)
            xs, vs = np.concatenate((start.x[None], xs)), np.concatenate((start.v[None], vs))
        return cls(t, xs, vs, end, steps, isinstance(grid, Course), compile)

    def followed_by(self, t: float, x: Floats, v: Floats) -> DenseOutput:
        """Add a row."""
        return replace(
            self,
            t=np.append(self.t, t),
            x=np.concatenate((self.x, x[None])),
            v=np.concatenate((self.v, v[None])),
            steps=np.append(self.steps, self.steps[-1:]),
        )

    def __copy__(self) -> DenseOutput:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> DenseOutput:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _forgotten, ()  # the system may hold functions that cannot be pickled

    def __call__(self, t: ArrayLike) -> States:
        """Return the states at times between the start and the end.

        Raises
        ------
        ArgumentError
            For times outside the run, and anything but a list of times.
        KickdriftError
            If the method finds no state at one of them.
        """
        times = _times(t, self.t[0], self.end)
        xs, vs, _ = self.states_at(times.reshape(-1))
        lost = ~np.isfinite(xs).all(axis=tuple(range(1, xs.ndim)))
        if lost.any():
            raise KickdriftError(
                f"there is no state at t={float(times.reshape(-1)[lost][0])!r}: the step to it has no solution, or is"
                " not finite; use a smaller step."
            )
        return States(xs.reshape(times.shape + xs.shape[1:]), vs.reshape(times.shape + vs.shape[1:]))

    def states_at(self, wanted: Floats) -> tuple[Floats, Floats, int]:
        """Return the states at times between the rows, NaN where there are none, and the force evaluations that they took."""
        ((xs, vs, evaluations),) = states_of([self], [wanted])
        return xs, vs, evaluations

    def _places(self, wanted: Floats) -> tuple[NDArray[np.intp], NDArray[np.int64], Floats]:
        """Return the last row before each time, the number of whole steps from there, and the remaining time."""
        sign = np.sign(self.steps[0])
        farthest = max(abs(self.t[0]), abs(self.end))
        near = _ROUNDING * np.abs(self.steps) + _SPACINGS * np.spacing(farthest)
        row = np.searchsorted(sign * self.t - near, sign * wanted, side="right") - 1
        ahead, rounding = (wanted - self.t[row]) / self.steps[row], near[row] / np.abs(self.steps[row])
        counts = np.floor(ahead + rounding).astype(np.int64)
        left = ahead - counts
        rest = np.where(left > rounding, left * self.steps[row], 0.0)
        far = (counts > 1) | ((counts == 1) & (rest != 0.0))
        if self.varies and far.any():
            raise ArgumentError(
                f"t={float(wanted[far][0])!r} lies several steps after a row, and the steps vary; keep every step, or"
                " request the times with t_eval."
            )
        return row, counts, rest


def states_of(
    outputs: Sequence[DenseOutput], wanted: Sequence[Floats], params: Floats = NO_NUMBERS
) -> list[tuple[Floats, Floats, int]]:
    """Return of each of some outputs of one method what `DenseOutput.states_at` returns, at its times, all at once.

    Each may have params of its own, (O, p), followed by those of the control of parts of steps.
    """
    places = [output._places(times) for output, times in zip(outputs, wanted, strict=True)]
    row = [own for own, _, _ in places]
    counts, rest = (np.concatenate([own[k] for own in places]) for k in (1, 2))
    xs, vs, here, whole = (
        np.concatenate([getattr(output, name)[own] for output, own in zip(outputs, row, strict=True)])
        for name in ("x", "v", "t", "steps")
    )
    evaluations = np.zeros(counts.size, dtype=np.int64)
    if counts.any() or rest.any():
        processing = outputs[0].compile()
        numbers = np.repeat(params, [times.size for times in wanted], axis=0) if len(params) else params
        for sizes, repeats in ((whole, counts), (rest, (rest != 0.0).astype(np.int64))):
            moved = np.flatnonzero(repeats)
            if moved.size:
                xs[moved], vs[moved], own = processing.go_on(
                    here[moved], sizes[moved], repeats[moved], xs[moved], vs[moved], rows_of(numbers, moved)
                )
                evaluations[moved] += own
            here = here + sizes * repeats
    ends = np.cumsum([times.size for times in wanted])[:-1]
    parts = zip(np.split(xs, ends), np.split(vs, ends), np.split(evaluations, ends), strict=True)
    return [(x, v, int(count.sum())) for x, v, count in parts]


def check_between(system: System, grid: Grid) -> None:
    """Refuse times off the grid of steps for stochastic systems, whose path is known only at the ends of steps.

    Raises
    ------
    ArgumentError
    """
    if grid.wanted is None or system.kind is not Kind.LANGEVIN:
        return
    off = grid.wanted[~np.isin(grid.wanted, grid.times)]
    first = float(off[0]) if off.size else float(grid.wanted[0])
    nearest = grid.t0 + round((first - grid.t0) / grid.step) * grid.step
    raise ArgumentError(
        f"t_eval={first!r}: a stochastic path is known only after whole steps of {abs(grid.step)!r}, in ascending"
        f" order; the nearest is {nearest!r}. Choose a step that divides all times, and sort them."
    )


def _forgotten() -> None:
    """Return None, which stands for the dense output of a solution that was unpickled."""


def _times(t: Any, first: float, last: float) -> Floats:
    try:
        times = np.asarray(reals(t))
    except TypeError:
        raise ArgumentError(f"t={t!r} must be a time, or an array of times.") from None
    low, high = min(first, last), max(first, last)
    outside = ~((times >= low) & (times <= high))
    if outside.any():
        raise ArgumentError(
            f"t={float(times[outside][0])!r} lies outside the times of the solution, {float(first)!r} to"
            f" {float(last)!r}; extend it with continue_to first."
        )
    return times
