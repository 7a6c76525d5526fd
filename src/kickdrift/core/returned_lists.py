"""Functions that return ``np.array([a, b])``, or the list alone, return the tuple of these numbers, which takes no memory.

A list and an array made of it for each evaluation take 30 ns, as long as many a force takes in all.
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
    """Have compiled code of a function return a tuple of floats where it returns a list of numbers, or an array made of one."""
    setattr(function, _TUPLES, True)


@register_pass(mutates_CFG=False, analysis_only=False)
class TuplesForLists(FunctionPass):  # type: ignore[misc]
    """Makes tuples of the lists from which the arrays are made that a function returns."""

    _name = "kickdrift_tuples_for_lists"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        """Change Numba's intermediate representation of a function, if it is so at all of its returns."""
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
    """Return the call of ``np.array``, if there is one, and the list behind what is returned, if nothing else sees them."""
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
    """Return what becomes of a statement: of a list a tuple of floats, and of the array made of it that tuple."""
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
