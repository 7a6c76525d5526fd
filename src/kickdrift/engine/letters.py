"""Letters: flows bound to a system and compiled to the functions that the loop calls, ``letter(t, h, state)``."""

from collections.abc import Callable
from functools import cache, lru_cache
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from kickdrift.core import memory
from kickdrift.core.calls import address_of
from kickdrift.core.compilation import Function, compiled, is_kept, is_users, specialise, unbound
from kickdrift.core.naming import comes_with_kickdrift, specialised_name
from kickdrift.engine.flows import layout
from kickdrift.engine.flows.record import Flow
from kickdrift.engine.flows.sums import sums
from kickdrift.engine.flows.table import FLOWS
from kickdrift.engine.loop import LETTER
from kickdrift.engine.program import Program
from kickdrift.systems.system import System

_SMALL = 8  # numbers of a state up to which the accelerations pass in registers
_CALLED_ONCE = (
    "solve",
    "solve_component",
    "evaluate_component",
    "project",
    "leave_over",
    "linearise",
    "take_step",
    "estimate",
)

arrays: Callable[[Any], Any] = unbound
flow: Callable[..., None] = unbound


def _letter(t: float, h: float, state: Any) -> None:
    x, v, params, work = arrays(state)
    flow(t, h, x, v, params, work)


def functions_of(system: System, program: Program) -> dict[str, Function]:
    """Return the functions that the flows of a program call, by the names of `kickdrift.engine.flows.layout.PARTS`."""
    functions = {"acceleration": system.acceleration, **system.parts}
    if system.velocity is not None:
        functions["velocity"] = system.velocity
    if program.split:
        functions["acceleration"] = system.parts["remainder"]
    return functions


class Bound(NamedTuple):
    """What letters depend on: the same for runs that differ only by the numbers of a state."""

    program: Program
    functions: tuple[tuple[str, Function], ...]
    kick: Function | None  # the system's own
    n: int
    n_v: int
    params: bytes  # if flows depend on them, see `Flow.by_params`
    compensated: bool
    packaged: bool


def bind(system: System, program: Program, compensated: bool) -> Bound:
    """Bind a program to the functions of a system.

    A system's own kick does not keep the acceleration, so it is used only where that is not used again.
    """
    kick, params = None, b""
    if system.kick is not None and program.alone:
        kick = system.kick(compensated)
    if program.by_params:
        params = system.params.tobytes()
    functions = tuple(functions_of(system, program).items())
    return Bound(program, functions, kick, system.x0.size, system.v0.size, params, compensated, system.packaged)


class Letters(NamedTuple):
    """Compiled letters, those of the primers last, and their addresses; and addresses of functions that they call so."""

    built: tuple[Function, ...]
    flows: NDArray[np.int64]
    called: dict[str, int]


@lru_cache(maxsize=256)
def compile_letters(bound: Bound) -> Letters:
    """Compile the letters of a native system, or load them from disk."""
    built, names = tuple(build(name, bound) for name in bound.program.names), set[str]()
    for flow in bound.program.names:
        if not _inlined(bound, FLOWS[flow]):
            names |= parts_called(FLOWS[flow])
    called = {name: address_of(function, layout.FLAT) for name, function in bound.functions if name in names}
    return Letters(built, np.array([address_of(letter, LETTER) for letter in built]), called)


@cache
def parts_called(known: Flow) -> frozenset[str]:
    """Return the names of the functions of a system that a flow calls."""
    names = {name for t in (known.template, *known.parts.values()) for name in t.__code__.co_names}
    return frozenset(part for part in layout.PARTS if f"{part}_at" in names)


def _inlined(bound: Bound, known: Flow) -> tuple[str, ...]:
    """Return the functions that are inlined into a flow, which is then compiled for this system alone.

    With a user's function that takes time; a call by address costs 2 ns, negligible beside the forces of a large state.
    """
    return known.inlined if bound.packaged or bound.n <= _SMALL else ()


def build(name: str, bound: Bound, scratch: Any = None) -> Function:
    """Compile the flow `name`; given a `scratch`, for the interpreter instead."""
    n, known, functions = bound.n, FLOWS[name], dict(bound.functions)
    constants: dict[str, int] = {}
    if known.constants is not None:
        params = np.frombuffer(bound.params).copy()
        constants = known.constants(bound.program.coefficients, n, params, "velocity" in functions)
    if scratch is not None:
        interpreted = _interpreted(known, functions, bound.compensated, constants, scratch)
        return specialise(_letter, "letter", arrays=lambda state: state, flow=interpreted)
    inlined = tuple((role, functions[role]) for role in _inlined(bound, known))
    own = bound.kick if name in bound.program.alone else None
    # Flows with parts are large: most are compiled only once, for all sizes.
    most = layout.FEW if known.constants else 0 if known.parts else _SMALL
    sizes = (n, bound.n_v) if n <= most else None
    return _native(known, name, inlined, own, sizes, bound.compensated, bound.packaged, tuple(constants.items()))


def shared() -> list[tuple[Function, Any]]:
    """Return the letters that are compiled once for all systems, or for many, with their signatures."""
    found = []
    for name, known in FLOWS.items():
        if not known.inlined:
            small = [] if known.parts else [(n, n) for n in range(1, _SMALL + 1)]
            ahead = known.ahead if known.constants else [(sizes, {}) for sizes in (None, *small)]
            found += [(_shared(name, sizes, tuple(constants.items())), LETTER) for sizes, constants in ahead]
    return found


def _shared(name: str, sizes: tuple[int, int] | None, constants: tuple[tuple[str, int], ...]) -> Function:
    letter: Any = _native(FLOWS[name], name, (), None, sizes, True, False, constants)
    letter.recipe = (_shared, (name, sizes, constants))
    return cast(Function, letter)


@lru_cache(maxsize=256)
def _native(
    known: Flow,
    name: str,
    inlined: tuple[tuple[str, Function], ...],
    own: Function | None,
    sizes: tuple[int, int] | None,
    compensated: bool,
    packaged: bool,
    constants: tuple[tuple[str, int], ...],
) -> Function:
    template = known.small if known.small and sizes else known.template
    bindings: dict[str, Any] = {
        "SIZE": sizes[0] if sizes else 0,
        "SIZE_OF_V": sizes[1] if sizes else 0,
        "scratch": layout.scratch_by_address,
        **dict(constants),
        **sums(native=True, compensated=compensated),
        **{f"{part}_at": layout.part_by_address(part) for part in layout.PARTS},
        **{f"{part}_at": layout.part_inlined(part, function) for part, function in inlined},
    }
    bound_to = own or (inlined[0][1] if inlined else template)
    hot = known.constants is not None and sizes is not None
    for part, function in known.parts.items():
        # Not all are inlined, and none for large states: implicit Runge-Kutta flows compile in half the time.
        bound_part = specialise(function, part, **bindings)
        bindings[part] = compiled(cached=False, inline=hot and part in _CALLED_ONCE)(bound_part)
        if part == "residual":
            bindings["residual_inside"] = _inline(bound_part) if hot else bindings[part]
    bound = own or _inline(specialise(template, template.__name__, **bindings))
    arrays = memory.arrays
    if sizes:
        arrays = _inline(specialise(memory.small_arrays, "small_arrays", SIZE=sizes[0], SIZE_OF_V=sizes[1]))
    letter = specialise(
        _letter,
        specialised_name(
            bound_to,
            name,
            "_".join(map(str, sizes)) if sizes else "n",
            *(str(int(value)) for _, value in constants),
            "own" if own else "compensated" if compensated else "plain",
        ),
        arrays=arrays,
        flow=bound,
    )
    kept = bound_to is template or is_kept(bound_to) or (packaged and comes_with_kickdrift(bound_to))
    return compiled(cached=kept, users=is_users(bound_to))(letter)


def _inline(function: Function) -> Function:
    return compiled(cached=False, inline=True)(function)


def _interpreted(
    known: Flow, functions: dict[str, Function], compensated: bool, constants: dict[str, int], scratch: Any
) -> Function:
    bindings: dict[str, Any] = {
        "scratch": layout.scratch_interpreted(scratch),
        "has_part": layout.has_part_interpreted(functions),
        **constants,
        **sums(native=False, compensated=compensated),
        **{f"{name}_at": layout.part_interpreted(function) for name, function in functions.items()},
    }
    for part, function in known.parts.items():
        bindings[part] = specialise(function, part, **bindings)
        if part == "residual":
            bindings["residual_inside"] = bindings[part]
    return specialise(known.template, known.template.__name__, **bindings)
