"""Tethers: against geodesics of developable meshes, lengths that no vertex exceeds, and energy that does not grow."""

import copy

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

import kickdrift as kd
from kickdrift.world.deformables.geodesics import lines_on, shortest_ways
from kickdrift.world.deformables.mesh import cloth_mesh, grid

STEP = 1 / 60
SOFTER = pytest.mark.filterwarnings("ignore:Of .*, as much as the step allows:kickdrift.UnsolvedWarning")


def ways_from(mesh, source):
    lengths, nearest = shortest_ways(lines_on(mesh), len(mesh.vertices), np.array([source]))
    assert (nearest == source).all()
    return lengths


def random_mesh(seed, count=400):
    points = np.random.default_rng(seed).random((count, 2))
    inner = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    points = np.concatenate((points * 0.9 + 0.05, inner))
    return np.column_stack((points, np.zeros(len(points)))), Delaunay(points).simplices.astype(np.int64)


@pytest.mark.parametrize(
    ("mesh", "longer"),
    [
        (grid(30, 30, (1.0, 1.0)), 0.014),
        (grid(30, 30, (3.0, 1.0)), 0.09),
        (random_mesh(1), 0.05),
        (random_mesh(2), 0.05),
    ],
)
def test_ways_on_flat_meshes_are_straight(mesh, longer):
    flat = cloth_mesh(*mesh)
    for source in (0, len(flat.vertices) // 2, len(flat.vertices) - 1):
        straight = np.linalg.norm(flat.vertices - flat.vertices[source], axis=1)
        ways = ways_from(flat, source)
        assert (ways >= straight * (1.0 - 1e-12)).all()
        assert (ways <= (1.0 + longer) * straight).all()


def test_ways_along_a_rolled_sheet_are_those_of_the_flat_one():
    points, triangles = grid(25, 15, (1.0, 0.6))
    radius = 0.2  # chords of a cylinder: the sheet unrolls to edges that are shorter than the arcs
    angle = points[:, 0] / radius
    rolled = np.column_stack((radius * np.sin(angle), points[:, 1], radius * np.cos(angle)))
    flat = points.copy()
    flat[:, 0] *= np.sin(0.5 / 24 / radius) / (0.5 / 24 / radius)
    expected = ways_from(cloth_mesh(flat, triangles), 7)
    assert ways_from(cloth_mesh(rolled, triangles), 7) == pytest.approx(expected, rel=1e-9)


def test_there_is_no_way_to_a_separate_piece():
    points, triangles = grid(3, 3, (1.0, 1.0))
    mesh = cloth_mesh(np.concatenate((points, points + 5.0)), np.concatenate((triangles, triangles + 9)))
    lengths, nearest = shortest_ways(lines_on(mesh), 18, np.array([0, 2]))
    assert np.isfinite(lengths[:9]).all()
    assert set(nearest[:9]) == {0, 2}
    assert np.isinf(lengths[9:]).all()


def stiff_sheet(strain, substeps=1, n=40):
    """Return a world with a sheet that the step makes ten thousand times softer, held at two corners."""
    world = kd.World(substeps=substeps)
    sheet = world.add_cloth_grid(
        (1.0, 1.0), (n, n), position=(0, 0, 2), stretch_stiffness=1e7, shear_stiffness=1e7, tether_strain=strain
    )
    sheet.pin([0, n * n - n])
    return world, sheet


def excess(sheet, ways, nearest):
    """Return by how much the vertices are beyond their ways from the nearest pins, relative to them."""
    held = ways > 0.0
    apart = np.linalg.norm(sheet.position - sheet.position[nearest], axis=1)
    return float((apart[held] / ways[held]).max()) - 1.0


@SOFTER
@pytest.mark.parametrize("substeps", [1, 2])
@pytest.mark.parametrize("strain", [1e-3, 0.02])
def test_no_vertex_goes_beyond_its_tether(strain, substeps):
    world, sheet = stiff_sheet(strain, substeps)
    mesh = cloth_mesh(sheet.position.copy(), sheet.triangles)
    ways, energy, most = shortest_ways(lines_on(mesh), 1600, np.array([0, 1560])), world.energy().total, 0.0
    for _ in range(120):
        world.advance(STEP, 1)
        most = max(most, excess(sheet, *ways))
        assert world.energy().total < energy + 1e-6
    assert most == pytest.approx(strain, rel=0.05)
    world, sheet = stiff_sheet(0.0, substeps)
    world.advance(STEP, 30)
    assert excess(sheet, *ways) > 0.025


def ball_on_a_rope(strain, density, pinned_to_cart=False):
    world = kd.World(substeps=1)
    rope = world.add_rope(
        np.linspace((0, 0, 3), (0, 0, 2), 20), density=0.05, stretch_stiffness=1e5, tether_strain=strain
    )
    ball = world.add_sphere(0.2, position=(0, 0, 1.8), velocity=(2, 0, 0), density=density)
    rope.pin([19], ball)
    cart = world.add_box((0.1, 0.1, 0.1), position=(0, 0, 3.1), kinematic=True, velocity=(0, 1, 0))
    rope.pin([0], cart if pinned_to_cart else None)
    return world, rope, ball


@SOFTER
@pytest.mark.parametrize("pinned_to_cart", [False, True], ids=["world", "cart"])
@pytest.mark.parametrize("density", [100.0, 1e5])
def test_a_heavy_ball_does_not_stretch_a_light_rope(density, pinned_to_cart):
    world, rope, _ = ball_on_a_rope(0.01, density, pinned_to_cart)
    longest = 0.0
    for _ in range(180):
        world.advance(STEP, 1)
        longest = max(longest, np.linalg.norm(rope.position - rope.position[0], axis=1).max())
    assert longest == pytest.approx(1.01, abs=1e-3)
    world, rope, _ = ball_on_a_rope(0.0, density)
    for _ in range(30):
        world.advance(STEP, 1)
        longest = max(longest, np.linalg.norm(rope.position[19] - rope.position[0]))
    assert longest > 1.05


@SOFTER
def test_a_ball_swings_on_a_tethered_rope_as_a_pendulum():
    world, _, ball = ball_on_a_rope(1e-4, 1e4)
    places = []
    for _ in range(240):
        world.advance(STEP, 1)
        places.append(float(ball.position[0]))
    places = np.array(places)
    crossings = np.flatnonzero((places[:-1] < 0) != (places[1:] < 0))[1:]
    half = np.diff(crossings).mean() * STEP
    # The ball hangs from a point: its length is 1.2 m and 2 r^2 / (5 l) for its inertia, if it turns with the rope.
    small = np.pi * np.sqrt((1.2 + 0.4 * 0.04 / 1.2) / 9.81)
    amplitude = np.arccos(1.0 - 2.0**2 / (2 * 9.81 * 1.2))
    assert half == pytest.approx(small * (1.0 + amplitude**2 / 16), rel=0.03)


@SOFTER
def test_sheets_that_are_let_go_or_cut_off_fall():
    world, sheet = stiff_sheet(0.01, n=9)
    world.advance(STEP, 30)
    sheet.unpin([0, 72])
    centre = sheet.position.mean(axis=0)
    sheet.velocity[:] = 0.0
    world.advance(STEP, 30)
    assert centre[2] - sheet.position[:, 2].mean() == pytest.approx(0.5 * 9.81 * 0.25, rel=0.05)
    world, sheet = stiff_sheet(0.01, n=9)
    sheet.cut(point=(0, 0.01, 2), normal=(0, 1, 0))
    world.advance(STEP, 60)
    assert sheet.position[:, 2].min() < -2.0
    held = sheet.position[:, 2] > 0.9
    assert 36 <= held.sum() < 81


@SOFTER
def test_worlds_with_tethers_go_on_with_the_same_bits(tmp_path):
    world, sheet = stiff_sheet(0.01)
    world.advance(STEP, 20)
    other, state = copy.deepcopy(world), world.snapshot()
    loaded = kd.load_world(world.save(tmp_path / "world.npz"))
    world.advance(STEP, 20)
    ended = sheet.position.copy()
    for copied in (other, loaded):
        copied.advance(STEP, 20)
        assert np.array_equal(copied.cloths.handle(0).position, ended)
    world.restore(state)
    world.advance(STEP, 20)
    assert np.array_equal(sheet.position, ended)


@SOFTER
@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10_000))
def test_random_tethered_sheets_gain_no_energy(seed):
    rng = np.random.default_rng(seed)
    world = kd.World(substeps=int(rng.integers(1, 4)))
    n, stiffness = int(rng.integers(5, 12)), 10 ** rng.uniform(2, 8)
    sheet = world.add_cloth_grid(
        rng.uniform(0.5, 1.5, 2), (n, n), stretch_stiffness=stiffness, shear_stiffness=stiffness,
        density=10 ** rng.uniform(-1, 1), tether_strain=10 ** rng.uniform(-4, -1),
    )  # fmt: skip
    sheet.pin([[0], [0, n - 1], list(range(n)), list(range(0, n, 2))][int(rng.integers(4))])
    sheet.velocity[n:] = 0.3 * rng.normal(size=(n * n - n, 3))
    start = world.energy()
    allowed = 0.01 * (start.kinetic + 9.81 * sheet.mass.sum())
    for _ in range(40):
        world.advance(STEP, 3)
        assert world.energy().total < start.total + allowed


@pytest.mark.parametrize("strain", [-0.1, np.nan, np.inf, 1e-20, "1", None])
def test_invalid_strains_are_errors(strain):
    world = kd.World()
    with pytest.raises(kd.ArgumentError, match="tether_strain"):
        world.add_cloth_grid(tether_strain=strain)
    with pytest.raises(kd.ArgumentError, match="tether_strain"):
        world.add_rope([(0, 0, 0), (1, 0, 0)], tether_strain=strain)


@pytest.mark.parametrize(("options", "advised"), [({"damping": 1e-3}, False), ({"stretch_stiffness": 1e6}, True)])
@SOFTER
def test_tethers_are_advised_where_the_step_makes_cloth_softer(options, advised):
    world = kd.World()
    world.add_cloth_grid(vertices=(30, 30), **options)
    assert ("tether_strain" in world.run(duration=0.02, step=STEP).message) == advised


def test_tethers_can_be_set_and_removed():
    world = kd.World(substeps=1)
    rope = world.add_rope(
        [(0, 0, -0.1 * k) for k in range(11)], stretch_stiffness=50.0, density=0.5, linear_damping=1.0
    )
    rope.pin([0])
    for strain, longest in ((0.01, 1.01), (0.0, 1.05)):
        rope.tether_strain = strain
        assert rope.tether_strain == strain
        world.advance(STEP, 300)
        assert -rope.position[-1, 2] == pytest.approx(longest, abs=5e-3)
    with pytest.raises(kd.KickdriftError, match="tether_strain"):
        rope.tether_strain = -0.1
