"""The flow of Kepler's problem, x'' = -mu x / |x|^3, exact for every orbit and any step, and the jump.

Templates, see `kickdrift.engine.flows.kick_drift`. The state is bodies in space, or one body in the plane, and the last
params are mu for each of them; mu = 0 is free motion.

In universal variables [1]_ with dX = dt / |x| one formula serves ellipses, parabolas and hyperbolas. With
beta = 2 mu / r0 - v^2, eta = x . v, zeta = mu - beta r0 and the functions G_n(X) = X^n c_n(beta X^2) of Stumpff,

    h = r0 X + eta G_2 + zeta G_3,    r = dh/dX = r0 + eta G_1 + zeta G_2

is solved for X. Then x and v change by f x + g v and f' x + g' v with f = -mu G_2 / r0, g = r0 G_1 + eta G_2,
f' = -mu G_1 / (r0 r) and g' = -mu G_2 / r. (These are Gauss' functions less their values at h = 0:
compensated sums need differences.)

References
----------
.. [1] K. Stumpff, Himmelsmechanik I (1959); S. Mikkola, K. Innanen, Celest. Mech. Dyn. Astron. 74 (1999) 59;
   H. Rein, D. Tamayo, Mon. Not. R. Astron. Soc. 452 (2015) 376.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.engine.flows.layout import TROUBLE, change_of_v

Floats = NDArray[np.float64]

add_to_x: Callable[..., None] = unbound
add_to_v: Callable[..., None] = unbound
jump_at: Callable[..., None] = unbound

_C2 = tuple(1 / math.factorial(2 * k + 2) for k in range(8))  # c_n(z) = sum_k (-z)^k / (2 k + n)!
_C3 = tuple(1 / math.factorial(2 * k + 3) for k in range(8))
_SIXTH = 1 / 6
_SMALL = 0.25  # |beta X^2| up to which the series are summed: the first term left out is 3e-21 of the sum
_CLOSE = 1e-5  # how far the last correction may reach, in units of the length on which r changes
_MOST_ITERATIONS = 200
_BISECT_AFTER = 30
_LEAST_DISTANCE = 1e-14  # in units of the terms that make it up
_LARGEST_EXPONENT = 700.0  # of a hyperbola: exp(709) is the largest number


def kepler(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance each body by h around the centre of its force."""
    n = x.size
    size = 3 if n % 3 == 0 else 2
    dx, dv = work[:n], change_of_v(n, work)
    for body in range(n // size):
        mu, i = params[params.size - n // size + body], size * body
        x0, x1, x2 = x[i], x[i + 1], x[i + 2] if size == 3 else 0.0
        v0, v1, v2 = v[i], v[i + 1], v[i + 2] if size == 3 else 0.0
        f, g, df, dg = 0.0, h, 0.0, 0.0
        if mu != 0.0:
            f, g, df, dg, trouble = gauss_functions(
                mu, h, math.sqrt(x0 * x0 + x1 * x1 + x2 * x2), x0 * v0 + x1 * v1 + x2 * v2, v0 * v0 + v1 * v1 + v2 * v2
            )
            if trouble != 0.0:
                work[TROUBLE] = trouble
        dx[i], dx[i + 1] = f * x0 + g * v0, f * x1 + g * v1
        dv[i], dv[i + 1] = df * x0 + dg * v0, df * x1 + dg * v1
        if size == 3:
            dx[i + 2], dv[i + 2] = f * x2 + g * v2, df * x2 + dg * v2
    add_to_x(x, 1.0, dx, work)
    add_to_v(v, 1.0, dv, work)


def jump(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x by h at the rate that a split assigns to the kicks; their acceleration does not change."""
    rate = work[3 * x.size : 4 * x.size]
    jump_at(t, x, v, params, work, rate)
    add_to_x(x, h, rate, work)


@compiled(inline=True)
def stiefel_functions(beta: float, X: float) -> tuple[float, float, float, float]:
    """Return G_0 to G_3 of X: by series for a fraction of X, doubled until it is X, at least once.

    The constants of the series have errors of rounding that are the same in every step. Doubled, they hardly matter to
    G_1^2 = G_2 (2 - beta G_2), on which energy and angular momentum depend.
    """
    y, doublings = 0.5 * X, 1
    while abs(beta * y * y) > _SMALL and abs(y) < math.inf:  # halving infinity would never end
        y, doublings = 0.5 * y, doublings + 1
    z = beta * y * y
    zz = z * z
    c2 = (_C2[0] - z * _C2[1]) + zz * (_C2[2] - z * _C2[3])
    c2 += zz * zz * ((_C2[4] - z * _C2[5]) + zz * (_C2[6] - z * _C2[7]))
    c3 = (_C3[0] - z * _C3[1]) + zz * (_C3[2] - z * _C3[3])
    c3 += zz * zz * ((_C3[4] - z * _C3[5]) + zz * (_C3[6] - z * _C3[7]))
    g2, g3 = y * y * c2, y * y * y * c3
    g0, g1 = 1.0 - beta * g2, y - beta * g3
    for _ in range(doublings):
        g3 = 2.0 * (g3 + g1 * g2)
        g2, g1 = 2.0 * g1 * g1, 2.0 * g0 * g1
        g0 = 1.0 - beta * g2
    return g0, g1, g2, g3


@compiled(inline=True)
def gauss_functions(mu: float, h: float, r0: float, eta: float, v2: float) -> tuple[float, float, float, float, float]:
    """Return f, g, f', g', and zero unless the solution failed.

    X is close to the solution when the correction by Newton's method is small on the length over which r changes. Then
    the correction, and its effect on the G_n, follow from their Taylor series: a step that is short for the orbit
    takes one evaluation of the G_n.
    """
    inverse_r0 = 1.0 / r0 if r0 > 0.0 else math.inf
    beta = 2.0 * mu * inverse_r0 - v2
    if not abs(beta) < math.inf:
        return math.nan, math.nan, math.nan, math.nan, 0.0
    zeta = mu - beta * r0
    if beta > 0.0 and h * h * (beta * beta * beta) > math.pi**2 * mu * mu:  # half a period
        period = 2.0 * math.pi * mu / (beta * math.sqrt(beta))
        h -= period * np.rint(h / period)
    forwards = math.copysign(1.0, h)
    h, eta = abs(h), forwards * eta

    X, low, high = first_guess(mu, h, inverse_r0, eta, beta, zeta)
    delta, trouble = 0.0, 1.0
    for iteration in range(_MOST_ITERATIONS):
        g0, g1, g2, g3 = stiefel_functions(beta, X)
        left = (r0 * X - h) + eta * g2 + zeta * g3
        r = r0 + eta * g1 + zeta * g2
        slope = eta * g0 + zeta * g1
        if r > 0.0:
            inverse_r = 1.0 / r
            newton = -left * inverse_r
            curved = 0.5 * slope * inverse_r * newton
            bent = (zeta * g0 - beta * eta * g1) * inverse_r * newton * newton
            if abs(curved) < _CLOSE and abs(bent) < _CLOSE**2 and abs(beta) * newton * newton < _CLOSE**2:
                delta = newton * (1.0 - curved * (1.0 - 2.0 * curved) - _SIXTH * bent)
                trouble = 0.0
                break
        if left > 0.0:
            high = X
        else:
            low = X
        closer = next_guess(X, left, r, slope, low, high, iteration)
        if closer == X:  # low and high are neighbours
            trouble = 0.0
            break
        X = closer
    d2, d3 = 0.5 * delta * delta, _SIXTH * delta * delta * delta
    d1 = delta - beta * d3
    g2 += g1 * d1 + (1.0 - beta * g2) * d2
    g1 += g0 * d1 - beta * g1 * d2
    r = r0 + eta * g1 + zeta * g2
    if not r > _LEAST_DISTANCE * (r0 + abs(eta * g1) + abs(zeta * g2)):
        trouble = 1.0  # a collision: r is lost to rounding
    rate = -mu / r
    f, g = -mu * inverse_r0 * g2, r0 * g1 + eta * g2
    return f, forwards * g, forwards * rate * inverse_r0 * g1, rate * g2, trouble


@compiled(inline=True)
def first_guess(
    mu: float, h: float, inverse_r0: float, eta: float, beta: float, zeta: float
) -> tuple[float, float, float]:
    """Return the first X, a lower bound and an upper one."""
    straight, u, w = h * inverse_r0, eta * inverse_r0, zeta * inverse_r0
    turn, bend = u * straight, w * straight * straight
    high = math.inf
    if abs(turn) < 0.3 and abs(bend) < 0.1:
        return straight * (1.0 - 0.5 * turn * (1.0 - turn) - _SIXTH * bend), 0.0, high
    if beta > 0.0:
        high = 2.0 * math.pi / math.sqrt(beta)
        return h * beta / mu, 0.0, high
    mean = 6.0 * h / mu
    X = mean ** (1.0 / 3.0)
    if beta < 0.0:
        s = math.sqrt(-beta)
        high = _LARGEST_EXPONENT / s
        X = min(X, (1.0 + math.log1p(2.0 * h * s**3 / mu)) / s)
    return X, 0.0, high


@compiled(inline=True)
def next_guess(X: float, left: float, r: float, slope: float, low: float, high: float, iteration: int) -> float:
    """Return X after a step of Laguerre's method, or of bisection if that leaves the bracket or converges slowly."""
    root = math.sqrt(abs(16.0 * r * r - 20.0 * left * slope))
    if r + root > 0.0 and iteration < _BISECT_AFTER:
        closer = X - 5.0 * left / (r + root)
        if low < closer < high:
            return closer
    return 2.0 * X if high == math.inf else 0.5 * (low + high)
