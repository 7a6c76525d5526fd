"""Bending of a cloth: how its triangles resist being folded against each other.

The angle of a fold is measured by s = 2 sin(theta / 2), which is theta where it is small and keeps the energy bounded where
a cloth lies folded on itself. The curvature of a triangle, a symmetric tensor (xx, yy, sqrt 2 xy), is the one that folds
its three sides in this way: kappa = sum_k W_k (s_k - s_k at rest). It is exact for every quadratic surface, on any mesh
(Grinspun, Gingold, Reisman and Zorin, Computing discrete shape operators on general meshes, Eurographics 2006, section 4),
which springs across edges are not. The energy of an area A is A D |kappa|^2 / 2, that of a plate whose Poisson ratio is zero.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, minus, plus, times
from kickdrift.world.cloth.layout import (
    BENDING,
    BENDING_DAMPING,
    BENT,
    CURVATURE_WEIGHTS,
    DAMPED,
    EDGE,
    FACE_AREA,
    FIRST_FACE,
    FIRST_FOLD,
    LAST_FACE,
    LAST_FOLD,
    MOMENT,
    REST_FOLD,
    SIDES,
    WINGS,
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
    numbers, fold, own = floats(world, CLOTH_NUMBERS), integers(world, FOLD), integers(world, CLOTH)
    state, particle, force = floats(world, FOLD_NUMBERS), floats(world, PARTICLE), floats(world, PARTICLE_FORCE)
    ahead = 0.0 if begins else numbers[cloth, BENDING_DAMPING] / part
    for k in range(own[cloth, FIRST_FOLD], own[cloth, LAST_FOLD]):
        bent = _measure(*_fold(particle, fold, k)) - state[k, REST_FOLD]
        state[k, DAMPED], state[k, BENT] = share * bent + ahead * (bent - state[k, BENT]), bent
        state[k, MOMENT] = 0.0
    _find_moments(world, cloth)
    stiffness = numbers[cloth, BENDING]
    for k in range(own[cloth, FIRST_FOLD], own[cloth, LAST_FOLD]):
        moment = stiffness * state[k, MOMENT]
        pushes = _gradients(*_fold(particle, fold, k))
        for corner in range(4):
            at, push = fold[k, EDGE + corner], pushes[corner]
            for j in range(3):
                force[at, j] -= moment * push[j]


@compiled(inline=True)
def _fold(particle: Any, fold: Any, k: int) -> tuple[Vector, Vector, Vector]:
    """Return the edge of a fold, and where its wings are from the edge's start."""
    start = vector_at(particle, fold[k, EDGE], 0)
    edge = minus(vector_at(particle, fold[k, EDGE + 1], 0), start)
    left, right = vector_at(particle, fold[k, WINGS], 0), vector_at(particle, fold[k, WINGS + 1], 0)
    return edge, minus(left, start), minus(right, start)


@compiled(inline=True)
def _measure(edge: Vector, left: Vector, right: Vector) -> float:
    """Return 2 sin(theta / 2), positive where the wings are lifted along the normal."""
    n, m = cross(edge, left), cross(right, edge)
    lengths = math.sqrt(dot(n, n) * dot(m, m))
    sine, cosine = dot(cross(m, n), edge) / (lengths * math.sqrt(dot(edge, edge))), dot(n, m) / lengths
    if cosine > 0.0:
        return sine / math.sqrt(0.5 * (1.0 + cosine))
    return math.copysign(math.sqrt(2.0 - 2.0 * cosine), sine)


@compiled(inline=True)
def _gradients(edge: Vector, left: Vector, right: Vector) -> tuple[Vector, Vector, Vector, Vector]:
    """Return the derivatives of `_measure` over the start and the end of the edge and over the wings."""
    n, m = cross(edge, left), cross(right, edge)
    nn, mm, square = dot(n, n), dot(m, m), dot(edge, edge)
    cosine = dot(n, m) / math.sqrt(nn * mm)
    slope = math.sqrt(square * max(0.5 * (1.0 + cosine), 0.0))  # ds/dtheta times the edge's length
    on_left, on_right = times(slope / nn, n), times(slope / mm, m)
    s, t = dot(left, edge) / square, dot(right, edge) / square
    start = times(-1.0, plus(times(1.0 - s, on_left), times(1.0 - t, on_right)))
    end = times(-1.0, plus(times(s, on_left), times(t, on_right)))
    return start, end, on_left, on_right


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
