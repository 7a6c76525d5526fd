"""Cloth that is cut and that tears: what is conserved, where it parts, and what is seen of it."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import kickdrift as kd
from kickdrift.scenes.worlds.cloths import tear

STEP = 1 / 60
UPRIGHT = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)  # warp hangs down


def pieces(cloth):
    """How many parts hang together by edges, and which vertices have triangles that do not."""
    triangles = cloth.triangles
    corners = np.arange(triangles.size).reshape(-1, 3)
    ends = np.sort(np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2), axis=2).reshape(-1, 2)
    _, edge = np.unique(ends, axis=0, return_inverse=True)
    face = np.repeat(np.arange(len(triangles)), 3)
    joined = coo_array((np.ones(len(face)), (face, len(triangles) + edge.ravel())), shape=(corners.size * 2,) * 2)
    return len(np.unique(connected_components(joined, directed=False)[1][: len(triangles)]))


def whole(world):
    return world.momentum(), world.angular_momentum(), sum(world.cloth(name).mass.sum() for name in ("sheet",))


@pytest.mark.parametrize("self_collision", [False, True])
def test_a_cut_parts_a_sheet_and_keeps_mass_momentum_and_energy(self_collision):
    world = kd.World(gravity=(0, 0, 0))
    sheet = world.add_cloth_grid((1.0, 1.0), (9, 9), name="sheet", self_collision=self_collision)
    other = world.add_cloth_grid((1.0, 1.0), (4, 4), position=(0, 0, 3), bending_stiffness=1e-3, name="other")
    rng = np.random.default_rng(1)
    sheet.velocity[:] = rng.normal(size=(81, 3))
    world.advance(STEP, 5)
    momentum, spin, mass = whole(world)
    energy, lies = world.energy(), other.position.copy()
    assert sheet.cut(point=(0.02, 0, 0), normal=(2.0, 0, 0)) >= 9
    assert pieces(sheet) == 2
    after = world.energy()
    assert whole(world)[2] == pytest.approx(mass, rel=1e-15)
    assert np.allclose(world.momentum(), momentum, rtol=1e-14, atol=1e-15)
    assert np.allclose(world.angular_momentum(), spin, rtol=1e-14, atol=1e-15)
    assert after.kinetic == pytest.approx(energy.kinetic, rel=1e-14)
    assert after.potential <= energy.potential
    assert np.array_equal(other.position, lies)
    world.advance(STEP, 30)
    assert np.allclose(world.momentum(), momentum, atol=1e-12)
    assert np.allclose(other.position, lies, atol=1e-12)
    assert np.isfinite(sheet.position).all()


def test_the_lower_half_of_what_is_cut_falls_freely_and_the_upper_one_hangs():
    world = kd.World()
    sheet = world.add_cloth_grid((1.0, 0.5), (11, 6), orientation=UPRIGHT, name="sheet")
    sheet.pin(np.flatnonzero(sheet.position[:, 2] > 0.499))
    world.advance(STEP, 30)
    middle = sheet.position[:, 2].mean()
    below = sheet.triangles[sheet.position[sheet.triangles, 2].mean(axis=1) < middle]
    sheet.cut(point=(0, 0, middle), normal=(0, 0, 1))
    below = np.unique(sheet.triangles[sheet.position[sheet.triangles, 2].mean(axis=1) < middle])
    before, mass = sheet.position[below], sheet.mass[below]
    speed = mass @ sheet.velocity[below] / mass.sum()
    world.advance(STEP, 30)
    fallen = mass @ (sheet.position[below] - before) / mass.sum()
    assert fallen[2] == pytest.approx(0.5 * speed[2] - 0.5 * 9.81 * 0.25, rel=1e-6)
    assert sheet.position[:, 2].max() == pytest.approx(0.5, abs=1e-9)


def test_a_plane_beside_a_sheet_cuts_nothing():
    world = kd.World()
    sheet = world.add_cloth_grid((1.0, 1.0), (4, 4))
    before = sheet.triangles
    assert sheet.cut(point=(2, 0, 0), normal=(1, 0, 0)) == 0
    assert np.array_equal(sheet.triangles, before)
    for point, normal in (((0, 0), (1, 0, 0)), ((0, 0, np.nan), (1, 0, 0)), ((0, 0, 0), (0, 0, 0))):
        with pytest.raises(kd.KickdriftError, match=r"must be 3|no direction"):
            sheet.cut(point, normal)


def test_cloths_after_one_that_is_cut_go_on_as_they_would_have():
    found = []
    for cuts in (False, True):
        world = kd.World()
        first = world.add_cloth_grid((1.0, 1.0), (5, 5))
        second = world.add_cloth_grid((1.0, 1.0), (5, 5), position=(5, 0, 0), bending_stiffness=1e-3)
        lamp = world.add_sphere(0.05, position=(5, 0, -0.1), mass=0.05)
        second.pin([0, 4, 20, 24])
        second.pin([12], lamp)
        if cuts:
            first.cut((0, 0.01, 0), (0, 1, 0))
        world.advance(STEP, 10)
        found.append((second.position.copy(), lamp.position.copy(), len(first.mass)))
    assert np.allclose(found[0][0], found[1][0], atol=1e-9)
    assert np.allclose(found[0][1], found[1][1], atol=1e-9)
    assert found[1][2] > found[0][2]


@pytest.mark.parametrize("limit", [0.05, 0.2])
def test_a_strip_tears_where_it_is_pulled_beyond_its_strain_and_not_before(limit):
    world = kd.World(gravity=(0, 0, 0), substeps=8)
    strip = world.add_cloth_grid(
        (1.0, 0.2), (21, 5), stretch_stiffness=200.0, damping=5e-3, tear_strain=limit, name="sheet"
    )
    right = np.flatnonzero(strip.position[:, 0] > 0.499)
    strip.pin(np.flatnonzero(strip.position[:, 0] < -0.499))
    strip.pin(right)
    count, mass, speed = len(strip.mass), strip.mass.sum(), 0.05
    strip.velocity[:] = speed * (strip.position[:, :1] + 0.5) * (1, 0, 0)
    torn = None
    for k in range(400):
        world.step(STEP)
        if len(strip.mass) > count:
            torn = speed * STEP * (k + 1)
            break
    assert torn == pytest.approx(limit, rel=0.1)
    strip.velocity[right] = 0.0
    world.advance(STEP, 120)
    assert pieces(strip) >= 2
    assert strip.mass.sum() == pytest.approx(mass, rel=1e-14)
    assert np.isfinite(strip.position).all()


def test_recordings_of_what_tears_show_new_vertices_where_they_came_from(tmp_path):
    world = kd.World()
    sheet = world.add_cloth_grid((1.0, 1.0), (7, 7), name="sheet")
    other = world.add_cloth_grid((1.0, 1.0), (3, 3), position=(3, 0, 0), name="other")
    with world.record() as recording:
        world.step(STEP)
        sheet.cut((0.01, 0, 0), (1, 0, 0))
        world.step(STEP)
        half = sheet.position[:, 0] > 0
        sheet.velocity[half, 0] += 3.0
        sheet.cut((0, 0.01, 0), (0, 1, 0))
        world.step(STEP)
    seen = recording.cloth("sheet")
    assert np.isfinite(recording.particles).all()
    assert seen.shape[1] == len(sheet.mass) > 49
    assert np.array_equal(seen[-1], sheet.position)
    assert np.array_equal(recording.cloth("other")[-1], other.position)
    assert np.array_equal(recording.drawn_cloth("sheet").triangles, sheet.triangles)
    sides = seen[0][sheet.triangles] - np.roll(seen[0][sheet.triangles], 1, axis=1)
    assert np.linalg.norm(sides, axis=2).max() < 0.25  # no triangle reaches across
    again = kd.load(recording.save(tmp_path / "cut.npz"))
    assert np.array_equal(again.cloth("sheet"), seen)


def test_worlds_with_what_is_cut_go_on_with_the_same_bits(tmp_path):
    world = kd.World()
    lamp = world.add_sphere(0.05, position=(0, 0, -0.2), mass=0.05)
    sheet = world.add_cloth_grid((1.0, 1.0), (5, 5), tear_strain=0.3, name="sheet")
    sheet.pin([0, 4, 20, 24])
    sheet.pin([12], lamp)
    sheet.cut((0.0, 0.0, 0.0), (1.0, 0.01, 0.0))
    world.advance(STEP, 5)
    before = world.snapshot()
    world.save(tmp_path / "cut.npz")
    world.advance(STEP, 20)
    seen = [sheet.position.copy()]
    world.restore(before)
    for one in (world, kd.load_world(tmp_path / "cut.npz")):
        one.advance(STEP, 20)
        seen.append(one.cloth("sheet").position.copy())
    assert np.array_equal(seen[0], seen[1])
    assert np.array_equal(seen[0], seen[2])
    assert lamp.position[2] > -0.2 - 0.5 * 9.81 * (25 * STEP) ** 2 / 2  # it hangs on both halves


def test_what_is_written_to_disk_cannot_tear(tmp_path):
    world = kd.World()
    sheet = world.add_cloth_grid((1.0, 1.0), (4, 4), tear_strain=0.3)
    with pytest.raises(kd.KickdriftError, match="set its tear_strain to 0"):
        world.run(1.0, STEP, save_to=tmp_path / "rows.zarr")
    sheet.tear_strain = 0.0
    assert sheet.tear_strain == 0.0
    with pytest.raises(kd.KickdriftError, match="tear_strain"):
        sheet.tear_strain = -1.0


def test_a_run_in_which_a_sheet_tears_resumes_with_the_same_bits(tmp_path):
    whole = tear(vertices=(9, 8)).run(0.4, 1 / 120)
    before = tear(vertices=(9, 8)).run(0.25, 1 / 120, checkpoint=tmp_path / "run")
    after = tear(vertices=(9, 8)).run(0.4, 1 / 120, checkpoint=tmp_path / "run")
    assert before.particles.shape[1] > 72
    assert np.array_equal(after.particles, whole.particles)
