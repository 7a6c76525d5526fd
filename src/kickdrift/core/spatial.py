"""Spatial vectors for compiled code: six numbers that stay in vector registers.

Rows of 6x6 blocks, velocities with angular velocities, forces with torques. Written number by number, arithmetic on them is
compiled number by number, since Numba packs loops alone, and those of six turns are unrolled before it does.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, models, register_model

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector

_NUMBER, _INDEX = ir.DoubleType(), ir.IntType(32)
_SIX = ir.VectorType(_NUMBER, 6)
_FLAGS = ("reassoc", "nsz", "arcp", "contract", "afn")


class _Spatial(types.Type):  # type: ignore[misc]
    """Six floats."""

    def __init__(self) -> None:
        super().__init__(name="Spatial")


SPATIAL = _Spatial()


@register_model(_Spatial)
class _Model(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _SIX)


def _place(context: Any, builder: Any, kind: Any, array: Any, index: Any) -> Any:
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), _SIX.as_pointer())


def _spread(builder: Any, number: Any) -> Any:
    """Six times the same number."""
    nothing = ir.Constant(_SIX, ir.Undefined)
    one = builder.insert_element(nothing, number, ir.Constant(_INDEX, 0))
    return builder.shuffle_vector(one, nothing, ir.Constant(ir.VectorType(_INDEX, 6), [0] * 6))


@intrinsic  # type: ignore[untyped-decorator]
def _read(typing_context: Any, array: Any, index: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load(_place(context, builder, signature.args[0], *arguments), align=8)

    return SPATIAL(array, types.intp), generate


@intrinsic  # type: ignore[untyped-decorator]
def _write(typing_context: Any, array: Any, index: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.store(arguments[2], _place(context, builder, signature.args[0], *arguments[:2]), align=8)
        return context.get_dummy_value()

    return types.none(array, types.intp, SPATIAL), generate


@intrinsic  # type: ignore[untyped-decorator]
def scaled(typing_context: Any, factor: Any, a: Any) -> Any:
    """Multiple of a spatial vector."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fmul(_spread(builder, arguments[0]), arguments[1], flags=_FLAGS)

    return SPATIAL(types.float64, SPATIAL), generate


@intrinsic  # type: ignore[untyped-decorator]
def plus_scaled(typing_context: Any, a: Any, factor: Any, b: Any) -> Any:
    """Sum of a spatial vector and a multiple of another."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        share = builder.fmul(_spread(builder, arguments[1]), arguments[2], flags=_FLAGS)
        return builder.fadd(arguments[0], share, flags=_FLAGS)

    return SPATIAL(SPATIAL, types.float64, SPATIAL), generate


@intrinsic  # type: ignore[untyped-decorator]
def _moved(typing_context: Any, a: Any, x: Any, y: Any, z: Any) -> Any:
    """With s = (x, y, z) and u the first three numbers of a, add s x u to the last three."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        a, *s = arguments
        total, nothing = a, ir.Constant(_SIX, None)
        # s x u = s' u'' - s'' u', each prime one place ahead
        for ahead, sign in ((1, builder.fadd), (2, builder.fsub)):
            factors = nothing
            for k in range(3):
                factors = builder.insert_element(factors, s[(k + ahead) % 3], ir.Constant(_INDEX, 3 + k))
            places = [6, 6, 6, *((k + 3 - ahead) % 3 for k in range(3))]
            numbers = builder.shuffle_vector(a, nothing, ir.Constant(ir.VectorType(_INDEX, 6), places))
            total = sign(total, builder.fmul(factors, numbers, flags=_FLAGS), flags=_FLAGS)
        return total

    return SPATIAL(SPATIAL, types.float64, types.float64, types.float64), generate


@intrinsic  # type: ignore[untyped-decorator]
def inner(typing_context: Any, a: Any, b: Any) -> Any:
    """Inner product."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(_NUMBER, [_NUMBER, _SIX])
        total = cgutils.get_or_insert_function(builder.module, kind, "llvm.vector.reduce.fadd.v6f64")
        products = builder.fmul(*arguments, flags=_FLAGS)
        return builder.call(total, [ir.Constant(_NUMBER, 0.0), products], fastmath=_FLAGS)

    return types.float64(SPATIAL, SPATIAL), generate


@compiled(inline=True, fast=True)
def moved(a: Any, s: Vector) -> Any:
    """Add to the last three numbers the cross product of s with the first three."""
    return _moved(a, s[0], s[1], s[2])


@compiled(inline=True, fast=True)
def spatial_of(array: Any, first: int) -> Any:
    """Read six neighbouring numbers of an array."""
    return _read(array, first)


@compiled(inline=True, fast=True)
def put_spatial_of(array: Any, first: int, value: Any) -> None:
    """Write six neighbouring numbers of an array."""
    _write(array, first, value)


@compiled(inline=True, fast=True)
def spatial_at(table: Any, row: int, column: int) -> Any:
    """Read six neighbouring numbers of a row of a table."""
    return _read(table, row * table.shape[1] + column)


@compiled(inline=True, fast=True)
def put_spatial(table: Any, row: int, column: int, value: Any) -> None:
    """Write six neighbouring numbers of a row of a table."""
    _write(table, row * table.shape[1] + column, value)
