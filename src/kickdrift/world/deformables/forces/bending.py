"""Bending of a cloth: forces from the curvature of its triangles.

The curvature of a triangle, a symmetric tensor (xx, yy, sqrt 2 xy), follows from the angles at its three sides so that it is
exact for every quadratic surface, on any mesh (Grinspun, Gingold, Reisman and Zorin, Computing discrete shape operators on
general meshes, Eurographics 2006, section 4), unlike with springs across edges. For small angles it is a linear function H of
the heights of six vertices, its corners and those across its sides. Applied to their positions x in space, H x is the same
curvature times the normal, however the cloth is rotated and rolled up without being stretched (Bergou, Wardetzky, Harmon, Zorin
and Grinspun, A quadratic bending model for inextensible surfaces, SGP 2006): at a fold by theta the normal jumps by
2 sin(theta / 2). The energy of an area A, that of a plate whose Poisson ratio is zero, is A D |H x - c n|^2 / 2 with the
curvature c at rest and the normal n of the triangle. If c is zero, the force is linear in x with constant coefficients: that on
each vertex is a sum over some 18 others (`bending_couplings`). Otherwise -A D c H x . n is added, as |n| is one.

Damping acts on the change of H x in a part of a substep, in a frame that rotates with the cloth: at the angular velocity for
which the dissipation is smallest, which conserves angular momentum. Parts that rotate relative to the rest of a bent cloth
are damped for that, too.
"""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, applied, cross, dot, inverse_symmetric, length, minus, plus, times
from kickdrift.world.columns import column, vector_at
from kickdrift.world.contacts.layout import COUPLING_CHUNK, TURNING_CHUNK, WIDTH
from kickdrift.world.deformables.chunks import Numbers, for_chunks
from kickdrift.world.deformables.forces.bending_simd import (
    are_pairs,
    couple_damped_lanes,
    couple_lanes,
    curvature,
    turn_lanes,
)
from kickdrift.world.deformables.layout import (
    BENDING,
    BENDING_DAMPING,
    COUPLINGS,
    CURVES,
    FIRST_COUPLING,
    FIRST_CURVED,
    FIRST_PARTICLE,
    FORCES,
    LAST_CURVED,
    LAST_PARTICLE,
    PLACES,
    PULLS,
    STENCIL,
)
from kickdrift.world.deformables.particle_fields import PARTICLES_IN_CHUNK, add_force, field_size
from kickdrift.world.tables import (
    BENDING_SUMS,
    CLOTH,
    CLOTH_NUMBERS,
    COUPLING,
    COUPLING_NUMBERS,
    CURVED_FACE,
    CURVED_FACE_NUMBERS,
    PARTICLE,
    PARTICLE_COUPLINGS,
    PARTICLE_LANES,
    flat,
    flat_integers,
    floats,
    integers,
)

column(BENDING_SUMS, 9)  # of a chunk: the sums of `_spin`
_SUMS = 9 * WIDTH
_TURNS = 1e-12  # rad^2: total bending below which the rotation of a cloth is undetermined


@compiled
def add_bending(world: int, cloth: int, share: float, damped: float) -> None:
    """Add `share` times the forces of bending to those on the particles of a cloth, and `damped` times those of damping.

    The damping forces belong to the change since the last evaluation, divided by the time since then, s; `damped` is zero if
    there was none.
    """
    numbers, own = floats(world, CLOTH_NUMBERS), integers(world, CLOTH)
    stiffness, ahead = share * numbers[cloth, BENDING], damped / share * numbers[cloth, BENDING_DAMPING]
    if stiffness == 0.0:
        return
    first, last = own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]
    for_chunks(world, COUPLING_CHUNK, PARTICLES_IN_CHUNK, cloth, first, last, (stiffness, ahead, 0.0, 0.0, 0.0))
    if ahead > 0.0:
        x, y, z = times(stiffness * ahead, _spin(world, last - first))
        for_chunks(world, TURNING_CHUNK, PARTICLES_IN_CHUNK, cloth, first, last, (x, y, z, 0.0, 0.0))
    if own[cloth, FIRST_CURVED] < own[cloth, LAST_CURVED]:
        _add_rest(world, cloth, stiffness)


@compiled
def couple_some(world: int, cloth: int, begin: int, end: int, numbers: Numbers) -> None:
    """Add the forces between coupled particles to those on some; the numbers are the stiffness and how far to extrapolate.

    Consecutive particles with the same couplings are processed eight at a time; those of the last eight that have been
    processed already are skipped. The sums of `_spin` over them are written to `BENDING_SUMS`.
    """
    own, ranges = integers(world, CLOTH), integers(world, PARTICLE_COUPLINGS)
    fields, size, stiffness, ahead = flat(world, PARTICLE_LANES), field_size(world), numbers[0], numbers[1]
    offsets, weights = flat_integers(world, COUPLING), flat(world, COUPLING_NUMBERS)
    start, origin = own[cloth, FIRST_COUPLING], own[cloth, FIRST_PARTICLE]
    sums = carray(floats_on_stack(_SUMS), (_SUMS,))
    sums[:] = 0.0
    i = begin
    while i < end:
        first, last, after = ranges[i, COUPLINGS], ranges[i, COUPLINGS + 1], i + 1
        while after + WIDTH <= end and are_pairs(ranges, after, first, last):
            after += WIDTH
        while after < end and ranges[after, COUPLINGS] == first and ranges[after, COUPLINGS + 1] == last:
            after += 1
        first, last = start + first, start + last
        if after - i < WIDTH:
            for j in range(i, after):
                _couple_one(world, j, first, last, stiffness, ahead, origin, sums)
        elif ahead > 0.0:
            for k in range(i, after, WIDTH):
                at = min(k, after - WIDTH)
                couple_damped_lanes(
                    fields, size, at, k - at, offsets, weights, first, last, stiffness, ahead, origin, sums
                )
        else:
            for k in range(i, after, WIDTH):
                at = min(k, after - WIDTH)
                couple_lanes(fields, size, at, k - at, offsets, weights, first, last, stiffness)
        i = after
    totals, row = floats(world, BENDING_SUMS), (begin - origin) // PARTICLES_IN_CHUNK
    for k in range(BENDING_SUMS.width):
        totals[row, k] = 0.0
        for lane in range(WIDTH):
            totals[row, k] += sums[k * WIDTH + lane]


@compiled
def _couple_one(
    world: int, i: int, first: int, last: int, stiffness: float, ahead: float, begin: int, sums: Any
) -> None:
    """Do the same for a single particle."""
    offsets, weights = flat_integers(world, COUPLING), flat(world, COUPLING_NUMBERS)
    fields, size = flat(world, PARTICLE_LANES), field_size(world)
    x, p = _vector(fields, size, PLACES, i), curvature(floats(world, PARTICLE), i, offsets, weights, first, last)
    q = minus(p, _vector(fields, size, CURVES, i))
    for k in range(3):
        fields[(CURVES + k) * size + i] = p[k]
        fields[(FORCES + k) * size + i] += stiffness * (p[k] + ahead * q[k])
    u = minus(x, _vector(fields, size, PLACES, begin))
    torque = cross(u, q)
    for k in range(3):
        sums[k * WIDTH] += torque[k]
        sums[(3 + k) * WIDTH] += u[k] * p[k]
    sums[6 * WIDTH] += u[0] * p[1]
    sums[7 * WIDTH] += u[0] * p[2]
    sums[8 * WIDTH] += u[1] * p[2]


@compiled(inline=True)
def _vector(fields: Any, size: int, field: int, i: int) -> Vector:
    return (fields[field * size + i], fields[(field + 1) * size + i], fields[(field + 2) * size + i])


@compiled
def _spin(world: int, count: int) -> Vector:
    """Return the angular velocity w of the frame that rotates with a cloth of some particles.

    With p = -H^T H x and its last change q, the force is D (p + ahead (q - w x p)). Its torque is zero for the w that
    satisfies sum x x q = sum (x . p) w - p (x . w), which also minimises |H dx - w x H x|: (tr S - S) w = torque, with S
    negative definite. The sums are the torque, and S as xx, yy, zz, xy, xz, yz.
    """
    sums, totals = floats(world, BENDING_SUMS), carray(floats_on_stack(9), (9,))
    totals[:] = 0.0
    for row in range((count + PARTICLES_IN_CHUNK - 1) // PARTICLES_IN_CHUNK):
        for k in range(9):
            totals[k] += sums[row, k]
    torque, (xx, yy, zz) = (totals[0], totals[1], totals[2]), (totals[3], totals[4], totals[5])
    trace = xx + yy + zz - _TURNS * (1.0 - (xx + yy + zz))
    matrix = (trace - xx, trace - yy, trace - zz, -totals[6], -totals[7], -totals[8])
    inverse = inverse_symmetric(matrix)
    w = applied(inverse, torque)
    again = applied(
        inverse, minus(torque, applied(matrix, w))
    )  # refinement: for nearly flat cloths few digits are left
    return plus(w, again)


@compiled
def turn_some(world: int, cloth: int, begin: int, end: int, numbers: Numbers) -> None:
    """Subtract the damping of the rotation of the frame, the first three numbers, from the forces on some particles."""
    fields, size, x, y, z = flat(world, PARTICLE_LANES), field_size(world), numbers[0], numbers[1], numbers[2]
    for i in range(begin, end - WIDTH + 1, WIDTH):
        turn_lanes(fields, size, i, x, y, z)
    for i in range(end - (end - begin) % WIDTH, end):
        back = cross((x, y, z), _vector(fields, size, CURVES, i))
        for k in range(3):
            add_force(world, i, k, -back[k])


@compiled
def _add_rest(world: int, cloth: int, stiffness: float) -> None:
    """Add the forces of the term A c H x . n of triangles that are curved at rest: its gradient, with PULLS = A c H.

    The normal n = p x q / |p x q| of the sides p and q changes by the part of (dp x q + p x dq) / |p x q| perpendicular to it.
    """
    own, particle = integers(world, CLOTH), floats(world, PARTICLE)
    stencil, numbers = integers(world, CURVED_FACE), floats(world, CURVED_FACE_NUMBERS)
    for f in range(own[cloth, FIRST_CURVED], own[cloth, LAST_CURVED]):
        a, b, c = stencil[f, STENCIL], stencil[f, STENCIL + 1], stencil[f, STENCIL + 2]
        origin = vector_at(particle, a, 0)
        p, q = minus(vector_at(particle, b, 0), origin), minus(vector_at(particle, c, 0), origin)
        across = cross(p, q)
        doubled = length(across)
        n, curved = times(1.0 / doubled, across), (0.0, 0.0, 0.0)
        for k in range(6):
            i = stencil[f, STENCIL + k]
            pull = numbers[f, PULLS + k]
            curved = plus(curved, times(pull, minus(vector_at(particle, i, 0), origin)))
            for axis in range(3):
                add_force(world, i, axis, stiffness * pull * n[axis])
        turn = times(stiffness / doubled, minus(curved, times(dot(curved, n), n)))
        on_b, on_c = cross(q, turn), cross(turn, p)
        for axis in range(3):
            add_force(world, b, axis, on_b[axis])
            add_force(world, c, axis, on_c[axis])
            add_force(world, a, axis, -on_b[axis] - on_c[axis])
