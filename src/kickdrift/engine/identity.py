"""The identity of a run: digests, equal in every process, of everything that determines it. Only the same run can be resumed.

It guards against mistakes. Where the dependencies of a function cannot be determined, its code alone is compared.
"""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import partial
from types import CodeType
from typing import Any

import numpy as np

from kickdrift.core.naming import digest, source_digest
from kickdrift.core.version import VERSION
from kickdrift.engine.event_functions import functions_of
from kickdrift.engine.function_key import taken_apart
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.start import Start
from kickdrift.methods import Method

_FLOORS = "core", "methods", "systems", "engine", "world"
_FLAGS = "terminal", "direction", "rate_bound"  # attributes of event functions


def version() -> str:
    """Return the version, which determines the bits of a run."""
    return f"kickdrift {VERSION}, sources {source_digest(*_FLOORS)}"


def identity_of(
    problem: Any,
    grid: Grid | Course,
    start: Start,
    params: Any,
    method: Method,
    compensated: bool,
    compiles: bool,
    events: Any,
    steps: Any,
) -> dict[str, str]:
    """Return the identity of a run, by the names of the arguments of `solve`.

    For equal steps it contains neither their size nor the rows, which change with the end and are compared when a run resumes.
    For variable steps it contains the end.
    """
    varies = isinstance(grid, Course)
    rows: list[Any] = [grid.stride, grid.wanted, grid.streamed] if isinstance(grid, Course) else []
    if isinstance(grid, Grid) and grid.streamed:
        rows = [grid.every, grid.times if grid.wanted is None else grid.wanted]
    return {
        "problem": digest(written(problem)),
        "t_span": repr((grid.t0, grid.t1) if varies else grid.t0),
        "x0": digest(written(start.x)),
        "v0": digest(written(start.v)),
        "args": digest(written(params)),
        "method": f"{method.name} {digest(written(method))}",
        "compensated": repr(compensated),
        "compile": repr(compiles),
        "events": digest(written(marked(events))),
        "step_control, impacts or switches": digest(written(steps)),
        "save_every, t_eval or save_to": digest(written(rows)),
    }


def marked(events: Any) -> list[Any]:
    """Return event functions and their attributes."""
    functions = list(functions_of(events))
    return [functions, [[getattr(function, flag, None) for flag in _FLAGS] for function in functions]]


def written(value: Any) -> Hashable:
    """Return a description of a value that is the same in every process."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, digest(np.ascontiguousarray(value).tobytes())
    if isinstance(value, Enum):
        return type(value).__name__, value.name
    if isinstance(value, str | int | float | complex | bytes | None | np.generic):
        return type(value).__name__, repr(value)
    if isinstance(value, partial):
        return "partial", written(value.func), written(value.args), written(value.keywords)
    if is_dataclass(value) and not isinstance(value, type):
        return type(value).__name__, *((each.name, written(getattr(value, each.name))) for each in fields(value))
    if isinstance(value, Mapping):
        return "mapping", *((str(name), written(member)) for name, member in value.items())
    if isinstance(value, Sequence):
        return "sequence", *map(written, value)
    if callable(value):
        return _of_function(value)
    return (type(value).__name__,)


def _of_function(function: Any) -> Hashable:
    taken = taken_apart(function, free=False)
    if taken.known:
        return taken.key
    python = getattr(function, "py_func", function)
    code = getattr(python, "__code__", None)
    return getattr(python, "__qualname__", type(python).__name__), None if code is None else _of_code(code)


def _of_code(code: CodeType) -> Hashable:
    constants = (_of_code(each) if isinstance(each, CodeType) else repr(each) for each in code.co_consts)
    return digest(code.co_code), code.co_names, *constants
