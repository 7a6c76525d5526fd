"""Gravity where most bodies have no mass: they are attracted and do not attract, so that the cost grows with their number.

Arrays are as in `kickdrift.systems.gravity`. Bodies with mass meet in pairs or tiles, as they do there; those without are
copied into fields of their own, and each body with mass attracts a block of them at once.
"""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.views import part
from kickdrift.systems import gravity

Floats = NDArray[np.float64]
FEW = 31  # bodies up to which a loop over the pairs is faster than tiles (measured: even at 28)
_BLOCK = 256  # bodies without mass, whose positions and sums stay in the L1 cache
_FIELDS = 6


def mostly_massless(gm: Floats, threads: bool = False) -> bool:
    """Whether so many bodies have no mass that those with mass and those without are better summed apart.

    That is done on one core: with `threads`, the massive ones must be a sixteenth, so that no number of cores up to that
    would be faster. The number of threads must not decide, since bits depend on the order of the sums.
    """
    share = 16 if threads else 4
    return bool(gm.size > FEW and share * np.count_nonzero(gm) <= gm.size)


@compiled
def add_gravity_of_massive(h: float, x: Floats, params: Floats, into: Floats) -> None:
    """Add h times the acceleration to `into`, of bodies most of which have no mass."""
    bodies = params.size - 1
    massive = 0
    for i in range(bodies):
        massive += params[i + 1] != 0.0
    heavy, position, attracted = np.empty(massive + 1), np.empty(3 * massive), np.empty(3 * massive)
    heavy[0] = params[0]
    k = 0
    for i in range(bodies):
        if params[i + 1] != 0.0:
            heavy[k + 1] = params[i + 1]
            for axis in range(3):
                position[3 * k + axis], attracted[3 * k + axis] = x[3 * i + axis], 0.0
            k += 1
    if massive <= FEW:
        gravity.add_gravity_pairwise(h, position, heavy, attracted)
    else:
        gravity.add_gravity_tiled(h, position, heavy, attracted)
    _scatter_massive(attracted, params, into)
    _add_to_massless(h, x, params, position, heavy, into)


@compiled
def _scatter_massive(attracted: Floats, params: Floats, into: Floats) -> None:
    k = 0
    for i in range(params.size - 1):
        if params[i + 1] != 0.0:
            for axis in range(3):
                into[3 * i + axis] += attracted[3 * k + axis]
            k += 1


@compiled
def _add_to_massless(h: float, x: Floats, params: Floats, position: Floats, heavy: Floats, into: Floats) -> None:
    """Go through the bodies without mass, a block at a time."""
    block, bodies, i = np.empty(_FIELDS * _BLOCK), np.zeros(_BLOCK, dtype=np.int64), 0
    while i < params.size - 1:
        size = 0
        while i < params.size - 1 and size < _BLOCK:
            if params[i + 1] == 0.0:
                bodies[size] = i
                block[size], block[_BLOCK + size], block[2 * _BLOCK + size] = x[3 * i], x[3 * i + 1], x[3 * i + 2]
                size += 1
            i += 1
        _attract(heavy, position, block, size)
        for k in range(size):
            for axis in range(3):
                into[3 * bodies[k] + axis] += h * block[(3 + axis) * _BLOCK + k]


@compiled(fast=True)
def _attract(heavy: Floats, position: Floats, block: Floats, size: int) -> None:
    """Write the accelerations of a block: its last three fields."""
    x, y, z = part(block, 0, size), part(block, _BLOCK, size), part(block, 2 * _BLOCK, size)
    ax, ay, az = part(block, 3 * _BLOCK, size), part(block, 4 * _BLOCK, size), part(block, 5 * _BLOCK, size)
    for k in range(size):
        ax[k] = ay[k] = az[k] = 0.0
    for j in range(heavy.size - 1):
        px, py, pz, gm = position[3 * j], position[3 * j + 1], position[3 * j + 2], heavy[j + 1]
        for k in range(size):
            dx, dy, dz = px - x[k], py - y[k], pz - z[k]
            r2 = dx * dx + dy * dy + dz * dz + heavy[0]
            w = gm / (r2 * math.sqrt(r2))
            ax[k] += w * dx
            ay[k] += w * dy
            az[k] += w * dz
