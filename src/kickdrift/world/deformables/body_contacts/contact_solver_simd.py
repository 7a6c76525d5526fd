"""Contacts of eight particles at once with shapes that they do not move: see `contact_solver`."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from kickdrift.world.contacts.layout import WIDTH
from kickdrift.world.contacts.simd_transpose import transposed
from kickdrift.world.deformables.layout import (
    CLOTH_NORMAL,
    CLOTH_OFFSET,
    CONTACT_FRICTION,
    GROUND_VELOCITY,
    PARTICLE_VELOCITY,
)
from kickdrift.world.deformables.simd_vectors import (
    NUMBER,
    VECTOR,
    WORD,
    Lanes,
    begin_of,
    dot,
    loaded,
    plus,
    same,
    vector_pointer,
)
from kickdrift.world.tables import CONTACT_LANE_PARTICLES, CONTACT_LANES, PARTICLE

_TINY = 1e-300


@intrinsic
def resolve_lanes(
    context: Any, rows: Any, lanes: Any, particles: Any, row: Any, part: Any, push: Any, advance: Any
) -> Any:
    """Resolve the eight contacts in a row of lanes: mass does not matter where no body is moved."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        rows, lanes, particles = (begin_of(context, builder, signature.args[k], values[k]) for k in range(3))
        row, (part, push, advance) = values[3], (same(builder, value) for value in values[4:7])
        begin = builder.mul(row, WORD(CONTACT_LANES.width))
        number = [loaded(builder, lanes, plus(builder, begin, WIDTH * k)) for k in range(WIDTH)]
        places = [_row_of(builder, rows, row, lane) for lane in range(WIDTH)]
        loaded_rows = [builder.load(vector_pointer(builder, particles, place), align=8) for place in places]
        own = [Lanes(builder, field) for field in transposed(builder, loaded_rows)]
        zero, n = Lanes(builder, ir.Constant(VECTOR, None)), [number[CLOTH_NORMAL + k] for k in range(3)]
        ground = [number[GROUND_VELOCITY + k] for k in range(3)]
        v = [own[PARTICLE_VELOCITY + k] - ground[k] for k in range(3)]
        approach, gap = dot(n, v), dot(n, own[:3]) - number[CLOTH_OFFSET]
        out = _larger(_smaller(zero - gap, part * push), zero)
        wanted = zero - _larger(gap + out, zero) / part
        offset = number[CLOTH_OFFSET] + advance * dot(n, ground)
        builder.store(offset.value, vector_pointer(builder, lanes, plus(builder, begin, WIDTH * CLOTH_OFFSET)), align=8)
        more = _larger(wanted - approach, zero)
        slip = [v[k] - approach * n[k] for k in range(3)]
        speed = dot(slip, slip).root()
        stopped = _smaller(number[CONTACT_FRICTION] * more, speed) / _larger(speed, same(builder, NUMBER(_TINY)))
        for k in range(3):
            own[k] = own[k] + out * n[k]
            own[PARTICLE_VELOCITY + k] = own[PARTICLE_VELOCITY + k] + more * n[k] - stopped * slip[k]
        touching = builder.fcmp_ordered(">", (more + out).value, zero.value)
        any_of_them = builder.icmp_unsigned("!=", builder.bitcast(touching, ir.IntType(WIDTH)), ir.IntType(WIDTH)(0))
        with builder.if_then(any_of_them):
            for place, values_ in zip(places, transposed(builder, [field.value for field in own]), strict=True):
                builder.store(values_, vector_pointer(builder, particles, place), align=8)
        return context.get_dummy_value()

    return types.none(rows, lanes, particles, types.int64, *3 * [types.float64]), generate


def _row_of(builder: Any, rows: Any, row: Any, lane: int) -> Any:
    """Return the index at which the particle of a lane begins in its table."""
    at = plus(builder, builder.mul(row, WORD(CONTACT_LANE_PARTICLES.width)), lane)
    return builder.mul(builder.load(builder.gep(rows, [at])), WORD(PARTICLE.width))


def _larger(a: Lanes, b: Lanes) -> Lanes:
    return Lanes(a.builder, a.builder.select(a.builder.fcmp_ordered(">", a.value, b.value), a.value, b.value))


def _smaller(a: Lanes, b: Lanes) -> Lanes:
    return Lanes(a.builder, a.builder.select(a.builder.fcmp_ordered("<", a.value, b.value), a.value, b.value))
