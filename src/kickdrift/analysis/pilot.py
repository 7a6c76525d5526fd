"""Pilot runs by which methods are compared: their length, their reference, and extrapolation to the whole span."""

import math
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kickdrift.analysis.reference import HUGE, Rates
from kickdrift.core.errors import KickdriftError

Floats = NDArray[np.float64]

ROWS = 32
"""Times at which a pilot run is looked at."""

_SCOUTING = 3000  # evaluations of a first look, at a loose tolerance
_TIGHTER = 12  # times as many at 1e-13 as at 1e-6, by DOP853: 1e7^(1/8), and more where they are restarted
_MOST = 60_000  # evaluations of the reference
_SECONDS = 2.0  # of the reference, by which it is shorter where forces are dear
_EXACT_TO = 1e-12  # of the states: what the reference is off by, or rounding


@dataclass(frozen=True, eq=False)
class Pilot:
    """The beginning of a run, and its accurate result.

    Attributes
    ----------
    t0, length, span : float
        Start, length with its sign, and that of the whole span.
    step : float
        A step that resolves the motion.
    x, v : (ROWS, n) array
        The states at equal distances, the last of them at the end of the pilot.
    """

    t0: float
    length: float
    span: float
    step: float
    x: Floats
    v: Floats

    def errors(self, xs: Floats, vs: Floats) -> Floats:
        """Return the errors of some of the rows, evenly spread, in terms of the largest numbers of x and of v.

        Each is the largest up to there, and at least what the reference itself may be off by.
        """
        every = ROWS // xs.shape[0]
        worst = np.full(xs.shape[0], _EXACT_TO)
        for own, exact in ((xs, self.x), (vs, self.v)):
            if exact.shape[1]:
                off = np.abs(own.reshape(xs.shape[0], -1) - exact[every - 1 :: every]).max(axis=1)
                worst = np.fmax(worst, np.where(np.isfinite(off), off, np.inf) / (np.abs(exact).max() or 1.0))
        return np.maximum.accumulate(worst)

    def at_the_end(self, errors: Floats, conserving: bool, steady: bool) -> tuple[float, float]:
        """Return the error to expect at the end of the span, and the power of time with which it grows.

        Errors of phase grow in proportion to time at the least where something is conserved (`steady`), and with its square
        where the energy drifts, which methods that are not `conserving` may show late.
        """
        times = abs(self.span / self.length)
        if times <= 1 or not math.isfinite(errors[-1]):
            return float(errors[-1]), 1.0
        since = slice(errors.size // 4, None)
        passed = np.arange(1, errors.size + 1)[since] / errors.size
        power = float(np.polyfit(np.log(passed), np.log(errors[since]), 1)[0]) if passed.size > 2 else 1.0
        power = min(max(power, 1.0 if steady else 0.0), 1.2 if conserving else 2.0)
        expected = errors[-1] * times**power
        if steady and not conserving and passed.size > 2:
            from scipy.optimize import nnls

            (linear, square), _ = nnls(np.stack([passed, passed**2], axis=1), errors[since])
            expected = max(expected, linear * times + square * times**2)
        return float(expected), math.log(expected / errors[-1]) / math.log(times)

    @property
    def exact_to(self) -> float:
        """The least error that can be told."""
        return 100 * _EXACT_TO


def fly(rates: Rates, t0: float, span: float) -> Pilot:
    """Measure the time scale of a problem, and solve as much of its span as is cheap, to 1e-13.

    Raises
    ------
    KickdriftError
        If DOP853 does not get anywhere.
    """
    from scipy.integrate import DOP853

    if np.abs(rates(t0, rates.start)).max() >= HUGE:  # compiles, too
        raise KickdriftError("the forces at the initial state are not finite; check them there.")
    began = time.perf_counter()
    scout = DOP853(rates, t0, rates.start, t0 + span, rtol=1e-6, atol=1e-7 * rates.scales)
    sizes = []
    while scout.status == "running" and scout.nfev < _SCOUTING and time.perf_counter() - began < _SECONDS / _TIGHTER:
        scout.step()
        sizes.append(abs(scout.t - scout.t_old) if scout.t_old is not None else 0.0)
    if scout.status == "failed" or scout.t == t0:
        raise KickdriftError("DOP853 finds no step from the initial state; check the forces there.")
    cost = (time.perf_counter() - began) / scout.nfev
    affordable = min(_MOST, _SECONDS / cost) / _TIGHTER / scout.nfev  # in terms of what the scout has done
    length = math.copysign(min(abs(span), abs(scout.t - t0) * max(affordable, 0.25)), span)
    y, states, at, latest = rates.start, [], t0, time.perf_counter() + 4 * _SECONDS
    for row in range(1, ROWS + 1):
        end = t0 + length * row / ROWS
        leg = DOP853(rates, at, y, end, rtol=1e-13, atol=1e-14 * rates.scales)
        while leg.status == "running" and time.perf_counter() < latest:
            leg.step()
        if leg.status != "finished":
            raise KickdriftError(
                f"DOP853 cannot compute the motion to 1e-13 beyond t={float(leg.t)!r} within {4 * _SECONDS:g} s: the"
                " forces may not be smooth; shorten the span, or compare methods with kd.analysis.work_precision."
            )
        y, at = leg.y, end
        states.append(y)
    found, size = np.array(states), rates.size
    return Pilot(t0, length, span, float(np.median(sizes)), found[:, :size], found[:, size:])
