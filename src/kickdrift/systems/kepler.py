"""The Kepler problem in the plane: x'' = -mu x / |x|^3."""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.arguments import number
from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.systems.system import Quantity, System, start

Floats = NDArray[np.float64]

_PART = 2048


@compiled
def _acceleration(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    r2 = x[0] * x[0] + x[1] * x[1]
    f = -params[0] / (r2 * math.sqrt(r2))
    out[0] = f * x[0]
    out[1] = f * x[1]


@compiled
def _nothing(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[:] = 0.0


@compiled
def _energy(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[0] = 0.5 * (v[0] * v[0] + v[1] * v[1]) - params[0] / math.sqrt(x[0] * x[0] + x[1] * x[1])


@compiled
def _angular_momentum(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[0] = x[0] * v[1] - x[1] * v[0]


def kepler(eccentricity: float = 0.6, semi_major_axis: float = 1.0, mu: float = 1.0) -> System:
    """Create a body on an elliptic orbit, starting at the pericentre; the state has shape (2,).

    ``method="wisdom-holman"`` is exact here, except for rounding.

    Parameters
    ----------
    eccentricity : float
        At least 0 and below 1.
    semi_major_axis : float
        Half the length of the ellipse; the body starts at ``semi_major_axis * (1 - eccentricity)``.
    mu : float
        Gravitational parameter. The period is 2 pi sqrt(semi_major_axis^3 / mu).

    Returns
    -------
    System

    Raises
    ------
    ArgumentError
        For an eccentricity outside [0, 1), or an axis or `mu` that is not positive.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> orbit = kd.systems.kepler(eccentricity=0.6)
    >>> sol = kd.solve(orbit, (0.0, 2 * np.pi), step=0.01, method="wisdom-holman")
    >>> bool(abs(sol.x[-1] - sol.x[0]).max() < 1e-13)
    True
    """
    e, a, mu = number("eccentricity", eccentricity), number("semi_major_axis", semi_major_axis), number("mu", mu)
    if not 0 <= e < 1:
        raise ArgumentError(f"eccentricity={eccentricity!r} must be at least 0 and below 1; the orbit is an ellipse.")
    for name, value in (("semi_major_axis", a), ("mu", mu)):
        if not (math.isfinite(value) and value > 0):
            raise ArgumentError(f"{name}={value!r} must be positive and finite.")
    mean_motion = math.sqrt(mu / a) / a  # a**3 may be beyond the range of floats

    def exact(t: Floats) -> tuple[Floats, Floats]:
        # Murray, Dermott, Solar System Dynamics (1999), section 2.4.
        anomaly = eccentric_anomaly(mean_motion * np.asarray(t, dtype=np.float64), e)
        c, s, minor = np.cos(anomaly), np.sin(anomaly), math.sqrt(1 - e * e)
        rate = mean_motion / (1 - e * c)
        return np.stack([a * (c - e), a * minor * s], -1), np.stack([-a * rate * s, a * minor * rate * c], -1)

    return System(
        name="kepler",
        acceleration=_acceleration,
        x0=start([a * (1 - e), 0.0]),
        v0=start([0.0, math.sqrt(mu / a * (1 + e) / (1 - e))]),
        params=np.array([mu]),
        quantities={"energy": Quantity(_energy), "angular momentum": Quantity(_angular_momentum)},
        exact=exact,
        kind=Kind.NEARLY_KEPLERIAN,
        parts={"remainder": _nothing},
        packaged=True,
        dimensions=("space",),
        coordinates={"space": ["x", "y"]},
        source="Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), section I.2.3",
        gm=np.array([mu], dtype=np.float64),
    )


def eccentric_anomaly(mean_anomaly: Floats, eccentricity: float) -> Floats:
    """Solve Kepler's equation E - e sin E = M for arrays of M, to rounding.

    Newton's method on (0, pi), where E - e sin E is convex, converges from beyond the zero for every eccentricity below 1.
    Begun at the least of pi, M + e and M / (1 - e), which all are beyond it. The correction c is followed by one of
    e c^2 / 2 (1 - e) at most. Parts of the arrays that stay in the L1 cache take half the time.
    """
    solved = np.empty(mean_anomaly.size)
    for first in range(0, solved.size, _PART):
        _solve_part(mean_anomaly.reshape(-1)[first : first + _PART], eccentricity, solved[first : first + _PART])
    return solved.reshape(mean_anomaly.shape)


def _solve_part(mean_anomaly: Floats, e: float, solved: Floats) -> None:
    turns = np.round(mean_anomaly / (2 * math.pi))
    m = mean_anomaly - 2 * math.pi * turns
    sign, m = np.sign(m), np.abs(m)
    anomaly = np.minimum(np.minimum(m + e, m / (1 - e)), math.pi)
    for _ in range(60):
        correction = (anomaly - e * np.sin(anomaly) - m) / (1 - e * np.cos(anomaly))
        anomaly = anomaly - correction
        if np.all(e * correction * correction <= 4e-17 * (1 - e) * np.maximum(anomaly, 1e-300)):
            break
    np.add(sign * anomaly, 2 * math.pi * turns, out=solved)
