"""Light bodies under heavy ones, with and without restitution: they are not pressed into what carries them."""

import warnings

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.world.contact_points import deepest_overlap

STEP = 1 / 60


def deepest(world, seconds, step=STEP):
    """Return the largest overlap of any contact at the ends of the steps, m."""
    depths = []
    for _ in range(round(seconds / step)):
        world.step(step)
        depths.append(deepest_overlap(world.tables))
    return max(depths)


@pytest.mark.parametrize("step", [1 / 60, 1 / 240])
@pytest.mark.parametrize("mass", [10.0, 100.0, 1000.0])
@pytest.mark.parametrize("e", [0.0, 0.2, 0.5, 1.0])
def test_a_light_plate_stays_on_the_floor_under_a_ball_that_bounces_on_it(e, mass, step):
    world = kd.World()
    world.add_plane(friction=0.5)
    plate = world.add_box((4, 4, 0.1), position=(0, 0, 0.05), mass=1.0, restitution=e, friction=0.5)
    world.add_sphere(0.5, position=(0, 0, 2), mass=mass, restitution=e, friction=0.5)
    lowest = 0.0
    for _ in range(round(2 / step)):
        world.step(step)
        lowest = min(lowest, plate.position[2] - 0.05)
    assert lowest > -0.005


@pytest.mark.parametrize("e", [0.0, 0.3, 0.8])
@pytest.mark.parametrize("floor", [0.0, 0.3, 0.8])
@pytest.mark.parametrize("ratio", [10.0, 100.0, 1000.0])
def test_a_heavy_ball_that_falls_on_a_light_one_does_not_pass_it(ratio, floor, e):
    """Where one of the contacts bounces and the other does not, sweeps let the heavy ball pass."""
    world = kd.World()
    world.add_plane(restitution=floor)
    world.add_sphere(0.3, position=(0, 0, 0.3), mass=1.0, restitution=e)
    world.add_sphere(0.3, position=(0, 0, 1.8), mass=ratio)
    assert deepest(world, 2.0) < 0.1


@pytest.mark.parametrize("seed", range(20))
def test_columns_of_random_masses_and_restitution_fall_without_passing_each_other(seed):
    rng, z, world = np.random.default_rng(seed), 0.3, kd.World()
    world.add_plane(friction=0.5, restitution=rng.choice([0.0, 0.3]))
    for _ in range(rng.integers(2, 6)):
        is_box, mass, e = rng.random() < 0.5, 10 ** rng.uniform(0, 3), rng.choice([0.0, 0.2, 0.5, 0.8])
        height, (x, y) = rng.uniform(0.1, 0.4) if is_box else 0.6, rng.uniform(-0.01, 0.01, 2)
        kind = {"mass": mass, "restitution": e, "friction": 0.5, "position": (x, y, z + height / 2)}
        if is_box:
            world.add_box((2, 2, height), **kind)
        else:
            world.add_sphere(height / 2, **kind)
        z += height + rng.uniform(0.05, 1.0)
    before = world.energy().total
    assert deepest(world, 3.0) < 0.15
    assert world.energy().total < before


@pytest.mark.parametrize("tilt", [0.01, 0.03, 0.05])
@pytest.mark.parametrize("overlap", [0.02, 0.04])
def test_a_light_ball_wedged_into_heavy_boxes_is_freed_and_presses_none_down(overlap, tilt):
    """Pushed apart at full speed, the boxes would shoot it away; without a push, all would sink for a second."""
    world = kd.World()
    world.add_plane(friction=0.5)
    base = world.add_box((2, 2, 0.36), position=(0, 0, 0.18), mass=20.0, friction=0.5)
    world.add_sphere(0.3, position=(0, 0, 0.66 - overlap), mass=1.0, friction=0.5)
    turned = (np.cos(tilt / 2), np.sin(tilt / 2), 0, 0)
    world.add_box((2, 2, 0.36), position=(0, 0, 1.14 - 2 * overlap), mass=900.0, friction=0.5, orientation=turned)
    lowest = 0.18
    for _ in range(60):
        world.step(STEP)
        lowest = min(lowest, base.position[2])
    assert lowest > 0.178
    assert deepest_overlap(world.tables) < 1e-3


def poured_balls(e):
    """200 balls in a shaft, about to fall on each other."""
    rng, world = np.random.default_rng(5), kd.World()
    world.add_plane(friction=0.3, restitution=e)
    for side in (-1, 1):
        world.add_box((0.1, 2, 4), position=(0.3 * side, 0, 2), static=True)
        world.add_box((2, 0.1, 4), position=(0, 0.3 * side, 2), static=True)
    for place in np.ndindex(5, 5, 8):
        at = 0.09 * (np.array(place) - (2, 2, -1)) + rng.uniform(-0.01, 0.01, 3)
        world.add_sphere(0.03, position=at, density=2500.0, friction=0.3, restitution=e)
    return world


def poured_boxes(e):
    """150 boxes in a plane, about to fall on each other."""
    rng, world = np.random.default_rng(0), kd.World(plane_normal=(0, 1, 0))
    world.add_plane(friction=0.3, restitution=e)
    for x, z in np.ndindex(10, 15):
        at, size = (0.27 * (x - 4.5), 0.0, 0.3 + 0.3 * z), rng.uniform(0.18, 0.26, 3)
        world.add_box(size, position=at, density=2500.0, friction=0.3, restitution=e)
    return world


@pytest.mark.parametrize("pour", [poured_balls, poured_boxes])
@pytest.mark.parametrize("e", [0.0, 0.3, 0.8])
def test_a_crowd_that_falls_on_each_other_leaves_no_impact_unresolved(e, pour):
    """Balls that pass each other approach along the normal of before, and turning boxes that have slid where they touched then.

    Neither is an approach where the impulse acts, which would be stopped in vain for ever.
    """
    world = pour(e)
    with warnings.catch_warnings():
        warnings.simplefilter("error", kd.UnsolvedWarning)
        world.advance(STEP, 90)
