"""Bending of a cloth: how its triangles resist being folded against each other.

The angle of a fold is measured by s = 2 sin(theta / 2), which is theta where it is small and keeps the energy bounded where
a cloth lies folded on itself. The curvature of a triangle, a symmetric tensor (xx, yy, sqrt 2 xy), is the one that folds
its three sides in this way: kappa = sum_k W_k (s_k - s_k at rest). It is exact for every quadratic surface, on any mesh
(Grinspun, Gingold, Reisman and Zorin, Computing discrete shape operators on general meshes, Eurographics 2006, section 4),
which springs across edges are not. The energy of an area A is A D |kappa|^2 / 2, that of a plate whose Poisson ratio is zero.
"""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import cross, dot, length, minus, plus, times
from kickdrift.world.cloth.layout import (
    BENDING,
    BENDING_DAMPING,
    BENT,
    CORNERS,
    CURVATURE_WEIGHTS,
    DAMPED,
    DOUBLED_AREA,
    EDGE,
    FACE_AREA,
    FACE_NORMAL,
    FIRST_FACE,
    FIRST_FOLD,
    FOLD_SLOPE,
    FOLDED_FACES,
    LAST_FACE,
    LAST_FOLD,
    MOMENT,
    REST_FOLD,
    SIDES,
)
from kickdrift.world.columns import vector_at
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    FACE,
    FACE_NUMBERS,
    FOLD,
    FOLD_NUMBERS,
    PARTICLE,
    PARTICLE_FORCE,
    floats,
    integers,
)

Floats = NDArray[np.float64]


@compiled
def add_bending(world: int, cloth: int, part: float, share: float, begins: bool) -> None:
    """Add `share` times the forces of bending to those on the particles of a cloth; as `add_membrane`."""
    _find_normals(world, cloth)
    _measure_folds(world, cloth, part, share, begins)
    _find_moments(world, cloth)
    _add_forces(world, cloth)


@compiled
def _find_normals(world: int, cloth: int) -> None:
    face, numbers, particle = integers(world, FACE), floats(world, FACE_NUMBERS), floats(world, PARTICLE)
    own = integers(world, CLOTH)
    for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
        origin = vector_at(particle, face[f, CORNERS], 0)
        first, second = vector_at(particle, face[f, CORNERS + 1], 0), vector_at(particle, face[f, CORNERS + 2], 0)
        across = cross(minus(first, origin), minus(second, origin))
        doubled = length(across)
        numbers[f, DOUBLED_AREA] = doubled
        for k in range(3):
            numbers[f, FACE_NORMAL + k] = across[k] / doubled


@compiled
def _measure_folds(world: int, cloth: int, part: float, share: float, begins: bool) -> None:
    """Measure folds, positive where the wings are lifted along the normal, and how fast they grow."""
    fold, state, particle = integers(world, FOLD), floats(world, FOLD_NUMBERS), floats(world, PARTICLE)
    numbers, face, own = floats(world, CLOTH_NUMBERS), floats(world, FACE_NUMBERS), integers(world, CLOTH)
    ahead = 0.0 if begins else numbers[cloth, BENDING_DAMPING] / part
    for k in range(own[cloth, FIRST_FOLD], own[cloth, LAST_FOLD]):
        edge = minus(vector_at(particle, fold[k, EDGE + 1], 0), vector_at(particle, fold[k, EDGE], 0))
        n = vector_at(face, fold[k, FOLDED_FACES], FACE_NORMAL)
        m = vector_at(face, fold[k, FOLDED_FACES + 1], FACE_NORMAL)
        sine, cosine = dot(cross(m, n), edge) / length(edge), dot(n, m)
        slope = math.sqrt(max(0.5 * (1.0 + cosine), 0.0))
        measure = sine / slope if cosine > 0.0 else math.copysign(math.sqrt(2.0 - 2.0 * cosine), sine)
        bent = measure - state[k, REST_FOLD]
        state[k, DAMPED], state[k, BENT] = share * bent + ahead * (bent - state[k, BENT]), bent
        state[k, FOLD_SLOPE], state[k, MOMENT] = slope, 0.0


@compiled
def _find_moments(world: int, cloth: int) -> None:
    """Add up the derivatives of |curvature|^2 / 2 over the angles of the folds."""
    face, rest, state = integers(world, FACE), floats(world, FACE_NUMBERS), floats(world, FOLD_NUMBERS)
    own = integers(world, CLOTH)
    for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
        curvature = (0.0, 0.0, 0.0)
        for k in range(3):
            weight = vector_at(rest, f, CURVATURE_WEIGHTS + 3 * k)
            curvature = plus(curvature, times(state[face[f, SIDES + k], DAMPED], weight))
        for k in range(3):
            weight = vector_at(rest, f, CURVATURE_WEIGHTS + 3 * k)
            state[face[f, SIDES + k], MOMENT] += rest[f, FACE_AREA] * dot(weight, curvature)


@compiled
def _add_forces(world: int, cloth: int) -> None:
    """Let the moments turn the triangles beside each fold.

    A fold opens as the normal n of a triangle turns about its side e, dtheta = (e x n) . dn / |e|, and a corner turns it by
    dn = dx x c / (2 A), but for what is along n, where the side c lies across the corner.
    """
    face, numbers, state = integers(world, FACE), floats(world, FACE_NUMBERS), floats(world, FOLD_NUMBERS)
    particle, force = floats(world, PARTICLE), floats(world, PARTICLE_FORCE)
    own, stiffness = integers(world, CLOTH), floats(world, CLOTH_NUMBERS)[cloth, BENDING]
    for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
        at = (face[f, CORNERS], face[f, CORNERS + 1], face[f, CORNERS + 2])
        x = (vector_at(particle, at[0], 0), vector_at(particle, at[1], 0), vector_at(particle, at[2], 0))
        sides = (minus(x[1], x[0]), minus(x[2], x[1]), minus(x[0], x[2]))
        turn = (0.0, 0.0, 0.0)
        for k in range(3):
            fold, side = face[f, SIDES + k], sides[k]
            turn = plus(turn, times(state[fold, MOMENT] * state[fold, FOLD_SLOPE] / length(side), side))
        push = times(stiffness / numbers[f, DOUBLED_AREA], cross(turn, vector_at(numbers, f, FACE_NORMAL)))
        for k in range(3):
            pull = cross(sides[(k + 1) % 3], push)
            for j in range(3):
                force[at[k], j] += pull[j]
