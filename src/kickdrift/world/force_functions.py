"""Forces and winds that users write as Python functions, compiled into the step.

A force names what it needs, and adds in place to the arrays `force` and `torque`, a wind to `wind`:

>>> def drag(velocity, force):
...     for body in range(len(force)):
...         for k in range(3):
...             force[body, k] -= 0.1 * velocity[body, k]

Floats and arrays of floats that the function captures are not compiled into it: they lie in a table of the world, those
of one force after those of the other, and each stage advances the offset to those of the next. So functions of the same code,
such as closures over different numbers, are compiled once, and cached on disk as those that `kickdrift.solve` gets.
"""

import inspect
from collections.abc import Mapping, Sequence
from functools import lru_cache
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.cache import fingerprint
from kickdrift.core.compilation import Function, compiled, unbound
from kickdrift.core.errors import ArgumentError
from kickdrift.core.memory import read_only, shaped
from kickdrift.engine.function_key import Taken, taken_apart
from kickdrift.engine.user_functions import argument_names, in_a_row, number_views
from kickdrift.world.layout import FORCE_BEFORE, MASS, SUBSTEP_FORCE
from kickdrift.world.step.stage_loop import STAGE
from kickdrift.world.tables import (
    FORCE,
    FORCE_NUMBERS,
    INERTIA,
    LOAD,
    MEMBER,
    MOTION,
    PARTICLE,
    PARTICLE_WIND,
    POSE,
    Tables,
    flat,
    floats,
    integers,
    rows,
)


class Sort(NamedTuple):
    """A kind of user function: a force or a wind.

    Attributes
    ----------
    name : str
        For messages.
    arguments : mapping of str to str
        Source code of the value of each argument that is allowed.
    outputs : tuple of str
        Arguments of which a function must have at least one.
    rows : str
        What a row of the arrays belongs to, for messages.
    """

    name: str
    arguments: Mapping[str, str]
    outputs: tuple[str, ...]
    rows: str


FORCES = Sort(
    "force",
    {
        "t": "t",
        "position": "floats(world, POSE)[:count, 0:3]",
        "orientation": "floats(world, POSE)[:count, 3:7]",
        "velocity": "floats(world, MOTION)[:count, 0:3]",
        "angular_velocity": "floats(world, MOTION)[:count, 3:6]",
        "mass": f"floats(world, INERTIA)[:count, {MASS}]",
        "force": "floats(world, FORCE)[:count, 0:3]",
        "torque": "floats(world, FORCE)[:count, 3:6]",
    },
    ("force", "torque"),
    "body",
)
_LAZY = inspect.CO_GENERATOR | inspect.CO_COROUTINE | inspect.CO_ASYNC_GENERATOR
_AROUND = (
    "Failed in",
    "During:",
    "File ",
    "Raised from",
)  # lines of Numba's messages that give the place of an error, not its cause

_TEMPLATE = """
def stage(t, h, world):
    count, numbers = rows(world, POSE), flat(world, FORCE_NUMBERS)
    at = int(numbers[0])
    numbers[0] += {size}
    function({views})
"""


class Force(NamedTuple):
    """A user's force or wind: the function, the stage of the step that calls it, the numbers that the function captures."""

    function: Function
    stage: Function
    numbers: NDArray[np.float64]
    sort: Sort

    def __reduce__(self) -> tuple[Any, ...]:
        return force_of, (self.function, self.sort)


@compiled
def begin_forces(t: float, h: float, world: int) -> None:
    """Set the forces of a substep to those of `World.apply_force`."""
    force, load, member = floats(world, FORCE), floats(world, LOAD), integers(world, MEMBER)
    for place in range(rows(world, MEMBER)):
        body = member[place, 0]
        for k in range(6):
            force[body, k] = load[body, k]
    if rows(world, FORCE_NUMBERS) > 0:
        floats(world, FORCE_NUMBERS)[0, 0] = 1.0


@compiled
def begin_later_forces(t: float, h: float, world: int) -> None:
    """Keep the forces of the start of a substep, and begin those of its end."""
    force, member = floats(world, FORCE), integers(world, MEMBER)
    for place in range(rows(world, MEMBER)):
        body = member[place, 0]
        for k in range(3):
            force[body, FORCE_BEFORE + k] = force[body, SUBSTEP_FORCE + k]
    begin_forces(t, h, world)


def put_numbers(tables: Tables, forces: Sequence[Force]) -> None:
    """Write the captured numbers of all forces, then of winds, after a row that holds the offset to those of the next stage."""
    ordered = sorted(forces, key=lambda force: force.sort != FORCES)
    numbers = np.concatenate([np.ones(1), *(force.numbers for force in ordered)])
    tables.put(FORCE_NUMBERS, numbers[:, None])


def force_of(function: Function, sort: Sort = FORCES) -> Force:
    """Return the force or the wind of a user's function.

    Raises
    ------
    ArgumentError
        If it is not a function, has an argument with an unknown name, has no output, or cannot be compiled.
    """
    names = argument_names(function, sort.name, tuple(sort.arguments), "capture numbers from the enclosing scope")
    if not set(sort.outputs) & set(names):
        wanted = " or ".join(f"`{name}`" for name in sort.outputs)
        raise ArgumentError(
            f"{sort.name} {_name(function)}({', '.join(names)}) has no output; take an argument {wanted},"
            f" {'arrays' if len(sort.outputs) > 1 else 'an array'} with one row per {sort.rows}, and add to"
            f" {'them' if len(sort.outputs) > 1 else 'it'} in place."
        )
    python = getattr(function, "py_func", function)
    if not isinstance(python, FunctionType) or python.__code__.co_flags & _LAZY:
        raise ArgumentError(
            f"{sort.name}={function!r} is a partial, a method or the like, which cannot be compiled; give a"
            " function defined with def."
        )
    taken = taken_apart(function)
    numbers = {name: value for name, value in taken.numbers.items() if name not in names}
    views = {name: sort.arguments[name] for name in names} | number_views(numbers, "numbers[at:]", 0)
    own = in_a_row(numbers)
    source = _TEMPLATE.format(size=own.size, views=", ".join(f"{name}={view}" for name, view in views.items()))
    return Force(function, _stage(taken, source, sort.name), own, sort)


@lru_cache(maxsize=128)
def _stage(taken: Taken, source: str, what: str) -> Function:
    """Compile the stage, once for all functions of the same code: memory for compiled code is never freed."""
    function = taken.function
    native = taken.snapshot(checked=True) if taken.known else function
    if not hasattr(native, "py_func"):
        native = compiled(cached=False, options=taken.options(checked=True))(native)
    python = _spelt(source)
    around = fingerprint(python)  # of the stage without the function
    python.__globals__["function"] = native
    if taken.known:
        python.__qualname__ = f"{what}_{taken.digest(around)}"
    stage: Any = compiled(cached=taken.known, users=True)(python)
    try:
        stage.compile(STAGE)
    except Exception as error:  # Numba raises its own errors, and any that its passes run into
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
        reason = next((line for line in lines if not line.startswith(_AROUND)), type(error).__name__)
        raise ArgumentError(
            f"{what} {_name(function)} cannot be compiled: {reason} Use loops and NumPy functions that Numba supports."
        ) from error
    made: Function = stage
    return made


def _spelt(source: str) -> FunctionType:
    """Define a stage from its source; its `function` is bound later."""
    names = (flat, floats, rows, read_only, shaped)
    scope: dict[str, Any] = {getattr(name, "__name__", ""): name for name in names} | {
        "__name__": __name__,
        "function": unbound,
        "POSE": POSE,
        "MOTION": MOTION,
        "INERTIA": INERTIA,
        "FORCE": FORCE,
        "FORCE_NUMBERS": FORCE_NUMBERS,
        "PARTICLE": PARTICLE,
        "PARTICLE_WIND": PARTICLE_WIND,
    }
    exec(source, scope)  # noqa: S102 - our own template, above
    stage: FunctionType = scope["stage"]
    return stage


def _name(function: Any) -> str:
    return str(getattr(inspect.unwrap(getattr(function, "py_func", function)), "__name__", function))
