"""The problems that `auto` is measured on: every kind, smooth and stiff, with the state at the end."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import kickdrift as kd
from kickdrift.core.kinds import Kind

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Problem:
    """A problem, and how it is run.

    Attributes
    ----------
    name : str
        For the table.
    kind : Kind
        Of the candidates.
    problem : Any
        What `solve` gets.
    end : float
        Where it ends, from 0.
    largest : float
        Largest step to try.
    x0, v0 : array, optional
        Start, where the problem has none.
    rates : callable, optional
        ``rates(t, y)`` of what is stiff, whose reference is by SciPy's Radau; that of the others is `dop853` at a small step.
    """

    name: str
    kind: Kind
    problem: Any
    end: float
    largest: float
    x0: Any = None
    v0: Any = None
    rates: Callable[..., Any] | None = None

    def run(self, method: str, step: float) -> kd.Solution:
        """Run it with a largest step, keeping the end."""
        return kd.solve(
            self.problem, (0.0, self.end), self.x0, self.v0, step=step, method=method, save_every=2**60, progress=False
        )

    @cached_property
    def exact(self) -> Floats:
        """State at the end."""
        if self.rates is None:
            return _state(self.run("dop853", self.largest / 200))
        return solve_ivp(self.rates, (0.0, self.end), self.x0, method="Radau", rtol=1e-12, atol=1e-14).y[:, -1]

    def error(self, run: kd.Solution) -> float:
        """Largest difference at the end, in terms of the largest number there; infinite where it was not reached."""
        if not run.success:
            return float("inf")
        exact = self.exact
        return float(abs(_state(run) - exact).max() / max(abs(exact).max(), 1e-300))


def _state(run: kd.Solution) -> Floats:
    return np.concatenate([run.x[-1].ravel(), run.v[-1].ravel()])


# Written in place, so that what is timed is the arithmetic.


def _rigid_body(y, out):
    out[0] = (1.0 / 3.0 - 0.5) * y[1] * y[2]
    out[1] = (1.0 - 1.0 / 3.0) * y[2] * y[0]
    out[2] = (0.5 - 1.0) * y[0] * y[1]


def _lorenz(y, out):
    out[0] = 10.0 * (y[1] - y[0])
    out[1] = y[0] * (28.0 - y[2]) - y[1]
    out[2] = y[0] * y[1] - 8.0 / 3.0 * y[2]


def _brusselator(y, out):
    out[0] = 1.0 + y[0] * y[0] * y[1] - 4.0 * y[0]
    out[1] = 3.0 * y[0] - y[0] * y[0] * y[1]


def _schroedinger(y, out):
    n = y.size // 2
    for i in range(n):
        left, right = (i - 1) % n, (i + 1) % n
        density = y[i] * y[i] + y[n + i] * y[n + i]
        out[i] = -(y[n + left] + y[n + right]) - density * y[n + i]
        out[n + i] = y[left] + y[right] + density * y[i]


def _schroedinger_start(n):
    i = np.arange(n)
    return np.concatenate([np.exp(-(((i - n / 2) / 4) ** 2)), 0.3 * np.sin(2 * np.pi * i / n)])


def _robertson(y, out):
    slow, middle, fast = 0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] * y[1]
    out[0] = middle - slow
    out[1] = slow - middle - fast
    out[2] = fast


def _van_der_pol(y, out):
    out[0] = y[1]
    out[1] = 1000.0 * (1.0 - y[0] * y[0]) * y[1] - y[0]


def _hires(y, out):
    out[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007
    out[1] = 1.71 * y[0] - 8.75 * y[1]
    out[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4]
    out[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3]
    out[4] = -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6]
    out[5] = -280.0 * y[5] * y[7] + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6]
    out[6] = 280.0 * y[5] * y[7] - 1.81 * y[6]
    out[7] = -280.0 * y[5] * y[7] + 1.81 * y[6]


def _van_der_pol_10(y, out):
    out[0] = y[1]
    out[1] = 10.0 * (1.0 - y[0] * y[0]) * y[1] - y[0]


def _kaps(y, out):
    out[0] = -1002.0 * y[0] + 1000.0 * y[1] * y[1]
    out[1] = y[0] - y[1] - y[1] * y[1]


def _enzyme(y, out):
    bound, freed = 1000.0 * y[0] * (1.0 - y[1]), y[1]
    out[0] = freed - bound
    out[1] = bound - 2.0 * freed


def _heat(y, out):
    n = y.size - 2  # the last two are what turns at the left end
    for i in range(n):
        left = y[i - 1] if i > 0 else y[n]
        right = y[i + 1] if i < n - 1 else 0.0
        out[i] = (left - 2.0 * y[i] + right) * 400.0 - y[i] * y[i] * y[i]
    out[n] = y[n + 1]
    out[n + 1] = -y[n]


def _prey(x, v, out):
    out[0] = x[0] * (1.0 - v[0])


def _predators(x, v, out):
    out[0] = v[0] * (x[0] - 1.0)


def _coriolis(x, v, out):
    speed = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    out[0] = 1.4 * v[1] - 0.02 * speed * v[0] - x[0]
    out[1] = -1.4 * v[0] - 0.02 * speed * v[1] - x[1]
    out[2] = -0.02 * speed * v[2] - 0.5 * x[2]


def _drag(x, v, out):
    out[0] = -np.sin(x[0]) - 0.1 * v[0] * abs(v[0])


def _gyroscope(x, v, out):
    out[0] = -x[0] + 3.0 * v[1] - x[0] * x[1]
    out[1] = -2.0 * x[1] - 3.0 * v[0] - 0.5 * x[0] * x[0]


def _double_pendulum_pull(q, p, out):
    c, s = np.cos(q[0] - q[1]), np.sin(q[0] - q[1])
    d = 1.0 + s * s
    a = p[0] * p[1] * s / d
    b = (p[0] * p[0] + 2.0 * p[1] * p[1] - 2.0 * p[0] * p[1] * c) * s * c / (d * d)
    out[0] = a - b + 2.0 * np.sin(q[0])
    out[1] = b - a + np.sin(q[1])


def _double_pendulum_speed(q, p, out):
    c, s = np.cos(q[0] - q[1]), np.sin(q[0] - q[1])
    d = 1.0 + s * s
    out[0] = (p[0] - p[1] * c) / d
    out[1] = (2.0 * p[1] - p[0] * c) / d


def _geodesic_pull(q, p, out):
    out[0] = -p[1] * p[1] * np.cos(q[0]) / np.sin(q[0]) ** 3 - np.sin(q[0])
    out[1] = 0.0


def _geodesic_speed(q, p, out):
    out[0] = p[0]
    out[1] = p[1] / np.sin(q[0]) ** 2


def _toda(x, out):
    n = x.size
    for i in range(n):
        out[i] = np.exp(x[i - 1] - x[i]) - np.exp(x[i] - x[(i + 1) % n])


def _fput(x, out):
    n = x.size
    for i in range(n):
        right = (x[i + 1] if i < n - 1 else 0.0) - x[i]
        left = x[i] - (x[i - 1] if i > 0 else 0.0)
        out[i] = right - left + 0.25 * (right * right - left * left)


def _henon_heiles(x, out):
    out[0] = -x[0] - 2.0 * x[0] * x[1]
    out[1] = -x[1] - x[0] * x[0] + x[1] * x[1]


def _identity(p, out):
    for i in range(p.size):
        out[i] = p[i]


def _relativistic(p, out):
    out[0] = p[0] / np.sqrt(1.0 + p[0] * p[0])


def _quartic(q, out):
    out[0] = q[0] + q[0] ** 3


def _spring(x, out):
    out[0] = -x[0] - x[0] ** 3


def _driven_pendulum(t, x, out):
    out[0] = -np.sin(x[0]) + 1.15 * np.cos(2.0 * t / 3.0)


def _field_of(x, out):
    out[0] = 0.0
    out[1] = 0.0
    out[2] = 1.0 + 0.1 * x[0]


def _pull(x, out):
    for i in range(3):
        out[i] = -0.1 * x[i]


def _first(f: Callable[..., Any], n: int) -> Callable[..., Any]:
    def rates(t, y):
        out = np.empty(n)
        f(y, out)
        return out

    return rates


def _first_order(name: str, f: Any, end: float, largest: float, y0: Any, stiff: bool = False) -> Problem:
    start = np.array(y0, dtype=float)
    rates = _first(f, start.size) if stiff else None
    return Problem(name, Kind.FIRST_ORDER, kd.FirstOrder(f), end, largest, start, rates=rates)


def _rod(n: int) -> Problem:
    start = np.append(np.zeros(n), [0.0, 1.0])
    return _first_order(f"rod of {n}, warmed and cooled", _heat, 20.0, 4.0, start, stiff=True)


def _planets(eccentricity: float) -> Any:
    speed = np.sqrt((1 - eccentricity) / (1 + eccentricity))
    x = [[0.0, 0.0, 0.0], [1 + eccentricity, 0.0, 0.0], [0.0, 3.2, 0.0], [-7.0, 0.0, 0.1]]
    v = [[0.0, 0.0, 0.0], [0.0, speed, 0.0], [-np.sqrt(1 / 3.2), 0.0, 0.01], [0.0, -np.sqrt(1 / 7.0), 0.0]]
    return kd.systems.planetary([1.0, 1e-4, 1e-3, 3e-4], x, v)


def _eight() -> Any:
    x = [[0.97000435669734, -0.24308753153583, 0.0], [-0.97000435669734, 0.24308753153583, 0.0], [0.0, 0.0, 0.0]]
    v = [[0.46620368572052, 0.43236573046051, 0.0]] * 2 + [[-0.93240737144104, -0.86473146092102, 0.0]]
    return kd.systems.nbody(masses=[1.0, 1.0, 1.0], x0=x, v0=v, G=1.0)


def named() -> list[Problem]:
    """Return twelve of all kinds."""
    i = np.arange(8)
    charged = kd.ChargedParticle(1.0, _field_of, _pull)
    return [
        Problem("figure eight", Kind.NEWTONIAN, _eight(), 126.5, 0.5),
        Problem("Toda lattice", Kind.NEWTONIAN, _toda, 300.0, 1.0, np.sin(2 * np.pi * i / 8), 0.5 * np.cos(i)),
        Problem("FPUT chain", Kind.NEWTONIAN, _fput, 600.0, 1.0, np.sin(np.pi * np.arange(1, 17) / 17), np.zeros(16)),
        Problem("charged particle", Kind.CHARGED, charged, 300.0, 1.0, [1.0, 0.0, 0.0], [0.0, 0.5, 0.1]),
        Problem("damped oscillator", Kind.DAMPED, kd.Damped(_spring, damping=0.01), 300.0, 1.0, [1.0], [0.5]),
        Problem("planets, e = 0.3", Kind.NEARLY_KEPLERIAN, _planets(0.3), 600.0, 2.0),
        _first_order("rigid body", _rigid_body, 600.0, 2.0, [0.3, 0.9, 0.8]),
        Problem("Lotka-Volterra", Kind.PARTITIONED, kd.Partitioned(_prey, _predators), 300.0, 1.0, [0.5], [1.5]),
        Problem(
            *("double pendulum", Kind.HAMILTONIAN, kd.Hamiltonian(_double_pendulum_pull, _double_pendulum_speed)),
            *(150.0, 0.5, [0.5, 0.3], [0.0, 0.1]),
        ),
        _first_order("Schroedinger chain of 64", _schroedinger, 20.0, 0.5, _schroedinger_start(64)),
        Problem("Coriolis with drag", Kind.VELOCITY_DEPENDENT, _coriolis, 300.0, 1.0, [1.0, 0.2, 0.5], [0.0, 0.5, 0.1]),
        _first_order("Robertson", _robertson, 1000.0, 100.0, [1.0, 0.0, 0.0], stiff=True),
    ]


def held_out() -> list[Problem]:
    """Return others, that no rule was made on."""
    return [
        Problem("Henon-Heiles", Kind.NEWTONIAN, _henon_heiles, 600.0, 1.0, [0.1, 0.0], [0.0, 0.5]),
        Problem(
            "relativistic oscillator", Kind.SEPARABLE, kd.Separable(_relativistic, _quartic), 300.0, 1.0, [0.5], [1.0]
        ),
        Problem("pendulum with drag", Kind.VELOCITY_DEPENDENT, _drag, 300.0, 1.0, [2.0], [0.5]),
        Problem("gyroscopic couple", Kind.VELOCITY_DEPENDENT, _gyroscope, 300.0, 0.5, [0.2, 0.1], [0.1, 0.0]),
        _first_order("Lorenz", _lorenz, 10.0, 0.1, [1.0, 1.0, 20.0]),
        _first_order("Brusselator", _brusselator, 150.0, 0.5, [1.5, 3.0]),
        Problem(
            *("spherical pendulum", Kind.HAMILTONIAN, kd.Hamiltonian(_geodesic_pull, _geodesic_speed)),
            *(200.0, 0.5, [1.0, 0.0], [0.0, 0.7]),
        ),
        _first_order("van der Pol, mu = 1000, before it jumps", _van_der_pol, 750.0, 20.0, [2.0, 0.0], stiff=True),
        _first_order("HIRES", _hires, 300.0, 4.0, [1.0, 0, 0, 0, 0, 0, 0, 0.0057], stiff=True),
        _first_order("van der Pol, mu = 10", _van_der_pol_10, 40.0, 0.2, [2.0, 0.0]),
        _first_order("Kaps", _kaps, 5.0, 0.5, [1.0, 1.0], stiff=True),
        _first_order("enzyme kinetics", _enzyme, 0.8, 0.1, [1.0, 1.0 / 1.002], stiff=True),
        _rod(20),
        _rod(40),
        Problem("driven pendulum", Kind.DAMPED, kd.Damped(_driven_pendulum, damping=0.5), 60.0, 1.0, [1.0], [0.5]),
        Problem(
            *("damped FPUT chain", Kind.DAMPED, kd.Damped(_fput, damping=0.1)),
            *(60.0, 1.0, 0.5 * np.sin(np.arange(16)), 0.5 * np.cos(np.arange(16) ** 2)),
        ),
    ]


def every_problem() -> list[Problem]:
    """Return both."""
    return named() + held_out()
