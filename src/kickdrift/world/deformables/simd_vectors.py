"""LLVM vectors of eight numbers, for eight triangles or particles at once, with Python's operators."""

from collections.abc import Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from kickdrift.world.contacts.layout import WIDTH
from kickdrift.world.contacts.simd_transpose import transposed

NUMBER, WORD = ir.DoubleType(), ir.IntType(64)
VECTOR = ir.VectorType(NUMBER, WIDTH)
_FLAGS = ("contract", "nsz", "reassoc", "arcp")


class Lanes:
    """A vector of eight numbers in the code that is being generated."""

    def __init__(self, builder: Any, value: Any) -> None:
        self.builder, self.value = builder, value

    def __add__(self, other: "Lanes") -> "Lanes":
        return Lanes(self.builder, self.builder.fadd(self.value, other.value, flags=_FLAGS))

    def __sub__(self, other: "Lanes") -> "Lanes":
        return Lanes(self.builder, self.builder.fsub(self.value, other.value, flags=_FLAGS))

    def __mul__(self, other: "Lanes") -> "Lanes":
        return Lanes(self.builder, self.builder.fmul(self.value, other.value, flags=_FLAGS))

    def __truediv__(self, other: "Lanes") -> "Lanes":
        return Lanes(self.builder, self.builder.fdiv(self.value, other.value, flags=_FLAGS))

    def root(self) -> "Lanes":
        """Return the square root."""
        function = cgutils.get_or_insert_function(
            self.builder.module, ir.FunctionType(VECTOR, [VECTOR]), "llvm.sqrt.v8f64"
        )
        return Lanes(self.builder, self.builder.call(function, [self.value]))


def dot(a: Sequence[Lanes], b: Sequence[Lanes]) -> Lanes:
    """Return the inner product of two vectors of three components."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def same(builder: Any, number: Any) -> Lanes:
    """Return the same number in all lanes."""
    one = builder.insert_element(ir.Constant(VECTOR, ir.Undefined), number, ir.IntType(32)(0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), None)
    return Lanes(builder, builder.shuffle_vector(one, ir.Constant(VECTOR, ir.Undefined), zeros))


def begin_of(context: Any, builder: Any, kind: Any, array: Any) -> Any:
    """Return a pointer to the first number of an array."""
    return context.make_array(kind)(context, builder, array).data


def vector_pointer(builder: Any, begin: Any, index: Any) -> Any:
    """Return a pointer to eight numbers of an array, which need not be aligned."""
    return builder.bitcast(builder.gep(begin, [index]), VECTOR.as_pointer())


def loaded(builder: Any, begin: Any, index: Any) -> Lanes:
    """Return eight numbers of an array."""
    return Lanes(builder, builder.load(vector_pointer(builder, begin, index), align=8))


def plus(builder: Any, index: Any, more: int) -> Any:
    """Return an index that is larger by a constant."""
    return builder.add(index, WORD(more))


@intrinsic(prefer_literal=True)
def rows_to_fields(context: Any, table: Any, i: Any, column: Any, fields: Any, at: Any, size: Any) -> Any:
    """Copy three columns, from a constant one on, of eight rows of a table of width eight, from row i on, to three fields."""
    first = column.literal_value

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        table, fields = (begin_of(context, builder, signature.args[k], values[k]) for k in (0, 3))
        i, at, size = values[1], values[4], values[5]
        begin = builder.mul(i, WORD(WIDTH))
        rows = [
            builder.load(vector_pointer(builder, table, plus(builder, begin, WIDTH * k)), align=8) for k in range(WIDTH)
        ]
        for k, vector in enumerate(transposed(builder, rows)[first : first + 3]):
            place = builder.add(at, builder.mul(size, WORD(k)))
            builder.store(vector, vector_pointer(builder, fields, place), align=8)
        return context.get_dummy_value()

    word = types.int64
    return types.none(table, word, column, fields, word, word), generate


@intrinsic
def kick_lanes(
    context: Any, table: Any, i: Any, fields: Any, at: Any, more: Any, size: Any, time: Any, keep: Any, fall: Any
) -> Any:
    """Add to columns 4 to 6 of eight rows of a table of width eight, from row i on, and multiply them by `keep`.

    The addends are `fall`, and a time times column 3 times the sums of three fields each, from `at` and `more` on, which are
    then set to zero. Rows whose column 3 is zero do not change.
    """
    mass, first = 3, 4

    def row_of(numbers: Any, else_: Any) -> Any:
        return [else_] * first + list(numbers) + [else_] * (WIDTH - first - len(numbers))

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        table, fields = (begin_of(context, builder, signature.args[k], values[k]) for k in (0, 2))
        i, (at, more, size, time, keep, fall) = values[1], values[3:]
        zero, one = ir.Constant(VECTOR, None), ir.Constant(VECTOR, [1.0] * WIDTH)
        forces = []
        for k in range(3):
            places = [builder.add(begin, builder.mul(size, WORD(k))) for begin in (at, more)]
            forces.append((loaded(builder, fields, places[0]) + loaded(builder, fields, places[1])).value)
            for place in places:
                builder.store(zero, vector_pointer(builder, fields, place), align=8)
        kept, fallen = one, zero
        for k in range(3):
            lane = ir.IntType(32)(first + k)
            kept = builder.insert_element(kept, keep, lane)
            fallen = builder.insert_element(fallen, builder.extract_value(fall, k), lane)
        begin, lanes = builder.mul(i, WORD(WIDTH)), ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [mass] * WIDTH)
        for k, force in enumerate(transposed(builder, row_of(forces, zero))):
            place = vector_pointer(builder, table, plus(builder, begin, WIDTH * k))
            row = Lanes(builder, builder.load(place, align=8))
            inverse = Lanes(builder, builder.shuffle_vector(row.value, row.value, lanes))
            kick = same(builder, time) * inverse * Lanes(builder, force) + Lanes(builder, fallen)
            moves = builder.fcmp_ordered(">", inverse.value, zero)
            # Not the results: they would be stored with a mask, which takes longer.
            kick, factor = (builder.select(moves, new, old) for new, old in ((kick.value, zero), (kept, one)))
            kicked = Lanes(builder, factor) * (row + Lanes(builder, kick))
            builder.store(kicked.value, place, align=8)
        return context.get_dummy_value()

    word, real = types.int64, types.float64
    return types.none(table, word, fields, word, word, word, real, real, types.UniTuple(real, 3)), generate


@intrinsic
def drift_lanes(context: Any, table: Any, i: Any, fields: Any, at: Any, size: Any, time: Any) -> Any:
    """Add columns 4 to 6 of eight rows of a table of width eight, from row i on, times a time, to columns 0 to 2.

    These are then copied to three fields.
    """
    moved = ir.Constant(VECTOR, [1.0, 1.0, 1.0, *[0.0] * 5])
    order = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [4, 5, 6, *[8] * 5])

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        table, fields = (begin_of(context, builder, signature.args[k], values[k]) for k in (0, 2))
        begin, (at, size, time) = builder.mul(values[1], WORD(WIDTH)), values[3:]
        rows = []
        for k in range(WIDTH):
            place = vector_pointer(builder, table, plus(builder, begin, WIDTH * k))
            row = Lanes(builder, builder.load(place, align=8))
            speed = Lanes(builder, builder.shuffle_vector(row.value, ir.Constant(VECTOR, None), order))
            row += same(builder, time) * Lanes(builder, moved) * speed
            builder.store(row.value, place, align=8)
            rows.append(row.value)
        for k, vector in enumerate(transposed(builder, rows)[:3]):
            field = builder.add(at, builder.mul(size, WORD(k)))
            builder.store(vector, vector_pointer(builder, fields, field), align=8)
        return context.get_dummy_value()

    word = types.int64
    return types.none(table, word, fields, word, word, types.float64), generate
