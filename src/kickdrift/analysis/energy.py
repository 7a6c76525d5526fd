"""Energy along a solution: its error, its drift, and the modified energy of the semi-implicit Euler method."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods
from kickdrift.analysis.drift import slope, times_of_drift
from kickdrift.analysis.solutions import checked
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.solution import Solution

Floats = NDArray[np.float64]


def energy_error(solution: Solution) -> Floats:
    """Return the energy error at the times kept: (E - E0) / |E0|, or E - E0 where E0 is zero.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    (T,) array
        Signed: positive where energy was gained.

    Raises
    ------
    KickdriftError
        If the system has no energy.

    Examples
    --------
    >>> import kickdrift as kd
    >>> sol = kd.solve(kd.systems.kepler(), (0.0, 20.0), step=0.01, method="leapfrog")
    >>> kd.analysis.energy_error(sol).shape
    (2001,)
    """
    return _relative(checked(solution).energy)


def largest_energy_error(solution: Solution) -> float:
    """Return the largest magnitude of `energy_error` at the times kept.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    float

    Raises
    ------
    KickdriftError
        If the system has no energy.

    Examples
    --------
    >>> import kickdrift as kd
    >>> sol = kd.solve(kd.systems.kepler(), (0.0, 20.0), step=0.01, method="leapfrog")
    >>> kd.analysis.largest_energy_error(sol) < 1e-3
    True
    """
    return float(np.abs(energy_error(solution)).max())


def energy_drift(solution: Solution) -> float:
    """Return the slope of the least-squares line through `energy_error`, per unit of time.

    For the bounded oscillation of a symplectic method the slope decreases with the length of the run; for a steady gain or
    loss it does not.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    float

    Raises
    ------
    ArgumentError
        If the solution has fewer than two times.
    KickdriftError
        If the system has no energy.

    Examples
    --------
    >>> import kickdrift as kd
    >>> spring = kd.systems.harmonic_oscillator()
    >>> sol = kd.solve(spring, (0.0, 100.0), step=0.01, method="explicit-euler")
    >>> kd.analysis.energy_drift(sol) > 0.005
    True
    """
    return slope(times_of_drift(solution), energy_error(solution))


def drift(t: Floats, energy: Floats) -> float:
    """Return the slope of the least-squares line through the relative energy error over time."""
    return slope(t, _relative(energy))


def largest_error(values: Floats, scale: float | None = None) -> tuple[float, float | None]:
    """Return the largest deviation of a quantity, (T,) or (T, size), from its start, and its ratio to a scale not 0.

    The scale is the size of the start by default.
    """
    deviation = values - values[0]
    sizes = np.abs(deviation) if values.ndim == 1 else np.linalg.norm(deviation, axis=1)
    largest = float(sizes.max())
    scale = float(np.linalg.norm(values[0])) if scale is None else scale
    return largest, largest / scale if scale > 0 else None


def _relative(energy: Floats) -> Floats:
    error: Floats = (energy - energy[0]) / (abs(float(energy[0])) or 1.0)
    return error


_CROSS_TERM = {methods.get("kick-drift").word: -1, methods.get("drift-kick").word: +1}


def modified_energy(
    method: str | methods.Method, step: float, omega: float, x: ArrayLike, v: ArrayLike
) -> Floats | np.float64:
    """Return the invariant of a semi-implicit Euler method on the oscillator x'' = -omega^2 x, conserved to rounding error.

    It is ``(v^2 + omega^2 x^2 -+ step omega^2 x v) / 2``, with the minus for the velocity first (``kick-drift``) and the
    plus for the position first (``drift-kick``). For ``step * omega < 2`` its level sets are ellipses, so the motion is
    bounded.

    Parameters
    ----------
    method : str or Method
        ``"kick-drift"``, ``"drift-kick"`` or one of their aliases.
    step : float
        The step, with its sign.
    omega : float
        Angular frequency, radians per unit of time.
    x, v : array_like
        Positions and velocities, of one shape.

    Returns
    -------
    array of that shape

    Raises
    ------
    ArgumentError
        For another method.

    Notes
    -----
    With the velocity first, insert v' = v - step omega^2 x and x' = x + step v': the energy changes in a step by the same
    amount as step omega^2 x v / 2. Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), section IX.1,
    has the general case, a series in the step.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> spring = kd.systems.harmonic_oscillator()
    >>> sol = kd.solve(spring, (0.0, 100.0), step=0.1, method="semi-implicit-euler")
    >>> kept = kd.analysis.modified_energy(
    ...     "semi-implicit-euler", sol.step, 1.0, sol.x, sol.v
    ... )
    >>> bool(np.ptp(sol.energy) > 0.01), bool(np.ptp(kept) < 1e-13)
    (True, True)
    """
    chosen = methods.get(method)
    if chosen.word not in _CROSS_TERM:
        raise ArgumentError(f"method={chosen.name!r} has no modified energy here; use 'kick-drift' or 'drift-kick'.")
    x, v = np.asarray(x, dtype=np.float64), np.asarray(v, dtype=np.float64)
    stiffness = omega * omega
    modified: Floats = 0.5 * (v * v + stiffness * x * x + _CROSS_TERM[chosen.word] * step * stiffness * x * v)
    return modified
