"""The membrane forces of a cloth on the corners of eight triangles at once; see `kickdrift.world.deformables.forces.membrane`.

Corners in consecutive rows, as in grids, are read and written as vectors; others one by one.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from kickdrift.world.contacts.layout import WIDTH
from kickdrift.world.deformables.layout import ADDED_TO, GROUP_CORNERS, PLACES
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

Load = Callable[[int], Lanes]


def _membrane(p: Sequence[Lanes], q: Sequence[Lanes], rest: Load, before: Load, law: Sequence[Lanes]) -> Any:
    """Return minus the forces on the second and the third corner, and the strains; see `membrane`.

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


class _Corners(NamedTuple):
    """The corners of eight triangles: fields of `size` numbers, in the rows that `rows` lists from `begin` on.

    `in_rows` says that those of each corner are consecutive.
    """

    fields: Any
    size: Any
    rows: Any
    begin: Any
    in_rows: bool


def _places(builder: Any, corners: _Corners, field: Any, c: int) -> list[Any]:
    """Return where the numbers of corner c are in a field; of consecutive ones the first."""
    shift = builder.mul(corners.size, field)
    lanes = 1 if corners.in_rows else WIDTH
    rows = [builder.load(builder.gep(corners.rows, [plus(builder, corners.begin, 3 * k + c)])) for k in range(lanes)]
    return [builder.add(shift, row) for row in rows]


def _read(builder: Any, corners: _Corners, field: Any, c: int) -> Lanes:
    """Return the numbers of corner c in a field."""
    places = _places(builder, corners, field, c)
    if corners.in_rows:
        return loaded(builder, corners.fields, places[0])
    vector = ir.Constant(VECTOR, ir.Undefined)
    for lane, place in enumerate(places):
        number = builder.load(builder.gep(corners.fields, [place]))
        vector = builder.insert_element(vector, number, ir.IntType(32)(lane))
    return Lanes(builder, vector)


def _add(builder: Any, corners: _Corners, field: Any, c: int, more: Lanes) -> None:
    """Add to the numbers of corner c in a field; one by one where corners may share a row."""
    places = _places(builder, corners, field, c)
    if corners.in_rows:
        total = loaded(builder, corners.fields, places[0]) + more
        builder.store(total.value, vector_pointer(builder, corners.fields, places[0]), align=8)
        return
    for lane, place in enumerate(places):
        pointer = builder.gep(corners.fields, [place])
        own = builder.extract_element(more.value, ir.IntType(32)(lane))
        builder.store(builder.fadd(builder.load(pointer), own), pointer)


def _add_membrane(in_rows: bool) -> Any:
    """Return the intrinsic for triangles whose corners are consecutive rows, or for any."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        fields, rows, rest, strain = (begin_of(context, builder, signature.args[k], values[k]) for k in (0, 2, 4, 6))
        size, begin, of, at = values[1], values[3], values[5], values[7]
        corners = _Corners(fields, size, rows, plus(builder, begin, GROUP_CORNERS), in_rows)
        x = [[_read(builder, corners, WORD(PLACES + k), c) for k in range(3)] for c in range(3)]
        p, q = ([x[c][k] - x[0][k] for k in range(3)] for c in (1, 2))
        on_b, on_c, strains = _membrane(
            p,
            q,
            lambda k: loaded(builder, rest, plus(builder, of, WIDTH * k)),
            lambda k: loaded(builder, strain, plus(builder, at, WIDTH * k)),
            [same(builder, value) for value in values[8:]],
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
            field = builder.load(builder.gep(rows, [plus(builder, begin, ADDED_TO + c)]))
            for k in range(3):
                _add(builder, corners, plus(builder, field, k), c, pulls[c][k])
        return context.get_dummy_value()

    @intrinsic
    def add(context, fields, size, group, begin, rest, of, strain, at, stretch, shear, share, ahead):  # type: ignore[no-untyped-def]
        word, law = types.int64, (stretch, shear, share, ahead)
        return types.none(fields, word, group, word, rest, word, strain, word, *law), generate

    return add


add_membrane_of_rows, add_membrane_of_any = _add_membrane(True), _add_membrane(False)
