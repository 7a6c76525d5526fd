"""Transposition of table rows to fields of lanes, and back: eight rows of eight numbers, in registers.

Processors do not forward scalar stores to a vector load of the same memory, but wait until the data are in the cache: that took
half of the time of a sweep.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from kickdrift.world.contacts.layout import WIDTH

_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
_WORD = ir.IntType(64)
# Shuffles of two vectors: interleave their elements at even and at odd places; and their pairs at even and at odd places.
_EVEN, _ODD = (0, 8, 2, 10, 4, 12, 6, 14), (1, 9, 3, 11, 5, 13, 7, 15)
_EVEN_PAIRS, _ODD_PAIRS = (0, 1, 4, 5, 8, 9, 12, 13), (2, 3, 6, 7, 10, 11, 14, 15)


@intrinsic(prefer_literal=True)
def gather_rows(context: Any, table: Any, first: Any, rows: Any, begin: Any, lanes: Any, field: Any) -> Any:
    """Copy six columns of eight rows of a table of width eight to fields of lanes, the first of which is `field`.

    `first` is the first of the columns, a constant. The indices of the rows are in `rows`, from `begin` on.
    """
    chosen = slice(first.literal_value, first.literal_value + 6)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        table, _, rows, begin, lanes, field = values
        places = _places(context, builder, signature.args, table, _WORD(0), rows, begin, 2)
        vectors = transposed(builder, [builder.load(place, align=8) for place in places])[chosen]
        for k, vector in enumerate(vectors):
            builder.store(vector, _field(context, builder, signature.args[4], lanes, field, k), align=8)
        return context.get_dummy_value()

    return types.none(table, first, rows, types.int64, lanes, types.int64), generate


@intrinsic
def scatter_rows(context: Any, table: Any, rows: Any, begin: Any, lanes: Any, field: Any) -> Any:
    """Write six fields of lanes into eight rows of a table of width eight, and zeros into the last two columns.

    If a row occurs several times, all of its lanes must hold the same numbers.
    """

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        table, rows, begin, lanes, field = values
        fields = [_field(context, builder, signature.args[3], lanes, field, k) for k in range(6)]
        vectors = [builder.load(place, align=8) for place in fields] + 2 * [ir.Constant(_VECTOR, None)]
        places = _places(context, builder, signature.args, table, _WORD(0), rows, begin, 1)
        for place, vector in zip(places, transposed(builder, vectors), strict=True):
            builder.store(vector, place, align=8)
        return context.get_dummy_value()

    return types.none(table, rows, types.int64, lanes, types.int64), generate


@intrinsic
def fetch_rows(context: Any, table: Any, column: Any, rows: Any, begin: Any) -> Any:
    """Prefetch the cache lines that contain a column of eight rows of a table."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        table, column, rows, begin = values
        byte, number = ir.IntType(8).as_pointer(), ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [byte, number, number, number])
        prefetch = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0i8")
        for place in _places(context, builder, signature.args, table, column, rows, begin, 2):
            # For reading, into the nearest cache, as data
            builder.call(prefetch, [builder.bitcast(place, byte), number(0), number(3), number(1)])
        return context.get_dummy_value()

    return types.none(table, types.int64, rows, types.int64), generate


def _places(
    context: Any, builder: Any, types_: Any, table: Any, column: Any, rows: Any, begin: Any, of_rows: int
) -> list[Any]:
    """Return pointers to eight numbers of each row, from a column on."""
    found = []
    for lane in range(WIDTH):
        at = builder.add(begin, _WORD(lane))
        row = builder.load(_item(context, builder, types_[of_rows], rows, [at]))
        found.append(builder.bitcast(_item(context, builder, types_[0], table, [row, column]), _VECTOR.as_pointer()))
    return found


def _field(context: Any, builder: Any, type_: Any, lanes: Any, field: Any, k: int) -> Any:
    """Return a pointer to field + k of all lanes."""
    begin = builder.mul(builder.add(field, _WORD(k)), _WORD(WIDTH))
    return builder.bitcast(_item(context, builder, type_, lanes, [begin]), _VECTOR.as_pointer())


def _item(context: Any, builder: Any, type_: Any, array: Any, indices: list[Any]) -> Any:
    made = context.make_array(type_)(context, builder, array)
    return cgutils.get_item_pointer(context, builder, type_, made, indices, wraparound=False)


def transposed(builder: Any, vectors: list[Any]) -> list[Any]:
    """Return the transpose of eight vectors of eight numbers."""
    found: list[Any] = [None] * WIDTH
    for odd, way in enumerate((_EVEN, _ODD)):
        a, b, c, d = (_joined(builder, vectors[k], vectors[k + 1], way) for k in range(0, WIDTH, 2))
        for k, pairs in enumerate((_EVEN_PAIRS, _ODD_PAIRS)):
            low, high = _joined(builder, a, b, pairs), _joined(builder, c, d, pairs)
            for half, again in enumerate((_EVEN_PAIRS, _ODD_PAIRS)):
                found[4 * half + 2 * k + odd] = _joined(builder, low, high, again)
    return found


def _joined(builder: Any, one: Any, other: Any, places: tuple[int, ...]) -> Any:
    return builder.shuffle_vector(one, other, ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), places))
