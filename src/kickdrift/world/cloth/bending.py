"""Bending of a cloth: how its triangles resist being folded against each other.

The curvature of a triangle, a symmetric tensor (xx, yy, sqrt 2 xy), follows from the angles at its three sides so that it is
exact for every quadratic surface, on any mesh (Grinspun, Gingold, Reisman and Zorin, Computing discrete shape operators on
general meshes, Eurographics 2006, section 4), which springs across edges are not. Of small angles it is a linear function H of
the heights of six vertices, its corners and those across its sides. Of their positions x in space, H x is the same curvature
along the normal, however the cloth is turned and rolled up without being stretched (Bergou, Wardetzky, Harmon, Zorin and
Grinspun, A quadratic bending model for inextensible surfaces, SGP 2006): at a fold by theta the normal jumps by
2 sin(theta / 2). The energy of an area A, that of a plate whose Poisson ratio is zero, is A D |H x - c n|^2 / 2 with the
curvature c at rest and the normal n of the triangle. Where c is zero, force is linear in x, the same for all time: that of
each vertex is a sum over some 18 others (`kickdrift.world.cloth.couplings`). Elsewhere -A D c H x . n is added, as |n| is one.

Damping is by the rate of H x, seen by who turns with the cloth: at the angular velocity for which least is damped, from
which it follows that angular momentum stays. What turns against the rest of its cloth while it is bent is damped for that.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, cross, dot, inverse_symmetric, length, minus, plus, times
from kickdrift.world.cloth.layout import (
    BENDING,
    BENDING_DAMPING,
    COUPLINGS,
    CURVE,
    FIRST_COUPLING,
    FIRST_CURVED,
    FIRST_PARTICLE,
    LAST_CURVED,
    LAST_PARTICLE,
    OFFSET,
    PARTICLE_VELOCITY,
    PULLS,
    STENCIL,
    WEIGHT,
)
from kickdrift.world.columns import vector_at
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    COUPLING,
    COUPLING_NUMBERS,
    CURVED_FACE,
    CURVED_FACE_NUMBERS,
    PARTICLE,
    PARTICLE_COUPLINGS,
    PARTICLE_FORCE,
    floats,
    integers,
)

Floats = NDArray[np.float64]

_TURNS = 1e-12  # rad^2: cloths that are bent by less, all in all, have no frame that turns with them


@compiled
def add_bending(world: int, cloth: int, share: float) -> None:
    """Add `share` times the forces of bending to those on the particles of a cloth."""
    numbers, own = floats(world, CLOTH_NUMBERS), integers(world, CLOTH)
    stiffness, damping = share * numbers[cloth, BENDING], numbers[cloth, BENDING_DAMPING]
    if stiffness == 0.0:
        return
    if damping > 0.0:
        _add_damped_pulls(world, cloth, stiffness, damping)
    else:
        _add_pulls(world, cloth, stiffness)
    if own[cloth, FIRST_CURVED] < own[cloth, LAST_CURVED]:
        _add_rest(world, cloth, stiffness)


@compiled(fast=True)
def _add_pulls(world: int, cloth: int, stiffness: float) -> None:
    """Add what particles get from each other as they lie."""
    own, particle, force = integers(world, CLOTH), floats(world, PARTICLE), floats(world, PARTICLE_FORCE)
    ranges, other, weight = (
        integers(world, PARTICLE_COUPLINGS),
        integers(world, COUPLING),
        floats(world, COUPLING_NUMBERS),
    )
    first = own[cloth, FIRST_COUPLING]
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        x, pull = vector_at(particle, i, 0), (0.0, 0.0, 0.0)
        for row in range(first + ranges[i, COUPLINGS], first + ranges[i, COUPLINGS + 1]):
            way = minus(vector_at(particle, i + other[row, OFFSET], 0), x)
            pull = plus(pull, times(weight[row, WEIGHT], way))
        for k in range(3):
            force[i, k] += stiffness * pull[k]


@compiled(fast=True)
def _add_damped_pulls(world: int, cloth: int, stiffness: float, damping: float) -> None:
    """Add what particles get from each other as they lie and as they move, seen by who turns with the cloth.

    With the curves p = -H^T H x and their rates q = -H^T H v the force is D (p + damping (q - w x p)); its torque is zero for
    the angular velocity w of sum x x q = sum (x . p) w - p (x . w), which also makes |H v - w x H x| least.
    """
    own, particle, force = integers(world, CLOTH), floats(world, PARTICLE), floats(world, PARTICLE_FORCE)
    ranges, other, weight = (
        integers(world, PARTICLE_COUPLINGS),
        integers(world, COUPLING),
        floats(world, COUPLING_NUMBERS),
    )
    first, begin, end = own[cloth, FIRST_COUPLING], own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]
    origin, torque = vector_at(particle, begin, 0), (0.0, 0.0, 0.0)
    xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(begin, end):
        x, v = vector_at(particle, i, 0), vector_at(particle, i, PARTICLE_VELOCITY)
        p, q = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for row in range(first + ranges[i, COUPLINGS], first + ranges[i, COUPLINGS + 1]):
            j, w = i + other[row, OFFSET], weight[row, WEIGHT]
            p = plus(p, times(w, minus(vector_at(particle, j, 0), x)))
            q = plus(q, times(w, minus(vector_at(particle, j, PARTICLE_VELOCITY), v)))
        for k in range(3):
            force[i, CURVE + k] = p[k]
            force[i, k] += stiffness * (p[k] + damping * q[k])
        arm = minus(x, origin)
        torque = plus(torque, cross(arm, q))
        xx, yy, zz = xx + arm[0] * p[0], yy + arm[1] * p[1], zz + arm[2] * p[2]
        xy, xz, yz = xy + arm[0] * p[1], xz + arm[0] * p[2], yz + arm[1] * p[2]
    spin = times(stiffness * damping, _spin((xx, yy, zz, xy, xz, yz), torque))
    for i in range(begin, end):
        back = cross(spin, vector_at(force, i, CURVE))
        for k in range(3):
            force[i, k] -= back[k]


@compiled
def _spin(curved: Any, torque: Vector) -> Vector:
    """Solve (tr S - S) w = torque, for S that is negative."""
    xx, yy, zz, xy, xz, yz = curved
    trace = xx + yy + zz - _TURNS * (1.0 - (xx + yy + zz))
    matrix = (trace - xx, trace - yy, trace - zz, -xy, -xz, -yz)
    inverse = inverse_symmetric(matrix)
    w = applied(inverse, torque)
    return plus(
        w, applied(inverse, minus(torque, applied(matrix, w)))
    )  # once more: nearly flat cloths leave few digits


@compiled
def _add_rest(world: int, cloth: int, stiffness: float) -> None:
    """Add what triangles get that are curved at rest: the slopes of A c H x . n, with pulls A c H.

    The normal n = p x q / |p x q| of the sides p and q turns by what is across it of (dp x q + p x dq) / |p x q|.
    """
    own, particle, force = integers(world, CLOTH), floats(world, PARTICLE), floats(world, PARTICLE_FORCE)
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
                force[i, axis] += stiffness * pull * n[axis]
        turn = times(stiffness / doubled, minus(curved, times(dot(curved, n), n)))
        on_b, on_c = cross(q, turn), cross(turn, p)
        for axis in range(3):
            force[b, axis] += on_b[axis]
            force[c, axis] += on_c[axis]
            force[a, axis] -= on_b[axis] + on_c[axis]
