"""Cloth: against the elastica, the catenary, hanging strips, terminal speed and conservation laws; and bad input."""

import copy

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

import kickdrift as kd
from kickdrift.world.deformables.forces import bending, membrane
from kickdrift.world.deformables.forces.bending_curvature import curvature_of
from kickdrift.world.deformables.layout import FORCES, FORCES_APART, LANE_FIELDS
from kickdrift.world.deformables.mesh import cloth_mesh, flattened, grid
from kickdrift.world.deformables.particle_fields import fill_lanes

STEP = 1 / 60
UPRIGHT = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)  # warp hangs down


def hanging_strip(n, stiffness=100.0, density=0.3, substeps=8):
    world = kd.World(substeps=substeps)
    strip = world.add_cloth_grid(
        (1.0, 0.2), (n + 1, n // 5 + 1), orientation=UPRIGHT, density=density, stretch_stiffness=stiffness,
        damping=1e-2, linear_damping=4.0,
    )  # fmt: skip
    height = strip.position[:, 2].copy()
    strip.pin(np.flatnonzero(height > height.max() - 1e-9))
    return world, strip, height < height.min() + 1e-9


@pytest.mark.parametrize(("n", "stiffness", "density"), [(10, 100.0, 0.3), (20, 60.0, 0.1), (40, 300.0, 0.5)])
def test_a_hanging_strip_stretches_by_its_own_weight(n, stiffness, density):
    world, strip, bottom = hanging_strip(n, stiffness, density)
    before = strip.position[bottom, 2].mean()
    world.advance(STEP, 400)
    extension = before - strip.position[bottom, 2].mean()
    assert extension == pytest.approx(density * 9.81 / (2 * stiffness), rel=0.01)
    assert np.abs(strip.velocity).max() < 1e-3


def elastica(length, load, stiffness):
    """Where the tip of a clamped strip under its own weight is: D theta'' = w (L - s) cos theta."""

    def slope(s, y):
        return np.stack((y[1], load * (length - s) * np.cos(y[0]) / stiffness, np.cos(y[0]), np.sin(y[0])))

    s = np.linspace(0.0, length, 50)
    guess = np.stack((-s, -np.ones_like(s), s, -s * s))
    solved = solve_bvp(slope, lambda a, b: np.array([a[0], b[1], a[2], a[3]]), s, guess, tol=1e-8)
    assert solved.success
    return solved.y[2:, -1]


@pytest.mark.parametrize("n", [10, 20, 40])
@pytest.mark.parametrize(("length", "stiffness"), [(0.4, 0.01), (0.25, 0.004)])
def test_a_clamped_strip_bends_as_the_elastica(n, length, stiffness):
    world, side = kd.World(substeps=8), length / n
    strip = world.add_cloth_grid(
        (length + side, 2 * side), (n + 2, 3), stretch_stiffness=300.0, shear_stiffness=60.0, bending_stiffness=stiffness,
        damping=1e-2, linear_damping=4.0,
    )  # fmt: skip
    start = strip.position[:, 0].min()
    strip.pin(np.flatnonzero(strip.position[:, 0] < start + 1.5 * side))
    world.advance(STEP, 300)
    tip = strip.position[-3:].mean(axis=0)[[0, 2]] - [start + side, 0.0]
    assert tip == pytest.approx(elastica(length, 0.2 * 9.81, stiffness), abs=0.02 * length * (10 / n))


def test_a_strip_that_is_not_clamped_by_two_rows_bends_too_far():
    """The check above fails where the half of an angle beside a clamp is counted as a whole."""
    mesh = cloth_mesh(*grid(12, 3, (0.44, 0.08)))
    clamped = curvature_of(mesh, flattened(mesh, np.array([1.0, 0, 0]))[0], mesh.vertices[:, 0] < 0.05)
    free = curvature_of(mesh, flattened(mesh, np.array([1.0, 0, 0]))[0], np.zeros(len(mesh.vertices), bool))
    assert np.abs(clamped.weights).max() == pytest.approx(2 * np.abs(free.weights).max())


def test_curvature_is_exact_for_quadratic_surfaces_on_any_mesh():
    rng = np.random.default_rng(3)
    vertices, triangles = grid(7, 6, (1.0, 0.8))
    vertices[:, :2] += rng.uniform(-0.03, 0.03, (len(vertices), 2))
    mesh = cloth_mesh(vertices, triangles)
    found = curvature_of(mesh, flattened(mesh, np.array([1.0, 0, 0]))[0], np.zeros(len(vertices), bool))
    xx, yy, xy = rng.normal(size=3)
    heights = 0.5 * xx * vertices[:, 0] ** 2 + 0.5 * yy * vertices[:, 1] ** 2 + xy * vertices[:, 0] * vertices[:, 1]
    inner = (mesh.sides >= 0).all(axis=1)
    curvature = np.einsum("mij,mj->mi", found.weights @ found.jumps, heights[found.stencils])[inner]
    assert curvature == pytest.approx(np.tile([xx, yy, np.sqrt(2) * xy], (inner.sum(), 1)), abs=1e-10)


def test_a_narrow_strip_hangs_as_a_catenary():
    length, span = 1.0, 0.7
    world = kd.World(substeps=8)
    chain = world.add_cloth_grid(
        (length, 0.05), (41, 3), stretch_stiffness=500.0, bending_stiffness=0.0, damping=1e-2, linear_damping=3.0
    )
    ends = [np.flatnonzero(sign * chain.position[:, 0] > 0.5 * length - 1e-9) for sign in (-1, 1)]
    chain.pin(np.concatenate(ends))
    for end, sign in zip(ends, (1, -1), strict=True):
        chain.velocity[end, 0] = sign * (length - span) / 2 / 2.0
    world.advance(STEP, 120)
    for end in ends:
        chain.velocity[end] = 0.0
    world.advance(STEP, 400)
    a = brentq(lambda a: 2 * a * np.sinh(span / 2 / a) - length, 0.05, 5.0)
    assert -chain.position[:, 2].min() == pytest.approx(a * (np.cosh(span / 2 / a) - 1.0), rel=0.005)


def sag(n, substeps):
    world = kd.World(substeps=substeps)
    sheet = world.add_cloth_grid((1.0, 1.0), (n, n), damping=1e-2, linear_damping=6.0)
    index = np.arange(n * n).reshape(n, n)
    sheet.pin(np.concatenate((index[0], index[-1], index[:, 0], index[:, -1])))
    world.advance(STEP, 240)
    return -sheet.position[:, 2].min()


def test_the_sag_of_a_sheet_depends_neither_on_substeps_nor_on_its_mesh():
    reference = sag(20, 8)
    assert sag(20, 32) == pytest.approx(reference, rel=1e-3)
    assert sag(80, 8) == pytest.approx(reference, rel=0.01)


def test_free_cloth_keeps_momentum_and_angular_momentum():
    world = kd.World(gravity=(0, 0, 0))
    sheet = world.add_cloth_grid((1.0, 1.0), (9, 9), bending_stiffness=1e-3, damping=1e-3)
    sheet.velocity[:] = np.random.default_rng(0).normal(size=sheet.velocity.shape)
    momentum, spin, energy = world.momentum(), world.angular_momentum(), world.energy().total
    world.advance(STEP, 1000)
    assert world.momentum() == pytest.approx(momentum, abs=1e-12)
    assert world.angular_momentum() == pytest.approx(spin, abs=1e-12)
    assert 0.0 < world.energy().total < energy  # which damping takes


def test_without_damping_energy_stays():
    world = kd.World(substeps=4)
    sheet = world.add_cloth_grid(
        (1.0, 1.0), (9, 9), stretch_stiffness=50.0, shear_stiffness=20.0, bending_stiffness=1e-3
    )
    sheet.pin([0, 8])
    energies = []
    for _ in range(200):
        world.step(STEP)
        energies.append(world.energy())
    exchanged = max(energy.kinetic for energy in energies)
    assert np.ptp([energy.total for energy in energies]) < 0.06 * exchanged


@pytest.mark.parametrize(
    ("drag", "density", "substeps"), [(0.5, 0.2, 4), (1.2, 0.2, 1), (1.2, 0.02, 4), (0.3, 1.0, 4), (2.0, 0.05, 8)]
)
def test_a_falling_sheet_reaches_its_terminal_speed_and_does_not_tilt(drag, density, substeps):
    """Where triangles felt the impulses of those before them, it was up to 5 % too fast, and one side fell faster."""
    world = kd.World(substeps=substeps)
    sheet = world.add_cloth_grid((1.0, 1.0), (9, 7), drag=drag, density=density, bending_stiffness=1.0)
    world.advance(STEP, 480)
    assert -sheet.velocity[:, 2] == pytest.approx(np.sqrt(2 * density * 9.81 / (1.2 * drag)), rel=1e-5)
    assert np.ptp(sheet.position[:, 2]) < 1e-6


def test_wind_carries_a_sheet_along_as_fast_as_itself():
    world = kd.World(gravity=(0, 0, 0))
    sheet = world.add_cloth_grid((1.0, 1.0), (5, 5), drag=50.0, density=0.01, bending_stiffness=1e-3)
    sheet.wind = (0.0, 0.0, 8.0)
    world.advance(STEP, 60)
    assert sheet.velocity[:, 2].mean() == pytest.approx(8.0, abs=0.01)


def test_a_sheet_drapes_over_a_ball_and_comes_to_rest():
    world = kd.World()
    world.add_plane()
    ball = world.add_sphere(0.3, position=(0, 0, 0.3), density=2000.0)
    sheet = world.add_cloth_grid(
        (1.0, 1.0), (25, 25), position=(0, 0, 0.8), damping=1e-3, linear_damping=1.5, bending_stiffness=1e-4
    )
    world.advance(STEP, 600)
    away = np.linalg.norm(sheet.position - ball.position, axis=1) - 0.3
    assert away.min() > 0.002  # half the thickness is 0.0025
    assert sheet.position[:, 2].min() > 0.0
    assert np.abs(sheet.velocity).max() < 0.01
    assert (away < 0.01).sum() > 100


@pytest.mark.parametrize("speed", [-2.0, -0.5, 0.5, 2.0])
def test_cloth_lies_on_what_moves_as_on_what_stands(speed):
    world = kd.World()
    platform = world.add_box((1.0, 1.0, 0.2), position=(0, 0, -0.1), kinematic=True)
    sheet = world.add_cloth_grid((0.5, 0.5), (5, 5), position=(0, 0, 0.0025))
    platform.velocity[:], sheet.velocity[:, 2] = (0, 0, speed), speed
    world.advance(STEP, 40)
    assert sheet.position[:, 2] - platform.position[2] - 0.1 == pytest.approx(0.0025, abs=1e-4)


@pytest.mark.parametrize("mass", [1.0, 0.1, 0.01])
def test_a_load_swings_on_cloth_without_gaining_energy(mass):
    world = kd.World()
    body = world.add_sphere(0.05, position=(0, 0, -0.5), mass=mass)
    strip = world.add_cloth_grid((1.0, 0.2), (11, 3), orientation=UPRIGHT)
    height = strip.position[:, 2].copy()
    strip.pin(np.flatnonzero(height > 0.5 - 1e-9))
    strip.pin(np.flatnonzero(height < -0.5 + 1e-9), body)
    energy, exchanged = [], []
    for _ in range(180):
        world.step(STEP)
        energy.append(world.energy().total)
        exchanged.append(world.energy().kinetic)
    assert np.mean(energy[-30:]) < np.mean(energy[:30]) + 0.02 * max(exchanged)


@pytest.mark.parametrize("speed", [10.0, 30.0])
def test_a_fast_ball_flies_into_a_sheet_that_stays_whole(speed):
    world = kd.World(gravity=(0, 0, 0))
    sheet = world.add_cloth_grid((1.0, 1.0), (21, 21))
    ball = world.add_sphere(0.15, position=(0, 0, -0.3), mass=10.0)
    ball.velocity[2] = speed
    momentum, energy = world.momentum(), world.energy().total
    world.advance(STEP, 60)
    assert world.momentum() == pytest.approx(momentum, abs=1e-9)
    assert world.energy().total <= energy * (1 + 1e-3)
    assert np.linalg.norm(sheet.position - ball.position, axis=1).min() > 0.14


def test_cloth_falls_through_what_meets_nothing():
    world = kd.World()
    world.add_sphere(0.3, position=(0, 0, 0), static=True, collides_with=())
    sheet = world.add_cloth_grid((0.5, 0.5), (7, 7), position=(0, 0, 0.4))
    world.advance(STEP, 30)
    assert sheet.position[:, 2] == pytest.approx(0.4 - 0.5 * 9.81 * 0.25, rel=1e-6)


def test_a_refused_pin_holds_nothing_and_old_handles_stay_old():
    world, other = kd.World(), kd.World()
    before = world.snapshot()
    gone = world.add_cloth_grid((1.0, 1.0), (4, 4))
    with pytest.raises(kd.KickdriftError, match="body"):
        gone.pin([0], other.add_sphere(0.1, position=(0, 0, 0)))
    assert (world.tables.array(kd.world.tables.PARTICLE)[:, 3] > 0.0).all()
    world.restore(before)
    new = world.add_cloth_grid((1.0, 1.0), (3, 3))
    assert new != gone
    with pytest.raises(kd.KickdriftError, match="was removed"):
        gone.position  # noqa: B018


def test_energy_is_that_of_the_fabric_before_the_first_step_too():
    world = kd.World(gravity=(0, 0, 0))
    sheet = world.add_cloth_grid((1.0, 1.0), (20, 20), bending_stiffness=0.0)
    sheet.position[:, 0] *= 1.1
    assert world.energy().potential == pytest.approx(0.5 * 200.0 * 0.1**2)


def test_cloth_slides_where_the_slope_is_steeper_than_its_friction():
    for angle, slides in ((0.95, False), (1.05, True)):
        slope = np.arctan(0.5 * angle)
        world = kd.World()
        world.add_plane(normal=(-np.sin(slope), 0, np.cos(slope)), friction=0.5)
        sheet = world.add_cloth_grid(
            (0.5, 0.5), (6, 6), orientation=(np.cos(slope / 2), 0, -np.sin(slope / 2), 0), friction=0.5,
            position=0.0026 * np.array((-np.sin(slope), 0, np.cos(slope))),
        )  # fmt: skip
        world.advance(STEP, 60)
        speed = np.linalg.norm(sheet.velocity.mean(axis=0))
        wanted = 9.81 * (np.sin(slope) - 0.5 * np.cos(slope)) if slides else 0.0
        assert speed == pytest.approx(wanted, abs=0.02)


def test_a_body_hangs_on_what_is_pinned_to_it():
    world = kd.World(substeps=8)
    body = world.add_box((0.2, 0.2, 0.05), position=(0, 0, -0.5), mass=0.5, damping=2.0)
    strip = world.add_cloth_grid(
        (1.0, 0.2), (21, 5), orientation=UPRIGHT, stretch_stiffness=200.0, damping=1e-2, linear_damping=4.0
    )
    height = strip.position[:, 2].copy()
    strip.pin(np.flatnonzero(height > 0.5 - 1e-9))
    strip.pin(np.flatnonzero(height < -0.5 + 1e-9), body)
    world.advance(STEP, 900)
    tension, own = 0.5 * 9.81 / 0.2, 0.2 * 9.81
    assert -0.5 - body.position[2] == pytest.approx(tension / 200.0 + own / (2 * 200.0), rel=0.02)


def test_what_is_pinned_to_a_body_that_is_removed_falls():
    world = kd.World()
    body = world.add_sphere(0.1, position=(0, 0, 5.0), static=True)
    sheet = world.add_cloth_grid((1.0, 1.0), (4, 4), position=(0, 0, 4.0))
    sheet.pin([0, 5], body)
    sheet.pin([3])
    world.remove(body)
    assert world.tables.count(kd.world.tables.PIN) == 0
    sheet.unpin([3])
    world.advance(STEP, 30)
    assert sheet.velocity[:, 2] == pytest.approx(-9.81 * 0.5, rel=1e-9)


def carried_sheet(mass, **options):
    """A body with a sheet, all of whose vertices are pinned to it."""
    world = kd.World()
    body = world.add_sphere(0.1, position=(0, 0, 5.0), mass=mass, collides_with=())
    sheet = world.add_cloth_grid((0.4, 0.5), (3, 4), position=(0, 0, 5.0), density=5.0, **options)
    sheet.pin(np.arange(12), body)
    return world, body, sheet


@pytest.mark.parametrize("lift", [0.0, 30.0])
def test_a_body_carries_the_weight_and_the_inertia_of_what_is_pinned_to_it(lift):
    world, body, sheet = carried_sheet(0.1)  # a tenth of the mass of the sheet
    for _ in range(30):
        world.apply_force(body, (0, 0, lift))
        world.step(STEP)
    assert body.velocity[2] == pytest.approx(0.5 * (lift / 1.1 - 9.81), abs=1e-9)
    assert np.abs(body.angular_velocity).max() < 1e-9
    assert sheet.position[:, 2] == pytest.approx(body.position[2], abs=1e-9)


def test_wind_drives_a_body_by_what_is_pinned_to_it():
    world, body, sheet = carried_sheet(2.0, drag=1.2)
    world.gravity, sheet.wind = (0, 0, 0), (0, 0, 8.0)
    world.advance(STEP, 60)
    assert body.velocity[2] == pytest.approx(8.0 - 1 / (1 / 8.0 + 0.5 * 1.2 * 1.2 * 0.2 / 3.0), rel=2e-3)


def test_a_turning_body_and_what_is_pinned_to_it_keep_momentum():
    world = kd.World(gravity=(0, 0, 0))
    body = world.add_box((0.2, 0.3, 0.1), position=(0, 0, 0), mass=0.5, collides_with=())
    body.velocity[:], body.angular_velocity[:] = (0.3, -0.1, 0.2), (1.0, -2.0, 3.0)
    sheet = world.add_cloth_grid((0.8, 0.6), (7, 6), damping=1e-3)
    sheet.pin([14, 15, 20, 21, 26], body)
    momentum, spin, energy = world.momentum(), world.angular_momentum(), world.energy().total
    world.advance(STEP, 200)
    assert world.momentum() == pytest.approx(momentum, abs=1e-12)
    assert world.angular_momentum() == pytest.approx(spin, abs=1e-4)
    assert 0.0 < world.energy().total < energy


@pytest.mark.parametrize("speed", [0.0, -2.0])
def test_a_sleeping_body_wakes_where_a_cloth_hits_it(speed):
    world = kd.World(gravity=(0, 0, 0), sleeping=True)
    ball = world.add_sphere(0.2, position=(0, 0, 0), mass=0.1)
    world.advance(STEP, 60)
    sheet = world.add_cloth_grid((0.5, 0.5), (9, 9), position=(0, 0, 0.3))
    sheet.velocity[:, 2] = speed
    momentum = world.momentum()
    world.advance(STEP, 60)
    assert world.momentum() == pytest.approx(momentum, abs=1e-12)
    assert (ball.velocity[2] < -0.1) == (speed < 0.0)


@pytest.mark.parametrize("side", [17, 19, 20, 21])
def test_a_ball_gains_no_energy_where_triangles_stretch_beyond_what_their_corners_cover(side):
    world = kd.World()
    sheet = world.add_cloth_grid(
        (1, 1),
        (side, side),
        density=0.3,
        stretch_stiffness=3000,
        shear_stiffness=900,
        bending_stiffness=1e-4,
        thickness=0.01,
    )
    sheet.pin(np.flatnonzero(np.abs(sheet.position[:, :2]).max(axis=1) > 0.5 - 1e-6))
    world.add_sphere(0.12, mass=4, position=(0, 0, 0.14), velocity=(0, 0, -2))
    energy = world.energy().total
    for _ in range(90):
        world.step(STEP)
        assert world.energy().total < energy + 0.16  # 1 % of that of the impact


def test_a_ball_dents_a_trampoline_and_comes_back():
    world = kd.World(substeps=8)
    n = 15
    sheet = world.add_cloth_grid((1.0, 1.0), (n, n), stretch_stiffness=300.0, shear_stiffness=100.0, density=0.3)
    index = np.arange(n * n).reshape(n, n)
    sheet.pin(np.concatenate((index[0], index[-1], index[:, 0], index[:, -1])))
    ball = world.add_sphere(0.12, position=(0.0, 0.0, 0.5), mass=1.0)
    lowest, highest = 1.0, -1.0
    for _ in range(60):
        world.step(STEP)
        lowest = min(lowest, ball.position[2])
    for _ in range(40):
        world.step(STEP)
        highest = max(highest, ball.position[2])
    assert lowest < 0.05
    assert 0.2 < highest < 0.5
    assert np.linalg.norm(sheet.position - ball.position, axis=1).min() > 0.12 - 0.005


def test_snapshots_copies_and_files_go_on_with_the_same_bits(tmp_path):
    world = kd.World()
    world.add_plane()
    ball = world.add_sphere(0.2, position=(0.1, 0, 0.3), density=100.0)
    sheet = world.add_cloth_grid((0.8, 0.8), (9, 9), position=(0, 0, 0.7), name="sheet", drag=1.0)
    sheet.pin([0], ball)
    world.advance(STEP, 20)
    snapshot, copied, path = world.snapshot(), copy.copy(world), world.save(tmp_path / "world.npz")
    world.advance(STEP, 30)
    ends = sheet.position.copy(), ball.position.copy()
    world.restore(snapshot)
    for other in (world, copied, kd.load_world(path)):
        other.advance(STEP, 30)
        assert np.array_equal(other.cloth("sheet").position, ends[0])
        assert np.array_equal(other.position[ball.index], ends[1])


def test_recordings_hold_cloths_and_files_of_them_too(tmp_path):
    world = kd.World()
    first = world.add_cloth_grid((1.0, 1.0), (4, 5))
    world.add_cloth_grid((1.0, 1.0), (3, 3), position=(0, 0, 1), name="second")
    recording = world.run(0.1, STEP, progress=False)
    assert recording.cloth(0).shape == (7, 20, 3)
    assert np.array_equal(recording.cloth(0)[-1], first.position)
    again = kd.load(recording.save(tmp_path / "cloths.npz"))
    assert np.array_equal(again.cloth("second"), recording.cloth("second"))
    assert np.array_equal(again.appearance.cloths[1].triangles, recording.appearance.cloths[1].triangles)
    with pytest.raises(kd.KickdriftError, match="second"):
        recording.cloth("third")


def test_what_is_too_stiff_for_the_step_is_softer_and_says_so():
    world = kd.World()
    sheet = world.add_cloth_grid((0.1, 0.1), (21, 21), stretch_stiffness=1e7, name="steel")
    sheet.velocity[:] = 0.1 * np.random.default_rng(0).normal(size=sheet.velocity.shape)
    with pytest.warns(kd.UnsolvedWarning, match=r"Of cloth 'steel'.*stretch_stiffness 665 of 1e\+07 N/m.*more") as said:
        recording = world.run(1.0, STEP, save_every=60, progress=False)
    assert len(said) == 1
    world.add_cloth_grid((0.1, 0.1), (21, 21), position=(1, 0, 0), stretch_stiffness=1e7, name="iron")
    with pytest.warns(kd.UnsolvedWarning, match="Of cloth 'iron'"):
        world.step(STEP)
    assert sheet.stiffness[0] < 1e6
    assert "'steel'" in recording.message
    with world.record() as own:
        world.step(STEP)
    assert "'steel'" in own.report()
    assert np.abs(sheet.velocity).max() < 20.0


def test_a_cloth_hardly_softer_than_its_fabric_causes_no_warning():
    world = kd.World()
    sheet = world.add_cloth_grid((1.0, 1.0), (21, 21), stretch_stiffness=1e5)
    world.step(STEP)
    assert 0.5e5 < sheet.stiffness[0] < 1e5


def test_a_cloth_that_is_lost_ends_the_step_and_leaves_the_world_as_it_was():
    world = kd.World()
    sheet = world.add_cloth_grid((1.0, 1.0), (4, 4))
    world.step(STEP)
    sheet.velocity[3] = np.nan
    before = sheet.position.copy()
    with pytest.raises(kd.KickdriftError, match="vertex 3 of cloth 0 was lost"):
        world.step(STEP)
    assert np.array_equal(sheet.position, before)
    sheet.velocity[3] = 0.0
    sheet.velocity[7] = 1e200
    with pytest.raises(kd.KickdriftError, match="vertex 7 of cloth 0 was lost"):
        world.step(STEP)
    sheet.velocity[7] = 0.0
    world.step(STEP)
    assert np.isfinite(sheet.position).all()


SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("vertices", "triangles", "words"),
    [
        (SQUARE, [[0, 1, 2], [0, 2, 4]], "triangle 1 has the vertices"),
        (SQUARE, [[0, 1, 2], [0, 2, -1]], "triangle 1 has the vertices"),
        (SQUARE, [[0, 1, 2], [0, 2, 2]], "triangle 1 has a vertex twice"),
        (SQUARE, [[0, 1, 2]], "vertex 3 is in no triangle"),
        (SQUARE, [[0, 1, 2], [2, 0, 3], [0, 2, 1]], "share one edge"),
        (SQUARE, [[0, 1, 2], [0, 3, 2]], "opposite orientations"),
        (SQUARE[:3], [[0, 1, 2], [0, 2, 1]], "triangles 0 and 1 have the same vertices"),
        (SQUARE[:3], [[0, 1, 2], [0, 1, 2]], "triangles 0 and 1 have the same vertices"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], "triangle 0 has no area"),
        ([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]], [[0, 1, 2]], "vertex 2 is at"),
        ([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], "vertices has the shape"),
        (SQUARE, [[0.0, 1.0, 2.0]], "whole numbers"),
        (SQUARE, np.zeros((0, 3), int), "whole numbers"),
        (SQUARE, [[0, 1], [0, 1, 2]], "whole numbers"),
        ("mesh", [[0, 1, 2]], "array of numbers"),
    ],
)
def test_meshes_that_no_cloth_is_made_of(vertices, triangles, words):
    world = kd.World()
    with pytest.raises(kd.KickdriftError, match=words):
        world.add_cloth(vertices, triangles)
    assert world.tables.count(kd.world.tables.PARTICLE) == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"density": 0.0}, "density"),
        ({"colour": 1.0}, "colour= is not an option"),
        ({"density": -1.0}, "density"),
        ({"thickness": 0.0}, "thickness"),
        ({"stretch_stiffness": np.inf}, "stretch_stiffness"),
        ({"shear_stiffness": -1.0}, "shear_stiffness"),
        ({"bending_stiffness": np.nan}, "bending_stiffness"),
        ({"damping": -1e-3}, "damping"),
        ({"friction": "rough"}, "friction"),
        ({"density": 1e308}, "density=1e.308 must be from"),
        ({"bending_stiffness": 1e308}, "bending_stiffness=1e.308 must be zero or from"),
        ({"size": (1e150, 1e150)}, "vertex 0 is at"),
        ({"size": (1.0, 0.0)}, "size"),
        ({"vertices": (1, 5)}, "vertices"),
        ({"vertices": (10.0, 5)}, "vertices"),
        ({"vertices": (10**5, 10**5)}, "vertices"),
        ({"vertices": (2**40, 2**40)}, "vertices"),
        ({"name": ""}, "name"),
    ],
)
def test_numbers_that_no_cloth_has(arguments, words):
    with pytest.raises(kd.KickdriftError, match=words):
        kd.World().add_cloth_grid(**arguments)


@pytest.mark.parametrize("vertices", [[16], [-1], [0.5], [[0, 1]], "corner", np.arange(16) < 4])
def test_vertices_that_cannot_be_pinned(vertices):
    sheet = kd.World().add_cloth_grid((1.0, 1.0), (4, 4))
    with pytest.raises(kd.KickdriftError, match=r"vert(ex|ices)"):
        sheet.pin(vertices)


def test_no_vertices_are_pinned_and_released():
    sheet = kd.World().add_cloth_grid((1.0, 1.0), (4, 4))
    sheet.pin([])
    sheet.unpin([])


@pytest.mark.parametrize("name", ["friction", "tear_strain"])
def test_properties_out_of_range_cannot_be_set(name):
    sheet = kd.World().add_cloth_grid((1.0, 1.0), (4, 4))
    before = getattr(sheet, name)
    with pytest.raises(kd.KickdriftError, match=f"{name}=1e.300 must be zero or from"):
        setattr(sheet, name, 1e300)
    assert getattr(sheet, name) == before


def test_a_wind_too_fast_to_count_with_is_refused():
    with pytest.raises(kd.KickdriftError, match=r"mean=.* is faster than 1e"):
        kd.gusts(mean=(1e100, 0.0, 0.0))
    sheet = kd.World().add_cloth_grid((1.0, 1.0), (4, 4))
    with pytest.raises(kd.KickdriftError, match="faster than 1e"):
        sheet.wind = (0.0, 1e200, 0.0)
    assert not sheet.wind.any()


def test_cloths_of_other_worlds_are_refused():
    one, other = kd.World(), kd.World()
    one.add_cloth_grid((1.0, 1.0), (4, 4))
    body = other.add_sphere(0.1, position=(0, 0, 0))
    with pytest.raises(kd.KickdriftError, match="body"):
        one.cloths.pin(one.add_cloth_grid((1.0, 1.0), (4, 4)), [0], body)


def roll(radius, n=9):
    """A quarter of a tube, as a mesh whose vertices lie at random."""
    rng = np.random.default_rng(4)
    points, triangles = grid(n, n, (1.0, 0.8))
    points[:, :2] += rng.uniform(-0.2 / n, 0.2 / n, (len(points), 2))
    angle = points[:, 0] / radius
    return np.stack((radius * np.sin(angle), points[:, 1], radius * np.cos(angle)), axis=1), triangles


def dent():
    """A cap of a ball, of a coarse mesh."""
    points, triangles = roll(1e6, 6)
    points[:, 2] = np.sqrt(1.0 - (points[:, 0] - 0.5) ** 2 - (points[:, 1] - 0.4) ** 2)
    return points, triangles


def box():
    """An open box: right angles at rest, and three of them at a corner."""
    corners = [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    sides = [(0, 2, 3, 1), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
    return np.array(corners, float), np.array([t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))])


@pytest.mark.parametrize("mesh", [roll(0.6), dent(), box()])
def test_cloth_that_is_curved_at_rest_stays_as_it_is_however_it_is_turned(mesh):
    world = kd.World(gravity=(0, 0, 0))
    cloth = world.add_cloth(*mesh, bending_stiffness=1e-2)
    turn, _ = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))
    cloth.position[:] = cloth.position @ (turn * np.linalg.det(turn)).T + 3.0
    before = cloth.position.copy()
    assert abs(world.energy().potential) < 1e-11
    world.advance(STEP, 60)
    assert cloth.position == pytest.approx(before, abs=1e-9)
    cloth.position[:] += 0.03 * np.random.default_rng(5).normal(size=before.shape)
    start, spin = world.energy().total, world.angular_momentum()
    energies = []
    for _ in range(120):
        world.step(STEP)
        energies.append(world.energy().total)
    assert energies == pytest.approx(np.full(120, start), rel=0.05)
    assert world.angular_momentum() == pytest.approx(spin, abs=1e-12)


def test_bending_a_flat_cloth_to_a_tube_takes_what_a_plate_does():
    stiffness, radius, area = 1e-2, 0.6, 0.8
    rolled, triangles = roll(radius, 33)
    flat = np.stack((radius * np.arctan2(rolled[:, 0], rolled[:, 2]), rolled[:, 1], np.zeros(len(rolled))), axis=1)
    world = kd.World(gravity=(0, 0, 0))
    cloth = world.add_cloth(flat, triangles, stretch_stiffness=1e-9, shear_stiffness=0.0, bending_stiffness=stiffness)
    cloth.position[:] = rolled
    assert world.energy().potential == pytest.approx(0.5 * stiffness * area / radius**2, rel=0.04)
    back = kd.World(gravity=(0, 0, 0))
    curved = back.add_cloth(rolled, triangles, stretch_stiffness=1e-9, shear_stiffness=0.0, bending_stiffness=stiffness)
    curved.position[:] = flat
    assert back.energy().potential == pytest.approx(0.5 * stiffness * area / radius**2, rel=0.04)


def test_a_bent_cloth_turns_on_while_its_bending_is_damped():
    """A rigid turn is not damped, and torque is none."""
    world, still = kd.World(gravity=(0, 0, 0)), np.zeros(3)
    rolled, triangles = roll(0.6)
    flat = np.stack((0.6 * np.arctan2(rolled[:, 0], rolled[:, 2]), rolled[:, 1], np.zeros(len(rolled))), axis=1)
    cloth = world.add_cloth(flat, triangles, bending_stiffness=1e-2, damping=1e-2)
    world.advance(1e-9, 1)  # compiles what is called by address
    world.cloths.tune(STEP / 4)
    cloth.position[:] = rolled
    turning = forces(world, bending, np.cross([1.0, -2.0, 0.5], rolled))
    assert turning == pytest.approx(forces(world, bending), abs=1e-11)
    cloth.velocity[:] = np.random.default_rng(0).normal(size=rolled.shape)
    damped = forces(world, bending, cloth.velocity)
    assert np.abs(damped - turning).max() > 1e-3
    assert np.cross(rolled, damped).sum(axis=0) == pytest.approx(still, abs=1e-12)
    assert damped.sum(axis=0) == pytest.approx(still, abs=1e-12)
    assert (cloth.velocity * (damped - turning)).sum() < 0.0


def test_a_cloth_that_is_folded_on_itself_unfolds():
    world = kd.World(gravity=(0, 0, 0))
    cloth = world.add_cloth_grid((1.0, 0.5), (21, 11), bending_stiffness=1e-3, damping=1e-3, linear_damping=0.5)
    folded = cloth.position[:, 0] > 1e-9
    cloth.position[folded, 0] *= -1.0
    cloth.position[folded, 2] += 1e-3
    start = world.energy().total
    world.advance(STEP, 600)
    assert world.energy().total < 0.05 * start
    assert np.linalg.norm(cloth.position[0] - cloth.position[-11]) > 0.95  # which were beside each other


def forces(world, room, speeds=None):
    """What membrane or bending do to the vertices of the only cloth of a world, damped if they have come with speeds."""
    lanes = world.tables.array(kd.world.tables.PARTICLE_LANES).reshape(LANE_FIELDS, -1)
    add, places, part = (
        membrane.add_membrane if room is membrane else bending.add_bending,
        world.tables.array(kd.world.tables.PARTICLE)[:, :3],
        1e-4,
    )
    now = places.copy()
    for damped in (0.0, 1.0 / part):
        lanes[FORCES : FORCES + 3] = lanes[FORCES_APART : FORCES_APART + 3] = 0.0
        places[:] = now - (part * speeds if damped == 0.0 and speeds is not None else 0.0)
        fill_lanes(world.tables.address, 0)
        add(world.tables.address, 0, 1.0, damped)
    return (lanes[FORCES : FORCES + 3] + lanes[FORCES_APART : FORCES_APART + 3]).T


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize("room", [membrane, bending])
def test_forces_are_the_slopes_of_the_energy(room, curved):
    """Compiled forces against central differences of the energy, which is written apart from them."""
    world = kd.World(gravity=(0, 0, 0))
    stretch, shear, fold = (50.0, 20.0, 0.0) if room is membrane else (1e-9, 0.0, 1e-2)
    mesh = roll(0.6, 4) if curved else grid(4, 4, (1.0, 0.7))
    sheet = world.add_cloth(*mesh, stretch_stiffness=stretch, shear_stiffness=shear, bending_stiffness=fold)
    world.advance(1e-9, 1)  # compiles what is called by address
    world.cloths.tune(STEP / 4)
    rng = np.random.default_rng(1)
    sheet.position[:] += 0.08 * rng.normal(size=sheet.position.shape)
    force = forces(world, room)
    for vertex in (0, 5, 6, 15):
        for axis in range(3):
            energies = []
            for way in (1e-6, -2e-6):
                sheet.position[vertex, axis] += way
                energies.append(world.energy().potential)
            sheet.position[vertex, axis] += 1e-6
            assert force[vertex, axis] == pytest.approx((energies[1] - energies[0]) / 2e-6, rel=1e-5, abs=1e-8)


def three_sheets(names=("flat", "bent", "held")):
    """Sheets of these names, the last of which has a body hang from it, and whose middle one is bent at rest."""
    world, size, cloths = kd.World(), (1.0, 1.0), {}
    lamp = world.add_sphere(radius=0.05, position=(5.0, 0.0, -0.2), mass=0.05)
    for name in names:
        if name == "bent":
            cloth = world.add_cloth(*roll(0.6), name=name)
        else:
            cloth = world.add_cloth_grid(size, (5, 5), position=(5.0 * (name == "held"), 0, 0), name=name, damping=1e-3)
        cloth.pin({"flat": [0, 4], "bent": [0, 8], "held": [0, 4, 20, 24]}[name])
        if name == "held":
            cloth.pin([12], lamp)
        cloths[name] = cloth
    return world, cloths


@pytest.mark.parametrize("name", ["flat", "bent", "held"])
def test_what_is_left_where_a_cloth_is_removed_goes_on_as_if_it_had_never_been_there(name):
    world, cloths = three_sheets()
    gone = cloths.pop(name)
    index = gone.index
    before = world.snapshot()
    world.remove_cloth(gone)
    assert [cloth.index for cloth in cloths.values()] == [0, 1]
    assert [world.cloth(kept) for kept in cloths] == list(cloths.values())
    with pytest.raises(kd.KickdriftError, match="was removed; use an existing cloth"):
        gone.pin([0])
    assert repr(gone) == f"Cloth(index={index}, generation={index}, name={name!r})"
    other, others = three_sheets(tuple(cloths))
    for one in (world, other):
        one.advance(STEP, 10)
    assert all(np.array_equal(cloth.position, others[kept].position) for kept, cloth in cloths.items())
    assert np.array_equal(world.position, other.position)
    world.restore(before)
    assert gone.index == index
    assert len(gone.position) == len(gone.mass)


def test_recordings_show_cloths_that_were_removed_until_then(tmp_path, small_pictures):
    world, cloths = three_sheets()
    flat, bent, held = cloths.values()
    with world.record() as recording:
        world.step(STEP)
        world.remove_cloth(bent)
        world.step(STEP)
        late = world.add_cloth_grid((1.0, 1.0), (3, 3), name="late")
        world.step(STEP)
    assert [np.isfinite(recording.cloth(k)).all(axis=(1, 2)).tolist() for k in range(4)] == [
        [True] * 4, [True, True, False, False], [True] * 4, [False, False, False, True],
    ]  # fmt: skip
    for name, cloth in (("flat", flat), ("held", held), ("late", late)):
        assert np.array_equal(recording.cloth(name)[-1], cloth.position)
        assert np.array_equal(recording.drawn_cloth(name).triangles, cloth.triangles)
    again = kd.load(recording.save(tmp_path / "cloths.npz"))
    assert np.array_equal(again.cloth("bent"), recording.cloth("bent"), equal_nan=True)
    assert recording.plot(tmp_path / "cloths.png")


def test_the_last_cloth_can_be_removed():
    world = kd.World(sleeping=True)
    sheet = world.add_cloth_grid((1.0, 1.0), (4, 4))
    world.step(STEP)
    world.remove_cloth(sheet)
    world.step(STEP)
    with pytest.raises(kd.KickdriftError, match="was removed"):
        world.remove_cloth(sheet)
    again = world.add_cloth_grid((1.0, 1.0), (3, 3))
    world.step(STEP)
    assert again != sheet
    assert again.velocity[:, 2].max() < 0.0
