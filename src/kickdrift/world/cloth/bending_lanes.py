"""The forces of bending on eight particles at once; see `kickdrift.world.cloth.bending`."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from kickdrift.world.cloth.lanes import VECTOR, WORD, Lanes, begin_of, loaded, same, vector_pointer
from kickdrift.world.cloth.layout import CURVES, FORCES, LANE_FIELDS, PLACES
from kickdrift.world.contacts.layout import WIDTH


def _couple(damped: bool) -> Any:
    """Return the intrinsic that couples eight particles by bending, with or without damping."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        fields, offsets, weights = (begin_of(context, builder, signature.args[k], values[k]) for k in (0, 4, 5))
        size, i, skip, first, last, stiffness = (values[k] for k in (1, 2, 3, 6, 7, 8))

        def place(field: int) -> Any:
            return builder.add(i, builder.mul(size, WORD(field)))

        axes = range(3)
        own = [loaded(builder, fields, place(PLACES + k)) for k in axes]
        zero = ir.Constant(VECTOR, None)
        totals = [cgutils.alloca_once_value(builder, zero) for _ in axes]
        with cgutils.for_range_slice(builder, first, last, WORD(1), intp=WORD) as (row, _):
            offset = builder.load(builder.gep(offsets, [row]))
            weight = same(builder, builder.load(builder.gep(weights, [row])))
            for k in axes:
                way = loaded(builder, fields, builder.add(place(PLACES + k), offset)) - own[k]
                builder.store((Lanes(builder, builder.load(totals[k])) + weight * way).value, totals[k])
        sums = [Lanes(builder, builder.load(total)) for total in totals]
        changes = [sums[k] - loaded(builder, fields, place(CURVES + k)) for k in axes] if damped else []
        for k in axes:
            builder.store(sums[k].value, vector_pointer(builder, fields, place(CURVES + k)), align=8)
        places = ir.Constant(ir.VectorType(WORD, WIDTH), list(range(WIDTH)))
        skipped = builder.insert_element(ir.Constant(ir.VectorType(WORD, WIDTH), ir.Undefined), skip, ir.IntType(32)(0))
        zeros = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), None)
        anew = builder.icmp_signed(">=", places, builder.shuffle_vector(skipped, skipped, zeros))

        def fresh(number: Lanes) -> Lanes:
            return Lanes(builder, builder.select(anew, number.value, zero))

        pulls = sums
        if damped:
            ahead = same(builder, values[9])
            pulls = [sums[k] + ahead * changes[k] for k in axes]
        for k in axes:
            total = loaded(builder, fields, place(FORCES + k)) + fresh(same(builder, stiffness) * pulls[k])
            builder.store(total.value, vector_pointer(builder, fields, place(FORCES + k)), align=8)
        if damped:
            added = begin_of(context, builder, signature.args[11], values[11])
            first_of_all = [builder.add(values[10], builder.mul(size, WORD(PLACES + k))) for k in axes]
            origin = [same(builder, builder.load(builder.gep(fields, [index]))) for index in first_of_all]
            (u, v, w), (a, b, c), (p, q, r) = [own[k] - origin[k] for k in axes], sums, changes
            products = (
                v * r - w * q, w * p - u * r, u * q - v * p, u * a, v * b, w * c, u * b, u * c, v * c,
            )  # fmt: skip
            for k, product in enumerate(products):
                total = loaded(builder, added, WORD(WIDTH * k)) + fresh(product)
                builder.store(total.value, vector_pointer(builder, added, WORD(WIDTH * k)), align=8)
        return context.get_dummy_value()

    word, real = types.int64, types.float64

    @intrinsic
    def couple(context, fields, size, i, skip, offsets, weights, first, last, stiffness):  # type: ignore[no-untyped-def]
        return types.none(fields, word, word, word, offsets, weights, word, word, real), generate

    @intrinsic
    def couple_damped(context, fields, size, i, skip, offsets, weights, first, last, stiffness, ahead, origin, sums):  # type: ignore[no-untyped-def]
        return types.none(fields, word, word, word, offsets, weights, word, word, real, real, word, sums), generate

    return couple_damped if damped else couple


couple_lanes, couple_damped_lanes = _couple(False), _couple(True)


@intrinsic
def are_pairs(context: Any, table: Any, i: Any, first: Any, second: Any) -> Any:
    """Whether eight rows of a table of two integers, from row i on, all hold the same two."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        table, words = begin_of(context, builder, signature.args[0], values[0]), ir.VectorType(WORD, WIDTH)
        wanted = ir.Constant(words, ir.Undefined)
        for lane in range(WIDTH):
            wanted = builder.insert_element(wanted, values[2 + lane % 2], ir.IntType(32)(lane))
        begin, equal = builder.mul(values[1], WORD(2)), None
        for half in (0, WIDTH):
            place = builder.bitcast(builder.gep(table, [builder.add(begin, WORD(half))]), words.as_pointer())
            found = builder.icmp_signed("==", builder.load(place, align=8), wanted)
            equal = found if equal is None else builder.and_(equal, found)
        mask = builder.bitcast(equal, ir.IntType(WIDTH))
        return builder.icmp_signed("==", mask, ir.IntType(WIDTH)(-1))

    return types.boolean(table, types.int64, types.int64, types.int64), generate


@intrinsic
def turn_lanes(context: Any, fields: Any, size: Any, i: Any, x: Any, y: Any, z: Any) -> Any:
    """Subtract (x, y, z) x CURVES from the forces on eight particles, from `i` on."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        fields, size, i = begin_of(context, builder, signature.args[0], values[0]), values[1], values[2]
        spin = [same(builder, value) for value in values[3:]]
        place = [builder.add(i, builder.mul(size, WORD(k))) for k in range(LANE_FIELDS)]
        curve = [loaded(builder, fields, place[CURVES + k]) for k in range(3)]
        for k in range(3):
            m, n = (k + 1) % 3, (k + 2) % 3
            force = loaded(builder, fields, place[FORCES + k]) - (spin[m] * curve[n] - spin[n] * curve[m])
            builder.store(force.value, vector_pointer(builder, fields, place[FORCES + k]), align=8)
        return context.get_dummy_value()

    return types.none(fields, types.int64, types.int64, types.float64, types.float64, types.float64), generate
