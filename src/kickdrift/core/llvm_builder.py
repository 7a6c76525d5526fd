"""Shorter LLVM code for structures and calls than Numba writes."""

from typing import Any

from llvmlite import ir as llvm
from llvmlite.ir.instructions import InsertValue
from numba import types
from numba.core import cgutils
from numba.core.imputils import user_function


class Builder(llvm.IRBuilder):  # type: ignore[misc]
    """Extracts members of structures directly from the instructions that inserted them."""

    def extract_value(self, agg: Any, idx: Any, name: str = "") -> Any:
        """Return a member."""
        path = list(idx) if isinstance(idx, tuple | list) else [idx]
        while isinstance(agg, InsertValue) and agg.function is self.function:
            given = list(agg.indices)
            if given == path[: len(given)]:
                agg, path = agg.value, path[len(given) :]
                if not path:
                    return agg
            elif path == given[: len(path)]:
                break
            else:
                agg = agg.aggregate
        return super().extract_value(agg, path, name)


def calling(part: Any, description: Any) -> Any:
    """Return the implementation of calls of a part; its status is not checked if it cannot fail."""
    if part.fails:
        return user_function(description, [part])
    result, arguments = description.restype, description.argtypes

    def call(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        function = context.declare_function(builder.module, description)
        place = cgutils.alloca_once(builder, context.call_conv.get_return_type(result).pointee)
        no_error = llvm.Constant(function.function_type.args[1], None)
        builder.call(function, [place, no_error, *context.get_arg_packer(arguments).as_arguments(builder, values)])
        if result == types.none:
            return context.get_dummy_value()
        return context.get_returned_value(builder, result, builder.load(place))

    call.signature, call.libs = arguments, (part,)  # type: ignore[attr-defined]
    return call
