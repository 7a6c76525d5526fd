"""The membrane of a cloth: how it resists being stretched along warp and weft, and sheared.

In each triangle the deformation is the same everywhere: F = (F_u, F_v), 3 x 2, takes a vector of the cloth at rest, in the
axes of warp and weft, to space. Stretch is |F_u| - 1 and |F_v| - 1, shear is F_u . F_v, and the energy of an area A is

    A / 2 (k (|F_u| - 1)^2 + k (|F_v| - 1)^2 + g (F_u . F_v)^2)

(Baraff and Witkin, Large steps in cloth simulation, SIGGRAPH 1998, section 4.2, as an energy density, so that it does not
depend on the triangles). Damping is that of a Kelvin-Voigt solid: a strain counts as it would be `damping` later.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, minus
from kickdrift.world.cloth.layout import (
    CORNERS,
    FACE_AREA,
    FIRST_FACE,
    LAST_FACE,
    MEMBRANE_DAMPING,
    SHEAR,
    STRAIN,
    STRETCH,
    TO_REST,
)
from kickdrift.world.columns import vector_at
from kickdrift.world.tables import CLOTH, CLOTH_NUMBERS, FACE, FACE_NUMBERS, PARTICLE, PARTICLE_FORCE, floats, integers

Floats = NDArray[np.float64]


@compiled
def add_membrane(world: int, cloth: int, part: float, share: float, begins: bool) -> None:
    """Add a share of the forces of a cloth's membrane to those on its particles.

    Damping is by the change of the strains in a part of a substep, s, of which none is known where the substep begins.
    """
    numbers, face, rest = floats(world, CLOTH_NUMBERS), integers(world, FACE), floats(world, FACE_NUMBERS)
    particle, force = floats(world, PARTICLE), floats(world, PARTICLE_FORCE)
    stretch, shear = numbers[cloth, STRETCH], numbers[cloth, SHEAR]
    ahead = 0.0 if begins else numbers[cloth, MEMBRANE_DAMPING] / part
    own = integers(world, CLOTH)
    for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
        a, b, c = face[f, CORNERS], face[f, CORNERS + 1], face[f, CORNERS + 2]
        origin = vector_at(particle, a, 0)
        p, q = minus(vector_at(particle, b, 0), origin), minus(vector_at(particle, c, 0), origin)
        u1, u2, v1, v2 = rest[f, TO_REST], rest[f, TO_REST + 1], rest[f, TO_REST + 2], rest[f, TO_REST + 3]
        u, v = _sum(u1, p, u2, q), _sum(v1, p, v2, q)
        length_u, length_v = math.sqrt(dot(u, u)), math.sqrt(dot(v, v))
        along_u, along_v, across = length_u - 1.0, length_v - 1.0, dot(u, v)
        area = rest[f, FACE_AREA]
        push_u = area * stretch * (share * along_u + ahead * (along_u - rest[f, STRAIN])) / length_u
        push_v = area * stretch * (share * along_v + ahead * (along_v - rest[f, STRAIN + 1])) / length_v
        turn = area * shear * (share * across + ahead * (across - rest[f, STRAIN + 2]))
        rest[f, STRAIN], rest[f, STRAIN + 1], rest[f, STRAIN + 2] = along_u, along_v, across
        on_u, on_v = _sum(push_u, u, turn, v), _sum(push_v, v, turn, u)
        for k in range(3):
            on_b, on_c = u1 * on_u[k] + v1 * on_v[k], u2 * on_u[k] + v2 * on_v[k]
            force[b, k] -= on_b
            force[c, k] -= on_c
            force[a, k] += on_b + on_c


@compiled
def largest_strain(world: int, cloth: int) -> float:
    """Return the largest strain along warp or weft of a cloth's triangles as they lie now."""
    face, rest, particle = integers(world, FACE), floats(world, FACE_NUMBERS), floats(world, PARTICLE)
    own, largest = integers(world, CLOTH), 1.0
    for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
        origin = vector_at(particle, face[f, CORNERS], 0)
        p = minus(vector_at(particle, face[f, CORNERS + 1], 0), origin)
        q = minus(vector_at(particle, face[f, CORNERS + 2], 0), origin)
        u = _sum(rest[f, TO_REST], p, rest[f, TO_REST + 1], q)
        v = _sum(rest[f, TO_REST + 2], p, rest[f, TO_REST + 3], q)
        for square in (dot(u, u), dot(v, v)):
            if square > largest:  # which NaN is not
                largest = square
    return math.sqrt(largest) - 1.0


@compiled(inline=True)
def _sum(s: float, a: Vector, t: float, b: Vector) -> Vector:
    return (s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2])


def inverse_edges(flat: Floats) -> Floats:
    """Invert the matrices of two edges of triangles that lie flat.

    Parameters
    ----------
    flat : (M, 3, 2) array
        Corners along warp and weft, m.

    Returns
    -------
    (M, 4) array
        F_u and F_v over the edges from the first corner to the second and to the third: as in `TO_REST`, 1/m.
    """
    edges = np.stack((flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]), axis=2)
    inverse: Any = np.linalg.inv(edges)
    return np.stack((inverse[:, 0, 0], inverse[:, 1, 0], inverse[:, 0, 1], inverse[:, 1, 1]), axis=1)
