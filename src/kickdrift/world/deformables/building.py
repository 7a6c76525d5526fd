"""The rows of a new cloth, rope or soft body, before they are in the tables of a world."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.fabric import Fabric
from kickdrift.world.deformables.forces.highest_frequency import elastic_rate
from kickdrift.world.deformables.forces.membrane import inverse_edges
from kickdrift.world.deformables.mesh import ClothMesh, flattened, masses_of
from kickdrift.world.deformables.rope_material import RopeMaterial
from kickdrift.world.deformables.rope_mesh import lengths_of, rope_masses, stretch_rate
from kickdrift.world.deformables.soft_material import SoftMaterial, lame
from kickdrift.world.deformables.tetrahedra import TetrahedralMesh
from kickdrift.world.shapes.kind_numbers import CAPSULE, SPHERE, TRIANGLE
from kickdrift.world.tables import CLOTH_NUMBERS, FACE_NUMBERS, TETRAHEDRON_NUMBERS

Floats = NDArray[np.float64]

# Upper bounds of the skin, relative to thickness and triangle size: with 0.2 of the latter, neighbours in a sheet would be
# pairs.
_OF_THICKNESS, _SKIN = 0.5, 0.12


# Kinds of shapes as which particles, and segments or triangles between them, meet those of bodies, by `DIMENSION`
MET_AS = {
    c.ROPE: frozenset({SPHERE, CAPSULE}),
    c.SHEET: frozenset({SPHERE, TRIANGLE}),
    c.VOLUME: frozenset({SPHERE, TRIANGLE}),
}


class Built(NamedTuple):
    """What a cloth, a rope or a soft body is made of.

    Attributes
    ----------
    dimension : int
        As in the column `DIMENSION`.
    mesh : ClothMesh
    masses : (N,) array
        Of the vertices, kg.
    at_rest : (M, K) array
        Rows of FACE_NUMBERS.
    numbers : (L,) array
        Row of CLOTH_NUMBERS.
    tetrahedra : (K, 4) array
        Vertices of each.
    cells_at_rest : (K, 10) array
        Rows of TETRAHEDRON_NUMBERS.
    """

    dimension: int
    mesh: ClothMesh
    masses: Floats
    at_rest: Floats
    numbers: Floats
    tetrahedra: NDArray[np.int64] = np.zeros((0, 4), dtype=np.int64)
    cells_at_rest: Floats = np.zeros((0, TETRAHEDRON_NUMBERS.width))


def built_cloth(mesh: ClothMesh, fabric: Fabric, warp: Floats) -> Built:
    """Return the rows of a cloth of a mesh."""
    to_rest = inverse_edges(flattened(mesh, warp)[0])
    areas = 0.5 / np.abs(to_rest[:, 0] * to_rest[:, 3] - to_rest[:, 1] * to_rest[:, 2])
    at_rest = np.zeros((len(areas), FACE_NUMBERS.width))
    at_rest[:, c.TO_REST : c.TO_REST + 4], at_rest[:, c.FACE_AREA] = to_rest, areas
    stiffness = fabric.stretch_stiffness, fabric.shear_stiffness, fabric.bending_stiffness
    numbers = _numbers(stiffness, fabric.damping, fabric.linear_damping, fabric.friction)
    _put_thickness(numbers, fabric.thickness, math.sqrt(float(np.median(areas))))
    numbers[c.AREA_DENSITY], numbers[c.TEAR_STRAIN] = fabric.density, fabric.tear_strain
    numbers[c.TETHER_STRAIN] = fabric.tether_strain
    numbers[c.DRAG], numbers[c.LIFT] = fabric.air_density * fabric.drag, fabric.air_density * fabric.lift
    return Built(c.SHEET, mesh, masses_of(mesh, fabric.density * areas), at_rest, numbers)


def built_rope(mesh: ClothMesh, material: RopeMaterial) -> Built:
    """Return the rows of a rope of these segments."""
    lengths = lengths_of(mesh.vertices)
    masses = rope_masses(lengths, material.density)
    at_rest = np.zeros((len(lengths), FACE_NUMBERS.width))
    at_rest[:, c.REST_LENGTH] = lengths
    stiffness = material.stretch_stiffness, 0.0, material.bending_stiffness
    numbers = _numbers(stiffness, material.damping, material.linear_damping, material.friction)
    _put_thickness(numbers, 2.0 * material.radius, float(np.median(lengths)))
    numbers[c.TETHER_STRAIN] = material.tether_strain
    numbers[c.MEMBRANE_RATE] = stretch_rate(lengths, material.stretch_stiffness, masses)
    return Built(c.ROPE, mesh, masses, at_rest, numbers)


def built_soft_body(mesh: TetrahedralMesh, material: SoftMaterial) -> Built:
    """Return what a soft body of these tetrahedra is made of."""
    surface, cells = mesh.surface, mesh.tetrahedra
    corners = surface.vertices[surface.triangles]
    at_rest = np.zeros((len(corners), FACE_NUMBERS.width))
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    at_rest[:, c.FACE_AREA] = 0.5 * np.linalg.norm(across, axis=1)
    quarters = np.repeat(0.25 * material.density * mesh.volumes, 4)
    masses = np.asarray(np.bincount(cells.ravel(), weights=quarters), dtype=np.float64)
    numbers = _numbers((material.young_modulus, 0.0, 0.0), material.damping, material.linear_damping, material.friction)
    numbers[c.POISSON_RATIO] = material.poisson_ratio
    _put_thickness(numbers, material.thickness, math.sqrt(float(np.median(at_rest[:, c.FACE_AREA]))))
    bulk, shear = lame(material.young_modulus, material.poisson_ratio)
    numbers[c.MEMBRANE_RATE] = elastic_rate(mesh, bulk, shear, masses)
    cells_at_rest = np.column_stack((mesh.to_rest.reshape(-1, 9), mesh.volumes))
    return Built(c.VOLUME, surface, masses, at_rest, numbers, cells, cells_at_rest)


def _numbers(stiffness: tuple[float, float, float], damping: float, linear_damping: float, friction: float) -> Floats:
    """Return a row of CLOTH_NUMBERS with these parameters; `stiffness` is against stretching, shear and bending."""
    numbers = np.zeros(CLOTH_NUMBERS.width)
    numbers[c.STRETCH : c.STRETCH + 5] = numbers[c.ASKED : c.ASKED + 5] = (*stiffness, damping, damping)
    numbers[c.LINEAR_DAMPING], numbers[c.CLOTH_FRICTION] = linear_damping, friction
    return numbers


def _put_thickness(numbers: Floats, thickness: float, size: float) -> None:
    """Write a thickness, and a skin for triangles of some size, m."""
    numbers[c.CLOTH_RADIUS], numbers[c.SKIN] = 0.5 * thickness, min(_OF_THICKNESS * thickness, _SKIN * size)
