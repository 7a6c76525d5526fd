"""Whether constraints, their Jacobian and a start fit together: looked at once, before any step."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.systems.constraints import INDEPENDENT, Constraints

Floats = NDArray[np.float64]
_REDUNDANT = 1e-9  # a singular value beside the largest that is rounding
_MOST_SHOWN = 12  # numbers of a state in a sentence


def check(constraints: Constraints, x: Floats, v: Floats) -> None:
    """Refuse a wrong Jacobian, a start that violates the constraints, and constraints that no forces can keep.

    Raises
    ------
    ArgumentError
    """
    g, G = constraints.values(x), constraints.jacobian(x)
    if not (np.isfinite(g).all() and np.isfinite(G).all()):
        raise ArgumentError(
            f"constraint: its values {g.tolist()!r} at x0 or their derivatives are not finite; rewrite it, for example"
            " with squared distances instead of distances."
        )
    beside = x + np.random.default_rng(0).uniform(-0.01, 0.01, x.size) * constraints.length(x)
    if constraints.has_jacobian:
        _check_jacobian(constraints, x)
        _check_jacobian(constraints, beside)
    _check_positions(constraints, x, g)
    _check_gradients(constraints, G, constraints.jacobian(beside))
    _check_rank(constraints, x, G)
    _check_velocities(constraints, v, G)


def _check_jacobian(constraints: Constraints, x: Floats) -> None:
    given, expected, closer = constraints.jacobian(x), constraints.differences(x), constraints.differences(x, 0.5)
    if not np.isfinite(expected).all():
        return  # a displaced point may lie outside the domain of the constraint
    sizes = abs(expected).max(axis=1, keepdims=True)
    tolerance = 1e-6 * sizes + 1e-9 * sizes.max() + 10 * abs(expected - closer)
    wrong = ~(abs(given - expected) <= tolerance)
    if wrong.any():
        i, j = (int(k) for k in np.argwhere(wrong)[0])
        place = (i, *(int(k) for k in np.unravel_index(j, constraints.system.x0.shape)))
        raise ArgumentError(
            f"jacobian: its entry {place} is {float(given[i, j])!r} at {_shown('x', x, constraints)}, where constraint"
            f" {i} changes by {float(expected[i, j]):.9g} per unit of x[{', '.join(map(str, place[1:]))}]. Correct it,"
            " or leave jacobian out to use finite differences."
        )


def _check_positions(constraints: Constraints, x: Floats, g: Floats) -> None:
    off = constraints.violated(x)
    if not off.any():
        return
    i = int(np.argmax(np.where(off, abs(g), 0.0)))
    nearest = constraints.nearest(x)
    remedy = "no position near it satisfies them, so check the constraint"
    if nearest is not None:
        remedy = f"move it by at most {abs(nearest - x).max():.3g}, to {_shown('x0', nearest, constraints)}"
    raise ArgumentError(f"x0 violates the constraints: constraint {i} is {float(g[i]):.3g} there, not 0; {remedy}.")


def _check_gradients(constraints: Constraints, G: Floats, beside: Floats) -> None:
    flat = abs(G).max(axis=1) <= INDEPENDENT * abs(beside).max(axis=1)
    if flat.any():
        rank = _rank(constraints, np.where(flat[:, None], 0.0, G))
        raise ArgumentError(
            f"constraint {int(np.argmax(flat))} does not change to first order at x0, so that no force can enforce it:"
            f" of {constraints.count} constraints, the rank found is {rank}. Rewrite it so that its derivative is not"
            " zero where it holds, such as g instead of g**2."
        )


def _check_rank(constraints: Constraints, x: Floats, G: Floats) -> None:
    m = constraints.count
    _, sizes, directions = np.linalg.svd(constraints.scaled(G)[0])
    shares = sizes / sizes[0]
    rank = int((shares > INDEPENDENT).sum())
    if (shares[rank:] > _REDUNDANT).any():
        raise ArgumentError(
            f"constraint: at x0 the {m} constraints are nearly dependent (the rank found is {rank}, and the next"
            f" singular value is {shares[rank]:.1e} of the largest), so that rounding errors would determine the"
            " forces; leave out the redundant ones, or start elsewhere."
        )
    if rank < min(m, x.size):
        _check_redundancy(constraints, x, directions[rank:], rank)


def _check_redundancy(constraints: Constraints, x: Floats, free: Floats, rank: int) -> None:
    """Refuse a singular configuration: redundant constraints are redundant nearby, too."""
    direction = np.sqrt(constraints.inverse_masses) * (np.random.default_rng(0).uniform(0.5, 1, len(free)) @ free)
    nearby = constraints.nearest(x + 0.01 * constraints.length(x) * direction / abs(direction).max())
    rank_there = None if nearby is None else _rank(constraints, constraints.jacobian(nearby))
    if rank_there != rank:
        found = "no position nearby satisfies all" if rank_there is None else f"{rank_there} are nearby"
        raise ArgumentError(
            f"constraint: of {constraints.count} constraints, the rank found at x0 is {rank}, but {found}: a singular"
            " configuration, where the constraints do not determine the motion; start next to it."
        )


def _rank(constraints: Constraints, G: Floats) -> int:
    sizes = np.linalg.svd(constraints.scaled(G)[0], compute_uv=False)
    return int((sizes > INDEPENDENT * sizes[0]).sum())


def _check_velocities(constraints: Constraints, v: Floats, G: Floats) -> None:
    rounding = 1e-12 if constraints.has_jacobian else 1e-10
    rates = G @ v
    off = abs(rates) > rounding * abs(G).sum(axis=1) * abs(v).max()
    if off.any():
        i, nearest = int(np.argmax(np.where(off, abs(rates), 0.0))), v - constraints.normal(G, rates)
        raise ArgumentError(
            f"v0 violates the constraints: constraint {i} changes at a rate of {float(rates[i]):.3g}, not 0; change v0"
            f" by at most {abs(nearest - v).max():.3g}, to {_shown('v0', nearest, constraints)}."
        )


def _shown(name: str, numbers: Floats, constraints: Constraints) -> str:
    if numbers.size > _MOST_SHOWN:
        return "the nearest that does not" if name == "v0" else "the nearest that does" if name == "x0" else "a start"
    return f"{name}={numbers.reshape(constraints.system.x0.shape).tolist()!r}"
