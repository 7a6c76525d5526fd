"""Kicks and drifts in a transformed time, each over a time that the variables of the other determine: for close encounters.

Templates. The step counts a time s with a rate dt/ds that each letter takes from the variables that it does not move:

- logarithmic Hamiltonian, of H = T(v) + U(x) < 0: drifts take ``1 / (T - E)``, kicks ``1 / -U``, which are equal on the exact
  motion. A Kepler orbit is exact, except for its time (Mikkola, Tanikawa, Mon. Not. R. Astron. Soc. 310, 745 (1999); Preto,
  Tremaine, Astron. J. 118, 2532 (1999)).
- time-transformed leapfrog: kicks take ``1 / Omega(x)``, drifts ``1 / W``, where W follows Omega by the present velocities
  (Mikkola, Aarseth, Celest. Mech. Dyn. Astron. 84, 343 (2002)).

All are relative to their initial values, so that the first step takes the given time.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.views import part
from kickdrift.engine.flows.layout import (
    BINDING,
    START_DENSITY,
    TROUBLE,
    UNFIT_DENSITY,
    control_memory,
    move_clock,
    own_params,
)

Floats = NDArray[np.float64]

acceleration_at: Callable[..., None] = unbound
energy_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound
density_of: Callable[..., float] = unbound
rate_of_density: Callable[..., float] = unbound
transformed_rekick: Callable[..., None] = unbound
energy_of: Callable[..., float] = unbound
potential_of: Callable[..., float] = unbound


def evaluate_energy(t: float, x: Floats, v: Floats, work: Floats) -> float:
    """Return the energy."""
    out = part(control_memory(x.size, work), 0, 1)
    energy_at(t, x, v, own_params(work), work, out)
    return float(out[0])


def evaluate_potential(t: float, x: Floats, v: Floats, work: Floats) -> float:
    """Return the energy at rest."""
    rest = part(control_memory(x.size, work), 1, v.size)
    for i in range(rest.size):
        rest[i] = 0.0
    return float(energy_of(t, x, rest, work))


@compiled(inline=True)
def time_of(h: float, density: float, work: Floats) -> float:
    """Return the time of a step h at a density; zero, with the failure noted, for an invalid one."""
    share = density / work[START_DENSITY]
    if not 0.0 < share < math.inf:
        work[TROUBLE] = UNFIT_DENSITY
        return 0.0
    return float(h / share)


def measure_binding(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Prepare the control: the energy at the start, and minus the potential energy as the density there."""
    work[BINDING] = -energy_of(t, x, v, work)
    work[START_DENSITY] = -potential_of(t, x, v, work)
    if not 0.0 < work[START_DENSITY] < math.inf:
        work[TROUBLE] = UNFIT_DENSITY


def logarithmic_kick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h over minus the potential energy."""
    a = work[: x.size]
    acceleration_at(t, x, v, params, work, a)
    add_to_v(v, time_of(h, -potential_of(t, x, v, work), work), a, work)


def logarithmic_rekick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Do the same with the acceleration that the last kick wrote to work."""
    add_to_v(v, time_of(h, -potential_of(t, x, v, work), work), work[: x.size], work)


def logarithmic_drift(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x, and the clock, by h over the kinetic energy less the energy at the start."""
    kinetic = energy_of(t, x, v, work) - potential_of(t, x, v, work)
    time = time_of(h, kinetic + work[BINDING], work)
    add_to_x(x, time, v, work)
    move_clock(time, work)


def measure_weight(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Prepare the control: W is Omega at the start, and both are relative to that."""
    work[START_DENSITY] = density_of(t, x, v, work)
    work[BINDING] = work[START_DENSITY]


def transformed_kick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h over Omega, and W by the mean of its rates at both ends."""
    acceleration_at(t, x, v, params, work, work[: x.size])
    transformed_rekick(t, h, x, v, params, work)


def kick_again(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Do the same with the acceleration in work."""
    omega = density_of(t, x, v, work)
    time = time_of(h, omega, work)
    rate = rate_of_density(t, x, v, params, work)
    add_to_v(v, time, work[: x.size], work)
    rate += rate_of_density(t, x, v, params, work)
    work[BINDING] += 0.5 * time * omega * rate


def transformed_drift(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x, and the clock, by h over W."""
    time = time_of(h, work[BINDING], work)
    add_to_x(x, time, v, work)
    move_clock(time, work)
