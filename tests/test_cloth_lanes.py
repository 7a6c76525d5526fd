"""Forces on eight triangles and particles at once are those on each, however vertices and triangles are numbered."""

import numba
import numpy as np
import pytest
from vector_instructions import needs_wide_vectors, packed

import kickdrift as kd
from kickdrift.world import tables
from kickdrift.world.deformables import layout
from kickdrift.world.deformables.chunks import CHUNK
from kickdrift.world.deformables.face_groups import face_groups
from kickdrift.world.deformables.forces import bending, membrane
from kickdrift.world.deformables.mesh import grid
from kickdrift.world.deformables.particle_fields import fill_lanes

N, M = 21, 19
PART = 1e-4  # s


def forces(world):
    """Forces of the membrane and of bending on the vertices of the only cloth of a world, damped and twice in a row."""
    lanes = world.tables.array(tables.PARTICLE_LANES)
    lanes[:] = 0.0
    particles = world.tables.array(tables.PARTICLE)
    for damped in (0.0, 1.0 / PART):
        fill_lanes(world.tables.address, 0)
        membrane.add_membrane(world.tables.address, 0, 1.0, damped)
        bending.add_bending(world.tables.address, 0, 0.5, damped)
        particles[:, :3] += PART * particles[:, layout.PARTICLE_VELOCITY :][:, :3]
    fields = lanes.reshape(layout.LANE_FIELDS, -1)
    return (fields[layout.FORCES :][:3] + fields[layout.FORCES_APART :][:3]).T


def sheet(vertices, triangles, moved, speeds):
    world = kd.World(gravity=(0, 0, 0))
    cloth = world.add_cloth(vertices, triangles, bending_stiffness=1e-3, damping=1e-3)
    world.advance(1e-9, 1)  # compiles what is called by address
    world.cloths.tune(1 / 240)
    cloth.position[:], cloth.velocity[:] = moved, speeds
    return world


def in_rows(world):
    return world.tables.array(tables.FACE_GROUP)[:, layout.IN_ROWS].astype(bool)


def test_forces_do_not_depend_on_how_vertices_and_triangles_are_numbered():
    vertices, triangles = grid(N, M, (1.0, 0.9))
    rng = np.random.default_rng(4)
    moved, speeds = vertices + 0.01 * rng.normal(size=vertices.shape), rng.normal(size=vertices.shape)
    regular = sheet(vertices, triangles, moved, speeds)
    order = rng.permutation(len(vertices))  # new number of each vertex
    back = np.argsort(order)
    shuffled = sheet(vertices[back], rng.permutation(order[triangles]), moved[back], speeds[back])
    # Rates are found to 1e-3 only, and say how much of the damping is granted.
    shuffled.tables.array(tables.CLOTH_NUMBERS)[:] = regular.tables.array(tables.CLOTH_NUMBERS)
    assert in_rows(regular).mean() > 0.7
    assert not in_rows(shuffled).any()
    wanted, found = forces(regular), forces(shuffled)[order]
    assert found == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())
    assert np.abs(wanted.sum(axis=0)).max() < 1e-11 * np.abs(wanted).max()


def test_every_triangle_is_in_one_group():
    _, triangles = grid(N, M, (1.0, 0.9))
    rest = np.tile([1.0, 0.0, 0.0, 1.0, 0.5], (len(triangles), 1))
    groups = face_groups(triangles, rest)
    areas = groups.rests[groups.of, 4]  # (G, 8)
    kept = groups.corners.transpose(0, 2, 1)[areas > 0.0]
    assert np.array_equal(np.unique(kept, axis=0), np.unique(triangles, axis=0))
    assert len(kept) == len(triangles)
    steps = np.diff(groups.corners, axis=2)
    assert (steps[groups.in_rows] == 1).all()
    assert not (steps[~groups.in_rows] == 1).all(axis=(1, 2)).any()


def test_forces_on_consecutive_triangles_are_added_without_overlap():
    # A processor waits where a vector is read from memory to which parts of it have just been written.
    groups = face_groups(grid(100, 100, (1.0, 1.0))[1], np.ones((2 * 99 * 99, 5)))
    rows, apart = groups.corners[groups.in_rows, :, 0], groups.apart[groups.in_rows]
    assert not groups.apart[~groups.in_rows].any()
    assert apart.sum(axis=1).tolist() == [1] * len(rows)
    both = np.concatenate((rows[:-1], rows[1:]), axis=1)
    sets = np.concatenate((apart[:-1], apart[1:]), axis=1)
    away = np.abs(both[:, :, None] - both[:, None])
    overlap = (away > 0) & (away < 8) & (sets[:, :, None] == sets[:, None])
    assert overlap.any(axis=(1, 2)).mean() < 0.2  # between the ranges of triangles only


@needs_wide_vectors
def test_forces_are_in_vectors():
    # Losing the vectors changes no result, only the speed.
    for function, roots, products in ((membrane.add_some_groups, 2, 40), (bending.couple_some, 0, 9)):
        fresh = numba.jit(**function.targetoptions)(function.py_func)
        fresh.compile(CHUNK.args)
        (assembly,) = fresh.inspect_asm().values()
        assert packed(assembly, "vsqrt") >= roots
        assert packed(assembly, r"vfn?m(?:add|sub)\d+") >= products
