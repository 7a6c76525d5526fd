"""The constraints of a system as functions of x alone, for use outside of steps, with NumPy."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kickdrift.systems.system import System

Floats = NDArray[np.float64]
INDEPENDENT = 1e-6  # of the largest singular value; of rows of unit length, as in the flows
DIFFERENCE = 1e-4  # of the size of x, as in the flows


@dataclass(frozen=True)
class Constraints:
    """The constraints g(x) = 0 of a system, x of shape (n,).

    Attributes
    ----------
    system : System
        Of the kind CONSTRAINED: its params end with the number m of constraints, a length that differences are measured
        by, and the inverse masses (n).
    """

    system: System

    @property
    def count(self) -> int:
        """The number m of constraints."""
        return int(self.system.params[-self.system.x0.size - 2])

    @property
    def inverse_masses(self) -> Floats:
        """Inverse masses, shape (n,)."""
        return self.system.params[-self.system.x0.size :]

    @property
    def has_jacobian(self) -> bool:
        """Whether the system provides its Jacobian."""
        return "constraint_jacobian" in self.system.parts

    def length(self, x: Floats) -> float:
        """Return the size of x, not less than that of the start."""
        return max(float(self.system.params[-x.size - 1]), float(abs(x).max()))

    def values(self, x: Floats) -> Floats:
        """Return g(x), shape (m,)."""
        return self._call("constraints", x, self.count)

    def jacobian(self, x: Floats) -> Floats:
        """Return the Jacobian at x, shape (m, n), by differences where the system has none."""
        if not self.has_jacobian:
            return self.differences(x)
        return self._call("constraint_jacobian", x, self.count * x.size).reshape(self.count, x.size)

    def differences(self, x: Floats, share: float = 1.0) -> Floats:
        """Return the Jacobian at x, shape (m, n), by differences over a share of the usual distance."""
        d = share * DIFFERENCE * self.length(x)
        return np.stack([along(self.values, x, unit, d) for unit in np.eye(x.size)], axis=1)

    def curvature(self, x: Floats, v: Floats) -> Floats:
        """Return the derivative of G v along v, shape (m,)."""
        speed, d = float(abs(v).max()), DIFFERENCE * self.length(x)
        if speed == 0:
            return np.zeros(self.count)
        direction = v / speed

        def slope(y: Floats) -> Floats:
            if self.has_jacobian:
                return self.jacobian(y) @ direction
            return along(self.values, y, direction, d)

        return along(slope, x, direction, d) * speed**2

    def normal(self, G: Floats, rates: Floats) -> Floats:
        """Return the smallest change u in the metric of the masses with G u = rates, shape (n,)."""
        root = np.sqrt(self.inverse_masses)
        rows, lengths = self.scaled(G)
        change: Floats = root * (np.linalg.pinv(rows, rcond=INDEPENDENT) @ (rates / lengths))
        return change

    def scaled(self, G: Floats) -> tuple[Floats, Floats]:
        """Return G M^(-1/2) with rows of length one, and the lengths that they had, 1 for rows of zeros."""
        rows = G * np.sqrt(self.inverse_masses)
        lengths = np.linalg.norm(rows, axis=-1)
        lengths = np.where(lengths > 0, lengths, 1.0)
        return rows / lengths[..., None], lengths

    def nearest(self, x: Floats) -> Floats | None:
        """Project onto the constraints by the Gauss-Newton method; None where that finds no such position."""
        y = x.copy()
        for _ in range(50):
            g, G = self.values(y), self.jacobian(y)
            if not (np.isfinite(g).all() and np.isfinite(G).all()):
                return None
            change = self.normal(G, g)
            y -= change
            if abs(change).max() <= 1e-15 * abs(y).max():
                break
        return y if not self.violated(y).any() else None

    def violated(self, x: Floats) -> NDArray[np.bool_]:
        """Return which constraints ask for changes of x by more than 1e-12 of its size, shape (m,)."""
        off: NDArray[np.bool_] = abs(self.values(x)) > 1e-12 * abs(self.jacobian(x)).sum(axis=1) * self.length(x)
        return off

    def _call(self, part: str, x: Floats, size: int) -> Floats:
        out = np.zeros(size)
        with np.errstate(all="ignore"):
            self.system.parts[part](0.0, x, x, self.system.params, out)
        return out


def along(function: Callable[[Floats], Floats], x: Floats, direction: Floats, d: float) -> Floats:
    """Differentiate a function at x along a direction, by differences of fourth order over steps d of it."""
    near = function(x + d * direction) - function(x - d * direction)
    far = function(x + 2 * d * direction) - function(x - 2 * d * direction)
    slope: Floats = (8 * near - far) / (12 * d)
    return slope
