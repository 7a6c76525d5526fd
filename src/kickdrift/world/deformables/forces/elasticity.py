"""The elastic forces of soft bodies: the stable Neo-Hookean energy of tetrahedra.

The deformation gradient F is constant in each tetrahedron, and the energy of a volume V, with I = tr(F^T F) and J = det F, is

    V (m / 2 (I - 3 - log((I + 1) / 4)) + l / 2 ((J - a)^2 - (1 - a)^2)),    a = 1 + 3 m / (4 l)

(Smith, de Goes and Kim, Stable Neo-Hookean Flesh Simulation, ACM Transactions on Graphics 37, 2018, equations 14 and 15, less
its value at rest). It is finite for inverted tetrahedra, which forces turn back. With m = 4/3 mu and l = lambda + 5/6 mu it is
Hooke's law with the Lame parameters lambda and mu for small strain.

Damping is that of a Kelvin-Voigt solid: the stress F (lambda tr(D) + 2 mu D) with D = (F^T dF/dt + dF^T/dt F) / 2, the rate of
the Green strain, over that of small strain. It is symmetric in the body, and conserves angular momentum. Where a body is
stretched it is divided by I / 3, as it would otherwise grow with that, beyond what is stable in a part of a substep.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.layout import (
    FIRST_TETRAHEDRON,
    FORCES,
    LAST_TETRAHEDRON,
    MEMBRANE_DAMPING,
    PARTICLE_VELOCITY,
    POISSON_RATIO,
    REST_VOLUME,
    STRETCH,
    TETRAHEDRON_CORNERS,
    TO_REST_CELL,
)
from kickdrift.world.deformables.particle_fields import field_size
from kickdrift.world.deformables.soft_material import lame
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    PARTICLE,
    PARTICLE_LANES,
    TETRAHEDRON,
    TETRAHEDRON_NUMBERS,
    flat,
    floats,
    integers,
)

Columns = tuple[Vector, Vector, Vector]

_lame = compiled(inline=True)(lame)


@compiled
def add_elasticity(world: int, cloth: int, share: float, damped: float) -> None:
    """Add `share` times the elastic forces of a soft body and `damped` times those of its damping to those on its particles."""
    numbers, own, corner = floats(world, CLOTH_NUMBERS), integers(world, CLOTH), integers(world, TETRAHEDRON)
    rest, particle = floats(world, TETRAHEDRON_NUMBERS), floats(world, PARTICLE)
    fields, size = flat(world, PARTICLE_LANES), field_size(world)
    bulk, shear = _lame(numbers[cloth, STRETCH], numbers[cloth, POISSON_RATIO])
    ahead = damped * numbers[cloth, MEMBRANE_DAMPING]
    for e in range(own[cloth, FIRST_TETRAHEDRON], own[cloth, LAST_TETRAHEDRON]):
        f, push = _gradient(corner, rest, particle, e, 0), share * rest[e, REST_VOLUME]
        p = _stress(f, bulk, shear, push)
        if ahead > 0.0:
            g = _gradient(corner, rest, particle, e, PARTICLE_VELOCITY)
            square = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2])
            eased = ahead * rest[e, REST_VOLUME] / max(square / 3.0, 1.0)
            p = _plus(p, _viscous_stress(f, g, eased * bulk, eased * shear))
        x, y, z = _weighted(p, rest, e, 0), _weighted(p, rest, e, 1), _weighted(p, rest, e, 2)
        a, b = corner[e, TETRAHEDRON_CORNERS], corner[e, TETRAHEDRON_CORNERS + 1]
        c, d = corner[e, TETRAHEDRON_CORNERS + 2], corner[e, TETRAHEDRON_CORNERS + 3]
        for k in range(3):
            at = (FORCES + k) * size
            fields[at + a] += x[k] + y[k] + z[k]
            fields[at + b] -= x[k]
            fields[at + c] -= y[k]
            fields[at + d] -= z[k]


@compiled(inline=True)
def _gradient(corner: Any, rest: Any, table: Any, e: int, first: int) -> Columns:
    """Return the columns of the gradient of vectors of the particles, three columns of a table from `first` on."""
    origin = vector_at(table, corner[e, TETRAHEDRON_CORNERS], first)
    x = minus(vector_at(table, corner[e, TETRAHEDRON_CORNERS + 1], first), origin)
    y = minus(vector_at(table, corner[e, TETRAHEDRON_CORNERS + 2], first), origin)
    z = minus(vector_at(table, corner[e, TETRAHEDRON_CORNERS + 3], first), origin)
    return (_column(x, y, z, rest, e, 0), _column(x, y, z, rest, e, 1), _column(x, y, z, rest, e, 2))


@compiled(inline=True)
def _column(x: Vector, y: Vector, z: Vector, rest: Any, e: int, k: int) -> Vector:
    at = TO_REST_CELL + k
    return plus(plus(times(rest[e, at], x), times(rest[e, at + 3], y)), times(rest[e, at + 6], z))


@compiled(inline=True)
def _stress(f: Columns, bulk: float, shear: float, volume: float) -> Columns:
    """Return the columns of the first Piola-Kirchhoff stress, times a volume."""
    m, stiff = 4.0 / 3.0 * shear, bulk + 5.0 / 6.0 * shear
    square = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2])
    u, v, w = cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])
    along = volume * m * (1.0 - 1.0 / (square + 1.0))
    swelling = volume * (stiff * (dot(f[0], u) - 1.0) - 0.75 * m)
    return (
        plus(times(along, f[0]), times(swelling, u)),
        plus(times(along, f[1]), times(swelling, v)),
        plus(times(along, f[2]), times(swelling, w)),
    )


@compiled(inline=True)
def _viscous_stress(f: Columns, g: Columns, bulk: float, shear: float) -> Columns:
    """Return the columns of F (bulk tr(D) + 2 shear D), where g are those of the rate of F."""
    xx, yy, zz = dot(f[0], g[0]), dot(f[1], g[1]), dot(f[2], g[2])
    xy = shear * (dot(f[0], g[1]) + dot(f[1], g[0]))
    xz = shear * (dot(f[0], g[2]) + dot(f[2], g[0]))
    yz = shear * (dot(f[1], g[2]) + dot(f[2], g[1]))
    all_ = bulk * (xx + yy + zz)
    xx, yy, zz = all_ + 2.0 * shear * xx, all_ + 2.0 * shear * yy, all_ + 2.0 * shear * zz
    return (
        plus(plus(times(xx, f[0]), times(xy, f[1])), times(xz, f[2])),
        plus(plus(times(xy, f[0]), times(yy, f[1])), times(yz, f[2])),
        plus(plus(times(xz, f[0]), times(yz, f[1])), times(zz, f[2])),
    )


@compiled(inline=True)
def _plus(p: Columns, q: Columns) -> Columns:
    return (plus(p[0], q[0]), plus(p[1], q[1]), plus(p[2], q[2]))


@compiled(inline=True)
def _weighted(p: Columns, rest: Any, e: int, corner: int) -> Vector:
    """Return minus the force on a corner but the first."""
    at = TO_REST_CELL + 3 * corner
    return plus(plus(times(rest[e, at], p[0]), times(rest[e, at + 1], p[1])), times(rest[e, at + 2], p[2]))


@compiled
def stiffening(world: int, cloth: int) -> float:
    """Estimate by what factor the stiffest deformed tetrahedron of a soft body is stiffer than at rest, one or more.

    Of the second derivatives of the energy, in F, the largest are m, l times the square of the cofactors, and l |J - a| times a
    stretch.
    """
    numbers, own, corner = floats(world, CLOTH_NUMBERS), integers(world, CLOTH), integers(world, TETRAHEDRON)
    rest, particle, most = floats(world, TETRAHEDRON_NUMBERS), floats(world, PARTICLE), 1.0
    bulk, shear = _lame(numbers[cloth, STRETCH], numbers[cloth, POISSON_RATIO])
    m, stiff = 4.0 / 3.0 * shear, bulk + 5.0 / 6.0 * shear
    at_rest = m + stiff + 0.75 * m
    for e in range(own[cloth, FIRST_TETRAHEDRON], own[cloth, LAST_TETRAHEDRON]):
        f = _gradient(corner, rest, particle, e, 0)
        u, v, w = cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])
        square = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2])
        areas = (dot(u, u) + dot(v, v) + dot(w, w)) / 3.0
        swelling = abs(stiff * (dot(f[0], u) - 1.0) - 0.75 * m)
        now = (m + stiff * areas + swelling * math.sqrt(square / 3.0)) / at_rest
        if now > most:  # False for NaN
            most = now
    return most
