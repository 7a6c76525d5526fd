"""Random scenes: whatever is thrown together stays finite, above the ground, and gains no energy."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from random_worlds import a_shape, random_world, watched

from kickdrift.world.shapes.cone import Cone
from kickdrift.world.shapes.cylinder import Cylinder
from kickdrift.world.world import World

STEP = 1 / 60


def scatter(world, rng, count, scale, decades, speed):
    """Place bodies side by side, so that none overlap, their sizes over some decades."""
    for k in range(count):
        reach = scale * 10 ** rng.uniform(-decades, 0)
        place = scale * (2.2 * np.array([k % 3, k // 3 % 3, k // 9 + 0.6]) + 0.05 * rng.normal(size=3))
        shape = (Cylinder(0.5 * reach, 1.7 * reach), Cone(0.8 * reach, 1.2 * reach))[k // 3 % 2]
        world.add_body(
            shape if k % 3 == 1 else a_shape(rng, reach),
            position=place,
            orientation=rng.normal(size=4),
            velocity=speed * rng.normal(size=3),
            angular_velocity=speed / reach * rng.normal(size=3),
            density=10 ** rng.uniform(2, 4),
            friction=rng.uniform(0, 1.2),
            restitution=rng.choice([0.0, 0.0, 0.5, 1.0]),
            rolling_resistance=rng.choice([0.0, 0.01 * reach]),
        )


@pytest.mark.parametrize("seed", range(8))
def test_random_scenes_come_down_and_stay_above_the_ground(seed):
    rng = np.random.default_rng(seed)
    world, scale = World(), 10 ** rng.uniform(-1, 1)
    ground = {"friction": 0.8, "restitution": rng.choice([0.0, 0.6])}
    if seed % 2:
        world.add_plane(**ground)
    else:
        edge = 1000 * scale
        world.add_box((edge, edge, scale), position=(0, 0, -scale / 2), static=True, **ground)
    scatter(world, rng, 18, scale, 1.0, rng.choice([0.0, 3.0]))
    energy = world.energy().total
    for _ in range(30):
        world.advance(STEP, 10)
        assert np.isfinite(world.velocity).all()
        assert world.energy().total <= 1.001 * energy
    assert (world.position[2:, 2] > 0).all()


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_bodies_that_nothing_else_touches_keep_their_momentum_and_gain_no_energy(seed):
    rng = np.random.default_rng(seed)
    world, scale = World(gravity=(0, 0, 0)), 10 ** rng.uniform(-2, 2)
    scatter(world, rng, 9, scale, 0.5, scale * 10 ** rng.uniform(-2, 1))
    world.velocity[1:] -= 0.5 * (world.position[1:] - world.position[1:].mean(axis=0))  # towards each other
    p, spin, energy = world.momentum(), world.angular_momentum(), world.energy().total
    size = np.sqrt(2 * energy * 1e4 * scale**3 * 9)
    slow = 4 * np.linalg.norm(world.velocity, axis=1).max() * STEP < 0.3 * 10**-0.5 * scale
    for _ in range(12):
        world.advance(STEP, 10)
        assert np.abs(world.momentum() - p).max() < 1e-12 * size
        # Arms stay as they are where bodies slide past each other by more than 0.3 of the smaller one in a step.
        unnoticed = 1e-11 if slow else 1e-2
        assert np.abs(world.angular_momentum() - spin).max() < unnoticed * size * scale
        assert world.energy().total <= 1.0001 * energy


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1))
@example(400)  # its bodies are fast at first, and steps are done in parts
def test_sizes_over_three_decades_in_one_scene_stay_finite(seed):
    rng = np.random.default_rng(seed)
    world = World()
    world.add_plane(friction=0.5)
    scatter(world, rng, 18, 1.0, 3.0, 1.0)
    world.advance(STEP, 200)
    assert np.isfinite(world.position).all()
    assert np.abs(world.velocity).max() < 100


@pytest.mark.filterwarnings(
    "ignore::kickdrift.UnsolvedWarning"
)  # some turn by several radians in a substep, and it is said
@pytest.mark.parametrize("seed", range(16))
def test_random_articulations_stay_finite_slow_and_together(seed):
    world, scale = random_world(seed)
    speed, gap = watched(world, scale, STEP, 400)
    assert np.isfinite(world.position).all()
    assert speed < 10
    assert gap < 0.02
