"""The mathematical pendulum: x'' = -omega^2 sin x."""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.arguments import number
from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.systems.system import Quantity, System, start

Floats = NDArray[np.float64]


@compiled
def _acceleration(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[0] = -params[0] * math.sin(x[0])


@compiled
def _energy(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    # 1 - cos x = 2 sin^2(x/2) keeps its digits near the bottom.
    s = math.sin(0.5 * x[0])
    out[0] = 0.5 * v[0] * v[0] + 2.0 * params[0] * s * s


def pendulum(amplitude: float = 2.0, omega: float = 1.0) -> System:
    """Create a pendulum released at rest from an angle; the state is a scalar, in radians.

    Parameters
    ----------
    amplitude : float
        Angle at the start, between 0 and pi.
    omega : float
        sqrt(g / l), the angular frequency of small swings.

    Returns
    -------
    System

    Raises
    ------
    ArgumentError
        If the amplitude does not lie between 0 and pi, or `omega` is not positive.

    Examples
    --------
    >>> import kickdrift as kd
    >>> sol = kd.solve(
    ...     kd.systems.pendulum(amplitude=3.0), (0.0, 10.0), step=0.01, method="kahan-li-8"
    ... )
    >>> x, v = kd.systems.pendulum(amplitude=3.0).exact(sol.t)
    >>> bool(abs(sol.x - x).max() < 1e-11)
    True
    """
    amplitude, omega = number("amplitude", amplitude), number("omega", omega)
    if not 0 < amplitude < math.pi:
        raise ArgumentError(f"amplitude={amplitude!r} must lie strictly between 0 and pi.")
    if not (math.isfinite(omega) and omega > 0):
        raise ArgumentError(f"omega={omega!r} must be positive and finite.")

    def exact(t: Floats) -> tuple[Floats, Floats]:
        # x = 2 asin(k sn(K - omega t, k)), k = sin(amplitude / 2): Ochs, Eur. J. Phys. 32, 479 (2011).
        from scipy.special import ellipj, ellipk

        k = math.sin(0.5 * amplitude)
        sn, cn, _, _ = ellipj(ellipk(k * k) - omega * np.asarray(t), k * k)
        return 2.0 * np.arcsin(k * sn), -2.0 * k * omega * cn

    return System(
        name="pendulum",
        acceleration=_acceleration,
        x0=start(amplitude),
        v0=start(0.0),
        params=np.array([omega * omega]),
        quantities={"energy": Quantity(_energy)},
        exact=exact,
        packaged=True,
        units={"x": "rad"},
        source="Ochs, Eur. J. Phys. 32, 479 (2011)",
    )
