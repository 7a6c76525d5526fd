"""Analysis, by Numba's intermediate representation, of where a function writes: whether that depends on its input."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from numba.core import ir
from numba.core.compiler import run_frontend

_SHAPES = ("shape", "size", "ndim")
_COUNTING = (range, len, min, max, abs, int, bool)  # functions whose results depend on their arguments alone
_PLAIN = (ir.Assign, ir.SetItem, ir.StaticSetItem, ir.Del, ir.Jump, ir.Branch, ir.Return)
_OPERATIONS = (
    "binop",
    "inplace_binop",
    "unary",
    "getitem",
    "static_getitem",
    "getattr",
    "call",
    "build_tuple",
    "getiter",
    "iternext",
    "pair_first",
    "pair_second",
    "exhaust_iter",
    "cast",
    "phi",
)


@dataclass(frozen=True)
class Writing:
    """Properties of a function that writes the same elements of `out` for all input numbers.

    Attributes
    ----------
    reads_same : bool
        Whether it also reads the same elements, so that its indices are either always within bounds or never.
    """

    reads_same: bool


def writing_of(function: Any, numbers: frozenset[str]) -> Writing | None:
    """Analyse how a Python function writes into its argument `out`; None if that may depend on its arguments `numbers`.

    It does not if neither branches nor indices are computed from them, and `out` itself is neither read nor passed on.
    """
    try:
        blocks = run_frontend(function).blocks.values()
    except Exception:  # functions that Numba cannot compile are reported elsewhere
        return None
    statements = [statement for block in blocks for statement in block.body]
    if not all(isinstance(statement, _PLAIN) for statement in statements):
        return None
    assigned = [(s.target.name, s.value) for s in statements if isinstance(s, ir.Assign)]
    if not all(_is_known(value) for _, value in assigned):
        return None
    out = _standing_for_out(assigned)
    depends = _dependent(assigned, numbers)
    if any(_misuses(statement, out, depends) for statement in statements):
        return None
    reads = (value.index.name for _, value in assigned if isinstance(value, ir.Expr) and value.op == "getitem")
    calls_others = any(_is_compiled(value) for _, value in assigned)
    return Writing(reads_same=not calls_others and not any(name in depends for name in reads))


def _is_known(value: Any) -> bool:
    if isinstance(value, ir.Expr):
        return value.op in _OPERATIONS
    return isinstance(value, ir.Arg | ir.Const | ir.Global | ir.FreeVar | ir.Var)


def _is_compiled(value: Any) -> bool:
    """Whether a value is a compiled function, which may read all its arguments."""
    return isinstance(value, ir.Global | ir.FreeVar) and hasattr(value.value, "py_func")


def _standing_for_out(assigned: list[tuple[str, Any]]) -> frozenset[str]:
    """Return the names of variables that may be the argument `out`."""
    found = {name for name, value in assigned if isinstance(value, ir.Arg) and value.name == "out"}
    return frozenset(_closure(found, assigned, lambda value: isinstance(value, ir.Var)))


def _dependent(assigned: list[tuple[str, Any]], numbers: frozenset[str]) -> frozenset[str]:
    """Return the names of variables that may depend on the numbers."""
    constants = {name: value.value for name, value in assigned if isinstance(value, ir.Global | ir.FreeVar)}
    found = {name for name, value in assigned if isinstance(value, ir.Arg) and value.name in numbers}
    for name, value in assigned:
        if isinstance(value, ir.Expr) and value.op == "call" and constants.get(value.func.name) not in _COUNTING:
            found.add(name)

    def passes_on(value: Any) -> bool:
        if not isinstance(value, ir.Expr):
            return True
        if value.op == "call":
            return constants.get(value.func.name) is not len
        return not (value.op == "getattr" and value.attr in _SHAPES)

    return frozenset(_closure(found, assigned, passes_on))


def _closure(found: set[str], assigned: list[tuple[str, Any]], passes_on: Any) -> set[str]:
    """Add all variables that depend on those found."""
    before = -1
    while len(found) > before:
        before = len(found)
        found |= {name for name, value in assigned if passes_on(value) and found & set(_used(value))}
    return found


def _used(value: Any) -> Iterator[str]:
    """Names of the variables in a value."""
    if isinstance(value, ir.Var):
        yield value.name
    elif isinstance(value, ir.Expr):
        yield from (variable.name for variable in value.list_vars())


def _misuses(statement: Any, out: frozenset[str], depends: frozenset[str]) -> bool:
    """Whether the control flow or an index of a statement depends on the numbers, or it uses `out` other than for writing."""
    if isinstance(statement, ir.Branch):
        return statement.cond.name in depends
    if isinstance(statement, ir.SetItem | ir.StaticSetItem):
        index = statement.index.name if isinstance(statement, ir.SetItem) else None
        return statement.target.name not in out or index in depends or statement.value.name in out
    if isinstance(statement, ir.Assign) and isinstance(statement.value, ir.Expr):
        if statement.value.op == "getattr" and statement.value.attr in _SHAPES:
            return False
        return bool(out & set(_used(statement.value)))
    return isinstance(statement, ir.Return) and statement.value.name in out
