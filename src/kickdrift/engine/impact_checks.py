"""Checks of impacts: masses, restitution and friction of gaps, and that these are not closed at the start."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import reals
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.quantities import evaluate_quantity
from kickdrift.systems.second_order import fitted
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]

BEYOND = 1e-9  # of the size of x: a start that is farther behind a surface is refused


def masses_of(given: Any, problem: Any, system: System) -> Floats:
    """Return a mass for each component of the state."""
    if given is None:
        given = getattr(problem, "mass", 1.0) if system.gm is None else system.gm
    masses = fitted("mass", given, system.x0.shape)
    if not (np.isfinite(masses) & (masses > 0.0)).all():
        raise ArgumentError(f"mass={given!r} of impacts must be positive and finite.")
    return masses


def check_friction(friction: Floats, gaps: Quantity, system: System, t0: float) -> None:
    """Refuse friction in gaps between two bodies: it is defined here only against surroundings at rest."""
    if system.x0.ndim < 2 or not friction.any():
        return
    touched = np.zeros(friction.size, dtype=int)
    moved = 1e-3 * (float(np.abs(system.x0).max()) or 1.0)

    def at(x: Floats) -> Floats:
        return evaluate_quantity(gaps, system, np.array([t0]), x[None], system.v0[None]).reshape(-1)

    for body in range(len(system.x0)):
        changed = np.zeros(friction.size, dtype=bool)
        for k in range(system.x0[body].size):
            x = system.x0.copy()
            x[body].flat[k] += moved
            changed |= at(x) != at(system.x0)
        touched += changed
    between = np.flatnonzero((friction > 0.0) & (touched > 1))
    if between.size:
        raise ArgumentError(
            f"gap {int(between[0])} is between two bodies and has friction {float(friction[between[0]])!r}, but"
            " impacts support friction only with surroundings at rest: give 0 there, or build a kd.World."
        )


def numbers_of(name: str, value: ArrayLike, count: int, most: float) -> Floats:
    """Return a number for each gap, from 0 to `most`.

    Raises
    ------
    ArgumentError
    """
    try:
        numbers = np.broadcast_to(reals(value), (count,))
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{name}={value!r} of impacts: {error}; give a number, or {count} of them.") from None
    if not ((numbers >= 0.0) & (numbers <= most) & np.isfinite(numbers)).all():
        raise ArgumentError(
            f"{name}={value!r} of impacts must be finite and {'from 0 to 1' if most == 1.0 else 'at least 0'}."
        )
    return numbers


def check_start(start: Floats, count: int, length: float) -> None:
    """Refuse a start beyond one of the first `count` surfaces, by more than rounding relative to `length`.

    Raises
    ------
    ArgumentError
    """
    if not np.isfinite(start).all():
        raise ArgumentError(f"the gaps at the start are {start.tolist()!r}; they must be finite.")
    beyond: Sequence[int] = np.flatnonzero(start[:count] < -BEYOND * length).tolist()
    if beyond:
        raise ArgumentError(
            f"gap {beyond[0]} is {float(start[beyond[0]])!r} at the start, beyond the surface; gaps are positive where"
            " nothing touches: move x0, or change the sign of the function."
        )
