"""Jacobi coordinates: each body relative to the centre of mass of those before it.

With M_i the mass of the bodies up to i, the Hamiltonian of N bodies is that of N - 1 Kepler problems with mu_i = G M_i,
of the free motion of the centre of mass (here body 0), and of the small remainder [1]_

    sum_(i > 1) G m_i M_(i-1) / |x'_i| - sum_(i > j, i > 1) G m_i m_j / |x_i - x_j|.

References
----------
.. [1] J. Wisdom, M. Holman, Astron. J. 102 (1991) 1528; masses as in H. Rein, D. Tamayo, Mon. Not. R. Astron. Soc. 452
   (2015) 376, section 2.
"""

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from numba import carray
from numpy.typing import NDArray

from kickdrift.core.compilation import Function, compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.systems import gravity
from kickdrift.systems.massless import FEW, add_gravity_of_massive, mostly_massless
from kickdrift.systems.splitting import Splitting, mus, planets, weights
from kickdrift.systems.system import Frame

Floats = NDArray[np.float64]
_FLOATS_OF_FEW = 3 * FEW


@compiled
def _of_few(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    position = carray(floats_on_stack(_FLOATS_OF_FEW), (_FLOATS_OF_FEW,))  # an array would cost 30 ns
    out[:] = 0.0
    locate(x, params, position)
    combine(x, params, position, True, out)


@compiled
def _of_many(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    position = np.empty(x.size)
    out[:] = 0.0
    locate(x, params, position)
    gravity.add_gravity_tiled(1.0, position[3:], planets(x.size, params), out[3:])
    combine(x, params, position, False, out)


@compiled
def _of_massless(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    position = np.empty(x.size)
    out[:] = 0.0
    locate(x, params, position)
    add_gravity_of_massive(1.0, position[3:], planets(x.size, params), out[3:])
    combine(x, params, position, False, out)


@compiled(cached=False, inline=True)
def locate(x: Floats, params: Floats, position: Floats) -> None:
    """Write where the bodies from 1 on are relative to body 0."""
    share = weights(x.size, params)
    cx = cy = cz = 0.0
    for i in range(1, x.size // 3):
        dx, dy, dz = x[3 * i], x[3 * i + 1], x[3 * i + 2]
        position[3 * i], position[3 * i + 1], position[3 * i + 2] = cx + dx, cy + dy, cz + dz
        cx, cy, cz = cx + share[i] * dx, cy + share[i] * dy, cz + share[i] * dz


@compiled(cached=False, inline=True)
def combine(x: Floats, params: Floats, position: Floats, pairs: bool, out: Floats) -> None:
    """Add the remainder to `out`, which has what the planets do to each other unless `pairs` are to be added, too.

    The attraction between the bodies 0 and 1 is in the Kepler problem of body 1, all of it. (In one loop: as three
    functions, `gravity` among them, it takes twice as long for 6 bodies.)
    """
    share, mu = weights(x.size, params), mus(x.size, params)
    cx = cy = cz = 0.0  # acceleration of body 0
    for i in range(2, x.size // 3):
        px, py, pz, gm = position[3 * i], position[3 * i + 1], position[3 * i + 2], params[2 + i]
        w = inverse_cube(px, py, pz)
        ax, ay, az = -params[2] * w * px, -params[2] * w * py, -params[2] * w * pz
        cx, cy, cz = cx + gm * w * px, cy + gm * w * py, cz + gm * w * pz
        for j in range(1, i if pairs else 1):
            dx, dy, dz = position[3 * j] - px, position[3 * j + 1] - py, position[3 * j + 2] - pz
            w = inverse_cube(dx, dy, dz)
            wi, wj = params[2 + j] * w, gm * w
            ax, ay, az = ax + wi * dx, ay + wi * dy, az + wi * dz
            out[3 * j] -= wj * dx
            out[3 * j + 1] -= wj * dy
            out[3 * j + 2] -= wj * dz
        out[3 * i] += ax
        out[3 * i + 1] += ay
        out[3 * i + 2] += az
    for i in range(1, x.size // 3):  # relative to the centre of mass of the bodies before
        ax, ay, az = out[3 * i] - cx, out[3 * i + 1] - cy, out[3 * i + 2] - cz
        cx, cy, cz = cx + share[i] * ax, cy + share[i] * ay, cz + share[i] * az
        dx, dy, dz = x[3 * i], x[3 * i + 1], x[3 * i + 2]
        w = mu[i] * inverse_cube(dx, dy, dz) if i > 1 else 0.0
        out[3 * i], out[3 * i + 1], out[3 * i + 2] = ax + w * dx, ay + w * dy, az + w * dz


@compiled(cached=False, inline=True)
def inverse_cube(x: float, y: float, z: float) -> float:
    """Return |x|^-3."""
    r2 = x * x + y * y + z * z
    return 1.0 / (r2 * math.sqrt(r2))


def _remainder(gm: Floats) -> Function:
    if mostly_massless(gm):
        return _of_massless
    return _of_few if gm.size <= FEW else _of_many


def _weights(gm: Floats) -> Floats:
    """m_i / M_i, 0 for body 0."""
    shares: Floats = gm / np.cumsum(gm)
    shares[0] = 0.0
    return shares


def _mu(gm: Floats) -> Floats:
    mu = np.cumsum(gm)
    mu[0] = 0.0
    return mu


def _frame(gm: Floats) -> Frame:
    shares = _weights(gm)
    return Frame(enter=partial(_both, _relative, shares), leave=partial(_both, _absolute, shares))


def _both(change: Callable[[Floats, Floats], Floats], shares: Floats, x: Floats, v: Floats) -> tuple[Floats, Floats]:
    return change(shares, x), change(shares, v)


def _relative(shares: Floats, x: Floats) -> Floats:
    out = np.empty_like(x)
    centre = x[..., 0, :]
    for i in range(1, shares.size):
        out[..., i, :] = x[..., i, :] - centre
        centre = centre + shares[i] * out[..., i, :]
    out[..., 0, :] = centre
    return out


def _absolute(shares: Floats, x: Floats) -> Floats:
    out = np.empty_like(x)
    centre = x[..., 0, :]
    for i in range(shares.size - 1, 0, -1):
        centre = centre - shares[i] * x[..., i, :]
        out[..., i, :] = centre + x[..., i, :]
    out[..., 0, :] = centre
    return out


JACOBI = Splitting(weights=_weights, mu=_mu, frame=_frame, remainder=_remainder, parts={})
