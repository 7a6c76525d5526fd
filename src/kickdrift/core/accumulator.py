"""Arrays `out` of compiled functions whose elements are added to a sum as they are written.

An *accumulator* stands for an array: ``out[i] = value`` adds h times the value to element i of another one, with a plain or a
compensated sum, or counts how often element i is written. Nothing can be read from it. A force can thus update the velocities
in one pass over memory instead of two and an array of accelerations.
"""

import operator
from typing import Any

from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, AttributeTemplate, infer_getattr, infer_global, signature
from numba.extending import intrinsic, lower_builtin, lower_getattr, models, register_model


class Accumulator(types.Type):  # type: ignore[misc]
    """The type of an accumulator, given by the types of its members, see `added_to`."""

    def __init__(self, values: Any, h: Any, factors: Any, residual: Any) -> None:
        self.values, self.h, self.factors, self.residual = values, h, factors, residual
        super().__init__(name=f"Accumulator({values}, {h}, {factors}, {residual})")


@register_model(Accumulator)
class _Model(models.StructModel):  # type: ignore[misc]
    def __init__(self, manager: Any, type_: Accumulator) -> None:
        members = [(name, getattr(type_, name)) for name in ("values", "h", "factors", "residual")]
        super().__init__(manager, type_, members)


@intrinsic  # type: ignore[untyped-decorator]
def added_to(typing_context: Any, values: Any, h: Any, factors: Any, residual: Any) -> Any:
    """Make an accumulator that adds h times each value written to `values`, or 1.0 if h is None.

    Values are multiplied by `factors`, an array, or None. The `residual` is an array of the rounding errors of the sums so far,
    for compensated summation, or None.
    """
    made = Accumulator(values, h, factors, residual)

    def generate(context: Any, builder: Any, own_signature: Any, arguments: Any) -> Any:
        new = cgutils.create_struct_proxy(made)(context, builder)
        new.values, new.h, new.factors, new.residual = arguments
        result = new._getvalue()
        context.nrt.incref(builder, made, result)
        return result

    return made(values, h, factors, residual), generate


@infer_getattr
class _Attributes(AttributeTemplate):  # type: ignore[misc]
    key = Accumulator

    def resolve_shape(self, out: Accumulator) -> Any:
        return types.UniTuple(types.intp, out.values.ndim)

    def resolve_size(self, out: Accumulator) -> Any:
        return types.intp


@lower_getattr(Accumulator, "shape")  # type: ignore[untyped-decorator]
def _shape(context: Any, builder: Any, type_: Accumulator, value: Any) -> Any:
    return _array(context, builder, type_, value).shape


@lower_getattr(Accumulator, "size")  # type: ignore[untyped-decorator]
def _size(context: Any, builder: Any, type_: Accumulator, value: Any) -> Any:
    return _array(context, builder, type_, value).nitems


def _array(context: Any, builder: Any, type_: Accumulator, value: Any) -> Any:
    accumulator = cgutils.create_struct_proxy(type_)(context, builder, value=value)
    return context.make_array(type_.values)(context, builder, value=accumulator.values)


@infer_global(operator.setitem)
class _Written(AbstractTemplate):  # type: ignore[misc]
    def generic(self, arguments: Any, keywords: Any) -> Any:
        """Accept numbers at integer indices, one for each dimension."""
        out, index, _ = arguments
        if not isinstance(out, Accumulator):
            return None
        indices = list(index) if isinstance(index, types.BaseTuple) else [index]
        if len(indices) != out.values.ndim or not all(isinstance(each, types.Integer) for each in indices):
            return None
        return signature(types.none, out, index, types.float64)


@lower_builtin(operator.setitem, Accumulator, types.Integer, types.Float)  # type: ignore[untyped-decorator]
@lower_builtin(operator.setitem, Accumulator, types.BaseTuple, types.Float)  # type: ignore[untyped-decorator]
def _add(context: Any, builder: Any, own_signature: Any, arguments: Any) -> Any:
    from numba.np.arrayobj import basic_indexing  # takes 20 ms, and is needed only to compile

    out, index, _ = own_signature.args
    indices, each = [arguments[1]], [index]
    if isinstance(index, types.BaseTuple):
        indices, each = cgutils.unpack_tuple(builder, arguments[1], len(index)), list(index)
    accumulator = cgutils.create_struct_proxy(out)(context, builder, value=arguments[0])

    def element(type_: Any, array: Any) -> Any:
        made = context.make_array(type_)(context, builder, value=array)
        pointer, _, _ = basic_indexing(
            context, builder, type_, made, each, indices, boundscheck=context.enable_boundscheck
        )
        return pointer

    at = element(out.values, accumulator.values)
    before, written = builder.load(at), arguments[2]
    if out.factors is not types.none:
        written = builder.fmul(written, builder.load(element(out.factors, accumulator.factors)))
    increment = before.type(1.0) if out.h is types.none else builder.fmul(accumulator.h, written)
    if out.residual is types.none:
        builder.store(builder.fadd(before, increment), at)
        return context.get_dummy_value()
    # Kahan's sum, as in `kickdrift.engine.flows.sums`.
    lost_at = element(out.residual, accumulator.residual)
    increment = builder.fsub(increment, builder.load(lost_at))
    total = builder.fadd(before, increment)
    builder.store(builder.fsub(builder.fsub(total, before), increment), lost_at)
    builder.store(total, at)
    return context.get_dummy_value()
