"""Angular velocities at pericentres, by which ``"auto"`` chooses among the splittings for planetary systems."""

import numpy as np

from kickdrift.systems.system import System


def fastest_pericentre(system: System) -> float:
    """Return the largest angular velocity at a pericentre of the Kepler orbits into which a planetary system is split."""
    x, v = system.x0, system.v0
    if system.frame is not None:
        x, v = system.frame.enter(x, v)
    x, v = x.reshape(-1, x.shape[-1]), v.reshape(-1, v.shape[-1])
    mu = system.params[system.params.size - len(x) :]
    x, v, mu = x[mu > 0], v[mu > 0], mu[mu > 0]
    distance = np.linalg.norm(x, axis=1)
    with np.errstate(all="ignore"):
        momentum = np.sqrt(np.maximum((x * x).sum(1) * (v * v).sum(1) - (x * v).sum(1) ** 2, 0.0))
        twice_energy = (v * v).sum(1) - 2 * mu / distance
        eccentricity = np.sqrt(np.maximum(1 + twice_energy * (momentum / mu) ** 2, 0.0))
        rates = mu**2 * (1 + eccentricity) ** 2 / momentum**3
    return float(rates[np.isfinite(rates)].max(initial=0.0))
