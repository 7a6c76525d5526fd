"""Random scenes: whatever is thrown together stays finite, above the ground, and gains no energy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kickdrift as kd
from kickdrift.world.adding import Part
from kickdrift.world.flaws import widest_gap
from kickdrift.world.flight import MASS
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.sphere import Sphere
from kickdrift.world.tables import INERTIA
from kickdrift.world.world import World

STEP = 1 / 60


def a_shape(rng, reach):
    """A shape, or parts of a body, no point of which is farther than `reach` from the origin."""
    match rng.integers(5):
        case 0:
            return Sphere(reach)
        case 1:
            return Capsule(reach / 3, 4 / 3 * reach)
        case 2:
            size = rng.uniform(0.1, 1.0, 3)
            return Box(2 * reach * size / np.linalg.norm(size))
        case 3:
            points = rng.normal(size=(int(rng.integers(6, 16)), 3))
            return Hull(points * reach / np.linalg.norm(points, axis=1).max())
        case _:
            bar = Part(Box((reach, reach / 4, reach / 4)))
            return [bar, Part(Sphere(reach / 3), position=(reach / 2, 0, 0), density=5000.0)]


def scatter(world, rng, count, scale, decades, speed):
    """Place bodies side by side, so that none overlap, their sizes over some decades."""
    for k in range(count):
        reach = scale * 10 ** rng.uniform(-decades, 0)
        place = scale * (2.2 * np.array([k % 3, k // 3 % 3, k // 9 + 0.6]) + 0.05 * rng.normal(size=3))
        world.add_body(
            a_shape(rng, reach),
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
def test_sizes_over_three_decades_in_one_scene_stay_finite(seed):
    rng = np.random.default_rng(seed)
    world = World()
    world.add_plane(friction=0.5)
    scatter(world, rng, 18, 1.0, 3.0, 1.0)
    world.advance(STEP, 200)
    assert np.isfinite(world.position).all()
    assert np.abs(world.velocity).max() < 100


def join(world, rng, a, b, reach):
    """Join two bodies halfway between them, in one of nine ways, with limits, motors and drives that suit their mass."""
    at_a, at_b = world.position[a.index].copy(), world.position[b.index].copy()
    axis, weight = rng.normal(size=3), 9.81 * world.tables.array(INERTIA)[b.index, MASS]
    middle, across = 0.5 * (at_a + at_b), np.cross(axis, rng.normal(size=3))

    def law(unit, span):
        choices = (
            {"limits": (-span * rng.uniform(0, 1), span * rng.uniform(0, 1))},
            {"motor": kd.Motor(span * rng.normal(), unit * rng.uniform(0, 3))},
            {"drive": kd.Drive(unit / span * 10 ** rng.uniform(-1, 2), unit / span * rng.uniform(0.1, 1))},
            {"friction": unit * rng.uniform(0, 0.3)},
        )
        return choices[rng.integers(4)]

    turns, slides = law(weight * reach, 1.0), law(weight, reach)
    ends = {"anchor_a": at_a, "anchor_b": at_b}
    match rng.integers(9):
        case 0:
            limits = {"swing_limit": rng.uniform(0.3, 2), "twist_limits": (-1.0, rng.uniform(0, 2))}
            world.add_ball_joint(a, b, anchor=middle, axis=axis, **limits)
        case 1:
            world.add_hinge(a, b, anchor=middle, axis=axis, **turns)
        case 2:
            world.add_slider(a, b, anchor=middle, axis=axis, **slides)
        case 3:
            world.add_fixed_joint(a, b, anchor=middle)
        case 4:
            world.add_universal_joint(a, b, anchor=middle, axis_a=axis, axis_b=across, about_a=kd.Axis(**turns))
        case 5:
            open_axis, held = kd.Axis(**slides), kd.Axis(locked=True)
            angular = (kd.Axis(**turns), held, held)
            linear = (open_axis, held, held)
            world.add_six_dof_joint(a, b, anchor=middle, axis_x=axis, axis_y=across, linear=linear, angular=angular)
        case 6:
            world.add_distance_joint(a, b, **ends)
        case 7:
            world.add_rope(a, b, **ends, length=1.2 * np.linalg.norm(at_b - at_a))
        case _:
            world.add_spring(a, b, **ends, hertz=10 ** rng.uniform(-0.5, 1), damping_ratio=rng.uniform(0, 1))


@pytest.mark.parametrize("seed", range(12))
def test_random_articulations_stay_finite_and_together(seed):
    rng = np.random.default_rng(seed)
    scale = 10 ** rng.uniform(-1.0, 1.0)
    world = World()
    if seed % 3 == 0:
        world.add_plane(friction=0.6)
    elif seed % 3 == 1:
        place = (-15 * scale, -15 * scale, 0)
        world.add_height_field(0.3 * scale * rng.uniform(-1, 1, (11, 11)), 3 * scale, position=place)
    for tree in range(3):
        reach, links = scale * 10 ** rng.uniform(-1, 0), []
        for k in range(6):
            place = (0.9 * reach * k, 4 * scale * (tree - 1), scale * (1.5 + 0.1 * rng.normal()))
            density = 300 * 10 ** rng.uniform(0, 1)
            links.append(world.add_body(a_shape(rng, 0.45 * reach), position=place, density=density))
            if k > 0:
                join(world, rng, links[max(0, k - int(rng.integers(1, 3)))], links[k], reach)
    for _ in range(10):
        world.advance(STEP, 100)
        assert np.isfinite(world.position).all()
        assert np.abs(world.velocity).max() < (30 if seed % 3 < 2 else 200) * np.sqrt(9.81 * scale)
        assert widest_gap(world.tables) < 0.02 * scale
