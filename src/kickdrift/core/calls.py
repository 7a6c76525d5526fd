"""Calling compiled functions by their address: how one compiled loop runs functions that it was not compiled with.

Numba's own first-class functions do the same, but are typed by the function where there is only one, which neither
caches nor stays one loop, and warn that they are experimental. Errors raised in the function called reach the caller.
"""

from typing import Any

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from kickdrift.core.compilation import Function


def address_of(function: Function, signature: Any) -> int:
    """Compile a function for a signature, if it is not yet, and return the address of its machine code.

    The caller keeps the function alive for as long as the address is used.
    """
    dispatcher: Any = function
    # Asking the dispatcher takes 0.1 ms, and the hash of a signature, of which there are few, 10 us.
    found = dispatcher.addresses.get(id(signature))
    if found is None:
        dispatcher.compile(signature)
        result = dispatcher.get_compile_result(signature)
        found = dispatcher.addresses[id(signature)] = (
            signature,
            result.library.get_pointer_to_function(result.fndesc.llvm_func_name),
        )
    address: int = found[1]
    return address


def caller(signature: Any) -> Any:
    """Make ``call(address, arguments)`` for compiled code, which calls the function of this signature at an address."""

    @intrinsic
    def call(typing_context: Any, address: Any, arguments: Any) -> Any:
        def generate(context: Any, builder: Any, own_signature: Any, values: Any) -> Any:
            convention = context.call_conv
            function_type = convention.get_function_type(signature.return_type, signature.args)
            function = builder.inttoptr(values[0], function_type.as_pointer())
            members = cgutils.unpack_tuple(builder, values[1], len(signature.args))
            status, value = convention.call_function(builder, function, signature.return_type, signature.args, members)
            with cgutils.if_unlikely(builder, status.is_error):
                convention.return_status_propagate(builder, status)
            return context.get_dummy_value() if signature.return_type is types.none else value

        return signature.return_type(types.intp, types.Tuple(signature.args)), generate

    return call


def raised_in_compiled_code(error: BaseException) -> bool:
    """Whether an exception is from compiled code: Numba adds a frame without globals for the place in the source.

    Not to those of its checks of bounds, which no other code words so.
    """
    if isinstance(error, IndexError) and error.args == ("index is out of bounds",):
        return True
    traceback = error.__traceback__
    while traceback is not None and traceback.tb_next is not None:
        traceback = traceback.tb_next
    return traceback is not None and not traceback.tb_frame.f_globals


def call_interpreted(function: Function, arguments: tuple[Any, ...]) -> None:
    """Call a Python function, as `caller` does a compiled one."""
    function(*arguments)
