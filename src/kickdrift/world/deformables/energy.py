"""Energy, momentum and angular momentum of cloths."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.rotations import cross
from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.soft_material import lame
from kickdrift.world.layout import BODY_KIND, DYNAMIC
from kickdrift.world.settings import GRAVITY
from kickdrift.world.tables import (
    BODY,
    CLOTH,
    CLOTH_NUMBERS,
    COUPLING,
    COUPLING_NUMBERS,
    CURVED_FACE,
    CURVED_FACE_NUMBERS,
    FACE,
    FACE_NUMBERS,
    PARTICLE,
    PARTICLE_COUPLINGS,
    PIN,
    SETTINGS,
    TETRAHEDRON,
    TETRAHEDRON_NUMBERS,
    Tables,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def cloth_energy(tables: Tables) -> tuple[float, float]:
    """Measure the kinetic and the potential energy of all cloths, gravitational and elastic, J."""
    if tables.count(CLOTH) == 0:
        return 0.0, 0.0
    particles = tables.array(PARTICLE)
    x, v = particles[:, :3], particles[:, c.PARTICLE_VELOCITY : c.PARTICLE_VELOCITY + 3]
    moved = _moved(tables)
    gravity = tables.array(SETTINGS)[0, GRAVITY : GRAVITY + 3]
    elastic = _membrane(tables, x) + _tension(tables, x) + _bending(tables, x) + _elastic(tables, x)
    return float(0.5 * moved @ (v * v).sum(axis=1)), float(elastic - moved @ (x @ gravity))


def cloth_momentum(tables: Tables) -> Floats:
    """Measure the momentum, (3,), kg m/s, of vertices that are free or pinned to dynamic bodies."""
    particles = tables.array(PARTICLE)
    total: Floats = _moved(tables) @ particles[:, c.PARTICLE_VELOCITY : c.PARTICLE_VELOCITY + 3]
    return total


def cloth_angular_momentum(tables: Tables) -> Floats:
    """Measure the angular momentum about the origin, (3,), kg m^2/s, of vertices that are free or pinned to dynamic bodies."""
    particles = tables.array(PARTICLE)
    push = _moved(tables)[:, None] * particles[:, c.PARTICLE_VELOCITY : c.PARTICLE_VELOCITY + 3]
    total: Floats = cross(particles[:, :3], push).sum(axis=0)
    return total


def _moved(tables: Tables) -> Floats:
    """Return the masses of particles that are free or pinned to dynamic bodies, and zero for others, (P,), kg."""
    particles, pins = tables.array(PARTICLE), tables.array(PIN)
    moved = np.where(particles[:, c.PARTICLE_INVERSE_MASS] > 0.0, particles[:, c.PARTICLE_MASS], 0.0)
    carried = pins[tables.array(BODY)[pins[:, c.PINNED_BODY], BODY_KIND] == DYNAMIC, c.PINNED_PARTICLE]
    moved[carried] = particles[carried, c.PARTICLE_MASS]
    return moved


def _membrane(tables: Tables, x: Floats) -> float:
    """Return the energy of stretching and shear, J."""
    own = tables.array(CLOTH)
    of_faces = np.repeat(tables.array(CLOTH_NUMBERS), own[:, c.LAST_FACE] - own[:, c.FIRST_FACE], axis=0)
    corners = x[tables.array(FACE)[:, c.CORNERS : c.CORNERS + 3]]
    rest = tables.array(FACE_NUMBERS)
    p, q = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    u1, u2, v1, v2 = (rest[:, c.TO_REST + k, None] for k in range(4))
    u, v = u1 * p + u2 * q, v1 * p + v2 * q
    stretch = (np.linalg.norm(u, axis=1) - 1.0) ** 2 + (np.linalg.norm(v, axis=1) - 1.0) ** 2
    shear = (u * v).sum(axis=1) ** 2
    density = of_faces[:, c.STRETCH] * stretch + of_faces[:, c.SHEAR] * shear
    density[np.repeat(own[:, c.DIMENSION] != c.SHEET, own[:, c.LAST_FACE] - own[:, c.FIRST_FACE])] = 0.0
    return float(0.5 * rest[:, c.FACE_AREA] @ density)


def _tension(tables: Tables, x: Floats) -> float:
    """Return the energy of the tension of ropes, J."""
    own, rest = tables.array(CLOTH), tables.array(FACE_NUMBERS)
    stiffness = np.repeat(tables.array(CLOTH_NUMBERS)[:, c.STRETCH], own[:, c.LAST_FACE] - own[:, c.FIRST_FACE])
    of = np.flatnonzero(rest[:, c.REST_LENGTH])
    ends, at_rest = x[tables.array(FACE)[of, c.CORNERS : c.CORNERS + 2]], rest[of, c.REST_LENGTH]
    longer = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) - at_rest
    return float(0.5 * stiffness[of] @ (longer**2 / at_rest))


def _elastic(tables: Tables, x: Floats) -> float:
    """Return the energy of soft bodies, J; see `kickdrift.world.deformables.forces.elasticity`."""
    own, rest = tables.array(CLOTH), tables.array(TETRAHEDRON_NUMBERS)
    of = np.repeat(tables.array(CLOTH_NUMBERS), own[:, c.LAST_TETRAHEDRON] - own[:, c.FIRST_TETRAHEDRON], axis=0)
    corners = x[tables.array(TETRAHEDRON)[:, c.TETRAHEDRON_CORNERS : c.TETRAHEDRON_CORNERS + 4]]
    edges = (corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)
    f = edges @ rest[:, c.TO_REST_CELL : c.TO_REST_CELL + 9].reshape(-1, 3, 3)
    bulk, shear = lame(of[:, c.STRETCH], of[:, c.POISSON_RATIO])
    m, stiff = 4.0 / 3.0 * shear, bulk + 5.0 / 6.0 * shear
    square, swelling = (f * f).sum(axis=(1, 2)), np.linalg.det(f) - 1.0
    density = 0.5 * m * (square - 3.0 - np.log((square + 1.0) / 4.0)) + swelling * (0.5 * stiff * swelling - 0.75 * m)
    return float(rest[:, c.REST_VOLUME] @ density)


def _bending(tables: Tables, x: Floats) -> float:
    """Return the energy of bending, J."""
    total = 0.0
    for own, numbers in zip(tables.array(CLOTH), tables.array(CLOTH_NUMBERS), strict=True):
        here, other, rows = _coupled_pairs(own, tables.array(PARTICLE_COUPLINGS), tables.array(COUPLING))
        apart = x[other] - x[here]
        flat = 0.25 * float(tables.array(COUPLING_NUMBERS)[rows, c.WEIGHT] @ (apart * apart).sum(axis=1))
        curved = slice(own[c.FIRST_CURVED], own[c.LAST_CURVED])
        rest, corners = tables.array(CURVED_FACE_NUMBERS)[curved], x[tables.array(CURVED_FACE)[curved, : c.STENCIL + 6]]
        sides = corners - corners[:, :1]
        normals = np.cross(sides[:, 1], sides[:, 2])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        along = np.einsum("mk,mkj,mj->m", rest[:, c.PULLS : c.PULLS + 6], sides, normals)
        total += float(numbers[c.BENDING]) * (flat + float((rest[:, c.REST_ENERGY] - along).sum()))
    return total


def _coupled_pairs(own: Integers, ranges: Integers, couplings: Integers) -> tuple[Integers, Integers, Integers]:
    """Return the particles of a cloth that bending couples, each pair twice, and the rows of their couplings."""
    begin = ranges[own[c.FIRST_PARTICLE] : own[c.LAST_PARTICLE], c.COUPLINGS]
    counts = ranges[own[c.FIRST_PARTICLE] : own[c.LAST_PARTICLE], c.COUPLINGS + 1] - begin
    here = np.repeat(np.arange(own[c.FIRST_PARTICLE], own[c.LAST_PARTICLE]), counts)
    within = np.arange(len(here)) - np.repeat(np.cumsum(counts) - counts, counts)
    rows = own[c.FIRST_COUPLING] + np.repeat(begin, counts) + within
    return here, here + couplings[rows, c.OFFSET], rows
