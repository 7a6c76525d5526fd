"""The multipliers of constraint forces along a solution."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.systems.constraints import INDEPENDENT, Constraints
from kickdrift.systems.system import System

Floats = NDArray[np.float64]
_ROWS = 1024  # at a time, for the memory


def evaluate(system: System, t: Floats, x: Floats, v: Floats) -> Floats:
    """Evaluate the multipliers lambda of a constrained system at each of T states.

    From g(x(t)) = 0, differentiated twice, with x'' = a - M^-1 G^T lambda and the tangent part of v, which is all of it
    except for `shake`::

        G M^-1 G^T lambda = G a + (derivative of G v along v)

    by differences: lambda is exact to some 1e-11 of its size with a Jacobian, 1e-8 without one. Where constraints are
    redundant it is the smallest, each measured by the length of its gradient.

    Returns
    -------
    (T, m) array
    """
    n = system.x0.size
    xs, vs = x.reshape(t.size, n), v.reshape(t.size, n)
    chunks = [slice(start, start + _ROWS) for start in range(0, t.size, _ROWS)]
    return np.concatenate([_of_rows(Constraints(system), t[rows], xs[rows], vs[rows]) for rows in chunks])


def constraint_acceleration(system: System, t: float, x: Floats, v: Floats) -> Floats:
    """Return the acceleration by the constraints at one state, shape (n,)."""
    constraints, multipliers = Constraints(system), evaluate(system, np.array([t]), x[None], v[None])[0]
    added: Floats = -constraints.inverse_masses * (multipliers @ constraints.jacobian(x))
    return added


def _of_rows(constraints: Constraints, t: Floats, xs: Floats, vs: Floats) -> Floats:
    root = np.sqrt(constraints.inverse_masses)
    rows, lengths = constraints.scaled(np.array([constraints.jacobian(x) for x in xs]))
    inverse = np.asarray(np.linalg.pinv(rows, rcond=INDEPENDENT), dtype=np.float64)
    tangent = vs - root * _times(inverse, _times(rows, vs / root))
    accelerations = np.zeros_like(xs)
    for i in range(t.size):
        constraints.system.acceleration(t[i], xs[i], tangent[i], constraints.system.params, accelerations[i])
    curvatures = np.array([constraints.curvature(x, v) for x, v in zip(xs, tangent, strict=True)])
    rates = _times(rows, accelerations / root) + curvatures / lengths
    return _times(np.swapaxes(inverse, 1, 2), _times(inverse, rates)) / lengths


def _times(matrices: Floats, vectors: Floats) -> Floats:
    product: Floats = np.einsum("tij,tj->ti", matrices, vectors)
    return product
