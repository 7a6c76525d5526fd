"""A pass for functions that return ``np.array([a, b])``, or a list: they return a tuple instead, which allocates nothing.

A list and an array made from it take 30 ns for each evaluation, as long as many a force takes altogether.
"""

import operator
from collections import Counter
from typing import Any

import numpy as np
from numba.core import ir
from numba.core.compiler_machinery import FunctionPass, register_pass
from numba.core.ir_utils import build_definitions

_TUPLES = "__returns_tuples__"


def tuples_for_lists(function: Any) -> None:
    """Mark a function whose compiled code is to return a tuple of floats for a list of numbers, or an array made from one."""
    setattr(function, _TUPLES, True)


@register_pass(mutates_CFG=False, analysis_only=False)
class TuplesForLists(FunctionPass):  # type: ignore[misc]
    """Replaces the lists and arrays of lists that a function returns by tuples."""

    _name = "kickdrift_tuples_for_lists"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        """Change Numba's intermediate representation of a function, if all its returns are of this form."""
        if not getattr(state.func_id.func, _TUPLES, False):
            return False
        found = [
            _array_of_list(state.func_ir, block.terminator.value)
            for block in state.func_ir.blocks.values()
            if isinstance(block.terminator, ir.Return)
        ]
        known = [each for each in found if each is not None]
        if len(known) < len(found) or len({len(listed.items) for _, listed in known}) != 1:
            return False
        calls, lists = ([id(value) for value in values if value is not None] for values in zip(*known, strict=True))
        for block in state.func_ir.blocks.values():
            block.body = [new for old in block.body for new in _changed(old, block.scope, calls, lists)]
        state.func_ir._definitions = build_definitions(state.func_ir.blocks)
        return True


def _array_of_list(function: Any, returned: Any) -> tuple[Any, Any] | None:
    """Return the call of ``np.array``, if there is one, and the list behind a returned value, if nothing else uses them."""
    mentions = Counter(
        variable.name for block in function.blocks.values() for each in block.body for variable in each.list_vars()
    )

    def made(variable: Any, operation: str) -> Any:
        try:
            definition = function.get_definition(variable)
        except KeyError:
            return None
        same = isinstance(definition, ir.Expr) and definition.op == operation
        return definition if same and mentions[variable.name] == 2 else None  # where it is made, and once more

    cast = made(returned, "cast")
    if cast is None:
        return None
    if (bare := made(cast.value, "build_list")) is not None:
        return (None, bare) if bare.items else None
    call = made(cast.value, "call")
    if call is None or len(call.args) != 1 or call.kws or call.vararg is not None or not _is_array(function, call.func):
        return None
    listed = made(call.args[0], "build_list")
    return (call, listed) if listed is not None and listed.items else None


def _is_array(function: Any, variable: Any) -> bool:
    """Whether a variable is ``np.array``."""
    try:
        definition = function.get_definition(variable)
        if isinstance(definition, ir.Expr) and definition.op == "getattr" and definition.attr == "array":
            return getattr(function.get_definition(definition.value), "value", None) is np
    except KeyError:
        return False
    return getattr(definition, "value", None) is np.array


def _changed(statement: Any, scope: Any, calls: list[int], lists: list[int]) -> list[Any]:
    """Return the statements that replace one: a list becomes a tuple of floats, and the array made from it that tuple."""
    value: Any = statement.value if isinstance(statement, ir.Assign) else None
    if id(value) in calls:
        statement.value = value.args[0]
    if id(value) not in lists:
        return [statement]
    loc = statement.loc
    one = scope.redefine("$one", loc)
    before, items = [ir.Assign(ir.Const(1.0, loc), one, loc)], []
    for item in value.items:  # times one, integers and Booleans are floats, as they are in an array with floats
        items.append(scope.redefine("$item", loc))
        before.append(ir.Assign(ir.Expr.binop(operator.mul, one, item, loc), items[-1], loc))
    statement.value = ir.Expr.build_tuple(items, loc)
    return [*before, statement]
