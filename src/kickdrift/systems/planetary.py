"""Planets around a heavy body, split into Kepler problems and small perturbations."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core import units
from kickdrift.core.arguments import reals
from kickdrift.core.compilation import Function, compiled, specialise, unbound
from kickdrift.core.errors import ArgumentError, unknown_name
from kickdrift.core.kinds import Kind
from kickdrift.systems.heliocentric import DEMOCRATIC_HELIOCENTRIC
from kickdrift.systems.jacobi import JACOBI
from kickdrift.systems.nbody import nbody
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]

function: Function = unbound

_SPLITTINGS = {"jacobi": JACOBI, "democratic-heliocentric": DEMOCRATIC_HELIOCENTRIC}


def planetary(
    masses: ArrayLike,
    x0: ArrayLike,
    v0: ArrayLike,
    G: float = 1.0,
    splitting: str = "jacobi",
    names: Sequence[str] | None = None,
    radii: ArrayLike | None = None,
) -> System:
    """Create a system of light bodies around a heavy one, the first; the state has shape (N, 3).

    It is `nbody` with a splitting: methods such as ``"wisdom-holman"`` and ``"blanes-aba-1064"`` solve the Kepler problems
    exactly, so that their errors are smaller by the ratio of the planets' masses to that of the first body.
    ``"close-encounters"`` is for planets that have close encounters with each other or the first body. All other methods run
    as on `nbody`, and the states are those of `nbody` in any case.

    Parameters
    ----------
    masses : (N,) array_like
        Masses, at least 0, the first the largest.
    x0, v0 : (N, 3) array_like
        Positions and velocities, in any inertial frame.
    G : float
        Gravitational constant, in the units of the other arguments.
    splitting : str
        The choice of Kepler problems: ``"jacobi"``, for bodies listed in order of distance, with the smaller perturbations;
        or ``"democratic-heliocentric"``, where the order does not matter, and orbits may cross.
    names : sequence of str, optional
        Names of the bodies.
    radii : (N,) array_like, optional
        Radii of the bodies, at least 0: they merge on contact, and the method is ``"close-encounters"``. Merged bodies keep
        their masses and move together from then on, with the velocity of their centre of mass and the sum of their volumes;
        `kickdrift.analysis.mergers` lists the mergers, their times and the kinetic energy lost.

    Returns
    -------
    System

    Raises
    ------
    ArgumentError
        As for `nbody`, and for fewer than two bodies, a first one that is not the heaviest, one at the position of the
        first, or bodies that overlap.
    UnknownNameError
        For an unknown splitting.

    Examples
    --------
    >>> import kickdrift as kd
    >>> x0, v0 = [[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 0, 0], [0, 1, 0], [-0.7, 0, 0]]
    >>> system = kd.systems.planetary([1, 1e-3, 1e-3], x0, v0)
    >>> sol = kd.solve(system, (0.0, 100.0), step=0.1, method="wisdom-holman")
    >>> bool(abs(sol.energy / sol.energy[0] - 1).max() < 1e-5)
    True
    """
    if splitting not in _SPLITTINGS:
        raise unknown_name("splitting", splitting, _SPLITTINGS)
    system = nbody(masses, x0, v0, G, names=names)
    chosen, gm = _SPLITTINGS[splitting], system.params[2:]
    if gm.size < 2:
        raise ArgumentError(f"masses has {gm.size} body; a planetary system has at least two.")
    if not gm[0] > 0 or gm.argmax() != 0:
        raise ArgumentError(
            f"masses[{int(gm.argmax())}] is the largest, or all are 0; put the heaviest body first, since the others"
            " orbit it."
        )
    sizes, quantities = None, system.quantities
    if radii is not None:
        sizes, quantities = _sizes(radii, system), {**quantities, "energy": Quantity(_energy_of_merged)}
    return replace(
        system,
        name="planetary",
        kind=Kind.NEARLY_KEPLERIAN,
        acceleration=_of_bodies(system.acceleration),
        kick=None if system.kick is None else partial(_kick_of_bodies, system.kick),
        quantities={name: replace(q, function=_of_bodies(q.function)) for name, q in quantities.items()},
        params=np.concatenate([system.params, np.zeros(0) if sizes is None else sizes, chosen.params(gm)]),
        radii=sizes,
        parts={"remainder": chosen.remainder(gm), **chosen.parts},
        frame=chosen.frame(gm),
        source="Wisdom, Holman, Astron. J. 102, 1528 (1991)",
    )


def _sizes(radii: ArrayLike, system: System) -> Floats:
    """Return the radii of bodies of which no two overlap."""
    unit = None if system.quantity_units is None else system.quantity_units.x
    if unit is not None and not units.has_unit(radii):
        raise ArgumentError(f"radii={radii!r} have no unit, but x0 has; give them in {units.spelt(unit)} or the like.")
    try:
        sizes = reals(radii if unit is None else units.numbers("radii", radii, unit))
    except TypeError as error:
        raise ArgumentError(f"radii={radii!r} must be numbers: {error}.") from None
    if sizes.shape != system.x0.shape[:1] or not (np.isfinite(sizes) & (sizes >= 0)).all():
        raise ArgumentError(f"radii={radii!r} must be {len(system.x0)} finite numbers of at least 0, one per body.")
    apart, contact = np.linalg.norm(system.x0[:, None] - system.x0, axis=-1), sizes[:, None] + sizes
    for i, j in np.argwhere(np.tril(apart < (1 - 1e-9) * contact, -1)).tolist():
        raise ArgumentError(
            f"bodies {j} and {i} overlap at the start: {apart[i, j] / contact[i, j]:.3g} of the sum of their radii apart; move"
            " one, or give smaller radii."
        )
    return sizes


@compiled
def _energy_of_merged(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    total = 0.0
    for i in range(params.size - 2):
        speed2 = potential = 0.0
        for k in range(3 * i, 3 * i + 3):
            speed2 += v[k] * v[k]
        for j in range(i):
            d2 = 0.0
            for k in range(3):
                d2 += (x[3 * j + k] - x[3 * i + k]) ** 2
            potential += params[2 + j] / math.sqrt(d2) if d2 > 0.0 else 0.0  # of those that are one
        total += params[2 + i] * (0.5 * speed2 - potential)
    out[0] = total / params[0]


# The functions of `nbody` take all params for masses; here the numbers of the splitting come after them.


@cache
def _of_bodies(of_nbody: Function) -> Function:
    return compiled(specialise(_without_splitting, f"{of_nbody.__name__}_of_bodies", function=of_nbody))


def _without_splitting(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    function(t, x, v, params[: 2 + x.size // 3], out)


@cache
def _kick_of_bodies(of_nbody: Callable[[bool], Function | None], compensated: bool) -> Function | None:
    kick = of_nbody(compensated)
    if kick is None:
        return None
    return compiled(specialise(_kick_without_splitting, "kick_of_bodies", function=kick))


def _kick_without_splitting(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    function(t, h, x, v, params[: 2 + x.size // 3], work)
