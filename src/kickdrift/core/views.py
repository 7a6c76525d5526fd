"""Views of one-dimensional arrays that cost nothing in compiled code."""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core.imputils import impl_ret_borrowed
from numba.extending import lower_builtin, type_callable
from numpy.typing import NDArray


def part(array: NDArray[np.float64], start: int, size: int) -> NDArray[np.float64]:
    """Return a view of some elements of a one-dimensional array: a slice whose ends compiled code does not check."""
    return array[start : start + size]


def words(array: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return a view of the floats of a one-dimensional array as integers of the same bits."""
    return array.view(np.int64)


def float_of(bits: int) -> float:
    """Return the float of these bits."""
    return float(np.int64(bits).view(np.float64))


def _populate(view: Any, **members: Any) -> None:
    from numba.np.arrayobj import populate_array  # takes 20 ms, and is needed only to compile

    populate_array(view, **members)


@type_callable(part)  # type: ignore[untyped-decorator]
def _type_of_part(context: Any) -> Any:
    def typer(array: Any, start: Any, size: Any) -> Any:
        return array.copy(layout="C")

    return typer


@lower_builtin(part, types.Array, types.Integer, types.Integer)  # type: ignore[untyped-decorator]
def _lower_part(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    whole = context.make_array(signature.args[0])(context, builder, arguments[0])
    view = context.make_array(signature.return_type)(context, builder)
    _populate(
        view,
        data=builder.gep(whole.data, [arguments[1]]),
        shape=[arguments[2]],
        strides=[context.get_constant(types.intp, 8)],
        itemsize=whole.itemsize,
        meminfo=whole.meminfo,
        parent=whole.parent,
    )
    return impl_ret_borrowed(context, builder, signature.return_type, view._getvalue())


@type_callable(words)  # type: ignore[untyped-decorator]
def _type_of_words(context: Any) -> Any:
    def typer(array: Any) -> Any:
        return array.copy(dtype=types.int64, layout="C")

    return typer


@lower_builtin(words, types.Array)  # type: ignore[untyped-decorator]
def _lower_words(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    floats = context.make_array(signature.args[0])(context, builder, arguments[0])
    view = context.make_array(signature.return_type)(context, builder)
    _populate(
        view,
        data=builder.bitcast(floats.data, ir.IntType(64).as_pointer()),
        shape=floats.shape,
        strides=floats.strides,
        itemsize=floats.itemsize,
        meminfo=floats.meminfo,
        parent=floats.parent,
    )
    return impl_ret_borrowed(context, builder, signature.return_type, view._getvalue())


@type_callable(float_of)  # type: ignore[untyped-decorator]
def _type_of_float_of(context: Any) -> Any:
    def typer(bits: Any) -> Any:
        return types.float64

    return typer


@lower_builtin(float_of, types.Integer)  # type: ignore[untyped-decorator]
def _lower_float_of(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return builder.bitcast(arguments[0], ir.DoubleType())
