"""The problems: laws of motion, starts, energies."""

from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np

from benchmarks.precision.laws import AnyLaw, Floats, Law


def _same(t: Any, x: Any, v: Any) -> Any:
    return v


def henon_heiles(m: ModuleType) -> Law:
    """H = (p^2 + q^2) / 2 + q0^2 q1 - q1^3 / 3 (Henon, Heiles, Astron. J. 69, 73, 1964)."""

    def force(t: Any, x: Any, v: Any) -> Any:
        return -x[0] - 2.0 * x[0] * x[1], -x[1] - x[0] * x[0] + x[1] * x[1]

    return Law(_same, force)


def henon_heiles_energy(x: Floats, v: Floats) -> Floats:
    """H."""
    return 0.5 * (v[0] ** 2 + v[1] ** 2 + x[0] ** 2 + x[1] ** 2) + x[0] ** 2 * x[1] - x[1] ** 3 / 3


def kepler(m: ModuleType) -> Law:
    """Make x'' = -x / |x|^3 in a plane."""

    def force(t: Any, x: Any, v: Any) -> Any:
        r2 = x[0] * x[0] + x[1] * x[1]
        w = -1.0 / (r2 * m.sqrt(r2))
        return w * x[0], w * x[1]

    return Law(_same, force)


def relativistic(m: ModuleType) -> Law:
    """H = sqrt(1 + p^2) + q^2 / 2 + q^4 / 4: the kinetic energy is not quadratic."""

    def velocity(t: Any, x: Any, v: Any) -> Any:
        return (v[0] / m.sqrt(1.0 + v[0] * v[0]),)

    def force(t: Any, x: Any, v: Any) -> Any:
        return (-x[0] - x[0] * x[0] * x[0],)

    return Law(velocity, force)


def relativistic_energy(x: Floats, v: Floats) -> Floats:
    """H."""
    return np.sqrt(1 + v[0] ** 2) + x[0] ** 2 / 2 + x[0] ** 4 / 4


def tao(m: ModuleType) -> Law:
    """H = (q^2 + 1) (p^2 + 1) / 2, not separable (Tao, Phys. Rev. E 94, 043303, 2016)."""

    def velocity(t: Any, x: Any, v: Any) -> Any:
        return ((x[0] * x[0] + 1.0) * v[0],)

    def force(t: Any, x: Any, v: Any) -> Any:
        return (-x[0] * (v[0] * v[0] + 1.0),)

    return Law(velocity, force)


def tao_energy(x: Floats, v: Floats) -> Floats:
    """H."""
    return (x[0] ** 2 + 1) * (v[0] ** 2 + 1) / 2


STIFF = 50.0


def stiff_spring(m: ModuleType) -> Law:
    """H = (p^2 + 50^2 q1^2) / 2 + ((q0 - q1)^4 + (q0 + q1)^4) / 4, of Fermi, Pasta and Ulam with one stiff spring."""

    def force(t: Any, x: Any, v: Any) -> Any:
        less, more = x[0] - x[1], x[0] + x[1]
        one, other = less * less * less, more * more * more
        return -one - other, one - other - STIFF * STIFF * x[1]

    return Law(_same, force)


def stiff_spring_energy(x: Floats, v: Floats) -> Floats:
    """H."""
    fast = (STIFF * x[1]) ** 2
    return 0.5 * (v[0] ** 2 + v[1] ** 2 + fast) + 0.25 * ((x[0] - x[1]) ** 4 + (x[0] + x[1]) ** 4)


def soft_springs(x: Any, out: Any) -> None:
    """Write the slow part of the same."""
    one, other = (x[0] - x[1]) ** 3, (x[0] + x[1]) ** 3
    out[0] = -one - other
    out[1] = one - other


def stiff_part(x: Any, out: Any) -> None:
    """Write the fast part of the same."""
    out[0] = 0.0
    out[1] = -STIFF * STIFF * x[1]


def van_der_pol(m: ModuleType) -> Law:
    """Make x'' = (1 - x^2) v - x."""

    def force(t: Any, x: Any, v: Any) -> Any:
        return ((1.0 - x[0] * x[0]) * v[0] - x[0],)

    return Law(_same, force)


def predator_and_prey(m: ModuleType) -> Law:
    """Make x' = x (1 - v), v' = v (x - 1), by Lotka and Volterra."""

    def velocity(t: Any, x: Any, v: Any) -> Any:
        return (x[0] * (1.0 - v[0]),)

    def force(t: Any, x: Any, v: Any) -> Any:
        return (v[0] * (x[0] - 1.0),)

    return Law(velocity, force)


def lorenz(m: ModuleType) -> Law:
    """Lorenz's equations at the usual parameters (J. Atmos. Sci. 20, 130, 1963)."""

    def rates(t: Any, x: Any, v: Any) -> Any:
        return 10.0 * (x[1] - x[0]), x[0] * (28.0 - x[2]) - x[1], x[0] * x[1] - 8.0 / 3.0 * x[2]

    return Law(rates)


def magnetic(m: ModuleType) -> Law:
    """Put a charge into B = R e_z and E = 0.01 (x, y, 0) / R^3 with R^2 = x^2 + y^2.

    He, Sun, Liu, Qin, J. Comput. Phys. 281, 135 (2015).
    """

    def force(t: Any, x: Any, v: Any) -> Any:
        r = m.sqrt(x[0] * x[0] + x[1] * x[1])
        e = 0.01 / (r * r * r)
        return e * x[0] + v[1] * r, e * x[1] - v[0] * r, 0.0 * x[2]

    return Law(_same, force)


def magnetic_field(x: Any, out: Any) -> None:
    """Write B."""
    out[0] = out[1] = 0.0
    out[2] = np.sqrt(x[0] * x[0] + x[1] * x[1])


def electric_field(x: Any, out: Any) -> None:
    """Write E."""
    r2 = x[0] * x[0] + x[1] * x[1]
    e = 0.01 / (r2 * np.sqrt(r2))
    out[0], out[1], out[2] = e * x[0], e * x[1], 0.0


def spherical_pendulum(m: ModuleType) -> Law:
    """Make x'' = -e_z - lambda x with lambda = (|v|^2 - z) / |x|^2, which keeps |x|: the constraint solved for."""

    def force(t: Any, x: Any, v: Any) -> Any:
        pull = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] - x[2]) / (x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
        return -pull * x[0], -pull * x[1], -1.0 - pull * x[2]

    return Law(_same, force)


def falling(x: Any, out: Any) -> None:
    """Write the force of gravity."""
    out[0] = out[1] = 0.0
    out[2] = -1.0


def off_sphere(x: Any) -> Any:
    """Return zero on the unit sphere."""
    return x[0] * x[0] + x[1] * x[1] + x[2] * x[2] - 1.0


def off_sphere_jacobian(x: Any, out: Any) -> None:
    """Write the derivatives of that."""
    out[:] = 2.0 * x


def falling_array(t: Any, q: Any) -> Any:
    """Return the force of gravity, for symplecta."""
    return np.array([0.0, 0.0, -1.0])


def off_sphere_array(q: Any) -> Any:
    """Return an array of one constraint, for symplecta."""
    return np.array([q[0] * q[0] + q[1] * q[1] + q[2] * q[2] - 1.0])


def off_sphere_jacobian_array(q: Any) -> Any:
    """Return an array of its derivatives, (1, 3), for symplecta."""
    return 2.0 * q.reshape(1, 3)


def damped_pendulum(m: ModuleType) -> Law:
    """Make x'' = -sin x + cos(2 t / 3) / 2 - v / 10."""

    def force(t: Any, x: Any, v: Any) -> Any:
        return (-m.sin(x[0]) + 0.5 * m.cos(2.0 * t / 3.0) - 0.1 * v[0],)

    return Law(_same, force)


def driven(t: Any, x: Any, out: Any) -> None:
    """Write the force on the driven pendulum but for its damping."""
    out[0] = -np.sin(x[0]) + 0.5 * np.cos(2.0 * t / 3.0)


def gravity(masses: tuple[float, ...]) -> AnyLaw:
    """Bodies that attract each other; the masses are times G."""
    n = len(masses)

    def law(m: ModuleType) -> Law:
        def force(t: Any, x: Any, v: Any) -> Any:
            a = [0.0 * x[0]] * (3 * n)
            for i in range(n):
                for j in range(i):
                    dx, dy, dz = x[3 * i] - x[3 * j], x[3 * i + 1] - x[3 * j + 1], x[3 * i + 2] - x[3 * j + 2]
                    r2 = dx * dx + dy * dy + dz * dz
                    w = 1.0 / (r2 * m.sqrt(r2))
                    a[3 * i], a[3 * j] = a[3 * i] - masses[j] * w * dx, a[3 * j] + masses[i] * w * dx
                    a[3 * i + 1], a[3 * j + 1] = a[3 * i + 1] - masses[j] * w * dy, a[3 * j + 1] + masses[i] * w * dy
                    a[3 * i + 2], a[3 * j + 2] = a[3 * i + 2] - masses[j] * w * dz, a[3 * j + 2] + masses[i] * w * dz
            return a

        return Law(_same, force)

    return law


def gravity_energy(masses: tuple[float, ...]) -> Callable[[Floats, Floats], Floats]:
    """Make a function for the energy, times G, of arrays (3 N, T)."""
    pairs = [(i, j) for i in range(len(masses)) for j in range(i)]

    def energy(x: Floats, v: Floats) -> Floats:
        x, v = x.reshape(len(masses), 3, -1), v.reshape(len(masses), 3, -1)
        kinetic = sum(0.5 * m * (v[i] ** 2).sum(axis=0) for i, m in enumerate(masses))
        bound = sum(masses[i] * masses[j] / np.sqrt(((x[i] - x[j]) ** 2).sum(axis=0)) for i, j in pairs)
        return np.asarray(kinetic - bound)

    return energy


def double_well(x: Any, out: Any) -> None:
    """Write the force of U = (x^2 - 1)^2 on each particle."""
    for i in range(x.size):
        out[i] = 4.0 * x[i] * (1.0 - x[i] * x[i])


def double_well_array(x: Any) -> Any:
    """Return it, for diffrax."""
    return 4.0 * x * (1.0 - x * x)


def mean_square(x: Floats, v: Floats) -> Floats:
    """x^2, once the start is forgotten."""
    return x[:, x.shape[1] // 5 :] ** 2


def mean_square_in_double_well(temperature: float) -> float:
    """Exact average of x^2 by the trapezoidal rule, which is exact to rounding here."""
    x = np.linspace(-6.0, 6.0, 20_001)
    weights = np.exp(-((x * x - 1.0) ** 2) / temperature)
    return float((weights * x * x).sum() / weights.sum())
