"""Which bodies have merged, and when."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.engine.solution import Solution

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_MOST_BISECTIONS = 60
_SPACINGS = 4.0  # of floats at the time


@dataclass(frozen=True)
class Merger:
    """Two bodies that became one.

    Attributes
    ----------
    t : float
        When; of a solution that was read from a file, the time of the first row after it.
    bodies : (str, str)
        Names, of merged bodies that of their first.
    energy_lost : float
        Kinetic, of their motion relative to each other. ``solution.energy`` loses that, and no longer counts their
        attraction, which is negative.
    """

    t: float
    bodies: tuple[str, str]
    energy_lost: float


def mergers(solution: Solution) -> tuple[Merger, ...]:
    """Return the mergers of a solution, in the order of their times.

    Parameters
    ----------
    solution : Solution
        Of bodies with radii, see `kickdrift.systems.planetary`.

    Raises
    ------
    ArgumentError
        For a solution of something else.

    Examples
    --------
    >>> import kickdrift as kd
    >>> x0, v0 = [[0, 0, 0], [1, 0, 0], [-1, 0, 0]], [[0, 0, 0], [0, 1, 0], [0, 1, 0]]
    >>> planets = kd.systems.planetary([1, 1e-3, 1e-3], x0, v0, radii=[0.01, 0.001, 0.001])
    >>> one, = kd.analysis.mergers(kd.solve(planets, (0.0, 2.0), step=0.2))
    >>> one.bodies, one.energy_lost > 0
    (('1', '2'), True)
    """
    plain = solution.plain
    if not plain.about.gm or plain.x.ndim != 3 or len(plain.about.gm) != plain.x.shape[1]:
        raise ArgumentError(
            f"{plain!r} is no run of bodies that attract each other; mergers are those of kd.systems.planetary(..., radii=...)."
        )
    found: list[Merger] = []
    for row in range(len(plain.t) - 1):
        if not np.array_equal(_together(plain.x[row]), _together(plain.x[row + 1])):
            found += _between(plain, row)
    return tuple(found)


def _between(solution: Solution, row: int) -> list[Merger]:
    """Return the mergers between two rows, one after the other."""
    names = [str(name) for name in solution.about.coordinates["body"]]
    gm = np.array(solution.about.gm)
    scale = solution.energy[row] / _energy(gm, solution.x[row], solution.v[row])
    low, end, found = float(solution.t[row]), float(solution.t[row + 1]), []
    before = solution.x[row], solution.v[row]
    while not np.array_equal(_together(before[0]), _together(solution.x[row + 1])):
        high, after = end, (solution.x[row + 1], solution.v[row + 1])
        for _ in range(_MOST_BISECTIONS if solution.dense is not None else 0):
            middle = 0.5 * (low + high)
            if abs(high - low) <= _SPACINGS * np.spacing(abs(high)):
                break
            states = solution(middle)
            if np.array_equal(_together(states.x), _together(before[0])):
                low, before = middle, (states.x, states.v)
            else:
                high, after = middle, (states.x, states.v)
        lost = scale * (_kinetic(gm, before[1]) - _kinetic(gm, after[1]))
        firsts = np.stack([_together(after[0]), _together(before[0])], axis=1)
        for one, other in sorted({(int(one), int(other)) for one, other in firsts if one != other}):
            found.append(Merger(high, (names[one], names[other]), float(lost)))
        low, before = high, after
    return found


def _together(x: Floats) -> Integers:
    """Return of each body the first one of those that it is one with."""
    firsts: Integers = (x[:, None] == x).all(axis=-1).argmax(axis=1)
    return firsts


def _energy(gm: Floats, x: Floats, v: Floats) -> float:
    """G times the energy, without that of those that are one."""
    i, j = np.tril_indices(gm.size, -1)
    distances = np.linalg.norm(x[i] - x[j], axis=-1)
    apart = distances > 0.0
    return _kinetic(gm, v) - float((gm[i] * gm[j])[apart] @ (1.0 / distances[apart]))


def _kinetic(gm: Floats, v: Floats) -> float:
    return float(0.5 * (gm * (v**2).sum(axis=-1)).sum())
