"""The exact flow of x'' = -omega^2 x, and kicks by filtered remaining forces.

Templates, see `kickdrift.engine.flows.kick_drift`. The angular frequencies are the last params. With xi = h omega, and h
the step of which a filtered kick does half, the kick is

    v += h/2 psi(xi) g(phi(xi) x),    phi = sinc^b,    psi = sinc^a (2/xi tan(xi/2))^c,

with the powers a, b, c from the coefficients of the method. (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd
ed., section XIII.2, where this psi is called psi_1.)

Layout of memory::

    0     half of the step to which the following filtered acceleration at x belongs; 0 if x has moved since
    1     CHANGES when it was evaluated
    8     that, or a change of x, or x filtered (n)
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.core.views import part
from kickdrift.engine.flows.layout import CHANGES, EVALUATIONS, change_of_v, coefficients_at, memory

Floats = NDArray[np.float64]
_HEAD = 8

acceleration_at: Callable[..., None] = unbound
add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound


def memory_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers."""
    return _HEAD + n


def oscillate(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Rotate x and v by the angle h omega."""
    n, own = x.size, memory(work)
    change, of_v = part(own, _HEAD, n), change_of_v(n, work)
    turn(h, part(params, params.size - n, n), x, v, change, of_v)
    add_to_x(x, 1.0, change, work)
    add_to_v(v, 1.0, of_v, work)
    own[0] = 0.0


def filtered_kick(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance v by h under the filtered acceleration, evaluated if x has changed."""
    n, own = x.size, memory(work)
    a, filtered = part(work, 0, n), part(own, _HEAD, n)
    if own[0] != h or own[1] != work[CHANGES]:
        powers, omega = part(work, coefficients_at(n), 3), part(params, params.size - n, n)
        inside(2.0 * h, omega, powers, x, filtered)
        acceleration_at(t, filtered, v, params, work, a)
        outside(2.0 * h, omega, powers, a)
        assign(filtered, a)  # a plain kick would overwrite it
        work[EVALUATIONS] += 1.0
        own[0], own[1] = h, work[CHANGES]
    add_to_v(v, h, filtered, work)


@compiled
def turn(h: float, omega: Floats, x: Floats, v: Floats, change: Floats, change_of_velocity: Floats) -> None:
    """Write the changes of x and v in h."""
    of, less, sine = 0.0, 0.0, h
    for k in range(x.size):
        if omega[k] != of:  # usually there are few frequencies: use the values of the last one
            of, half = omega[k], math.sin(0.5 * h * omega[k])
            less, sine = -2.0 * half * half, h * sinc(h * of)
        change[k] = less * x[k] + sine * v[k]
        change_of_velocity[k] = less * v[k] - of * of * sine * x[k]


@compiled
def inside(h: float, omega: Floats, powers: Floats, x: Floats, filtered: Floats) -> None:
    """Write phi x."""
    of, factor = 0.0, 1.0
    for k in range(x.size):
        if omega[k] != of:
            of, factor = omega[k], sinc(h * omega[k]) ** int(powers[1])
        filtered[k] = factor * x[k]


@compiled
def outside(h: float, omega: Floats, powers: Floats, a: Floats) -> None:
    """Multiply by psi."""
    of, factor = 0.0, 1.0
    for k in range(a.size):
        if omega[k] != of:
            of = omega[k]
            factor = sinc(h * of) ** int(powers[0])
            if powers[2] != 0.0 and of != 0.0:
                factor *= math.tan(0.5 * h * of) / (0.5 * h * of)
        a[k] *= factor


@compiled
def sinc(xi: float) -> float:
    """Return sin(xi) / xi."""
    return math.sin(xi) / xi if xi != 0.0 else 1.0
