"""Mass matrices that depend on the state: whether a run may start where they are positive definite."""

from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError

Floats = NDArray[np.float64]


def refuse_start(mass: FunctionType, size: int, t: float, x: Floats, v: Floats) -> None:
    """Refuse a start where the masses, the lower half of a matrix as a function of the state, are not positive definite."""
    given: dict[str, Any] = {"t": t, "x": x[()], "v": v[()], "out": np.zeros(size * (size + 1) // 2)}
    names = mass.__code__.co_varnames[: mass.__code__.co_argcount]
    returned = mass(**{name: given[name] for name in names})
    matrix = np.zeros((size, size))
    matrix[np.tril_indices(size)] = given["out"] if returned is None else returned
    least = np.linalg.eigvalsh(matrix).min() if np.isfinite(matrix).all() else 1.0
    if not least > 0.0:
        raise ArgumentError(
            f"lagrangian has a kinetic energy that is not positive definite at x0={x.tolist()!r}: the least eigenvalue"
            f" of its masses is {least:.3g} there. Start elsewhere, or check its signs."
        )
