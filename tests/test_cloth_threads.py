"""Cloths on threads: the same bits for any number of them, and chunks that do not write to each other's particles."""

import numba
import numpy as np
import pytest
from scipy.spatial import Delaunay

import kickdrift as kd
from kickdrift.world import tables
from kickdrift.world.contacts.layout import THREADED_LOOP, THREADED_SEARCH
from kickdrift.world.deformables.face_groups import GROUPS_IN_CHUNK, face_groups
from kickdrift.world.deformables.layout import IN_LANES, PAIR_KIND, TOUCHING_PARTICLE
from kickdrift.world.deformables.mesh import grid
from kickdrift.world.deformables.self_collision.untangling import CROSSING

STEP = 1 / 60
SIDE = 96  # enough particles and triangles for each of the loops to be run in parallel


def draped(side=SIDE, **options):
    """A sheet and a patch close above it that fall onto a ball."""
    world = kd.World(substeps=2, **options)
    world.add_plane()
    world.add_sphere(0.2, position=(0, 0, 0.2), static=True)
    for size, count, z in ((1.0, side, 0.406), (0.2, 20, 0.418)):
        cloth = world.add_cloth_grid((size, size), (count, count), position=(0, 0, z), density=0.2, thickness=0.01)
        cloth.position[:, 2] += 0.001 * np.sin(60.0 * cloth.position[:, 0] + 1e4 * z)
    return world


def moved(world, steps=4):
    world.advance(STEP, steps)
    return [
        world.tables.array(table).tobytes() for table in (tables.PARTICLE, tables.CLOTH_PAIR, tables.CLOTH_PAIR_NUMBERS)
    ]


def found(world):
    """Whether threads have found pairs of triangles."""
    return len(world.tables._room(tables.FOUND_PAIR)) > 0


@pytest.fixture
def thread_count():
    before = numba.get_num_threads()
    yield numba.set_num_threads
    numba.set_num_threads(before)


def test_any_number_of_threads_gives_the_same_bits(thread_count):
    wanted = moved(draped())
    for count in {1, 2, numba.config.NUMBA_NUM_THREADS}:
        if count <= numba.config.NUMBA_NUM_THREADS:
            thread_count(count)
            world = draped(threads=True)
            assert moved(world) == wanted
            assert world.tables.count(tables.CLOTH_PAIR) > 100
            assert found(world)  # found by threads
            assert world.tables.count(tables.CLOTH_PAIR) > 2000  # so many that they are laid in parallel
            assert world.tables.array(tables.KERNEL_ADDRESSES)[0, [THREADED_LOOP, THREADED_SEARCH]].all()


def test_a_world_without_threads_has_no_parallel_loops():
    world = draped(20)
    world.advance(STEP, 1)
    assert not world.tables.array(tables.KERNEL_ADDRESSES)[0, [THREADED_LOOP, THREADED_SEARCH]].any()
    assert not found(world)


def test_threads_take_over_from_a_snapshot_and_hand_back():
    world = draped()
    first = moved(world, 2)
    threaded = kd.World(threads=True)
    threaded.restore(world.snapshot())
    assert moved(threaded, 0) == first
    assert moved(threaded, 2) == moved(world, 2)
    world.restore(threaded.snapshot())
    assert moved(threaded, 1) == moved(world, 1)


def meshes():
    """Triangles of a grid, of the same shuffled, of random points, and of a fan, with the most colours that they may need."""
    rng = np.random.default_rng(7)
    regular = grid(100, 100, (1.0, 1.0))[1]
    order = rng.permutation(10_000)
    scattered = Delaunay(rng.uniform(size=(6000, 2))).simplices
    around = np.arange(1, 50_001)
    fan = np.stack((np.zeros_like(around), around, around + 1), axis=1)
    shuffled = rng.permutation(order[regular])
    return {"grid": (regular, 2), "shuffled": (shuffled, 40), "scattered": (scattered, 60), "fan": (fan, 10**9)}


def tangled(**options):
    """Two irregular meshes that cross each other, with damping."""
    world, rng = kd.World(substeps=2, **options), np.random.default_rng(5)
    points = 0.5 * np.stack(np.meshgrid(np.linspace(-1, 1, 72), np.linspace(-1, 1, 72)), axis=-1).reshape(-1, 2)
    points[(np.abs(points) < 0.5).all(axis=1)] += rng.uniform(-0.002, 0.002, (70**2, 2))
    for name, tilt in (("level", 0.0), ("tilted", 0.3)):
        fabric = {"name": name, "thickness": 0.004, "damping": 1e-3, "bending_stiffness": 1e-4, "self_collision": True}
        sheet = world.add_cloth(np.column_stack((points, tilt * points[:, 0])), Delaunay(points).simplices, **fabric)
        sheet.velocity[:, 0] = 0.2 * points[:, 0]
    return world


def test_irregular_meshes_that_cross_and_are_cut_have_the_same_bits_on_threads():
    wanted, found = tangled(), tangled(threads=True)
    assert moved(found, 2) == moved(wanted, 2)
    assert (wanted.tables.array(tables.CLOTH_PAIR)[:, PAIR_KIND] == CROSSING).any()
    for world in (wanted, found):
        world.cloth("level").cut((0.1, 0, 0), (1, 0.2, 0))
    assert moved(found, 1) == moved(wanted, 1)


@pytest.mark.parametrize("name", meshes())
def test_no_two_chunks_of_a_colour_have_a_common_particle(name):
    triangles, most = meshes()[name]
    rest = np.tile([1.0, 0.0, 0.0, 1.0, 0.5], (len(triangles), 1))
    groups = face_groups(triangles, rest)
    begin, colours = 0, 0
    while begin < len(groups.corners):
        end = groups.after[begin]
        assert end > begin
        assert (groups.after[begin:end] == end).all()
        seen = np.zeros(triangles.max() + 1, dtype=int)
        for first in range(begin, end, GROUPS_IN_CHUNK):
            seen[np.unique(groups.corners[first : min(first + GROUPS_IN_CHUNK, end)])] += 1
        assert seen.max() == 1
        begin, colours = end, colours + 1
    assert begin == len(groups.corners)
    assert colours <= most


def test_contacts_with_two_bodies_are_not_in_one_run():
    """A particle that touches two bodies must be in two runs, since threads share each."""
    world = kd.World(substeps=2)
    world.add_plane()
    world.add_box((4.0, 4.0, 0.002), position=(0, 0, -0.001 + 1e-5), static=True)
    world.add_cloth_grid((1.0, 1.0), (20, 20), position=(0, 0, 0.0052), thickness=0.01)
    world.advance(STEP, 3)
    contacts = world.tables.array(tables.CLOTH_CONTACT)
    starts = np.flatnonzero(contacts[:, IN_LANES] > 0)
    particles = contacts[:, TOUCHING_PARTICLE]
    assert len(np.unique(particles)) < len(particles)
    for start in starts:
        run = particles[start : start + contacts[start, IN_LANES]]
        assert (np.diff(run) > 0).all()
