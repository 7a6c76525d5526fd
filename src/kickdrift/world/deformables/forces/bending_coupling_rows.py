"""The couplings of the particles of a cloth by bending, in the tables of a world."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.forces.bending_couplings import Bending, bending_of, couplings_of
from kickdrift.world.deformables.forces.bending_curvature import curvature_of
from kickdrift.world.deformables.forces.highest_frequency import bending_rate
from kickdrift.world.deformables.mesh import ClothMesh, flattened
from kickdrift.world.deformables.rope_mesh import rope_bending
from kickdrift.world.deformables.row_ranges import replace_rows
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    COUPLING,
    COUPLING_NUMBERS,
    CURVED_FACE,
    CURVED_FACE_NUMBERS,
    FACE_NUMBERS,
    PARTICLE,
    PARTICLE_COUPLINGS,
    Table,
    Tables,
)

Floats = NDArray[np.float64]


def put_couplings(tables: Tables, row: int, mesh: ClothMesh) -> None:
    """Write the couplings of the particles of a cloth or a rope by bending, given the present pins; a soft body has none.

    Parameters
    ----------
    tables : Tables
    row : int
        Row of the cloth.
    mesh : ClothMesh
        Its mesh at rest.
    """
    own, numbers = tables.array(CLOTH)[row], tables.array(CLOTH_NUMBERS)[row]
    if own[c.DIMENSION] == c.VOLUME:
        return
    vertices, faces = slice(*own[c.FIRST_PARTICLE :][:2]), slice(*own[c.FIRST_FACE :][:2])
    particles, areas = tables.array(PARTICLE)[vertices], tables.array(FACE_NUMBERS)[faces, c.FACE_AREA]
    pinned = particles[:, c.PARTICLE_INVERSE_MASS] == 0.0
    if own[c.DIMENSION] == c.ROPE:
        bending, areas = rope_bending(mesh, pinned)  # lengths in place of areas
    else:
        flat, _ = flattened(mesh, np.array([1.0, 0.0, 0.0]))  # any axes will do: bending is the same in all directions
        bending = bending_of(mesh, curvature_of(mesh, flat, pinned))
    couplings = couplings_of(bending, areas, len(particles))
    tables.array(PARTICLE_COUPLINGS)[vertices] = couplings.ranges
    rows = {COUPLING: couplings.offsets[:, None], COUPLING_NUMBERS: couplings.weights[:, None]}
    replace_rows(tables, row, c.FIRST_COUPLING, rows)
    if own[c.DIMENSION] == c.SHEET:
        replace_rows(tables, row, c.FIRST_CURVED, _curved(bending, areas, int(own[c.FIRST_PARTICLE])))
    rate = bending_rate(mesh, bending, areas, particles[:, c.PARTICLE_MASS])
    numbers[c.BENDING_RATE] = math.sqrt(numbers[c.ASKED + 2]) * rate


def _curved(bending: Bending, areas: Floats, first: int) -> Mapping[Table, NDArray[Any]]:
    """Return the rows of triangles that are curved at rest, for a cloth whose first particle is `first`."""
    curved = np.flatnonzero(bending.rest.any(axis=1))
    rest, size = bending.rest[curved], areas[curved, None]
    stencils = np.zeros((len(curved), CURVED_FACE.width), dtype=np.int64)
    stencils[:, c.STENCIL : c.STENCIL + 6] = bending.stencils[curved] + first
    numbers = np.zeros((len(curved), CURVED_FACE_NUMBERS.width))
    numbers[:, c.PULLS : c.PULLS + 6] = size * np.einsum("ms,msk->mk", rest, bending.rows[curved])
    numbers[:, [c.REST_ENERGY]] = 0.5 * size * (rest * rest).sum(axis=1, keepdims=True)
    return {CURVED_FACE: stencils, CURVED_FACE_NUMBERS: numbers}
