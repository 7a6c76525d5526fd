"""Lowering of Numba's intermediate representation to a third of the LLVM code, two thirds of which LLVM would remove again.

A variable is loaded once a block. An element of a contiguous array is a load or a store, for which Numba copies the array's
descriptor to the stack. The machine code is the same, but for the order of sums in functions with fast mathematics.
"""

import operator
from typing import Any

from llvmlite import ir as llvm
from llvmlite.ir.instructions import Ret
from numba import carray, types
from numba.core import cgutils
from numba.core.errors import LoweringError, new_error_context  # type: ignore[attr-defined]
from numba.core.lowering import Lower as NumbaLower
from numba.cpython.builtins import max_vararg, min_vararg
from numba.np.arrayobj import get_cfarray_intrinsic

from kickdrift.core.llvm_builder import Builder

# Functions of Numba's that only call an intrinsic with their first arguments.
_IN_PLACE = {carray: (get_cfarray_intrinsic("C", None), 2), min: (min_vararg, 1), max: (max_vararg, 1)}
_ELEMENTS = (types.float64, types.int64)
_WORD = llvm.IntType(64)
_DATA, _SHAPE = 4, 5  # fields of Numba's arrays


class Lower(NumbaLower):  # type: ignore[misc]
    """Lowers one function to LLVM."""

    def init(self) -> None:
        """Begin without known values."""
        super().init()
        self._counted: dict[Any, bool] = {}
        self._at_hand: dict[Any, tuple[Any, Any, Any]] = {}

    def setup_function(self, fndesc: Any) -> None:
        """Begin a function."""
        super().setup_function(fndesc)
        self.builder = Builder(self.entry_block)
        self.call_helper = self.call_conv.init_call_helper(self.builder)

    def post_lower(self) -> None:
        """Note whether the function can fail."""
        super().post_lower()
        ends = [block.terminator for block in self.function.blocks if isinstance(block.terminator, Ret)]
        self.library.fails = not all(_is_zero(end.return_value) for end in ends)

    def lower_block(self, block: Any) -> None:
        """Lower a block; errors name the place."""
        self.pre_block(block)
        for statement in block.body:
            self.loc = statement.loc
            try:
                self.lower_inst(statement)
            except Exception:
                with new_error_context('lowering "{inst}" at {loc}', inst=statement, loc=self.loc, errcls_=self._error):
                    raise
        self.post_block(block)

    def _error(self, message: str) -> LoweringError:
        return LoweringError(message, loc=self.loc)

    def incref(self, typ: Any, val: Any) -> None:
        """Increment the reference count of a value that has one."""
        if self._is_counted(typ):
            super().incref(typ, val)

    def decref(self, typ: Any, val: Any) -> None:
        """Decrement the reference count of a value that has one."""
        if self._is_counted(typ):
            super().decref(typ, val)

    def _is_counted(self, type_: Any) -> bool:
        if not self.context.enable_nrt:
            return False
        if type_ not in self._counted:
            self._counted[type_] = bool(self.context.data_model_manager[type_].contains_nrt_meminfo())
        return self._counted[type_]

    def delvar(self, name: str) -> None:
        """End the life of a variable, which matters only if it counts references."""
        if self._is_counted(self.typeof(name)) or self.generator_info:
            super().delvar(name)
            self._at_hand.pop(name, None)

    def loadvar(self, name: str) -> Any:
        """Load a variable, or use the value that the block has already loaded or stored."""
        if name in self._blk_local_varmap or self.generator_info:
            return super().loadvar(name)
        return self._once(name, None, lambda: super(Lower, self).loadvar(name))

    def storevar(self, value: Any, name: str, argidx: Any = None) -> None:
        """Store a variable."""
        if self.generator_info or self._is_counted(self.typeof(name)):
            super().storevar(value, name, argidx)  # loads the old value, to decrement its count
            self._at_hand.pop(name, None)
            return
        if name in self._singly_assigned_vars:
            self._blk_local_varmap[name] = value
            return
        self._alloca_var(name, self.typeof(name))
        self.builder.store(value, self.getvar(name))
        self._at_hand[name] = self.builder.block, None, value

    def _once(self, key: Any, of: Any, make: Any) -> Any:
        """Return a value that this block has already computed from `of`, or compute it by `make`."""
        block, before, value = self._at_hand.get(key, (None, None, None))
        if block is not self.builder.block or before is not of:
            value = make()
            self._at_hand[key] = self.builder.block, of, value
        return value

    def lower_assign(self, ty: Any, inst: Any) -> Any:
        """Lower the right-hand side of an assignment; a function has no value."""
        return self.context.get_dummy_value() if isinstance(ty, types.Dispatcher) else super().lower_assign(ty, inst)

    def lower_binop(self, resty: Any, expr: Any, op: Any) -> Any:
        """Lower an operation on numbers; Numba would search for special versions for each constant."""
        signature = self.fndesc.calltypes[expr]
        if (
            not all(isinstance(type_, types.Number | types.Boolean) for type_ in signature.args)
            or op in _WITH_CONSTANTS
        ):
            return super().lower_binop(resty, expr, op)
        operands = [
            self.context.cast(self.builder, self.loadvar(operand.name), self.typeof(operand.name), type_)
            for operand, type_ in zip((expr.lhs, expr.rhs), signature.args, strict=True)
        ]
        found = self.context.typing_context.resolve_function_type(op, signature.args, {})
        implementation = self.context.get_function(self.context.typing_context.resolve_value_type(op), found)
        result = implementation(self.builder, operands)
        return self.context.cast(self.builder, result, signature.return_type, resty)

    def _lower_call_normal(self, fnty: Any, expr: Any, signature: Any) -> Any:
        """Lower a call, or the body of the function where that is shorter."""
        if getattr(fnty, "typing_key", None) is range and signature.return_type == types.range_state64_type:
            return self._range(self.fold_call_args(fnty, signature, expr.args, expr.vararg, expr.kws))
        intrinsic, count = _IN_PLACE.get(getattr(fnty, "typing_key", None), (None, 0))
        if intrinsic is None or not all(map(_is_plain, signature.args)):
            return super()._lower_call_normal(fnty, expr, signature)
        values = self.fold_call_args(fnty, signature, expr.args, expr.vararg, expr.kws)[:count]
        typing, types_ = self.context.typing_context, signature.args[:count]
        function = typing.resolve_value_type(intrinsic)
        found = self.context.get_function(function, typing.resolve_function_type(function, types_, {}))
        return found(self.builder, values)

    def _range(self, ends: list[Any]) -> Any:
        """Return a range in Numba's representation."""
        start = ends[0] if len(ends) > 1 else _WORD(0)
        step = ends[2] if len(ends) > 2 else _WORD(1)
        return self._structure(types.range_state64_type, start, ends[1] if len(ends) > 1 else ends[0], step)

    def _structure(self, type_: Any, *members: Any) -> Any:
        value = llvm.Constant(self.context.get_value_type(type_), llvm.Undefined)
        for place, member in enumerate(members):
            value = self.builder.insert_value(value, member, place)
        return value

    def lower_expr(self, resty: Any, expr: Any) -> Any:
        """Lower an expression; a loop over a range with a constant step counts the iterations that are left."""
        if expr.op == "getiter" and resty == types.range_iter64_type:
            start, stop, step = (self.builder.extract_value(self.loadvar(expr.value.name), k) for k in range(3))
            if isinstance(step, llvm.Constant) and step.constant != 0:
                return self._iterator(start, stop, step)
        elif expr.op == "iternext" and self.typeof(expr.value.name) == types.range_iter64_type:
            return self._next(self.loadvar(expr.value.name), resty)
        elif expr.op in ("pair_first", "pair_second") and not self._is_counted(self.typeof(expr.value.name)):
            return self.builder.extract_value(self.loadvar(expr.value.name), 0 if expr.op == "pair_first" else 1)
        return super().lower_expr(resty, expr)

    def _iterator(self, start: Any, stop: Any, step: Any) -> Any:
        at, left = (cgutils.alloca_once(self.builder, _WORD) for _ in range(2))
        self.builder.store(start, at)
        if step.constant < 0:
            start, stop = stop, start
        way, stride = self.builder.sub(stop, start), abs(step.constant)
        is_any = self.builder.icmp_signed(">", way, _WORD(0))
        if stride > 1:
            way = self.builder.sdiv(self.builder.add(way, _WORD(stride - 1)), _WORD(stride))
        self.builder.store(self.builder.select(is_any, way, _WORD(0)), left)
        return self._structure(types.range_iter64_type, at, stop, step, left)

    def _next(self, iterator: Any, pair: Any) -> Any:
        at, step, left = (self.builder.extract_value(iterator, k) for k in (0, 2, 3))
        count, value = self.builder.load(left), self.builder.load(at)
        is_left = self.builder.icmp_signed(">", count, _WORD(0))
        with self.builder.if_then(is_left):
            self.builder.store(self.builder.sub(count, _WORD(1), flags=["nsw"]), left)
            self.builder.store(self.builder.add(value, step), at)
        return self._structure(pair, value, is_left)

    def lower_getitem(self, resty: Any, expr: Any, value: Any, index: Any, signature: Any) -> Any:
        """Read an element."""
        if (indices := self._indices(value, index)) is None or resty != self.typeof(value.name).dtype:
            return super().lower_getitem(resty, expr, value, index, signature)
        return self.builder.load(self._pointer(value.name, indices))

    def lower_setitem(self, target_var: Any, index_var: Any, value_var: Any, signature: Any) -> Any:
        """Write an element."""
        if (indices := self._indices(target_var, index_var)) is None:
            return super().lower_setitem(target_var, index_var, value_var, signature)
        element = self.typeof(target_var.name).dtype
        value = self.context.cast(self.builder, self.loadvar(value_var.name), self.typeof(value_var.name), element)
        return self.builder.store(value, self._pointer(target_var.name, indices))

    def _indices(self, array: Any, index: Any) -> list[Any] | None:
        """Return the indices of one element of a contiguous array of 64-bit numbers; None for anything else."""
        array_type, index_type = self.typeof(array.name), self.typeof(index.name)
        if not isinstance(array_type, types.Array) or array_type.layout != "C" or array_type.dtype not in _ELEMENTS:
            return None
        if not array_type.aligned or self.context.enable_boundscheck:
            return None
        if _is_index(index_type) and array_type.ndim == 1:
            return [self._whole(self.loadvar(index.name), index_type)]
        if not (isinstance(index_type, types.BaseTuple) and len(index_type) == array_type.ndim):
            return None
        if not all(map(_is_index, index_type)):
            return None
        indices = self.loadvar(index.name)
        return [self._whole(self.builder.extract_value(indices, k), type_) for k, type_ in enumerate(index_type)]

    def _whole(self, value: Any, type_: Any) -> Any:
        return self.context.cast(self.builder, value, type_, types.intp)

    def _pointer(self, name: str, indices: list[Any]) -> Any:
        """Return a pointer to an element; negative indices count from the end."""
        array, place = self.loadvar(name), None
        for axis, index in enumerate(indices):
            size = self._field(name, array, (_SHAPE, axis))
            if not (isinstance(index, llvm.Constant) and index.constant >= 0):
                is_negative = self.builder.icmp_signed("<", index, llvm.Constant(index.type, 0))
                index = self.builder.select(is_negative, self.builder.add(index, size), index)
            place = index if place is None else self.builder.add(self.builder.mul(place, size), index)
        return self.builder.gep(self._field(name, array, (_DATA,)), [place])

    def _field(self, name: str, array: Any, path: tuple[int, ...]) -> Any:
        return self._once((name, path), array, lambda: self.builder.extract_value(array, path))


_WITH_CONSTANTS = (operator.pow, operator.ipow)


def _is_plain(type_: Any) -> bool:
    """Whether an argument is a number, a tuple of numbers, a pointer, or omitted."""
    members = type_ if isinstance(type_, types.BaseTuple) else (type_,)
    return all(isinstance(member, types.Number | types.Boolean | types.CPointer | types.Omitted) for member in members)


def _is_zero(value: Any) -> bool:
    return isinstance(value, llvm.Constant) and value.constant == 0


def _is_index(type_: Any) -> bool:
    return isinstance(type_, types.Integer) and type_.signed and type_.bitwidth == 64
