"""Which bodies have merged, and when."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kickdrift.analysis.solutions import checked
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.dense import DenseOutput, States
from kickdrift.engine.solution import Solution

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_SPACINGS = 4.0  # of floats at the time


@dataclass(frozen=True)
class Merger:
    """Two bodies that became one.

    Attributes
    ----------
    t : float
        Time of the merger; for a solution that was read from a file, or whose steps vary and are not all kept, the time of
        the first row after it.
    bodies : (str, str)
        Names; a merged body has the name of its first member.
    energy_lost : float
        Kinetic energy of their relative motion. ``solution.energy`` loses it, and no longer counts their mutual potential
        energy, which is negative. NaN for such a solution.
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

    Returns
    -------
    tuple of Merger

    Raises
    ------
    ArgumentError
        For a solution of something else.

    Examples
    --------
    >>> import kickdrift as kd
    >>> x0, v0 = [[0, 0, 0], [1, 0, 0], [-1, 0, 0]], [[0, 0, 0], [0, 1, 0], [0, 1, 0]]
    >>> planets = kd.systems.planetary([1, 1e-3, 1e-3], x0, v0, radii=[0.01, 0.001, 0.001])
    >>> (one,) = kd.analysis.mergers(kd.solve(planets, (0.0, 2.0), step=0.2))
    >>> one.bodies, one.energy_lost > 0
    (('1', '2'), True)
    """
    plain = checked(solution).plain
    if not plain.about.gm or plain.x.ndim != 3 or len(plain.about.gm) != plain.x.shape[1]:
        raise ArgumentError(
            f"{plain!r} is not a run of bodies that attract each other; only kd.systems.planetary(..., radii=...) has"
            " mergers."
        )
    names = [str(name) for name in plain.about.coordinates["body"]]
    gm = np.array(plain.about.gm)
    scale = float(plain.energy[0]) / _energy(gm, plain.x[0], plain.v[0])  # 1 / G
    rows = plain if plain.dense is None else plain.dense
    found: list[Merger] = []
    for row in range(len(rows.t) - 1):
        for t, known, before, after in _between(rows, plain.dense, row):
            firsts = np.stack([_together(after.x), known], axis=1)
            lost = math.nan if plain.dense is None else scale * (_kinetic(gm, before.v) - _kinetic(gm, after.v))
            for one, other in sorted({(int(one), int(other)) for one, other in firsts if one != other}):
                found.append(Merger(t, (names[one], names[other]), lost))
    return tuple(found)


def _between(
    rows: Solution | DenseOutput, dense: DenseOutput | None, row: int
) -> Iterator[tuple[float, Integers, States, States]]:
    """Yield of each merger between two rows its time, who was one with whom before, and the states before and after it."""
    known, last = _together(rows.x[row]), States(rows.x[row + 1], rows.v[row + 1])
    if dense is not None:
        one = slice(row, row + 1)
        dense = replace(dense, t=dense.t[one], x=dense.x[one], v=dense.v[one], steps=dense.steps[one])
    while not np.array_equal(known, _together(last.x)):
        high, before, after = float(rows.t[row + 1]), States(rows.x[row], rows.v[row]), last
        if dense is not None:
            high, before, after, dense = _bisect(dense, len(np.unique(known)), high, last)
        yield high, known, before, after
        known = _together(after.x)


def _bisect(dense: DenseOutput, many: int, high: float, after: States) -> tuple[float, States, States, DenseOutput]:
    """Return when so many bodies become fewer, the states just before and after, and the output from a step before on."""
    low, step = float(dense.t[0]), float(dense.steps[0])
    before = States(dense.x[0], dense.v[0])
    while abs(high - low) > _SPACINGS * np.spacing(abs(high)):
        whole = 0 if dense.varies else round((high - float(dense.t[0])) / step)
        middle = float(dense.t[0]) + whole // 2 * step if whole > 1 else 0.5 * (low + high)
        try:
            states = dense(middle)
        except ArgumentError:  # steps whose sizes vary, of which some lie between two rows
            return high, States(before.x, np.full_like(before.v, math.nan)), after, dense
        if len(np.unique(_together(states.x))) < many:
            high, after = middle, states
            continue
        low, before = middle, states
        if whole > 1:  # the next ones from there
            dense = replace(dense, t=np.array([low]), x=states.x[None], v=states.v[None])
    return high, before, after, dense


def _only(dense: DenseOutput, row: int) -> DenseOutput:
    """Return the output that continues from one row."""
    one = slice(row, row + 1)
    return replace(dense, t=dense.t[one], x=dense.x[one], v=dense.v[one], steps=dense.steps[one])


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
