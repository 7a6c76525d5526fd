"""Direct summation of Newtonian gravity: every pair of bodies, once.

Arrays are flat, shape (3 N,), body i at ``x[3*i:3*i+3]``; ``params = [softening**2, Gm_0, ..., Gm_{N-1}]``. Body i has
the softened acceleration [1]_ ``sum_j Gm_j (x_j - x_i) / (r**2 + softening**2)**1.5``. Units are the caller's, with
distances from 1e-100 to 1e100. Without softening, two bodies in one place get accelerations that are not finite.

Three kernels add ``h`` times the acceleration to an array: a kick, or with h = 1 the acceleration. For up to 30 bodies
`add_gravity_pairwise` is the fastest. `add_gravity_tiled` copies bodies into tiles, structures of arrays at constant
offsets: fields cannot overlap, and loops vectorise. `add_gravity_threaded` shares the tiles out to threads, in groups
that sit in a ring: each meets itself and the groups on the half of the ring ahead of it, with sums of its own for every
group it meets. These are added up at the end. The number of bodies alone fixes the groups and the order of every sum,
so the bits are the same for any number of threads.

References
----------
.. [1] S. J. Aarseth, Dynamical evolution of clusters of galaxies I, Mon. Not. R. Astron. Soc. 126 (1963) 223.
.. [2] M. Robertson, A brief history of InvSqrt, thesis, University of New Brunswick (2012).
"""

import math

import numpy as np
from numba import prange
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled

Floats = NDArray[np.float64]

# Bodies in a tile, at most: all tiles hold the same number to a vector, so that threads have the same work to do.
TILE = 128
_X, _Y, _Z, _GM, _TILE_SIZE = (TILE * field for field in range(5))
_SUMS_SIZE = 3 * TILE

# Groups of tiles, at most: as many threads can be busy. One parallel region with 1000 bodies in 8 groups is 1.88 times
# as fast on two threads, the 7 rounds of a tournament of tiles 1.80 times. 32 groups have twice the sums to add up: a
# serial evaluation of 10,000 bodies takes 2 % longer.
_MOST_GROUPS = 16

# Columns come in multiples of the float64 lanes of the widest vector registers, filled up with massless bodies far
# away: with a scalar loop over the 7 left over instead, N = 255 takes 19 % longer.
_LANES = 8
_FAR_AWAY = 1e100

# The bits of a float64 are about its logarithm: _SEED - bits/2 are the bits of 1/sqrt to 3.5 % [2].
_SEED = np.uint64(0x5FE6EB50C7B537A9)


@compiled(fast=True)
def add_gravity_pairwise(h: float, x: Floats, params: Floats, into: Floats) -> None:
    """Add h times the acceleration to `into`, which shares no memory with `x`: for a few bodies."""
    # Columns j < i, because a loop from 0 is vectorised as soon as it is long enough (N = 16: 1.6 times the speed).
    for i in range(1, params.size - 1):
        xi, yi, zi, gmi = x[3 * i], x[3 * i + 1], x[3 * i + 2], params[i + 1]
        ax = ay = az = 0.0
        for j in range(i):
            dx, dy, dz = x[3 * j] - xi, x[3 * j + 1] - yi, x[3 * j + 2] - zi
            r2 = dx * dx + dy * dy + dz * dz + params[0]
            w = h / (r2 * math.sqrt(r2))
            wi, wj = params[j + 1] * w, gmi * w
            ax, ay, az = ax + wi * dx, ay + wi * dy, az + wi * dz
            _add(into, 3 * j, 1, -wj * dx, -wj * dy, -wj * dz)
        _add(into, 3 * i, 1, ax, ay, az)


@compiled(fast=True)
def _add(array: Floats, at: int, stride: int, x: float, y: float, z: float) -> None:
    array[at] += x
    array[at + stride] += y
    array[at + 2 * stride] += z


@compiled
def add_gravity_tiled(h: float, x: Floats, params: Floats, into: Floats) -> None:
    """Add h times the acceleration to `into`, tile by tile: for many bodies."""
    tiles, sums = _packed(x, params)
    for group in range(len(sums)):
        _sum_half_ring(group, tiles, sums, params)
    _add_accelerations(h, sums, params, into)


@compiled(parallel=True)
def add_gravity_threaded(h: float, x: Floats, params: Floats, into: Floats) -> None:
    """Add h times the acceleration to `into` on Numba's threads, with the bits of `add_gravity_tiled`."""
    tiles, sums = _packed(x, params)
    for group in prange(len(sums)):
        _sum_half_ring(group, tiles, sums, params)
    _add_accelerations(h, sums, params, into)


@compiled
def _sum_half_ring(group: int, tiles: Floats, sums: Floats, params: Floats) -> None:
    groups, _, share, _ = sums.shape
    mine = sums[group]
    mine[:] = 0.0
    for step in range(_groups_ahead(group, groups) + 1):
        for p in range(share):
            i = group * share + p
            _, size_i = _members(i, len(tiles), params)
            if step == 0:
                _within_tile(tiles[i], mine[0, p], size_i, params[0])
            for q in range(share if step > 0 else p):
                j = (group + step) % groups * share + q
                _, size_j = _members(j, len(tiles), params)
                _between_tiles(tiles[i], tiles[j], mine[0, p], mine[step, q], size_i, size_j, params[0])


@compiled
def _groups_ahead(group: int, groups: int) -> int:
    # The number is even, or 1. Of two opposite groups one meets the other, on each half of the ring every second one.
    half = groups // 2
    side, place = divmod(group, max(half, 1))
    return half - (side + place) % 2


@compiled(fast=True)
def _between_tiles(
    a: Floats, b: Floats, sums_a: Floats, sums_b: Floats, size_a: int, size_b: int, softening2: float
) -> None:
    # Two rows at once, one by root and division, one by Newton's method: the divider and the multipliers work at the
    # same time. 2.40e9 interactions/s; both by root and division 2.03e9, both by Newton's method 2.12e9.
    for i in range(0, size_a, 2):
        k = i + 1  # a body without mass if the size is odd
        xi, yi, zi, gmi = a[_X + i], a[_Y + i], a[_Z + i], a[_GM + i]
        xk, yk, zk, gmk = a[_X + k], a[_Y + k], a[_Z + k], a[_GM + k]
        axi = ayi = azi = axk = ayk = azk = 0.0
        for j in range(_whole_vectors(size_b)):
            xj, yj, zj, gmj = b[_X + j], b[_Y + j], b[_Z + j], b[_GM + j]
            dxi, dyi, dzi = xj - xi, yj - yi, zj - zi
            dxk, dyk, dzk = xj - xk, yj - yk, zj - zk
            r2 = dxi * dxi + dyi * dyi + dzi * dzi + softening2
            w = 1.0 / (r2 * math.sqrt(r2))
            wi, wji = gmj * w, gmi * w
            w = _inverse_cube(dxk * dxk + dyk * dyk + dzk * dzk + softening2)
            wk, wjk = gmj * w, gmk * w
            axi, ayi, azi = axi + wi * dxi, ayi + wi * dyi, azi + wi * dzi
            axk, ayk, azk = axk + wk * dxk, ayk + wk * dyk, azk + wk * dzk
            _add(sums_b, _X + j, TILE, -wji * dxi - wjk * dxk, -wji * dyi - wjk * dyk, -wji * dzi - wjk * dzk)
        _add(sums_a, _X + i, TILE, axi, ayi, azi)
        _add(sums_a, _X + k, TILE, axk, ayk, azk)


@compiled(fast=True)
def _inverse_cube(r2: float) -> float:
    """r2**-1.5 to rounding by products alone; not finite where r2 is zero, infinite or not a number."""
    y = np.uint64(_SEED - (np.float64(r2).view(np.uint64) >> np.uint64(1))).view(np.float64)
    # With e = 1 - r2 y**2, 1/sqrt(r2) = y (1 - e)**-0.5. The quadratic is within 2.5e-5 of that for |e| < 0.07, the
    # range the seed leaves. Then |e| < 5e-5, and three terms of (1 - e)**-1.5 leave an error of 2e-17.
    e = 1.0 - r2 * (y * y)
    y *= 1.00000021 + e * (0.50109592 + e * 0.3755022)
    e = 1.0 - r2 * (y * y)
    cube = y * y * y
    return cube + (cube * e) * (1.5 + e * (1.875 + e * 2.1875))


@compiled(fast=True)
def _within_tile(tile: Floats, sums: Floats, size: int, softening2: float) -> None:
    for i in range(size):
        xi, yi, zi, gmi = tile[_X + i], tile[_Y + i], tile[_Z + i], tile[_GM + i]
        ax = ay = az = 0.0
        # Columns j > i, from the vector that holds i. Masked by index: a mask on r2 == 0 would hide coincident bodies.
        lane = i % _LANES
        rest, sums_rest = tile[i - lane :], sums[i - lane :]
        for j in range(_whole_vectors(size) - i + lane):
            dx, dy, dz = rest[_X + j] - xi, rest[_Y + j] - yi, rest[_Z + j] - zi
            r2 = dx * dx + dy * dy + dz * dz + softening2 if j > lane else np.inf
            w = 1.0 / (r2 * math.sqrt(r2))
            wi, wj = rest[_GM + j] * w, gmi * w
            ax, ay, az = ax + wi * dx, ay + wi * dy, az + wi * dz
            _add(sums_rest, _X + j, TILE, -wj * dx, -wj * dy, -wj * dz)
        _add(sums, _X + i, TILE, ax, ay, az)


@compiled
def _whole_vectors(size: int) -> int:
    return -(-size // _LANES) * _LANES


@compiled
def _members(tile: int, tiles: int, params: Floats) -> tuple[int, int]:
    """First body and number of bodies of a tile."""
    bodies = params.size - 1
    vectors = _whole_vectors(bodies) // _LANES
    start = tile * vectors // tiles * _LANES
    return start, min((tile + 1) * vectors // tiles * _LANES, bodies) - start


@compiled
def _packed(x: Floats, params: Floats) -> tuple[Floats, Floats]:
    full = -(-(params.size - 1) // TILE)
    groups = min(full + full % 2, _MOST_GROUPS) if full > 1 else 1
    share = -(-full // groups)
    tiles = np.zeros((groups * share, _TILE_SIZE))
    for t in range(len(tiles)):
        tile, (start, size) = tiles[t], _members(t, len(tiles), params)
        for i in range(size):
            _add(tile, i, TILE, x[3 * (start + i)], x[3 * (start + i) + 1], x[3 * (start + i) + 2])
            tile[_GM + i] = params[start + i + 1]
        tile[size : _whole_vectors(size)] = _FAR_AWAY
    return tiles, np.empty((groups, groups // 2 + 1, share, _SUMS_SIZE))


@compiled
def _add_accelerations(h: float, sums: Floats, params: Floats, into: Floats) -> None:
    groups, steps, share, _ = sums.shape
    for group in range(groups):
        total = sums[group, 0]
        for step in range(1, steps):
            total += sums[(group - step) % groups, step]
        for p in range(share):
            start, size = _members(group * share + p, groups * share, params)
            for i in range(size):
                _add(into, 3 * (start + i), 1, h * total[p, _X + i], h * total[p, _Y + i], h * total[p, _Z + i])


@compiled
def energy(x: Floats, v: Floats, params: Floats, G: float) -> float:
    """Kinetic and potential energy, masses Gm/G; rows of pairs are summed plainly, their sums with compensation."""
    total = lost = 0.0
    for i in range(params.size - 1):
        speed2 = v[3 * i] ** 2 + v[3 * i + 1] ** 2 + v[3 * i + 2] ** 2
        term = params[i + 1] * (0.5 * speed2 - _potential(i, x, params)) - lost
        total, lost = total + term, (total + term - total) - term
    return total / G


@compiled(fast=True)
def _potential(i: int, x: Floats, params: Floats) -> float:
    potential = 0.0
    for j in range(i):
        dx, dy, dz = x[3 * j] - x[3 * i], x[3 * j + 1] - x[3 * i + 1], x[3 * j + 2] - x[3 * i + 2]
        potential += params[j + 1] / math.sqrt(dx * dx + dy * dy + dz * dz + params[0])
    return potential


@compiled
def momentum(x: Floats, v: Floats, params: Floats, G: float, out: Floats) -> None:
    """Write the total momentum, shape (3,), masses Gm/G."""
    out[:] = 0.0
    for i in range(params.size - 1):
        m = params[i + 1] / G
        _add(out, 0, 1, m * v[3 * i], m * v[3 * i + 1], m * v[3 * i + 2])


@compiled
def angular_momentum(x: Floats, v: Floats, params: Floats, G: float, out: Floats) -> None:
    """Write the total angular momentum about the origin, shape (3,), masses Gm/G."""
    out[:] = 0.0
    for i in range(params.size - 1):
        m = params[i + 1] / G
        rx, ry, rz, vx, vy, vz = x[3 * i], x[3 * i + 1], x[3 * i + 2], v[3 * i], v[3 * i + 1], v[3 * i + 2]
        _add(out, 0, 1, m * (ry * vz - rz * vy), m * (rz * vx - rx * vz), m * (rx * vy - ry * vx))
