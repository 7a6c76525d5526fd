"""The membrane forces of a cloth: stretching along warp and weft, and shear.

The deformation gradient is constant in each triangle: F = (F_u, F_v), 3 x 2, maps vectors of the cloth at rest, in the axes of
warp and weft, to space. Stretch is |F_u| - 1 and |F_v| - 1, shear is F_u . F_v, and the energy of an area A is

    A / 2 (k (|F_u| - 1)^2 + k (|F_v| - 1)^2 + g (F_u . F_v)^2)

(Baraff and Witkin, Large steps in cloth simulation, SIGGRAPH 1998, section 4.2, as an energy density, so that it does not
depend on the mesh). Damping is that of a Kelvin-Voigt solid: forces are those of the strains extrapolated by `damping`, s.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, minus
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts.layout import MEMBRANE_CHUNK
from kickdrift.world.deformables.chunks import Numbers, for_chunks
from kickdrift.world.deformables.face_groups import GROUPS_IN_CHUNK
from kickdrift.world.deformables.forces.membrane_simd import add_membrane_of_any, add_membrane_of_rows
from kickdrift.world.deformables.layout import (
    AFTER_COLOUR,
    CORNERS,
    FIRST_FACE,
    FIRST_GROUP,
    IN_ROWS,
    LAST_FACE,
    LAST_GROUP,
    MEMBRANE_DAMPING,
    RESTS,
    SHEAR,
    STRETCH,
    TO_REST,
)
from kickdrift.world.deformables.particle_fields import field_size
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    FACE,
    FACE_GROUP,
    FACE_NUMBERS,
    GROUP_REST,
    GROUP_STRAIN,
    PARTICLE,
    PARTICLE_LANES,
    flat,
    flat_integers,
    floats,
    integers,
)

Floats = NDArray[np.float64]


@compiled
def add_membrane(world: int, cloth: int, share: float, damped: float) -> None:
    """Add `share` times the membrane forces of a cloth and `damped` times its damping forces to those on its particles.

    Damping uses the change of the strains since the last evaluation, divided by the time since then, s; `damped` is zero if
    there was none.
    """
    own, group = integers(world, CLOTH), integers(world, FACE_GROUP)
    g = own[cloth, FIRST_GROUP]
    while g < own[cloth, LAST_GROUP]:
        numbers = (share, damped, 0.0, 0.0, 0.0)
        for_chunks(world, MEMBRANE_CHUNK, GROUPS_IN_CHUNK, cloth, g, group[g, AFTER_COLOUR], numbers)
        g = group[g, AFTER_COLOUR]


@compiled
def add_some_groups(world: int, cloth: int, first: int, last: int, numbers: Numbers) -> None:
    """Do the same for some groups of triangles; `numbers` are the share and `damped`."""
    fabric, group, share, damped = floats(world, CLOTH_NUMBERS), integers(world, FACE_GROUP), numbers[0], numbers[1]
    fields, size = flat(world, PARTICLE_LANES), field_size(world)
    corners, rest, strain = flat_integers(world, FACE_GROUP), flat(world, GROUP_REST), flat(world, GROUP_STRAIN)
    stretch, shear = fabric[cloth, STRETCH], fabric[cloth, SHEAR]
    ahead = damped * fabric[cloth, MEMBRANE_DAMPING]
    for g in range(first, last):
        begin, of, at = g * FACE_GROUP.width, group[g, RESTS] * GROUP_REST.width, g * GROUP_STRAIN.width
        if group[g, IN_ROWS] != 0:
            add_membrane_of_rows(fields, size, corners, begin, rest, of, strain, at, stretch, shear, share, ahead)
        else:
            add_membrane_of_any(fields, size, corners, begin, rest, of, strain, at, stretch, shear, share, ahead)


@compiled
def largest_strain(world: int, cloth: int) -> float:
    """Return the largest present strain of a cloth's triangles along warp or weft, zero or positive."""
    face, rest, particle = integers(world, FACE), floats(world, FACE_NUMBERS), floats(world, PARTICLE)
    own, largest = integers(world, CLOTH), 1.0
    for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
        origin = vector_at(particle, face[f, CORNERS], 0)
        p = minus(vector_at(particle, face[f, CORNERS + 1], 0), origin)
        q = minus(vector_at(particle, face[f, CORNERS + 2], 0), origin)
        u = _sum(rest[f, TO_REST], p, rest[f, TO_REST + 1], q)
        v = _sum(rest[f, TO_REST + 2], p, rest[f, TO_REST + 3], q)
        for square in (dot(u, u), dot(v, v)):
            if square > largest:  # False for NaN
                largest = square
    return math.sqrt(largest) - 1.0


@compiled(inline=True)
def _sum(s: float, a: Vector, t: float, b: Vector) -> Vector:
    """Return s a + t b."""
    return (s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2])


def inverse_edges(flat: Floats) -> Floats:
    """Return the inverse matrices of two edges of each triangle at rest.

    Parameters
    ----------
    flat : (M, 3, 2) array
        Corners along warp and weft, m.

    Returns
    -------
    (M, 4) array
        Coefficients of F_u and F_v by the edges from the first corner to the second and the third, as in `TO_REST`, 1/m.
    """
    edges = np.stack((flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]), axis=2)
    inverse: Any = np.linalg.inv(edges)
    return np.stack((inverse[:, 0, 0], inverse[:, 1, 0], inverse[:, 0, 1], inverse[:, 1, 1]), axis=1)
