"""The membrane forces of a cloth on the corners of eight triangles at once; see `kickdrift.world.cloth.membrane`.

Corners in consecutive rows, as in grids, are read and written as vectors; others one by one.
"""

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from kickdrift.world.cloth.lanes import NUMBER, VECTOR, WORD, Lanes, begin_of, dot, loaded, plus, same, vector_pointer
from kickdrift.world.cloth.layout import ADDED_TO, GROUP_CORNERS, PLACES
from kickdrift.world.contacts.layout import WIDTH

Load = Callable[[int], Lanes]


def _membrane(p: Sequence[Lanes], q: Sequence[Lanes], rest: Load, before: Load, law: Sequence[Lanes]) -> Any:
    """Return minus the forces on the second and the third corner, and the strains; see `kickdrift.world.cloth.membrane`.

    `p` and `q` are the edges from the first corner; `law` is stretching and shear stiffness, share, and damping over the part.
    """
    stretch, shear, share, ahead = law
    u1, u2, v1, v2, area = (rest(k) for k in range(5))
    u = [u1 * p[k] + u2 * q[k] for k in range(3)]
    v = [v1 * p[k] + v2 * q[k] for k in range(3)]
    one = same(area.builder, NUMBER(1.0))
    over_u, over_v = one / dot(u, u).root(), one / dot(v, v).root()
    strains = dot(u, u) * over_u - one, dot(v, v) * over_v - one, dot(u, v)
    on = [share * now + ahead * (now - before(k)) for k, now in enumerate(strains)]
    push_u, push_v, turn = area * stretch * on[0] * over_u, area * stretch * on[1] * over_v, area * shear * on[2]
    on_u = [push_u * u[k] + turn * v[k] for k in range(3)]
    on_v = [push_v * v[k] + turn * u[k] for k in range(3)]
    on_b = [u1 * on_u[k] + v1 * on_v[k] for k in range(3)]
    on_c = [u2 * on_u[k] + v2 * on_v[k] for k in range(3)]
    return on_b, on_c, strains


def _add_membrane(in_rows: bool) -> Any:
    """Return the intrinsic for triangles whose corners are consecutive rows, or for any."""

    def typed(
        context: Any,
        fields: Any,
        size: Any,
        group: Any,
        begin: Any,
        rest: Any,
        of: Any,
        strain: Any,
        at: Any,
        *law: Any,
    ) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            arrays = [begin_of(context, builder, signature.args[k], values[k]) for k in (0, 2, 4, 6)]
            fields, corners, rest, strain = arrays
            size, begin, of, at = values[1], values[3], values[5], values[7]
            x = [
                [_read(builder, fields, size, WORD(PLACES + k), corners, begin, c) for k in range(3)] for c in range(3)
            ]
            p, q = ([x[c][k] - x[0][k] for k in range(3)] for c in (1, 2))
            law = [same(builder, value) for value in values[8:]]
            on_b, on_c, strains = _membrane(
                p,
                q,
                lambda k: loaded(builder, rest, plus(builder, of, WIDTH * k)),
                lambda k: loaded(builder, strain, plus(builder, at, WIDTH * k)),
                law,
            )
            for k, value in enumerate(strains):
                builder.store(value.value, vector_pointer(builder, strain, plus(builder, at, WIDTH * k)), align=8)
            none = Lanes(builder, ir.Constant(VECTOR, None))
            pulls = [
                [on_b[k] + on_c[k] for k in range(3)],
                [none - on_b[k] for k in range(3)],
                [none - on_c[k] for k in range(3)],
            ]
            for c in range(3):
                field = builder.load(builder.gep(corners, [plus(builder, begin, ADDED_TO - GROUP_CORNERS + c)]))
                for k in range(3):
                    _add(builder, fields, size, plus(builder, field, k), corners, begin, c, pulls[c][k])
            return context.get_dummy_value()

        return types.none(
            fields, types.int64, group, types.int64, rest, types.int64, strain, types.int64, *law
        ), generate

    def _places(builder: Any, size: Any, field: Any, corners: Any, begin: Any, c: int) -> list[Any]:
        shift = builder.mul(size, field)
        lanes = 1 if in_rows else WIDTH
        rows = [builder.load(builder.gep(corners, [plus(builder, begin, WIDTH * c + k)])) for k in range(lanes)]
        return [builder.add(shift, row) for row in rows]

    def _read(builder: Any, fields: Any, size: Any, field: Any, corners: Any, begin: Any, c: int) -> Lanes:
        places = _places(builder, size, field, corners, begin, c)
        if in_rows:
            return loaded(builder, fields, places[0])
        vector = ir.Constant(VECTOR, ir.Undefined)
        for lane, place in enumerate(places):
            vector = builder.insert_element(vector, builder.load(builder.gep(fields, [place])), ir.IntType(32)(lane))
        return Lanes(builder, vector)

    def _add(builder: Any, fields: Any, size: Any, field: Any, corners: Any, begin: Any, c: int, more: Lanes) -> None:
        places = _places(builder, size, field, corners, begin, c)
        if in_rows:
            total = loaded(builder, fields, places[0]) + more
            builder.store(total.value, vector_pointer(builder, fields, places[0]), align=8)
            return
        for lane, place in enumerate(places):
            pointer = builder.gep(fields, [place])
            own = builder.extract_element(more.value, ir.IntType(32)(lane))
            builder.store(builder.fadd(builder.load(pointer), own), pointer)

    def add(context, fields, size, group, begin, rest, of, strain, at, stretch, shear, share, ahead):  # type: ignore[no-untyped-def]
        return typed(context, fields, size, group, begin, rest, of, strain, at, stretch, shear, share, ahead)

    return intrinsic(add)


add_membrane_of_rows, add_membrane_of_any = _add_membrane(True), _add_membrane(False)
