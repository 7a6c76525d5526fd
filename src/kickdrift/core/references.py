"""Analysis of which functions must count references to arrays: those that may create arrays, or return their arguments."""

from typing import Any

from numba import carray, types
from numba.core import ir

from kickdrift.core.views import part, words


def counts_references(state: Any) -> bool:
    """Whether a function has to: unless all its arrays belong to its callers, or are views of such, and none is returned.

    Its caller keeps the arrays alive until it returns.
    """
    if state.flags.auto_parallel.enabled or not state.flags.no_cpython_wrapper:
        return True
    returned = _is_array(state, state.return_type) and any(_is_array(state, type_) for type_ in state.args)
    if state.func_ir.is_generator or returned:
        return True
    for block in state.func_ir.blocks.values():
        for statement in block.body:
            if isinstance(statement, ir.DynamicRaise | ir.DynamicTryRaise):
                return True
            if isinstance(statement, ir.SetItem | ir.StaticSetItem) and _copies(state, statement):
                return True
            if not isinstance(statement, ir.Assign) or not _is_array(state, state.typemap[statement.target.name]):
                continue
            if not _is_view(state, statement.value):
                return True
    return False


def _copies(state: Any, statement: Any) -> bool:
    """Whether an array is assigned to a slice, which needs a copy if they overlap, or the target is not an array."""
    into_array = isinstance(state.typemap[statement.target.name], types.Array)
    return not into_array or _is_array(state, state.typemap[statement.value.name])


def _is_array(state: Any, type_: Any) -> bool:
    return bool(state.targetctx.data_model_manager[type_].contains_nrt_meminfo())


def _is_view(state: Any, value: Any) -> bool:
    """Whether a value is an array that is not created here."""
    if not isinstance(value, ir.Expr):
        return True  # an argument, a constant, another variable
    if value.op == "call":
        function = state.typemap[value.func.name]
        if isinstance(function, types.Dispatcher):
            result = function.dispatcher.overloads.get(state.calltypes[value].args)
            return result is not None and not getattr(result.library, "counts", True)
        return isinstance(function, types.Function) and function.typing_key in (carray, part, words)
    if value.op == "static_getitem":
        return all(isinstance(part, int | slice) for part in _parts(value.index, tuple))
    if value.op == "getitem":
        index = _parts(state.typemap[value.index.name], types.BaseTuple)
        return all(isinstance(part, types.Integer | types.SliceType) for part in index)
    return value.op in ("cast", "phi", "null", "undef", "build_tuple", "exhaust_iter")


def _parts(index: Any, kind: Any) -> Any:
    return index if isinstance(index, kind) else (index,)


def lowered_without_counting(target: Any) -> Any:
    """Return a context that does not count references."""
    own = target.subtarget(enable_nrt=False)
    vars(own).pop("nrt", None)
    return own
