"""Derivatives of the energy along drifts and kicks, by differences: the flows of both parts are known exactly."""

from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.quantities import evaluate_quantity
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]

_REACH = 4  # points on either side of a difference: order 8 for the first two derivatives, 6 for the next two
_POINTS = np.arange(-_REACH, _REACH + 1)
# Of a step: rounding is that of the energy over the power of it, and truncation (spacing h omega)^8 of the term.
_SPACING = {1: 0.25, 2: 0.25, 3: 0.5, 4: 0.5}
_MOST_NUMBERS = 1 << 21


class FlowDerivatives:
    """Energies of states, and their derivatives along kicks and drifts."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._energy = system.quantities["energy"]
        self._kick = Quantity(system.acceleration, system.v0.size)
        self._drift = None if system.velocity is None else Quantity(system.velocity, system.x0.size)

    def energy(self, x: Floats, v: Floats) -> Floats:
        """Return the energies of rows."""
        return self._values(self._energy, x, v)

    def derivative(self, word: str, step: float, x: Floats, v: Floats) -> Floats:
        """Return the derivatives of the energy along the letters of a word, times the power of the step."""
        runs = [(letter, len(list(group))) for letter, group in groupby(word)]
        many = max(1, _MOST_NUMBERS // (x.shape[1] * _POINTS.size ** len(runs)))
        spacing = _SPACING[len(word)]
        parts = [
            self._along(runs, spacing * step, x[k : k + many], v[k : k + many]) for k in range(0, x.shape[0], many)
        ]
        return np.concatenate(parts) / spacing ** len(word)

    def _along(self, runs: list[tuple[str, int]], size: float, x: Floats, v: Floats) -> Floats:
        if not runs:
            return self.energy(x, v)
        (letter, times), *others = runs
        weights = _stencil(times)
        used = np.flatnonzero(weights)
        move = size * _POINTS[used][:, None, None]
        if letter == "D":
            rate = v if self._drift is None else self._values(self._drift, x, v)
            xs, vs = x + move * rate.reshape(x.shape), np.broadcast_to(v, (used.size, *v.shape))
        else:
            rate = self._values(self._kick, x, v)
            xs, vs = np.broadcast_to(x, (used.size, *x.shape)), v + move * rate.reshape(v.shape)
        values = self._along(others, size, xs.reshape(-1, x.shape[1]), vs.reshape(-1, x.shape[1]))
        total: Floats = weights[used] @ values.reshape(used.size, -1)
        return total

    def _values(self, quantity: Quantity, x: Floats, v: Floats) -> Floats:
        return evaluate_quantity(quantity, self._system, np.zeros(x.shape[0]), x, v)


def _stencil(derivative: int) -> Floats:
    """Return the weights of central differences, by the powers that they are exact for.

    B. Fornberg, Math. Comp. 51, 699 (1988).
    """
    powers = np.arange(_POINTS.size)
    wanted = np.zeros(_POINTS.size)
    wanted[derivative] = float(np.prod(np.arange(1, derivative + 1)))
    weights = np.linalg.solve(_POINTS.astype(np.float64) ** powers[:, None], wanted)
    return np.where(np.abs(weights) < 1e-12, 0.0, weights)
