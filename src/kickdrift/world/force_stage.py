"""Forces that users write as Python functions, compiled into the step.

A force names what it needs, and adds in place to the arrays `force` and `torque`:

>>> def drag(velocity, force):
...     for body in range(len(force)):
...         for k in range(3):
...             force[body, k] -= 0.1 * velocity[body, k]
"""

import inspect
from functools import lru_cache
from types import FunctionType
from typing import Any, NamedTuple

from kickdrift.core.compilation import Function, compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.function_key import Taken, taken_apart
from kickdrift.engine.user_functions import argument_names
from kickdrift.world.integration import MASS
from kickdrift.world.step import STAGE
from kickdrift.world.tables import FORCE, INERTIA, LOAD, MOTION, POSE, floats, rows

# What a force may name, and the view of the tables that it is given.
_ARGUMENTS = {
    "t": "t",
    "position": "floats(world, POSE)[:count, 0:3]",
    "orientation": "floats(world, POSE)[:count, 3:7]",
    "velocity": "floats(world, MOTION)[:count, 0:3]",
    "angular_velocity": "floats(world, MOTION)[:count, 3:6]",
    "mass": f"floats(world, INERTIA)[:count, {MASS}]",
    "force": "floats(world, FORCE)[:count, 0:3]",
    "torque": "floats(world, FORCE)[:count, 3:6]",
}

_LAZY = inspect.CO_GENERATOR | inspect.CO_COROUTINE | inspect.CO_ASYNC_GENERATOR
_AROUND = ("Failed in", "During:", "File ", "Raised from")  # where Numba was, and not what is wrong

_TEMPLATE = """
def stage(t, h, world):
    count = rows(world, POSE)
    function({views})
"""


class Force(NamedTuple):
    """A force of a user's: the function, and the stage of the step that calls it."""

    function: Function
    stage: Function

    def __reduce__(self) -> tuple[Any, ...]:
        return force_of, (self.function,)


@compiled
def begin_forces(t: float, h: float, world: int) -> None:
    """Begin with what `World.apply_force` asks for, in every substep."""
    force, load = floats(world, FORCE), floats(world, LOAD)
    for body in range(rows(world, LOAD)):
        for k in range(6):
            force[body, k] = load[body, k]


def force_of(function: Function) -> Force:
    """Make a force of a user's function.

    Raises
    ------
    ArgumentError
        If it is no function, names what there is not, adds to nothing, or cannot be compiled.
    """
    names = argument_names(function, "force", tuple(_ARGUMENTS), "take numbers from around the function")
    if "force" not in names and "torque" not in names:
        raise ArgumentError(
            f"force {_name(function)}({', '.join(names)}) adds to nothing; name `force` or `torque`, arrays of a row a body,"
            " and add to them in place."
        )
    python = getattr(function, "py_func", function)
    if not isinstance(python, FunctionType) or python.__code__.co_flags & _LAZY:
        raise ArgumentError(
            f"force={function!r} is a partial, a method, a generator or the like, of which no stage can be made; give a"
            " function by def."
        )
    return Force(function, _stage(taken_apart(function, free=False), tuple(names)))


@lru_cache(maxsize=128)
def _stage(taken: Taken, names: tuple[str, ...]) -> Function:
    """Compile the stage, once for all functions of the same code: memory for code is never given back."""
    function = taken.function
    native = taken.snapshot(checked=True) if taken.known else function
    if not hasattr(native, "py_func"):
        native = compiled(cached=False, options=taken.options(checked=True))(native)
    scope: dict[str, Any] = {
        "__name__": __name__,
        "function": native,
        "floats": floats,
        "rows": rows,
        "POSE": POSE,
        "MOTION": MOTION,
        "INERTIA": INERTIA,
        "FORCE": FORCE,
    }
    views = ", ".join(f"{name}={_ARGUMENTS[name]}" for name in names)
    exec(_TEMPLATE.format(views=views), scope)  # noqa: S102 - our own template, above
    stage: Any = compiled(cached=False)(scope["stage"])
    try:
        stage.compile(STAGE)
    except Exception as error:  # Numba's own, and what it stumbles over
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
        reason = next((line for line in lines if not line.startswith(_AROUND)), type(error).__name__)
        raise ArgumentError(
            f"force {_name(function)} cannot be compiled: {reason} Use loops and NumPy functions that Numba knows."
        ) from error
    made: Function = stage
    return made


def _name(function: Any) -> str:
    return str(getattr(inspect.unwrap(getattr(function, "py_func", function)), "__name__", function))
