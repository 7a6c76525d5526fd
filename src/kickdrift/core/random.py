"""Random numbers that are functions of a seed and a place in the sequence, with nothing kept in between.

Philox4x64-10 turns a counter of four words and a key into four random words [1]_: the same numbers whoever asks for
them, in whatever order, on however many threads. Normal numbers are made of them by Box and Muller's transform, which
rejects nothing, so that each number has a fixed place.

References
----------
.. [1] J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, Parallel random numbers: as easy as 1, 2, 3, SC'11 (2011).
.. [2] G. E. P. Box, M. E. Muller, A note on the generation of random normal deviates, Ann. Math. Stat. 29 (1958) 610.
"""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled

Floats = NDArray[np.float64]
Words = NDArray[np.uint64]

_ROUNDS = 10
_MULTIPLIER_0, _MULTIPLIER_1 = np.uint64(0xD2E7470EE14C6C93), np.uint64(0xCA5A826395121157)
_BUMP_0, _BUMP_1 = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBB67AE8584CAA73B)

_HALF, _LOW = np.uint64(32), np.uint64(0xFFFFFFFF)
_ZERO, _ONE = np.uint64(0), np.uint64(1)
_EXCESS = np.uint64(11)  # bits of a word that a float64 has no room for
_SPACING = 2.0**-53


@compiled(inline=True)
def _high_product(a: np.uint64, b: np.uint64) -> np.uint64:
    """Upper word of the product of two words, in halves."""
    a_high, a_low, b_high, b_low = a >> _HALF, a & _LOW, b >> _HALF, b & _LOW
    middle = a_high * b_low + ((a_low * b_low) >> _HALF)
    other = a_low * b_high + (middle & _LOW)
    return a_high * b_high + (middle >> _HALF) + (other >> _HALF)


@compiled(inline=True)
def philox(
    c0: np.uint64, c1: np.uint64, c2: np.uint64, c3: np.uint64, k0: np.uint64, k1: np.uint64
) -> tuple[np.uint64, np.uint64, np.uint64, np.uint64]:
    """Return the four words of Philox4x64-10 for a counter and a key."""
    for _ in range(_ROUNDS):
        high_0, high_1 = _high_product(_MULTIPLIER_0, c0), _high_product(_MULTIPLIER_1, c2)
        c0, c1, c2, c3 = high_1 ^ c1 ^ k0, _MULTIPLIER_1 * c2, high_0 ^ c3 ^ k1, _MULTIPLIER_0 * c0
        k0, k1 = k0 + _BUMP_0, k1 + _BUMP_1
    return c0, c1, c2, c3


@compiled
def fill_normal(seed: np.uint64, draw: np.uint64, out: Floats) -> None:
    """Fill an array with independent normal numbers of mean 0 and variance 1: the draw of this number under a seed.

    The words behind draw d are the stream of ``numpy.random.Philox(key=seed, counter=[0, d, 0, 0])``, four for every
    four numbers.
    """
    block = _ZERO
    for start in range(0, out.size, 4):
        block += _ONE
        a, b, c, d = philox(block, draw, _ZERO, _ZERO, seed, _ZERO)
        _fill_pair(a, b, out[start : start + 2])
        if start + 2 < out.size:
            _fill_pair(c, d, out[start + 2 : start + 4])


@compiled(inline=True)
def _fill_pair(a: np.uint64, b: np.uint64, out: Floats) -> None:
    # The radius from (0, 1], so that its logarithm is finite: it is at most sqrt(2 * 53 ln 2) = 8.6.
    radius = math.sqrt(-2.0 * math.log(np.float64((a >> _EXCESS) + _ONE) * _SPACING))
    angle = 2.0 * math.pi * (np.float64(b >> _EXCESS) * _SPACING)
    out[0] = radius * math.cos(angle)
    if out.size > 1:
        out[1] = radius * math.sin(angle)
