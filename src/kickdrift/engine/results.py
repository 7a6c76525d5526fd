"""Writing the result of a user's function into an array of the engine.

An assignment to a slice would do the same, but pulls Numba's general one into each function, with the text of its
error: 2 of the 2.6 s that compiling a force of one line took.
"""

from typing import Any

import numpy as np
from numba import types
from numba.extending import overload


def write_result(out: Any, result: Any) -> None:
    """Overwrite `out` with a number, or with an array, list or tuple that broadcasts to it."""
    out[...] = returned(result if result is None else np.asarray(result))


def returned(value: Any) -> Any:
    """Refuse None and complex numbers, which NumPy converts to NaN and to their real parts.

    A function that returns None has no return statement, or lacks the argument `out`.
    """
    if value is None:
        raise TypeError("it returned None")
    if isinstance(value, complex) or getattr(getattr(value, "dtype", None), "kind", "f") == "c":
        raise TypeError("it returned complex numbers")
    return value


@overload(write_result, jit_options={"no_cpython_wrapper": True, "no_cfunc_wrapper": True})  # type: ignore[untyped-decorator]
def _write_result(out: Any, result: Any) -> Any:
    if isinstance(result, types.Number | types.Boolean):
        return _fill
    if isinstance(result, types.UniTuple | types.List) and isinstance(result.dtype, types.Number) and out.ndim == 1:
        return _write_vector
    if isinstance(result, types.Array) and 1 <= result.ndim <= out.ndim <= 2:
        return {(1, 1): _write_vector, (1, 2): _write_row, (2, 2): _write_plane}[result.ndim, out.ndim]
    return _write_anything


def _fill(out: Any, result: Any) -> None:
    for i in range(out.size):
        out.flat[i] = result


def _write_vector(out: Any, result: Any) -> None:
    if len(result) == out.size:
        for i in range(
            len(result)
        ):  # a constant for tuples, whose numbers stay in registers where the loop is unrolled
            out[i] = result[i]
    elif len(result) == 1:
        for i in range(out.size):
            out[i] = result[0]
    else:
        raise ValueError("it returned an array of another shape")


def _write_row(out: Any, result: Any) -> None:
    for i in range(out.shape[0]):
        write_result(out[i], result)


def _write_plane(out: Any, result: Any) -> None:
    if result.shape[0] == out.shape[0]:
        for i in range(out.shape[0]):
            write_result(out[i], result[i])
    elif result.shape[0] == 1:
        for i in range(out.shape[0]):
            write_result(out[i], result[0])
    else:
        raise ValueError("it returned an array of another shape")


def _write_anything(out: Any, result: Any) -> None:
    out[...] = np.asarray(result)
