"""The scenes of worlds: that they are what they say, and do what such things do."""

import math

import numpy as np
import pytest


from kickdrift.scenes import worlds
from kickdrift.scenes.worlds.placing import about, between, scatter, turned

STEP = 1 / 60


def run(world, duration, step=STEP):
    for _ in range(round(duration / step)):
        world.step(step)


def heights(world):
    """Of all bodies but the ground and the floor."""
    return world.position[2:, 2]


@pytest.mark.parametrize(("base", "count"), [(1, 1), (10, 55), (20, 210), (100, 5050)])
def test_a_pyramid_has_as_many_cubes_as_its_rows(base, count):
    world = worlds.pyramid(base=base)
    assert len(heights(world)) == count
    assert heights(world).max() == pytest.approx(base - 0.5)
    rows = np.round(heights(world) - 0.5).astype(int)
    assert np.bincount(rows).tolist() == list(range(base, 0, -1))


def test_a_pyramid_stands():
    world = worlds.pyramid(base=6)
    before = world.position.copy()
    run(world, 1.0)
    assert np.linalg.norm(world.position - before, axis=1).max() < 0.01


def test_a_pyramid_without_friction_spreads():
    world = worlds.pyramid(base=6, friction=0.0)
    world.velocity[2] = (-0.2, 0.0, 0.0)  # its left lower cube
    before = world.position.copy()
    run(world, 1.0)
    assert np.linalg.norm(world.position - before, axis=1).max() > 0.1


def test_a_pile_falls_into_a_heap_on_the_floor():
    world = worlds.pile(count=(3, 3, 3))
    assert len(heights(world)) == 27
    run(world, 2.0)
    assert heights(world).min() > 0.48
    assert heights(world).max() < 3 * 1.0
    assert np.isfinite(world.velocity).all()


def test_dominoes_fall_one_after_the_other():
    world = worlds.dominoes(count=5)
    fallen_at = {}
    for step in range(120):
        world.step(STEP)
        for domino in np.flatnonzero(heights(world) < 0.15):
            fallen_at.setdefault(int(domino), step)
    assert sorted(fallen_at) == list(range(5))
    half = [np.argmax(np.array([fallen_at[domino] for domino in range(5)]) >= step) for step in sorted(fallen_at.values())]
    assert half == sorted(half)


def test_dominoes_that_stand_upright_keep_standing():
    world = worlds.dominoes(count=3, tilt=0.0)
    run(world, 1.0)
    assert np.abs(heights(world) - 0.18).max() < 0.001


def test_the_first_domino_leans_on_its_edge():
    world = worlds.dominoes(count=1, size=(0.1, 0.2, 0.4), tilt=0.3)
    w, x, y, z = world.orientation[2]
    corner = np.array(turned((w, x, y, z), (0.05, 0.0, -0.2)))
    assert world.position[2] + corner == pytest.approx([0.05, 0.0, 0.0], abs=1e-12)


def test_peaks_of_the_bouncing_disk_fall_by_the_square_of_the_restitution():
    world = worlds.bouncing_disk()
    height = []
    for _ in range(500):
        world.step(0.01)
        height.append(world.position[2, 2] - 0.1)
    z = np.array(height)
    peaks = z[1:-1][(z[1:-1] > z[:-2]) & (z[1:-1] >= z[2:])]
    assert peaks[0] == pytest.approx(25 / (2 * 9.81), rel=1e-3)
    assert peaks[1:4] / peaks[:3] == pytest.approx(0.81, rel=0.01)


def test_a_capsule_lies_between_two_points():
    start, end = (0.3, -0.2, 1.0), (-0.5, 0.4, 0.2)
    placed = between(start, end)
    half = np.array(turned(placed.orientation, (0.0, 0.0, placed.length / 2)))
    assert np.array(placed.position) - half == pytest.approx(start)
    assert np.array(placed.position) + half == pytest.approx(end)
    down = between((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    assert turned(down.orientation, (0.0, 0.0, 1.0)) == pytest.approx((0.0, 0.0, -1.0))


def test_a_turn_about_an_axis_is_counter_clockwise():
    assert turned(about((0.0, 0.0, 1.0), math.pi / 2), (1.0, 0.0, 0.0)) == pytest.approx((0.0, 1.0, 0.0))


def test_scattered_numbers_fill_their_interval_evenly():
    numbers = np.sort([scatter(number) for number in range(1000)])
    assert numbers[0] >= -0.5
    assert numbers[-1] < 0.5
    assert np.diff(numbers).max() < 2.7 / 1000  # the longest of three gaps
