"""Energy, momentum and angular momentum of cloths."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.rotations import cross
from kickdrift.world.cloth import layout as c
from kickdrift.world.cloth.curvature import fold_measures
from kickdrift.world.settings import GRAVITY
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    FACE,
    FACE_NUMBERS,
    FOLD,
    FOLD_NUMBERS,
    PARTICLE,
    SETTINGS,
    Tables,
)

Floats = NDArray[np.float64]


def cloth_energy(tables: Tables) -> tuple[float, float]:
    """Measure the kinetic energy of all cloths, and what they have by gravity and by being stretched and folded, J."""
    if tables.count(CLOTH) == 0:
        return 0.0, 0.0
    particles = tables.array(PARTICLE)
    x, v = particles[:, :3], particles[:, c.PARTICLE_VELOCITY : c.PARTICLE_VELOCITY + 3]
    moved = _moved(particles)
    gravity = tables.array(SETTINGS)[0, GRAVITY : GRAVITY + 3]
    elastic = _membrane(tables, x) + _bending(tables, x)
    return float(0.5 * moved @ (v * v).sum(axis=1)), float(elastic - moved @ (x @ gravity))


def cloth_momentum(tables: Tables) -> Floats:
    """Measure the momentum, (3,), kg m/s, of vertices that are not pinned."""
    particles = tables.array(PARTICLE)
    total: Floats = _moved(particles) @ particles[:, c.PARTICLE_VELOCITY : c.PARTICLE_VELOCITY + 3]
    return total


def cloth_angular_momentum(tables: Tables) -> Floats:
    """Measure the angular momentum about the origin, (3,), kg m^2/s, of vertices that are not pinned."""
    particles = tables.array(PARTICLE)
    push = _moved(particles)[:, None] * particles[:, c.PARTICLE_VELOCITY : c.PARTICLE_VELOCITY + 3]
    total: Floats = cross(particles[:, :3], push).sum(axis=0)
    return total


def _moved(particles: Floats) -> Floats:
    return np.where(particles[:, c.PARTICLE_INVERSE_MASS] > 0.0, particles[:, c.PARTICLE_MASS], 0.0)


def _of_faces(tables: Tables, column: int) -> Floats:
    """Return a number of the cloth for each of its triangles."""
    own = tables.array(CLOTH)
    numbers: Floats = np.repeat(tables.array(CLOTH_NUMBERS)[:, column], own[:, c.LAST_FACE] - own[:, c.FIRST_FACE])
    return numbers


def _membrane(tables: Tables, x: Floats) -> float:
    corners = x[tables.array(FACE)[:, c.CORNERS : c.CORNERS + 3]]
    rest = tables.array(FACE_NUMBERS)
    p, q = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    u1, u2, v1, v2 = (rest[:, c.TO_REST + k, None] for k in range(4))
    u, v = u1 * p + u2 * q, v1 * p + v2 * q
    stretch = (np.linalg.norm(u, axis=1) - 1.0) ** 2 + (np.linalg.norm(v, axis=1) - 1.0) ** 2
    shear = (u * v).sum(axis=1) ** 2
    density = _of_faces(tables, c.STRETCH) * stretch + _of_faces(tables, c.SHEAR) * shear
    return float(0.5 * rest[:, c.FACE_AREA] @ density)


def _bending(tables: Tables, x: Floats) -> float:
    faces, rest = tables.array(FACE), tables.array(FACE_NUMBERS)
    bent = fold_measures(x[tables.array(FOLD)[:, c.EDGE : c.EDGE + 4]]) - tables.array(FOLD_NUMBERS)[:, c.REST_FOLD]
    weights = rest[:, c.CURVATURE_WEIGHTS : c.CURVATURE_WEIGHTS + 9].reshape(-1, 3, 3)
    curvature = np.einsum("msk,ms->mk", weights, bent[faces[:, c.SIDES : c.SIDES + 3]])
    return float(0.5 * (rest[:, c.FACE_AREA] * _of_faces(tables, c.BENDING)) @ (curvature**2).sum(axis=1))
