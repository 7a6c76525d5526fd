"""Linear stability: the matrix of one step on the oscillator, and the amplification factor for y' = lambda y."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import methods
from kickdrift.analysis.one_step import take_step
from kickdrift.core.arguments import number
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.systems.system import System

Floats = NDArray[np.float64]

# Above the rounding of trace and determinant, 1e-15, and below the 1.6e-11 that the midpoint rule has in hand at 1e6.
_TOLERANCE = 1e-12
_SMALLEST, _LARGEST = 1e-3, 1e6
# Up to 20 the spacing of 0.05 is a third of the distance between the extrema of the traces of the catalogue's words.
_PROBES = np.concatenate([np.arange(1, 400) * 0.05, np.geomspace(20.0, _LARGEST, 50)])


def one_step_matrix(method: str | methods.Method, h_omega: float, damping: float = 0.0) -> Floats:
    """Return the matrix of one step on the oscillator x'' = -omega^2 x - 2 damping omega x', by running the method.

    Parameters
    ----------
    method : str or Method
        Name of a method.
    h_omega : float
        Step times angular frequency, positive.
    damping : float
        Damping ratio: 0 for none, 1 for critical.

    Returns
    -------
    (2, 2) array
        The matrix that takes (x, v / omega) to its value a step later.

    Raises
    ------
    ArgumentError
        If `h_omega` is not positive and finite, or `damping` negative.
    MethodMismatchError
        For damping with a method that does not support velocity-dependent accelerations.

    Examples
    --------
    >>> import kickdrift as kd
    >>> kd.analysis.one_step_matrix("kick-drift", 0.5)
    array([[ 0.75,  0.5 ],
           [-0.5 ,  1.  ]])
    """
    h_omega, damping = number("h_omega", h_omega), number("damping", damping)
    if not (math.isfinite(h_omega) and h_omega > 0):
        raise ArgumentError(f"h_omega={h_omega!r} must be positive and finite; it is the step times omega.")
    if not (math.isfinite(damping) and damping >= 0):
        raise ArgumentError(f"damping={damping!r} must be finite and at least 0; it is the damping ratio.")
    # Two oscillators with omega = 1 that do not see each other: each start is a column.
    starts = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    return np.array(take_step(_oscillators(damping), method, h_omega, *starts))


def _oscillators(damping: float) -> System:
    def acceleration(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
        out[:] = -x if damping == 0 else -x - 2 * damping * v

    return System(
        "oscillator",
        acceleration,
        np.zeros(2),
        np.zeros(2),
        kind=Kind.VELOCITY_DEPENDENT if damping > 0 else Kind.NEWTONIAN,
        native=False,
    )


def stability_limit(method: str | methods.Method, damping: float = 0.0) -> float:
    """Return the largest stable step times omega on the oscillator x'' = -omega^2 x - 2 damping omega x'.

    It is where the spectral radius of `one_step_matrix` first exceeds 1 as the step grows: there may be stable intervals
    beyond.

    Parameters
    ----------
    method : str or Method
        Name of a method.
    damping : float
        Damping ratio: 0 for none, 1 for critical.

    Returns
    -------
    float
        To about 1e-12. 0.0 if a step of ``h omega = 1e-3`` is already unstable. ``inf`` if every step tried up to 1e6 is
        stable, and so are the largest traces between them: evidence, not proof.

    Raises
    ------
    MethodMismatchError
        For damping with a method that does not support velocity-dependent accelerations.

    Notes
    -----
    Both eigenvalues lie in the unit circle where |trace| <= 1 + det and det <= 1 (Jury, Theory and Application of the
    z-Transform Method, 1964). Unlike the spectral radius, trace and determinant are smooth functions of
    the step, so that a window of instability between two probes shows as a maximum of the trace there.

    Examples
    --------
    >>> import kickdrift as kd
    >>> round(kd.analysis.stability_limit("leapfrog"), 9)
    2.0
    """
    from scipy.optimize import brentq, minimize_scalar

    def excesses(h_omega: float) -> tuple[float, float]:
        matrix = one_step_matrix(method, h_omega, damping)
        trace, determinant = abs(float(np.trace(matrix))), float(np.linalg.det(matrix))
        return trace - 1 - determinant - _TOLERANCE, determinant - 1 - _TOLERANCE

    def limit_between(stable: float, unstable: float) -> float:
        return float(brentq(lambda h: max(excesses(h)), stable, unstable, xtol=1e-14))

    if max(excesses(_SMALLEST)) > 0:
        return 0.0
    steps, traces = [_SMALLEST], [excesses(_SMALLEST)[0]]
    for probe in _PROBES:
        here = excesses(probe)
        if max(here) > 0:
            return limit_between(steps[-1], probe)
        if len(traces) > 1 and traces[-2] < traces[-1] > here[0]:
            peak = minimize_scalar(lambda h: -excesses(h)[0], bounds=(steps[-2], probe), method="bounded").x
            if max(excesses(peak)) > 0:
                return limit_between(steps[-2], peak)
        steps.append(probe)
        traces.append(here[0])
    return math.inf


def amplification_factor(method: str | methods.Method, z: ArrayLike) -> NDArray[np.complex128] | np.complex128:
    """Return R(z), the factor by which one step of size h multiplies y in y' = lambda y, with z = h lambda.

    Parameters
    ----------
    method : str or Method
        A Runge-Kutta method, such as ``"explicit-euler"``, ``"implicit-midpoint"`` or ``"gauss-4"``.
    z : array_like
        Complex numbers.

    Returns
    -------
    complex array of the shape of z
        Infinite at a pole.

    Raises
    ------
    ArgumentError
        For a word of kicks and drifts, or a tableau with other weights for v: these treat position and velocity differently,
        and are not defined for a single y.

    Notes
    -----
    R(z) = det(I - z A + z 1 b') / det(I - z A): 1 + z, 1 / (1 - z) and (1 + z/2) / (1 - z/2) for the explicit and the
    implicit Euler method and the midpoint rule. Hairer, Wanner, Solving Ordinary Differential Equations II, 2nd ed.
    (1996), section IV.3.

    Examples
    --------
    >>> import kickdrift as kd
    >>> round(float(abs(kd.analysis.amplification_factor("implicit-midpoint", 10j))), 12)
    1.0
    """
    chosen = methods.get(method)
    if chosen.tableau is None or chosen.tableau().a_of_v is not None:
        raise ArgumentError(
            f"method={chosen.name!r} has no amplification factor: it is not a map of one complex number; use"
            f" one_step_matrix({chosen.name!r}, h_omega)."
        )
    a, b = (np.array(part, dtype=np.float64) for part in (chosen.tableau().a, chosen.tableau().b))
    values = np.asarray(z, dtype=np.complex128)[..., None, None]
    matrix = np.eye(b.size) - values * a
    with np.errstate(divide="ignore", invalid="ignore"):
        factor: NDArray[np.complex128] = np.linalg.det(matrix + values * b) / np.linalg.det(matrix)
    return factor
