"""Users' derivatives of forces with respect to velocity: the matrix, checked against differences at the start."""

from typing import Any

import numpy as np

from kickdrift.core.compilation import unbound
from kickdrift.core.elementwise import multiply
from kickdrift.core.errors import ArgumentError
from kickdrift.systems.problem import Adapted, Adapter, Floats, Function

_MOST_SHOWN = 12  # numbers of a velocity in a sentence

jacobian: Function = unbound


def adapt_velocity_jacobian(function: Any, force: Adapted, adapter: Adapter) -> Adapted:
    """Adapt a function that gives the derivatives of a force or acceleration, in rows, with respect to v.

    Raises
    ------
    ArgumentError
        If the force does not depend on v, or the function gives other derivatives than differences do, at the start or
        at another velocity.
    """
    if "v" not in force.names:
        raise ArgumentError("velocity_jacobian is given, but the force has no argument v; leave it out.")
    n = adapter.v0.size
    adapted = adapter.adapt(function, "velocity_jacobian", shape=(n, n))
    v = adapter.v0.reshape(-1)
    _check(adapted.function, force.function, adapter, v)
    # At rest, a wrong factor of a drag that is quadratic does not show.
    beside = v + np.random.default_rng(0).uniform(0.5, 1.0, n) * (np.abs(v).max() or 1.0)
    _check(adapted.function, force.function, adapter, beside)
    return adapted


def jacobian_divided_by_mass(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    """Write the derivatives of accelerations from those of forces; the inverse masses are the last params."""
    jacobian(t, x, v, params, out)
    n = x.size
    for i in range(n):
        multiply(out[i * n : (i + 1) * n], params[params.size - n + i])


def _check(function: Function, force: Function, adapter: Adapter, v: Floats) -> None:
    n, x = v.size, adapter.x0.reshape(-1)
    given = np.zeros(n * n)
    with np.errstate(all="ignore"):
        try:
            function(adapter.t0, x.copy(), v.copy(), adapter.args.copy(), given)
            expected, closer = (_differences(force, adapter, x, v, share) for share in (1.0, 0.5))
        except (ArithmeticError, ValueError):
            return  # a velocity may lie outside the domain of the force
    if not np.isfinite(expected).all():
        return
    tolerance = 1e-6 * abs(expected).max() + 10 * abs(expected - closer)
    wrong = ~(abs(given.reshape(n, n) - expected) <= tolerance)
    if wrong.any():
        i, j = (int(k) for k in np.argwhere(wrong)[0])
        place = f"v={v.tolist()!r}" if n <= _MOST_SHOWN else "the start"
        raise ArgumentError(
            f"velocity_jacobian: its entry ({i}, {j}) is {float(given[i * n + j])!r} where number {i} of the force"
            f" changes by {float(expected[i, j]):.9g} per unit of number {j} of v, at {place}. Correct it, or leave"
            " velocity_jacobian out to use finite differences."
        )


def _differences(force: Function, adapter: Adapter, x: Floats, v: Floats, share: float) -> Floats:
    """Central differences, over 6e-6, the cube root of rounding, of the size of v times a share."""
    columns = []
    for j in range(v.size):
        change = np.zeros_like(v)
        change[j] = 6e-6 * share * max(abs(v[j]), np.abs(v).max() or 1.0)
        ends = np.zeros((2, v.size))
        force(adapter.t0, x.copy(), v + change, adapter.args.copy(), ends[0])
        force(adapter.t0, x.copy(), v - change, adapter.args.copy(), ends[1])
        columns.append((ends[0] - ends[1]) / (2 * change[j]))
    return np.stack(columns, axis=1)
