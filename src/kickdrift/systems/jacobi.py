"""Jacobi coordinates: each body relative to the centre of mass of those before it.

With M_i the mass of the bodies up to i, the Hamiltonian of N bodies is that of N - 1 Kepler problems with mu_i = G M_i, of
the free motion of the centre of mass (here body 0), and of the small remainder [1]_

    sum_(i > 1) G m_i M_(i-1) / |x'_i| - sum_(i > j, i > 1) G m_i m_j / |x_i - x_j|.

References
----------
.. [1] J. Wisdom, M. Holman, Astron. J. 102 (1991) 1528; masses as in H. Rein, D. Tamayo, Mon. Not. R. Astron. Soc. 452
   (2015) 376, section 2.
"""

import math
from functools import partial

import numpy as np
from numba import carray
from numpy.typing import NDArray

from kickdrift.core.compilation import Function, compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.systems import gravity
from kickdrift.systems.nbody import FEW
from kickdrift.systems.splitting import Splitting, mus, planets, weights
from kickdrift.systems.system import Frame

Floats = NDArray[np.float64]
_FLOATS_OF_FEW = 3 * FEW


@compiled(cached=False)
def _of_few(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    position = carray(floats_on_stack(_FLOATS_OF_FEW), (_FLOATS_OF_FEW,))[: x.size]  # an array would cost 30 ns
    locate(x, params, position)
    out[:] = 0.0
    gravity.add_gravity_pairwise(1.0, position[3:], planets(x.size, params), out[3:])
    finish(x, params, position, out)


@compiled(cached=False)
def _of_many(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    position = np.empty(x.size)
    locate(x, params, position)
    out[:] = 0.0
    gravity.add_gravity_tiled(1.0, position[3:], planets(x.size, params), out[3:])
    finish(x, params, position, out)


@compiled(cached=False)
def locate(x: Floats, params: Floats, position: Floats) -> None:
    """Write where the bodies are relative to body 0."""
    share = weights(x.size, params)
    position[:3] = 0.0
    cx = cy = cz = 0.0
    for i in range(1, x.size // 3):
        dx, dy, dz = x[3 * i], x[3 * i + 1], x[3 * i + 2]
        position[3 * i], position[3 * i + 1], position[3 * i + 2] = cx + dx, cy + dy, cz + dz
        cx, cy, cz = cx + share[i] * dx, cy + share[i] * dy, cz + share[i] * dz


@compiled(cached=False, fast=True)
def finish(x: Floats, params: Floats, position: Floats, out: Floats) -> None:
    """Turn the accelerations of the planets by each other into the remainder.

    The attraction between the bodies 0 and 1 is in the Kepler problem of body 1, all of it.
    """
    share, mu = weights(x.size, params), mus(x.size, params)
    cx = cy = cz = 0.0
    for i in range(2, x.size // 3):
        px, py, pz = position[3 * i], position[3 * i + 1], position[3 * i + 2]
        r2 = px * px + py * py + pz * pz
        w = 1.0 / (r2 * math.sqrt(r2))
        towards, back = params[2] * w, params[2 + i] * w
        out[3 * i] -= towards * px
        out[3 * i + 1] -= towards * py
        out[3 * i + 2] -= towards * pz
        cx, cy, cz = cx + back * px, cy + back * py, cz + back * pz
    for i in range(1, x.size // 3):  # relative to the centre of mass of the bodies before
        ax, ay, az = out[3 * i] - cx, out[3 * i + 1] - cy, out[3 * i + 2] - cz
        cx, cy, cz = cx + share[i] * ax, cy + share[i] * ay, cz + share[i] * az
        out[3 * i], out[3 * i + 1], out[3 * i + 2] = ax, ay, az
    for i in range(2, x.size // 3):
        dx, dy, dz = x[3 * i], x[3 * i + 1], x[3 * i + 2]
        r2 = dx * dx + dy * dy + dz * dz
        w = mu[i] / (r2 * math.sqrt(r2))
        out[3 * i] += w * dx
        out[3 * i + 1] += w * dy
        out[3 * i + 2] += w * dz


def _remainder(bodies: int) -> Function:
    return _of_few if bodies <= FEW else _of_many


def _weights(gm: Floats) -> Floats:
    """m_i / M_i, 0 for body 0."""
    shares = gm / np.cumsum(gm)
    shares[0] = 0.0
    return shares


def _mu(gm: Floats) -> Floats:
    mu = np.cumsum(gm)
    mu[0] = 0.0
    return mu


def _frame(gm: Floats) -> Frame:
    shares = _weights(gm)
    return Frame(
        enter=lambda x, v: (_relative(shares, x), _relative(shares, v)),
        leave=lambda x, v: (_absolute(shares, x), _absolute(shares, v)),
    )


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
