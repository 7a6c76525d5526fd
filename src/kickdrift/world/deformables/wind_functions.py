"""Winds as Python functions of users, like forces; see `kickdrift.world.force_functions`."""

import inspect

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.compilation import Function
from kickdrift.core.errors import ArgumentError
from kickdrift.world.argument_checks import vector
from kickdrift.world.deformables.layout import PARTICLE_VELOCITY
from kickdrift.world.force_functions import FORCES, Force, Sort, force_of

WINDS = Sort(
    "wind",
    {
        "t": "t",
        "position": "floats(world, PARTICLE)[:rows(world, PARTICLE), 0:3]",
        "velocity": f"floats(world, PARTICLE)[:rows(world, PARTICLE), {PARTICLE_VELOCITY}:{PARTICLE_VELOCITY + 3}]",
        "wind": "floats(world, PARTICLE_WIND)[:rows(world, PARTICLE), 0:3]",
    },
    ("wind",),
    "vertex",
)


_FASTEST = 1e6  # m/s: the largest wind, whose square and forces are finite


def air_velocity(argument: str, value: ArrayLike) -> NDArray[np.float64]:
    """Return the velocity of air, (3,), m/s.

    Raises
    ------
    ArgumentError
        For numbers that are not finite, and for winds too fast to be squared.
    """
    air = vector(argument, value, 3)
    if np.abs(air).max() > _FASTEST:
        raise ArgumentError(f"{argument}={value!r} is faster than {_FASTEST:g} m/s; give a slower one.")
    return air


def force_or_wind_of(function: Function) -> Force:
    """Return the wind of a user's function if it has an argument `wind`, and otherwise its force.

    Raises
    ------
    ArgumentError
        As `kickdrift.world.force_functions.force_of`.
    """
    code = getattr(inspect.unwrap(getattr(function, "py_func", function)), "__code__", None)
    blows = code is not None and "wind" in code.co_varnames[: code.co_argcount]
    return force_of(function, WINDS if blows else FORCES)
