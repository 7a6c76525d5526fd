"""Winds as Python functions of users, like forces; see `kickdrift.world.force_functions`."""

import inspect

from kickdrift.core.compilation import Function
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
