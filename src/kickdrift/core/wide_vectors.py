"""Vector registers of 512 bits, for loops that are worth it."""

from typing import Any

from numba import types
from numba.extending import lower_builtin, type_callable

_ATTRIBUTE = '"prefer-vector-width"="512"'


def prefer_512_bits() -> None:
    """Have the compiled function that calls this use registers of 512 bits where there are any.

    LLVM prefers 256 bits on most of Intel's processors, which were clocked lower for the others. The function is compiled
    by itself, because inlined it would be as its caller is.
    """


@type_callable(prefer_512_bits)  # type: ignore[untyped-decorator]
def _type(context: Any) -> Any:
    return lambda: types.none


@lower_builtin(prefer_512_bits)  # type: ignore[untyped-decorator]
def _lower(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    set.add(builder.function.attributes, _ATTRIBUTE)  # whose own `add` knows no attributes of processors
    builder.function.attributes.add("noinline")
    return context.get_dummy_value()
