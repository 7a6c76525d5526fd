"""Lyapunov exponents: the rates at which neighbouring trajectories diverge."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods
from kickdrift.analysis.spans import ends_of, step_of
from kickdrift.analysis.tangent import Steps, scales_of
from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System

Floats = NDArray[np.float64]

_APART = 1e-6  # of the state: rounding leaves 1e-10 of a direction, and bending 1e-12
_TURNING = 0.1  # of the time, in which directions turn to where they grow the most, and which is not counted
_STEPS = 20  # between two renormalisations, at most
_GROWTH = 100.0  # of a displacement between them, or its decay: beyond it displacements bend, or are lost to rounding


@dataclass(frozen=True, eq=False)
class LyapunovExponents:
    """Lyapunov exponents, and their convergence.

    Attributes
    ----------
    values : (K,) array
        The K largest, in descending order, per unit of time: means over the time from a tenth of the span to its end.
    t : (T,) array
        Times of the renormalisations.
    running : (T, K) array
        Means from the start to those times.
    """

    values: Floats
    t: Floats
    running: Floats

    def __repr__(self) -> str:
        values = ", ".join(f"{value:.4g}" for value in self.values)
        return f"<LyapunovExponents {values} per unit of time, from {self.t.size} renormalisations to t={self.t[-1]:g}>"


def lyapunov_exponent(
    problem: System | Problem | Callable[..., Any],
    t_span: Sequence[float],
    x0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    step: float,
    method: str | methods.Method = "blanes-moan-srkn6b",
    count: int = 1,
    args: Sequence[float] | None = None,
    compile: bool = True,  # noqa: A002 - as in `solve`
) -> LyapunovExponents:
    """Measure the rates at which neighbouring trajectories diverge.

    Small displacements to both sides of the trajectory are integrated with it, and renormalised and orthogonalised every
    twenty steps, or more often where they grow fast. A positive exponent indicates chaos; in regular motion all of them decay
    to zero like log(t) / t.

    Parameters
    ----------
    problem, t_span, x0, v0, step, args, compile
        As for `kickdrift.solve`.
    method : str or Method
        A method for the kind of the problem.
    count : int
        Number of exponents, up to the dimension of the state; each costs two more runs.

    Returns
    -------
    LyapunovExponents

    Raises
    ------
    ArgumentError
        For an invalid count, for bodies that merge, and for whatever `kickdrift.solve` refuses.
    KickdriftError
        If the run does not reach its end.

    Notes
    -----
    Benettin, Galgani, Giorgilli, Strelcyn, Meccanica 15, 9 (1980).

    Examples
    --------
    >>> import kickdrift as kd
    >>> found = kd.analysis.lyapunov_exponent(
    ...     lambda x: x, (0.0, 50.0), 0.0, 0.0, step=0.01, compile=False, method="leapfrog"
    ... )
    >>> round(found.values[0], 4)
    np.float64(1.0)
    """
    begin, end = ends_of(t_span)
    if not 0 < step_of(step) <= abs(end - begin):
        raise ArgumentError(f"step={step!r} must be positive, and at most the length of t_span={t_span!r}.")
    if isinstance(problem, System) and problem.radii is not None:
        raise ArgumentError(
            f"the bodies of {problem.name!r} have radii, and merge on contact, where the motion has no derivative."
            " Leave the radii out."
        )
    n_steps = max(2, math.ceil(abs(end - begin) / step * (1 - 1e-12)))
    h = (end - begin) / n_steps
    steps = Steps(problem, method, h, x0, v0, t=begin, args=args, compile_=compile)
    if not is_whole(count, 1, steps.start.size):
        raise ArgumentError(
            f"count={count!r} must be a whole number from 1 to {steps.start.size}, the dimension of the state."
        )
    lengths = _APART * scales_of(steps.x0, steps.v0, math.copysign(max(abs(h), abs(end - begin) / 1000), h))
    times, logarithms = zip(*_renormalised(steps, begin, h, n_steps, lengths, count), strict=True)
    t, sums = np.array(times), np.cumsum(logarithms, axis=0)
    first = min(int(np.searchsorted(np.abs(t - begin), _TURNING * abs(end - begin))), t.size - 2)
    before, since = (sums[first], t[first]) if first >= 0 else (0.0, begin)
    values = (sums[-1] - before) / abs(end - since)
    return LyapunovExponents(values, t, sums / np.abs(t - begin)[:, None])


def _renormalised(
    steps: Steps, begin: float, h: float, n_steps: int, lengths: Floats, count: int
) -> Iterator[tuple[float, Floats]]:
    """Run the steps, and yield the time of each renormalisation and the logarithms of the growth since the one before."""
    directions = np.linalg.qr(np.random.default_rng(0).normal(size=(steps.start.size, count)))[0]
    state, done, stretch = steps.start, 0, _STEPS
    while done < n_steps:
        t, now = begin + done * h, min(stretch, n_steps - done)
        moved = lengths * directions.T
        try:
            rows = steps.advance(t, np.concatenate((state[None], state + moved, state - moved)), now)
        except KickdriftError:
            if now == 1:
                raise
            # Fails, too, if it was the state that overflowed, and not a displacement.
            steps.advance(t, state[None], now)
            stretch = now // 2
            continue
        grown = (rows[1 : 1 + count] - rows[1 + count :]) / (2 * lengths)
        if not np.isfinite(grown).all():
            raise KickdriftError(f"the state is not finite at t={begin + (done + now) * h!r}; use a smaller step.")
        turned, triangle = np.linalg.qr(grown.T)
        logarithm = np.log(np.abs(np.diag(triangle)))
        if now > 1 and np.abs(logarithm).max() > np.log(_GROWTH):
            stretch = now // 2
            continue
        state, done, directions = rows[0], done + now, turned
        yield begin + done * h, logarithm
