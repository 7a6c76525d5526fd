"""The members: Kepler orbits of period 2 pi that begin at their pericentres."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def orbits(count: int, most: float) -> tuple[Floats, Floats]:
    """Return starts of orbits with eccentricities up to `most`, and their velocities."""
    e = np.random.default_rng(0).uniform(0.0, most, count)
    return np.stack([1 - e, 0 * e], axis=1), np.stack([0 * e, np.sqrt((1 + e) / (1 - e))], axis=1)


def energy(x: Floats, v: Floats) -> Floats:
    """Return the energies of bodies, (..., 2)."""
    values: Floats = 0.5 * (v**2).sum(axis=-1) - 1 / np.sqrt((x**2).sum(axis=-1))
    return values
