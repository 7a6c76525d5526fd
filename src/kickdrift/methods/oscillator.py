"""The order of kicks and drifts on the harmonic oscillator, which bounds that on everything else."""

import math
from collections.abc import Iterable
from itertools import zip_longest

_ROUNDING = 1e-9  # of coefficients with so many digits, over some thirty kicks and drifts

_Row = tuple[list[float], list[float]]  # of a matrix: two power series in h


def order_on_oscillator(moves: Iterable[tuple[bool, float]], most: int) -> int:
    """Return the order of a step, or `most` if it has that.

    Parameters
    ----------
    moves : iterable of (bool, float)
        Drifts (True) and kicks of x'' = -x, first to last, each with its share of the step.
    most : int
    """
    x: _Row = ([1.0], [0.0])
    v: _Row = ([0.0], [1.0])
    for is_drift, share in moves:
        x, v = (_advanced(x, v, share), v) if is_drift else (x, _advanced(v, x, -share))
    for power in range(most + 1):
        size = (-1.0) ** (power // 2) / math.factorial(power)
        rotation = (size, 0.0, 0.0, size) if power % 2 == 0 else (0.0, size, -size, 0.0)
        found = [series[power] if power < len(series) else 0.0 for series in (*x, *v)]
        if max(abs(a - b) for a, b in zip(found, rotation, strict=True)) > _ROUNDING:
            return power - 1
    return most


def _advanced(row: _Row, by: _Row, share: float) -> _Row:
    """Add h times a share of one row to another."""
    first, second = (
        [a + share * b for a, b in zip_longest(one, [0.0, *other], fillvalue=0.0)]
        for one, other in zip(row, by, strict=True)
    )
    return first, second
