"""Democratic heliocentric coordinates: positions relative to body 0, velocities relative to the centre of mass.

The Hamiltonian of N bodies is that of N - 1 Kepler problems with mu = G m_0, of the free motion of the centre of mass (here
body 0), of the attraction between the planets, and of |sum m_i v'_i|^2 / 2 m_0 for the motion of body 0 [1]_. The last two
commute: all planets jump by one vector. They are the remainder, the last as the part ``jump``.

References
----------
.. [1] M. Duncan, H. Levison, M. Lee, Astron. J. 116 (1998) 2067, section 2.
"""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import Function, compiled
from kickdrift.systems import gravity
from kickdrift.systems.massless import FEW, add_gravity_of_massive, mostly_massless
from kickdrift.systems.splitting import Splitting, planets, weights
from kickdrift.systems.system import Frame

Floats = NDArray[np.float64]


@compiled
def _of_few(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[:] = 0.0
    gravity.add_gravity_pairwise(1.0, x[3:], planets(x.size, params), out[3:])


@compiled
def _of_many(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[:] = 0.0
    gravity.add_gravity_tiled(1.0, x[3:], planets(x.size, params), out[3:])


@compiled
def _of_massless(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    out[:] = 0.0
    add_gravity_of_massive(1.0, x[3:], planets(x.size, params), out[3:])


@compiled
def _jump(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    share = weights(x.size, params)
    jx = jy = jz = 0.0
    for i in range(1, x.size // 3):
        jx, jy, jz = jx + share[i] * v[3 * i], jy + share[i] * v[3 * i + 1], jz + share[i] * v[3 * i + 2]
    out[:3] = 0.0
    for i in range(1, x.size // 3):
        out[3 * i], out[3 * i + 1], out[3 * i + 2] = jx, jy, jz


def _remainder(gm: Floats) -> Function:
    if mostly_massless(gm):
        return _of_massless
    return _of_few if gm.size <= FEW else _of_many


def _weights(gm: Floats) -> Floats:
    """m_i / m_0, 0 for body 0."""
    shares: Floats = gm / gm[0]
    shares[0] = 0.0
    return shares


def _mu(gm: Floats) -> Floats:
    mu = np.full(gm.size, gm[0])
    mu[0] = 0.0
    return mu


def _frame(gm: Floats) -> Frame:
    shares = (gm / gm.sum())[:, None]
    return Frame(partial(_enter, shares), partial(_leave, shares))


def _enter(shares: Floats, x: Floats, v: Floats) -> tuple[Floats, Floats]:
    xs, vs = x - x[..., :1, :], v - (shares * v).sum(axis=-2, keepdims=True)
    xs[..., 0, :], vs[..., 0, :] = (shares * x).sum(axis=-2), (shares * v).sum(axis=-2)
    return xs, vs


def _leave(shares: Floats, x: Floats, v: Floats) -> tuple[Floats, Floats]:
    first = x[..., :1, :] - (shares[1:] * x[..., 1:, :]).sum(axis=-2, keepdims=True)
    recoil = (shares[1:] / shares[0] * v[..., 1:, :]).sum(axis=-2)
    xs, vs = x + first, v + v[..., :1, :]
    xs[..., :1, :], vs[..., 0, :] = first, v[..., 0, :] - recoil
    return xs, vs


DEMOCRATIC_HELIOCENTRIC = Splitting(weights=_weights, mu=_mu, frame=_frame, remainder=_remainder, parts={"jump": _jump})
