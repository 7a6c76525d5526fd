"""Letters: flows bound to a system and compiled to what the loop calls, ``letter(t, h, state)``."""

from collections.abc import Callable
from typing import Any

from kickdrift.core import memory
from kickdrift.core.compilation import Function, compiled, specialise, specialised_name, unbound
from kickdrift.engine import flows, implicit
from kickdrift.systems.system import System

_SMALL = 8  # numbers of a state up to which the accelerations pass in registers

_TEMPLATES: dict[str, Function] = {
    "kick": flows.kick,
    "rekick": flows.rekick,
    "accelerate": flows.accelerate,
    "drift": flows.drift,
    "explicit-euler": flows.explicit_euler,
    "implicit-euler": implicit.implicit_euler,
    "implicit-midpoint": implicit.implicit_midpoint,
}

arrays: Callable[[Any], Any] = unbound
flow: Callable[..., None] = unbound


def _letter(t: float, h: float, state: Any) -> None:
    x, v, params, work = arrays(state)
    flow(t, h, x, v, params, work)


def build(name: str, system: System, compensated: bool) -> Function:
    """Bind the flow `name` to a system: compiled where the system is native, for the interpreter where not."""
    if not system.native:
        return specialise(_letter, "letter", arrays=lambda state: state, flow=_bind(name, system, compensated))
    n = system.x0.size
    small = compiled(cached=False, inline=True)(specialise(memory.small_arrays, "small_arrays", SIZE=n))
    letter = specialise(
        _letter,
        specialised_name(system.acceleration, name, str(n) if n <= _SMALL else "n", "k" if compensated else "p"),
        arrays=small if n <= _SMALL else memory.arrays,
        flow=_bind(name, system, compensated),
    )
    return compiled(cached=system.packaged)(letter)


def _bind(name: str, system: System, compensated: bool) -> Function:
    native = system.native

    def bind(template: Function, **bindings: Any) -> Function:
        bound = specialise(template, template.__name__, **bindings)
        return compiled(cached=False, inline=True)(bound) if native else bound

    if name == "own-kick":
        assert system.kick is not None
        return system.kick
    template = _TEMPLATES[name]
    if name == "kick" and native and system.x0.size <= _SMALL:
        template = flows.kick_small
    bindings: dict[str, Any] = {"acceleration": system.acceleration, "SIZE": system.x0.size}
    if name.startswith("implicit"):
        residual = bind(implicit.stage_residual, acceleration=system.acceleration)
        matrix = bind(implicit.form_matrix, acceleration=system.acceleration)
        bindings["solve_stage"] = bind(
            implicit.solve_stage, stage_residual=residual, form_matrix=matrix, acceleration=system.acceleration
        )
    return bind(template, **bindings, **_sums(native, compensated))


def _sums(native: bool, compensated: bool) -> dict[str, Function]:
    if compensated and native:
        return {"add_to_x": flows.add_to_x_compensated, "add_to_v": flows.add_to_v_compensated}
    if compensated:
        return {
            "add_to_x": flows.add_to_x_compensated_interpreted,
            "add_to_v": flows.add_to_v_compensated_interpreted,
        }
    add = flows.add if native else flows.add_interpreted
    return {"add_to_x": add, "add_to_v": add}
