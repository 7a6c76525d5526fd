"""Globals and free variables of a function as arguments of its compiled code.

Numba freezes them. Where they are numbers that change from call to call, such as the stiffness of a spring, that would be
a compilation for each; as arguments they cost a load each.
"""

import inspect
from collections.abc import Collection, Mapping
from typing import Any

from numba.core import ir
from numba.core.compiler_machinery import FunctionPass, register_pass
from numba.core.ir_utils import build_definitions

_FREE, _PASSED = "__free_numbers__", "__passed_numbers__"


def numbers_as_arguments(function: Any, names: Collection[str], callees: Mapping[str, Collection[str]]) -> None:
    """Mark a function whose compiled code is to take some of its globals and free variables as arguments of their names.

    An argument with a default, of these names, loses it. The compiled functions among its `callees` get the arguments of
    the names given there, which the function has itself as ``callee__name``. The interpreter is told nothing.
    """
    given = inspect.signature(function).parameters
    free = [name for name in names if name not in given]
    needed = [_plain(given[name], name in names) for name in given]
    added = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in free]
    parameters = sorted([*needed, *added], key=lambda parameter: parameter.default is not parameter.empty)
    function.__signature__ = inspect.Signature(parameters)
    setattr(function, _FREE, frozenset(free))
    setattr(function, _PASSED, {callee: tuple(numbers) for callee, numbers in callees.items() if numbers})


def _plain(parameter: inspect.Parameter, needed: bool) -> inspect.Parameter:
    default = parameter.empty if needed else parameter.default
    return parameter.replace(kind=parameter.POSITIONAL_OR_KEYWORD, default=default)


@register_pass(mutates_CFG=False, analysis_only=False)
class GlobalsAsArguments(FunctionPass):  # type: ignore[misc]
    """Replaces globals and free variables of a function by arguments."""

    _name = "kickdrift_globals_as_arguments"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        """Change Numba's intermediate representation of a function."""
        free: frozenset[str] = getattr(state.func_id.func, _FREE, frozenset())
        passed: dict[str, tuple[str, ...]] = getattr(state.func_id.func, _PASSED, {})
        callees: dict[str, str] = {}  # by the variables that stand for them
        for block in state.func_ir.blocks.values():
            for statement in block.find_insts(ir.Assign):
                value = statement.value
                if isinstance(value, ir.Global | ir.FreeVar) and value.name in free:
                    statement.value = ir.Var(block.scope, value.name, statement.loc)
                elif isinstance(value, ir.Global | ir.FreeVar) and value.name in passed:
                    callees[statement.target.name] = value.name
        for block in state.func_ir.blocks.values():
            for call in block.find_exprs("call"):
                if (callee := callees.get(call.func.name)) is not None:
                    more = [(name, ir.Var(block.scope, f"{callee}__{name}", call.loc)) for name in passed[callee]]
                    call.kws = (*call.kws, *more)
        if free or passed:
            state.func_ir._definitions = build_definitions(state.func_ir.blocks)
        return bool(free or passed)
