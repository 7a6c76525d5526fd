"""Winds that vary around cloths: gusts and functions of users, and how hard air can push."""

import math

import numba
import numpy as np
import pytest
from scipy.special import gamma, kv

import kickdrift as kd
from kickdrift.scenes.worlds.cloths import flag
from kickdrift.world.deformables.gusts import _waves

STEP = 1 / 60
UPRIGHT = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)


def sheet(world, **options):
    """A square metre across the x axis."""
    return world.add_cloth_grid((1.0, 1.0), (6, 6), orientation=UPRIGHT, **options)


def test_a_wind_of_position_and_time_drives_as_a_uniform_one_of_its_speed_does():
    speed = np.array([3.0, 0.0, 0.0])

    def rising(t, position, wind):
        for i in range(len(wind)):
            for k in range(3):
                wind[i, k] += speed[k] * t + 0.0 * position[i, k]

    world, other = (kd.World(gravity=(0, 0, 0)) for _ in range(2))
    one, two = sheet(world, drag=1.2), sheet(other, drag=1.2)
    world.add_wind(rising)
    for k in range(40):
        world.step(STEP)
        for part in range(4):  # a step of one substep at a time
            other.substeps = 1
            two.wind = speed * (STEP * k + STEP * part / 4)
            other.step(STEP / 4)
    assert one.velocity[:, 0].min() > 0.5
    assert np.allclose(one.velocity, two.velocity, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("drag", "lift"), [(1e3, 0.0), (1e3, 1e3), (0.0, 1e3), (1.0, 0.3)])
def test_air_takes_energy_of_the_motion_through_it_in_steps_however_long(drag, lift):
    world = kd.World(gravity=(0, 0, 0), substeps=1)
    cloth = sheet(
        world, drag=drag, lift=lift, density=0.01, stretch_stiffness=1e-6, shear_stiffness=0.0, bending_stiffness=0.0
    )
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    cloth.position[:, :2] = cloth.position[:, :2] @ turn.T
    cloth.wind = wind = np.array([40.0, 0.0, 0.0])
    before = 0.5 * cloth.mass.sum() * 40.0**2
    for _ in range(30):
        world.step(STEP)
        relative = 0.5 * cloth.mass @ ((cloth.velocity - wind) ** 2).sum(axis=1)
        assert relative <= before * (1.0 + 1e-12) + 1e-28  # J: rounding errors of velocities
        assert 0.0 <= cloth.mass @ cloth.velocity[:, 0] <= 80.0 * cloth.mass.sum()
        before = relative
    if drag == 1e3 and lift == 0.0:
        assert np.allclose(cloth.velocity, wind, atol=0.1)


def test_gusts_have_the_correlations_of_von_karman():
    length, seeds = 5.0, 200
    for distance in (1.0, 5.0, 10.0):
        along, across = [], []
        for seed in range(seeds):
            waves = _waves(np.array([8.0, 0.0, 0.0]), 1.0, length, seed).T
            assert np.allclose((waves[:, 5:] ** 2).sum(axis=0) / 2, 1.0)
            assert np.abs((waves[:, :3] * waves[:, 5:]).sum(axis=1)).max() < 1e-14  # nothing is compressed
            for axis in range(3):
                moved = 0.5 * waves[:, 5:] ** 2 * np.cos(math.tau * distance * waves[:, axis, None])
                along.append(moved[:, axis].sum())
                across += [moved[:, axis - 1].sum(), moved[:, axis - 2].sum()]
        scaled = distance / (1.339 * length)
        scale = 2.0 ** (2 / 3) / gamma(1 / 3) * scaled ** (1 / 3)
        assert np.mean(along) == pytest.approx(scale * kv(1 / 3, scaled), abs=0.04)
        lateral = scale * (kv(1 / 3, scaled) - 0.5 * scaled * kv(2 / 3, scaled))
        assert np.mean(across) == pytest.approx(lateral, abs=0.04)


def test_gusts_have_their_strength_and_are_the_same_for_the_same_seed():
    place, out = np.random.default_rng(0).uniform(-5.0, 5.0, (40, 3)), {}
    for seed, again in ((0, False), (0, True), (1, False)):
        blow, found = numba.njit(kd.gusts((8.0, 0.0, 2.0), intensity=0.25, seed=seed)), []
        for t in np.arange(0.0, 600.0, 2.0):
            found.append(np.zeros((40, 3)))
            blow(t, place, found[-1])
        out[seed, again] = np.array(found)
    speed = math.hypot(8.0, 2.0)
    assert np.array_equal(out[0, False], out[0, True])
    assert not np.allclose(out[0, False], out[1, False])
    for winds in out.values():
        assert np.allclose(winds.mean(axis=(0, 1)), (8.0, 0.0, 2.0), atol=0.1 * speed)
        assert np.allclose(winds.std(axis=(0, 1)), 0.25 * speed, rtol=0.25)


def test_a_flag_in_gusts_stays_within_the_energy_of_the_wind():
    world = flag(vertices=(12, 8), wind=0.0)
    cloth = world.cloth("flag")
    world.add_wind(kd.gusts((10.0, 2.0, 0.0), intensity=0.4, length=3.0, seed=2))
    fastest = []
    for _ in range(15):
        world.advance(STEP, 40)
        fastest.append(np.linalg.norm(cloth.velocity, axis=1).max())
        assert world.energy().kinetic < 0.5 * cloth.mass.sum() * 30.0**2
    assert 1.0 < np.max(fastest) < 60.0


def test_worlds_with_winds_are_copied_and_saved(tmp_path):
    wind = kd.gusts((8.0, 0.0, 0.0), seed=3)
    world = flag(vertices=(8, 6), wind=2.0)
    world.add_wind(wind)
    world.advance(STEP, 5)
    world.save(tmp_path / "world.npz")
    again = kd.load_world(tmp_path / "world.npz", forces=[wind])
    before, seen = world.snapshot(), []
    world.advance(STEP, 5)
    seen.append(world.cloth("flag").position.copy())
    world.restore(before)
    for one in (world, again):
        one.advance(STEP, 5)
        seen.append(one.cloth("flag").position.copy())
    assert np.array_equal(seen[0], seen[1])
    assert np.array_equal(seen[0], seen[2])


def test_winds_and_forces_find_their_own_numbers():
    world = kd.World(gravity=(0, 0, 0))
    ball = world.add_sphere(0.1, position=(5, 0, 0), mass=1.0)
    cloth = sheet(world, drag=1e3)
    breeze, push = np.array([2.0, 3.0]), 7.0

    def blow(wind):
        for i in range(len(wind)):
            wind[i, 0] += breeze[0]

    def pushes(mass, force):
        for i in range(len(force)):
            force[i, 2] += push * (mass[i] > 0.0)

    world.add_wind(blow)
    world.add_force(pushes)
    world.advance(STEP, 60)
    assert ball.velocity[2] == pytest.approx(7.0)
    assert np.allclose(cloth.velocity, (2.0, 0.0, 0.0), atol=0.05)


@pytest.mark.parametrize(
    ("wind", "words"),
    [
        (lambda t, position: None, "no output"),
        (lambda force, wind: None, "name them t, position, velocity, wind"),
        (7.0, "is not a function"),
    ],
)
def test_functions_that_are_no_winds(wind, words):
    with pytest.raises(kd.KickdriftError, match=words):
        kd.World().add_wind(wind)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"mean": (1, 2)}, "mean"),
        ({"mean": (1, 2, math.nan)}, "mean"),
        ({"mean": (1, 0, 0), "intensity": -0.1}, "intensity"),
        ({"mean": (1, 0, 0), "length": 0.0}, "length"),
        ({"mean": (1, 0, 0), "seed": -1}, "seed"),
        ({"mean": (1, 0, 0), "seed": 0.5}, "seed"),
    ],
)
def test_gusts_that_cannot_be(arguments, words):
    with pytest.raises(kd.KickdriftError, match=words):
        kd.gusts(**arguments)
