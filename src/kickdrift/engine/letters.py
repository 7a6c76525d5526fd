"""Letters: flows bound to a system and compiled to what the loop calls, ``letter(t, h, state)``."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from kickdrift.core import memory
from kickdrift.core.calls import address_of
from kickdrift.core.compilation import Function, comes_with_kickdrift, compiled, specialise, specialised_name, unbound
from kickdrift.engine.flows import kick_drift, layout
from kickdrift.engine.flows.sums import sums
from kickdrift.engine.flows.table import FLOWS, Flow
from kickdrift.engine.program import Program
from kickdrift.systems.system import System

_SMALL = 8  # numbers of a state up to which the accelerations pass in registers
_CALLED_ONCE = ("solve", "solve_component", "evaluate_component", "project", "leave_over", "linearise")

arrays: Callable[[Any], Any] = unbound
flow: Callable[..., None] = unbound


def _letter(t: float, h: float, state: Any) -> None:
    x, v, params, work = arrays(state)
    flow(t, h, x, v, params, work)


def functions_of(system: System, program: Program) -> dict[str, Function]:
    """Return what the flows of a program call, by the names of `kickdrift.engine.flows.layout.PARTS`."""
    functions = {"acceleration": system.acceleration, **system.parts}
    if system.velocity is not None:
        functions["velocity"] = system.velocity
    if program.split:
        functions["acceleration"] = system.parts["remainder"]
    return functions


def addresses_of(functions: dict[str, Function], flows: tuple[str, ...]) -> dict[str, int]:
    """Compile the functions of a native system that the flows call by address, and return their addresses."""
    templates = [t for name in flows for t in (FLOWS[name].template, *FLOWS[name].parts.values())]
    called = {global_name for template in templates for global_name in template.__code__.co_names}
    return {name: address_of(function, layout.FLAT) for name, function in functions.items() if f"{name}_at" in called}


def build(name: str, system: System, program: Program, compensated: bool, scratch: Any) -> Function:
    """Bind the flow `name` to a system: compiled where the system is native, for the interpreter where not.

    The interpreter needs the scratch itself. A system's own kick leaves no acceleration behind, so it serves where none
    is used again.
    """
    n = system.x0.size
    functions = functions_of(system, program)
    known = FLOWS[name]
    constants: dict[str, int] = {}
    if known.constants is not None:
        constants = known.constants(program.coefficients, n, system.params, "velocity" in functions)
    if not system.native:
        bound = _interpreted(known, functions, compensated, constants, scratch)
        return specialise(_letter, "letter", arrays=lambda state: state, flow=bound)
    inlined = tuple(functions[role] for role in known.inlined)
    own = None
    if name == "kick" and not (compensated or program.split or "rekick" in program.flows):
        own = system.kick
    # Flows with parts are large: most are compiled once for all sizes.
    most = layout.FEW if known.constants else 0 if known.parts else _SMALL
    sizes = (n, system.v0.size) if n <= most else None
    return _native(known, name, inlined, own, sizes, compensated, system.packaged, tuple(constants.items()))


@lru_cache(maxsize=256)
def _native(
    known: Flow,
    name: str,
    inlined: tuple[Function, ...],
    own: Function | None,
    sizes: tuple[int, int] | None,
    compensated: bool,
    packaged: bool,
    constants: tuple[tuple[str, int], ...],
) -> Function:
    template = kick_drift.kick_small if name == "kick" and sizes else known.template
    bindings: dict[str, Any] = {
        "SIZE": sizes[0] if sizes else 0,
        "SIZE_OF_V": sizes[1] if sizes else 0,
        "scratch": layout.scratch_by_address,
        **dict(constants),
        **sums(native=True, compensated=compensated),
        **dict(zip(known.inlined, inlined, strict=True)),
    }
    if not inlined:
        bindings |= {f"{part}_at": layout.part_by_address(part) for part in layout.PARTS}
    hot = known.constants is not None and sizes is not None
    for part, function in known.parts.items():
        # Not all forced inline, and none for many numbers: implicit Runge-Kutta flows compile in half the time.
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
            (own or inlined[0]) if inlined else template,
            name,
            "_".join(map(str, sizes)) if sizes else "n",
            *(str(int(value)) for _, value in constants),
            "own" if own else "compensated" if compensated else "plain",
        ),
        arrays=arrays,
        flow=bound,
    )
    return compiled(cached=not inlined or (packaged and comes_with_kickdrift(inlined[0])))(letter)


def _inline(function: Function) -> Function:
    return compiled(cached=False, inline=True)(function)


def _interpreted(
    known: Flow, functions: dict[str, Function], compensated: bool, constants: dict[str, int], scratch: Any
) -> Function:
    bindings: dict[str, Any] = {
        "scratch": layout.scratch_interpreted(scratch),
        **constants,
        **sums(native=False, compensated=compensated),
        **{role: functions[role] for role in known.inlined},
        **{f"{name}_at": layout.part_interpreted(function) for name, function in functions.items()},
    }
    for part, function in known.parts.items():
        bindings[part] = specialise(function, part, **bindings)
        if part == "residual":
            bindings["residual_inside"] = bindings[part]
    return specialise(known.template, known.template.__name__, **bindings)
