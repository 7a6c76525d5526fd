"""Views of memory without cost, which compiled flows and the loop pass to each other.

Passing four arrays to a function by value costs 7 ns a call (each is seven machine words); passing the address of a
block that describes them costs 2 ns, and the views made from it vanish when the compiler inlines them.
"""

from ctypes import addressof, c_char
from typing import Any

import numpy as np
from llvmlite import ir
from numba import carray, types
from numba.core.imputils import impl_ret_borrowed
from numba.extending import intrinsic
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled

_FLOATS = types.CPointer(types.float64)
_INTEGERS = types.CPointer(types.int64)
_WORD = ir.IntType(64)

SIZE = SIZE_OF_V = 0  # bound by the caller of `small_arrays`


@intrinsic
def word(typing_context: Any, block: Any, index: Any) -> Any:
    """Word of a block of machine words at an address."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        words = builder.inttoptr(arguments[0], _WORD.as_pointer())
        return builder.load(builder.gep(words, [arguments[1]]))

    return types.intp(types.intp, types.intp), generate


@intrinsic
def put_word(typing_context: Any, block: Any, index: Any, value: Any) -> Any:
    """Overwrite a word of a block of machine words at an address."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        words = builder.inttoptr(arguments[0], _WORD.as_pointer())
        builder.store(arguments[2], builder.gep(words, [arguments[1]]))
        return context.get_dummy_value()

    return types.none(types.intp, types.intp, types.intp), generate


@intrinsic
def integers_at(typing_context: Any, address: Any) -> Any:
    """Pointer to the integers at an address."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(_INTEGERS))

    return _INTEGERS(types.intp), generate


@intrinsic
def floats_at(typing_context: Any, address: Any) -> Any:
    """Pointer to the floats at an address."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(_FLOATS))

    return _FLOATS(types.intp), generate


@intrinsic
def _floats_of(typing_context: Any, array: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return context.make_array(signature.args[0])(context, builder, arguments[0]).data

    return _FLOATS(array), generate


@intrinsic
def word_in(typing_context: Any, array: Any, index: Any) -> Any:
    """Bits of an element of a one-dimensional array of floats, as a machine word."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        words = builder.bitcast(data, _WORD.as_pointer())
        return builder.load(builder.gep(words, [arguments[1]]))

    return types.intp(array, types.intp), generate


@intrinsic(prefer_literal=True)
def floats_on_stack(typing_context: Any, size: Any) -> Any:
    """Pointer to a fresh local buffer of a constant number of floats, which the compiler can keep in registers.

    Its contents are undefined: `cgutils.alloca_once` would fill it with zeros at every call of the function.
    """
    count = size.literal_value

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        with builder.goto_entry_block():
            storage = builder.alloca(ir.ArrayType(ir.DoubleType(), count))
        if count >= 8:
            storage.align = 64  # vectors that cross cache lines take twice as long
        return builder.bitcast(storage, context.get_value_type(_FLOATS))

    return _FLOATS(size), generate


@compiled(inline=True)
def arrays(block: int) -> Any:
    """Return the one-dimensional arrays x, v, params and work, whose addresses and sizes are the words of a block."""
    return (
        carray(floats_at(word(block, 0)), (word(block, 1),)),
        carray(floats_at(word(block, 2)), (word(block, 3),)),
        carray(floats_at(word(block, 4)), (word(block, 5),)),
        carray(floats_at(word(block, 6)), (word(block, 7),)),
    )


def small_arrays(block: int) -> Any:
    """Return the arrays as `arrays` does, with sizes known at compile time, so that loops over them are unrolled."""
    x, v, params, work = arrays(block)
    return carray(_floats_of(x), (SIZE,)), carray(_floats_of(v), (SIZE_OF_V,)), params, work


@compiled(inline=True)
def shaped(array: NDArray[np.float64], shape: tuple[int, ...]) -> Any:
    """Return a view of a one-dimensional array in another shape (``reshape`` calls into C, at 10 ns a call)."""
    return carray(_floats_of(array), shape)


@intrinsic
def read_only(typing_context: Any, array: Any) -> Any:
    """Return the same array, which compiled code may not write to."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return impl_ret_borrowed(context, builder, signature.return_type, arguments[0])

    return array.copy(readonly=True)(array), generate


def start_of_array(array: NDArray[Any]) -> int:
    """Return the address of a contiguous array, 0 of an empty one; `array.ctypes` takes three times as long."""
    if not array.size:
        return 0
    return addressof(c_char.from_buffer(array.data)) if array.flags.writeable else int(array.ctypes.data)
