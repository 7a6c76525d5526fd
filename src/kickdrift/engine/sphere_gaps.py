"""Gaps between spheres, for impacts of many bodies on each other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.arguments import reals
from kickdrift.core.errors import ArgumentError


def sphere_gaps(radii: ArrayLike) -> Callable[..., Any]:
    """Return the gaps between all pairs of spheres, for `Impacts` of states (N, d).

    Parameters
    ----------
    radii : (N,) array_like
        Positive.

    Returns
    -------
    callable
        ``gap(x)`` returns N (N - 1) / 2 numbers.

    Raises
    ------
    ArgumentError
        If `radii` is not a list of positive numbers.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> disks = kd.Impacts(kd.sphere_gaps([0.5, 0.5]), restitution=1.0)
    >>> still = lambda x: np.zeros((2, 2))
    >>> start = [[0, 0], [2, 0]], [[1, 0], [0, 0]]
    >>> options = {"step": 0.1, "method": "velocity-verlet", "compile": False}
    >>> sol = kd.solve(still, (0.0, 2.0), *start, impacts=disks, **options)
    >>> sol.v[-1].round(12)
    array([[0., 0.],
           [1., 0.]])
    """
    try:
        sizes = reals(radii)
    except TypeError as error:
        raise ArgumentError(f"radii={radii!r} must be numbers: {error}.") from None
    if sizes.ndim != 1 or sizes.size < 2 or not (np.isfinite(sizes) & (sizes > 0)).all():
        raise ArgumentError(f"radii={radii!r} must be at least two positive numbers.")

    def gap(x):  # type: ignore[no-untyped-def]
        gaps, row = np.empty(len(x) * (len(x) - 1) // 2), 0
        for i in range(len(x)):
            for j in range(i):
                square = 0.0
                for k in range(x.shape[1]):
                    square += (x[i, k] - x[j, k]) ** 2
                gaps[row] = np.sqrt(square) - sizes[i] - sizes[j]
                row += 1
        return gaps

    return gap
