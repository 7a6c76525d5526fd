"""The harmonic oscillator: x'' = -omega^2 x."""

import math
import sys

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.arguments import number
from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.systems.system import Quantity, System, start

Floats = NDArray[np.float64]


@compiled
def _acceleration(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[0] = -params[0] * x[0]


@compiled
def _energy(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[0] = 0.5 * (v[0] * v[0] + params[0] * x[0] * x[0])


def harmonic_oscillator(omega: float = 1.0, x0: float = 1.0, v0: float = 0.0) -> System:
    """Create a harmonic oscillator of unit mass, x'' = -omega^2 x; the state is a scalar.

    Parameters
    ----------
    omega : float
        Angular frequency, in radians per unit of time.
    x0, v0 : float
        Start.

    Returns
    -------
    System

    Raises
    ------
    ArgumentError
        If `omega` is not positive, or its square is not a normal number.

    Examples
    --------
    >>> import kickdrift as kd
    >>> kd.systems.harmonic_oscillator().exact(0.0)
    (np.float64(1.0), np.float64(0.0))
    """
    omega, x0, v0 = number("omega", omega), number("x0", x0), number("v0", v0)
    if not (math.isfinite(omega) and omega > 0):
        raise ArgumentError(f"omega={omega!r} must be positive and finite.")
    if not sys.float_info.min <= omega * omega < math.inf:
        raise ArgumentError(
            f"omega={omega!r} is out of range: its square, to which the force is proportional, is {omega * omega!r}. Use"
            " another unit of time."
        )

    def exact(t: Floats) -> tuple[Floats, Floats]:
        c, s = np.cos(omega * t), np.sin(omega * t)
        return x0 * c + v0 / omega * s, v0 * c - x0 * omega * s

    return System(
        name="harmonic-oscillator",
        acceleration=_acceleration,
        x0=start(x0),
        v0=start(v0),
        params=np.array([omega * omega]),
        quantities={"energy": Quantity(_energy)},
        exact=exact,
        packaged=True,
        source="Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), section I.1",
    )
