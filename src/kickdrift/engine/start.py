"""The start of a run: x, v and params from the arguments of users."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift import systems
from kickdrift.core.arguments import all_finite, reals
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.systems.problem import Problem
from kickdrift.systems.system import System
from kickdrift.systems.system import start as as_start

Floats = NDArray[np.float64]


class Start(NamedTuple):
    """Position and velocity, which is empty for first-order equations."""

    x: Floats
    v: Floats


def start_of(problem: Any, x0: ArrayLike | None, v0: ArrayLike | None) -> Start:
    """Find the start of a problem, which a system brings itself.

    Raises
    ------
    ArgumentError
        For an invalid problem, or an invalid initial state.
    """
    if not callable(problem) and not isinstance(problem, System | Problem):
        raise ArgumentError(
            f"problem={problem!r} is neither a function nor a system; give one, such as kd.systems.get('kepler')."
        )
    if problem in systems.catalogue().values():
        raise ArgumentError(f"problem={problem.__name__} is a function that creates a system; call it.")
    if isinstance(problem, System):
        x0, v0 = problem.x0 if x0 is None else x0, problem.v0 if v0 is None else v0
        has_velocity = problem.kind is not Kind.FIRST_ORDER
    else:
        has_velocity = getattr(problem, "has_velocity", True)
        if not has_velocity and v0 is not None:
            raise ArgumentError(f"v0={v0!r} is given, but first-order equations have only x0, the initial y.")
    x = _floats("x0", x0)
    if x.size == 0:
        raise ArgumentError(f"x0 of shape {x.shape} is empty; give at least one number.")
    if isinstance(problem, System) and x.shape != problem.x0.shape:
        raise ArgumentError(
            f"x0 has shape {x.shape} but {problem.name!r} has states of shape {problem.x0.shape}; give that shape."
        )
    if not has_velocity:
        return Start(x, np.zeros(0))
    v = _floats("v0", v0)
    if x.shape != v.shape:
        raise ArgumentError(f"v0 has shape {v.shape} but x0 has shape {x.shape}; give one velocity per position.")
    return Start(x, v)


def _floats(name: str, value: ArrayLike | None) -> Floats:
    if value is None:
        raise ArgumentError(f"{name} is missing; a function needs x0 and v0 to start from.")
    try:
        array = as_start(value)
    except TypeError as error:
        raise ArgumentError(
            f"{name}={value!r} is not an array of numbers: {error}; give a number, list or array."
        ) from None
    if not all_finite(array):
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ArgumentError(f"{name} is {array[where]} at index {where}; the initial state must be finite.")
    return array


def parameters(args: Sequence[float] | None) -> Floats:
    """Return the numbers that functions get as params.

    Raises
    ------
    ArgumentError
        For anything but a flat list of finite numbers.
    """
    if args is None:
        return np.zeros(0)
    if isinstance(args, Mapping):
        raise ArgumentError(
            f"args={args!r} has names, but the function gets its params in order: give args={tuple(args.values())!r}."
        )
    try:
        params = np.atleast_1d(reals(args))
    except TypeError as error:
        raise ArgumentError(
            f"args={args!r} must be numbers ({error}); the function gets them as the float array params."
        ) from None
    if params.ndim != 1:
        raise ArgumentError(f"args has shape {params.shape}; give a flat list of numbers.")
    if not all_finite(params):
        raise ArgumentError(f"args={args!r} must be finite.")
    return params
