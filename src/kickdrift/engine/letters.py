"""Letters: flows bound to a system and compiled to what the loop calls, ``letter(t, h, state)``."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from kickdrift.core import memory
from kickdrift.core.compilation import Function, comes_with_kickdrift, compiled, specialise, specialised_name, unbound
from kickdrift.engine import flows
from kickdrift.engine.flow_table import FLOWS
from kickdrift.systems.system import System

_SMALL = 8  # numbers of a state up to which the accelerations pass in registers

arrays: Callable[[Any], Any] = unbound
flow: Callable[..., None] = unbound


def _letter(t: float, h: float, state: Any) -> None:
    x, v, params, work = arrays(state)
    flow(t, h, x, v, params, work)


def build(name: str, system: System, compensated: bool, primed: bool) -> Function:
    """Bind the flow `name` to a system: compiled where the system is native, for the interpreter where not.

    A system's own kick leaves no acceleration behind, so it serves where a step is not `primed` with one.
    """
    n = system.x0.size
    if not system.native:
        flow = _bind(name, system.acceleration, False, n, compensated)
        return specialise(_letter, "letter", arrays=lambda state: state, flow=flow)
    own = system.kick if name == "kick" and not compensated and not primed else None
    return _native(name, system.acceleration, own, min(n, _SMALL + 1), compensated, system.packaged)


@lru_cache(maxsize=256)
def _native(
    name: str, acceleration: Function, own: Function | None, n: int, compensated: bool, packaged: bool
) -> Function:
    flow = own or _bind(name, acceleration, True, n, compensated)
    small = compiled(cached=False, inline=True)(specialise(memory.small_arrays, "small_arrays", SIZE=n))
    forceless = FLOWS[name].forceless
    letter = specialise(
        _letter,
        specialised_name(
            flow if forceless else acceleration,
            name,
            str(n) if n <= _SMALL else "n",
            "own" if own else "compensated" if compensated else "plain",
        ),
        arrays=small if n <= _SMALL else memory.arrays,
        flow=flow,
    )
    return compiled(cached=forceless or (packaged and comes_with_kickdrift(acceleration)))(letter)


def _bind(name: str, acceleration: Function, native: bool, n: int, compensated: bool) -> Function:
    def bound(template: Function) -> Function:
        function = specialise(template, template.__name__, **bindings)
        return compiled(cached=False, inline=True)(function) if native else function

    bindings: dict[str, Any] = {"acceleration": acceleration, "SIZE": n, **_sums(native, compensated)}
    for part in FLOWS[name].parts:
        bindings[part.__name__] = bound(part)
    small = name == "kick" and native and n <= _SMALL
    return bound(flows.kick_small if small else FLOWS[name].template)


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
