"""Steps by a density: the number of steps per unit of time is a function of the state, and is integrated along with it.

Templates. With the density rho, a step takes the time ``first step / z``, where z follows rho / rho(start):

- Hairer, Soederlind, SIAM J. Sci. Comput. 26, 1838 (2005): ``z' = d/dt log rho`` in the time that counts steps, half of it
  before the step and half of it after. Explicit, and a symmetric step stays symmetric.
- Huang, Leimkuhler, SIAM J. Sci. Comput. 18, 239 (1997): the mean of z before and after is rho in the middle of the step.

The rate of log rho is a difference over half a step, forwards and back along x' (and v', where rho sees v): it changes its sign
with the velocities, exactly, and so keeps the step reversible. With differences over an eighth of a step the energy is no
better, and rounding leads 3000 steps back to within 4e-11 instead of 4e-12; over a whole one, planets that meet are lost
sooner.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.views import part
from kickdrift.engine.flows.layout import (
    DEAR,
    DENSITY,
    DENSITY_HERE,
    DENSITY_RATE,
    DENSITY_ROUNDED_OFF,
    EVALUATIONS,
    FIRST_STEP,
    MISSED_DENSITY,
    START_DENSITY,
    TROUBLE,
    UNFIT_DENSITY,
    VELOCITY,
    control_memory,
    has_part,
    own_params,
)

Floats = NDArray[np.float64]

_FARTHEST = 10.0  # times too dense or too sparse: the steps have then missed a peak of the density, and cannot recover

density_at: Callable[..., None] = unbound
acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound
density_of: Callable[..., float] = unbound
rate_of_density: Callable[..., float] = unbound
rates_of_v: Callable[..., None] = unbound


@compiled(inline=True)
def note_missed(work: Floats) -> None:
    """Note that the steps have missed the density, unless it was invalid before."""
    if work[TROUBLE] != UNFIT_DENSITY:
        work[TROUBLE] = MISSED_DENSITY


@compiled(inline=True)
def take_density(density: float, work: Floats) -> None:
    """Set the density of the next steps, and note the failure if it is invalid."""
    if 0.0 < density < math.inf:
        work[DENSITY] = density
    else:
        note_missed(work)


@compiled(inline=True)
def move_density(work: Floats) -> None:
    """Advance z by half a step at the last rate, with a compensated sum."""
    increment = 0.5 * work[FIRST_STEP] * work[DENSITY_RATE] - work[DENSITY_ROUNDED_OFF]
    total = work[DENSITY] + increment
    work[DENSITY_ROUNDED_OFF] = (total - work[DENSITY]) - increment
    take_density(total, work)


def evaluate_density(t: float, x: Floats, v: Floats, work: Floats) -> float:
    """Return the density, with the failure noted if it is invalid."""
    n = x.size
    out = part(control_memory(n, work), 4 * n, 1)
    density_at(t, x, v, own_params(work), work, out)
    work[EVALUATIONS] += work[DEAR]
    if not 0.0 < out[0] < math.inf:
        work[TROUBLE] = UNFIT_DENSITY
        return 1.0
    return float(out[0])


def difference_density(t: float, x: Floats, v: Floats, params: Floats, work: Floats) -> float:
    """Return the rate of the logarithm of the density along the motion."""
    n, room = x.size, control_memory(x.size, work)
    there, v_there, rate, v_rate = (
        part(room, 0, n),
        part(room, n, v.size),
        part(room, 2 * n, n),
        part(room, 3 * n, v.size),
    )
    here = density_of(t, x, v, work)
    work[DENSITY_HERE] = here
    span = 0.5 * abs(work[FIRST_STEP]) * work[START_DENSITY] / here
    if has_part(VELOCITY, work):
        velocity_at(t, x, v, params, work, rate)
    else:
        for i in range(n):
            rate[i] = v[i]
    rates_of_v(t, x, v, params, work, v_rate)
    for i in range(n):
        there[i] = x[i] + span * rate[i]
    for i in range(v.size):
        v_there[i] = v[i] + span * v_rate[i]
    ahead = density_of(t + span, there, v_there, work)
    for i in range(n):
        there[i] = x[i] - span * rate[i]
    for i in range(v.size):
        v_there[i] = v[i] - span * v_rate[i]
    behind = density_of(t - span, there, v_there, work)
    return float((ahead - behind) / (2.0 * span * here))


def rates_left_out(t: float, x: Floats, v: Floats, params: Floats, work: Floats, out: Floats) -> None:
    """Set the rates of v to zero, for densities that do not depend on v."""
    for i in range(out.size):
        out[i] = 0.0


def rates_evaluated(t: float, x: Floats, v: Floats, params: Floats, work: Floats, out: Floats) -> None:
    """Write the rates of v, for densities that depend on it."""
    work[EVALUATIONS] += 1.0
    acceleration_at(t, x, v, params, work, out)


def measure_density(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Prepare the control: the density is that of the start, to which the first step belongs."""
    work[START_DENSITY] = density_of(t, x, v, work)
    work[DENSITY] = 1.0
    work[DENSITY_RATE] = rate_of_density(t, x, v, params, work)


def begin_density(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance z by half a step, at the rate from the last step."""
    move_density(work)


def end_density(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance z by half a step, at the rate at the end of the step."""
    work[DENSITY_RATE] = rate_of_density(t, x, v, params, work)
    move_density(work)
    off = work[DENSITY] * work[START_DENSITY] / work[DENSITY_HERE]
    if not 1.0 / _FARTHEST < off < _FARTHEST:
        note_missed(work)


def reflect_density(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Reflect z at the density in the middle of the step."""
    take_density(2.0 * density_of(t, x, v, work) / work[START_DENSITY] - work[DENSITY], work)
