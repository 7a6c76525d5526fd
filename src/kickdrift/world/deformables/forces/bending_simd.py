"""The forces of bending on eight particles at once; see `kickdrift.world.deformables.forces.bending`."""

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from kickdrift.world.contacts.layout import WIDTH
from kickdrift.world.deformables.layout import CURVES, FORCES, LANE_FIELDS, PLACES
from kickdrift.world.deformables.simd_vectors import NUMBER, VECTOR, WORD, Lanes, begin_of, loaded, same, vector_pointer
from kickdrift.world.tables import PARTICLE

Place = Callable[[int], Any]  # of the numbers of eight particles in a field
_AXES = range(3)


def _curvature(builder: Any, fields: Any, own: Sequence[Lanes], place: Place, couplings: Sequence[Any]) -> list[Lanes]:
    """Return the sum of a weight times the vector to each coupled particle; `couplings` are offsets, weights, and a range."""
    offsets, weights, first, last = couplings
    totals = [cgutils.alloca_once_value(builder, ir.Constant(VECTOR, None)) for _ in _AXES]
    with cgutils.for_range_slice(builder, first, last, WORD(1), intp=WORD) as (row, _):
        offset = builder.load(builder.gep(offsets, [row]))
        weight = same(builder, builder.load(builder.gep(weights, [row])))
        for k in _AXES:
            way = loaded(builder, fields, builder.add(place(PLACES + k), offset)) - own[k]
            builder.store((Lanes(builder, builder.load(totals[k])) + weight * way).value, totals[k])
    return [Lanes(builder, builder.load(total)) for total in totals]


def _lanes_from(builder: Any, first: Any) -> Any:
    """Return the mask of the lanes from `first` on."""
    words, zeros = ir.VectorType(WORD, WIDTH), ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), None)
    one = builder.insert_element(ir.Constant(words, ir.Undefined), first, ir.IntType(32)(0))
    return builder.icmp_signed(">=", ir.Constant(words, list(range(WIDTH))), builder.shuffle_vector(one, one, zeros))


def _products(arm: Sequence[Lanes], curve: Sequence[Lanes], change: Sequence[Lanes]) -> tuple[Lanes, ...]:
    """Return the products whose sums over all particles determine the rotation; see `bending`."""
    (u, v, w), (a, b, c), (p, q, r) = arm, curve, change
    return v * r - w * q, w * p - u * r, u * q - v * p, u * a, v * b, w * c, u * b, u * c, v * c


def _couple(damped: bool) -> Any:
    """Return the intrinsic that couples eight particles by bending, with or without damping."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        fields, offsets, weights = (begin_of(context, builder, signature.args[k], values[k]) for k in (0, 4, 5))
        size, i, skip, first, last, stiffness = (values[k] for k in (1, 2, 3, 6, 7, 8))

        def place(field: int) -> Any:
            return builder.add(i, builder.mul(size, WORD(field)))

        def add(numbers: Any, index: Any, more: Lanes) -> None:
            kept = Lanes(builder, builder.select(wanted, more.value, ir.Constant(VECTOR, None)))
            total = loaded(builder, numbers, index) + kept
            builder.store(total.value, vector_pointer(builder, numbers, index), align=8)

        own = [loaded(builder, fields, place(PLACES + k)) for k in _AXES]
        curve = _curvature(builder, fields, own, place, (offsets, weights, first, last))
        change = [curve[k] - loaded(builder, fields, place(CURVES + k)) for k in _AXES] if damped else []
        for k in _AXES:
            builder.store(curve[k].value, vector_pointer(builder, fields, place(CURVES + k)), align=8)
        wanted = _lanes_from(builder, skip)
        pulls = curve
        if damped:
            ahead = same(builder, values[9])
            pulls = [curve[k] + ahead * change[k] for k in _AXES]
        for k in _AXES:
            add(fields, place(FORCES + k), same(builder, stiffness) * pulls[k])
        if damped:
            sums = begin_of(context, builder, signature.args[11], values[11])
            origin = [builder.add(values[10], builder.mul(size, WORD(PLACES + k))) for k in _AXES]
            arm = [own[k] - same(builder, builder.load(builder.gep(fields, [origin[k]]))) for k in _AXES]
            for k, product in enumerate(_products(arm, curve, change)):
                add(sums, WORD(WIDTH * k), product)
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
def curvature(context: Any, table: Any, i: Any, offsets: Any, weights: Any, first: Any, last: Any) -> Any:
    """Return the sum of a weight times the vector from particle i to each that is coupled to it, in a range of couplings.

    The first four of the eight columns of a particle are one vector.
    """

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        table, offsets, weights = (begin_of(context, builder, signature.args[k], values[k]) for k in (0, 2, 3))
        row, zeros = ir.VectorType(NUMBER, 4), ir.Constant(ir.VectorType(ir.IntType(32), 4), None)

        def place_of(particle: Any) -> Any:
            begin = builder.gep(table, [builder.mul(particle, WORD(PARTICLE.width))])
            return Lanes(builder, builder.load(builder.bitcast(begin, row.as_pointer()), align=8))

        own, total = place_of(values[1]), cgutils.alloca_once_value(builder, ir.Constant(row, None))
        with cgutils.for_range_slice(builder, values[4], values[5], WORD(1), intp=WORD) as (k, _):
            way = place_of(builder.add(values[1], builder.load(builder.gep(offsets, [k])))) - own
            weight, none = builder.load(builder.gep(weights, [k])), ir.Constant(row, ir.Undefined)
            weight = builder.shuffle_vector(builder.insert_element(none, weight, ir.IntType(32)(0)), none, zeros)
            builder.store((Lanes(builder, builder.load(total)) + Lanes(builder, weight) * way).value, total)
        found = builder.load(total)
        return context.make_tuple(
            builder, signature.return_type, [builder.extract_element(found, ir.IntType(32)(k)) for k in _AXES]
        )

    word = types.int64
    return types.UniTuple(types.float64, 3)(table, word, offsets, weights, word, word), generate


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
