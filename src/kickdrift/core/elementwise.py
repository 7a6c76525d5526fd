"""Operations on arrays in place: on whole arrays in the interpreter, as loops in compiled code.

Numba compiles a loop ten times as fast as its general assignment to a slice, which broadcasts and formats errors.
"""

from typing import Any

from numba.extending import overload


def assign(out: Any, values: Any) -> None:
    """Overwrite an array by another one of its size, or by a number."""
    out[:] = values


@overload(assign)  # type: ignore[untyped-decorator]
def _assign(out: Any, values: Any) -> Any:
    return _assign_each if hasattr(values, "ndim") else _assign_all


def _assign_each(out: Any, values: Any) -> None:
    for i in range(out.size):
        out[i] = values[i]


def _assign_all(out: Any, values: Any) -> None:
    for i in range(out.size):
        out[i] = values


def multiply(out: Any, factors: Any) -> None:
    """Multiply an array by another one of its size, or by a number, in place."""
    out *= factors


@overload(multiply)  # type: ignore[untyped-decorator]
def _multiply(out: Any, factors: Any) -> Any:
    return _multiply_each if hasattr(factors, "ndim") else _multiply_all


def _multiply_each(out: Any, factors: Any) -> None:
    for i in range(out.size):
        out[i] *= factors[i]


def _multiply_all(out: Any, factors: Any) -> None:
    for i in range(out.size):
        out[i] *= factors


def subtract_product(out: Any, factors: Any, values: Any) -> None:
    """Subtract factors * values from an array, all of one size, in place."""
    out -= factors * values


@overload(subtract_product)  # type: ignore[untyped-decorator]
def _subtract_product(out: Any, factors: Any, values: Any) -> Any:
    return _subtract_each_product


def _subtract_each_product(out: Any, factors: Any, values: Any) -> None:
    for i in range(out.size):
        out[i] -= factors[i] * values[i]
