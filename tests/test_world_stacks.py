"""Stacks: towers, mass ratios, loaded plates and what slides under loads."""

import numpy as np
import pytest

from kickdrift import World

STEP, G = 1 / 60, 9.81


def stack(sizes, masses, offsets=None, friction=0.6):
    world, height = World(), 0.0
    world.add_plane(friction=friction)
    for k, (size, mass) in enumerate(zip(sizes, masses, strict=True)):
        x = 0.0 if offsets is None else offsets[k]
        world.add_box(size, position=(x, 0, height + size[2] / 2), mass=mass, friction=friction)
        height += size[2]
    return world


def off(world, start):
    return np.abs(world.position - start)[:, :2].max()


@pytest.mark.parametrize("edge", [1.0, 0.05])
@pytest.mark.parametrize("count", [20, 40])
def test_towers_stand(count, edge):
    world = stack([(edge, edge, edge)] * count, [1000 * edge**3] * count)
    start = world.position.copy()
    world.advance(STEP, 600)
    assert off(world, start) < 0.03
    assert np.abs(world.velocity).max() < 0.02
    assert (world.position[2:, 2] > start[2:, 2] - 0.35).all()


@pytest.mark.parametrize("shape", ["box", "cylinder"])
@pytest.mark.parametrize(("edge", "gravity"), [(0.001, 9.81), (0.005, 9.81), (0.1, 1000.0)])
def test_towers_of_what_falls_by_its_own_size_in_a_step_stand(edge, gravity, shape):
    world = World(gravity=(0, 0, -gravity))
    world.add_plane(friction=0.6)
    add, size = (world.add_box, (3 * (edge,),)) if shape == "box" else (world.add_cylinder, (edge / 2, edge))
    for k in range(5):
        add(*size, position=(0, 0, (0.5 + k) * edge), friction=0.6)
    heights = edge * (0.5 + np.arange(5))
    for _ in range(20):
        world.advance(STEP, 3)
        assert world.position[2:, 2] == pytest.approx(heights, abs=0.05 * edge)
    assert np.abs(world.velocity).max() < 1e-9


@pytest.mark.parametrize("masses", [[1, 10], [2.0**-k for k in range(10)]])
def test_mass_ratios_come_to_rest(masses):
    world = stack([(1, 1, 1)] * len(masses), masses)
    start = world.position.copy()
    world.advance(STEP, 600)
    assert off(world, start) < 0.005
    assert np.abs(world.velocity).max() < 1e-6


@pytest.mark.parametrize("masses", [[1, 100], [1, 1, 1, 1, 100], [1.5**k for k in range(10)]])
def test_light_boxes_bear_heavy_ones(masses):
    world = stack([(1, 1, 1)] * len(masses), masses)
    start = world.position.copy()
    world.advance(STEP, 600)
    assert off(world, start) < 0.02
    assert np.abs(world.velocity).max() < 0.02


@pytest.mark.parametrize(("share", "stands"), [(0.8, True), (0.9, True), (1.1, False)])
def test_bricks_overhang_as_the_harmonic_series_allows(share, stands):
    offsets = np.concatenate([[0], -share * np.cumsum(1 / (2 * np.arange(1, 10)))])[::-1]
    world = stack([(1, 0.5, 0.2)] * 10, [100] * 10, offsets)
    start = world.position.copy()
    world.advance(STEP, 600)
    assert (off(world, start) < 0.1) == stands


def test_a_loaded_plate_rests_and_slides_at_its_coefficient():
    world = World()
    world.add_plane(friction=0.4)
    plate = world.add_box((20, 20, 1), position=(0, 0, 0.5), mass=10, friction=0.4)
    for x in range(5):
        for y in range(5):
            world.add_box((1, 1, 1), position=(4 * x - 8, 4 * y - 8, 1.5), mass=1, friction=0.8)
    world.advance(STEP, 300)
    assert np.abs(world.velocity).max() < 1e-9
    force = 1.1 * 0.4 * 35 * G
    for _ in range(60):
        world.apply_force(plate, (force, 0, 0))
        world.step(STEP)
    assert (force / 35 - world.velocity[plate.index, 0]) / G == pytest.approx(0.4, rel=0.005)


def test_tilting_a_base_slowly_tips_what_stands_on_it_where_statics_says():
    """Arms that stay where a box came to rest must not hold it up."""
    world = World()
    base = world.add_box((4, 4, 0.2), position=(0, 0, -0.1), kinematic=True, friction=2.0)
    box = world.add_box((0.4, 0.4, 1.0), position=(0, 0, 0.5), friction=2.0)
    speed = 0.05
    world.angular_velocity[base.index] = (0, speed, 0)
    while abs(world.angular_velocity[box.index, 1]) < 1.0:
        world.step(STEP)
        assert world.time < 20
    assert speed * world.time == pytest.approx(np.arctan(0.4) + speed * 0.6, abs=0.04)


def test_the_residual_says_what_is_left_unsolved():
    calm, wild = stack([(1, 1, 1)] * 3, [1, 1, 1]), stack([(1, 1, 1)] * 70, [1.0] * 69 + [1000.0])
    calm.advance(STEP, 300)
    assert 0.0 < calm.residual < 1e-9
    wild.step(STEP)
    assert 1e-3 < wild.residual < 10.0
    assert World().residual == 0.0


def test_a_box_slides_over_the_triangles_of_a_mesh_as_over_a_plane():
    """Each triangle has its own friction, aside of the centre of the box, and all of it acts against the way it slides."""
    x, y = np.meshgrid(np.linspace(-10, 10, 21), np.linspace(-2, 2, 5), indexing="ij")
    corner = 5 * np.arange(20)[:, None] + np.arange(4)
    faces = [np.stack([corner, corner + 5, corner + 6], axis=-1), np.stack([corner, corner + 6, corner + 1], axis=-1)]
    world = World()
    world.add_mesh(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3), np.concatenate(faces).reshape(-1, 3), friction=0.3)
    box = world.add_box((1, 1, 1), position=(-5, 0.1, 0.5), friction=0.3).index
    world.advance(STEP, 60)
    world.velocity[box] = (4, 0, 0)
    world.advance(STEP, 60)
    assert (4 - world.velocity[box, 0]) / G == pytest.approx(0.3, rel=0.005)
    assert abs(world.velocity[box, 1]) < 1e-3


def test_planar_stacks_come_to_rest():
    pyramid = [(i - 0.5 * (9 - row), 0, row + 0.5) for row in range(10) for i in range(10 - row)]
    for places in ([(0.2 * (k % 2), 0, k + 0.5) for k in range(5)], pyramid):
        world = World(plane_normal=(0, 1, 0))
        world.add_plane(friction=0.6)
        for place in places:
            world.add_box((1, 1, 1), position=place, friction=0.6)
        start = world.position.copy()
        world.advance(STEP, 600)
        assert off(world, start) < 0.01
        assert np.abs(world.velocity).max() < 1e-4


@pytest.mark.parametrize("seed", range(3))
def test_balls_squeezed_into_too_small_a_box_come_to_rest(seed):
    """Springs that were forces alone, as those of deep overlaps with a bounded bias are, would let them wander for ever."""
    random, world, room = np.random.default_rng(seed), World(gravity=(0, 0, 0), plane_normal=(0, 1, 0)), 4.0
    for normal in ((1, 0, 0), (-1, 0, 0), (0, 0, 1), (0, 0, -1)):
        world.add_plane(normal, point=-room * np.array(normal), friction=0.6)
    for x in np.arange(-3.6, 3.7, 0.8):
        for z in np.arange(-3.6, 3.7, 0.8):
            world.add_sphere(0.5, position=(x, 0, z) + random.uniform(-0.05, 0.05, 3) * (1, 0, 1), mass=1, friction=0.6)
    world.advance(STEP, 300)
    assert np.abs(world.velocity).max() < 1e-6
    assert np.abs(world.position[5:]).max() < room - 0.3


@pytest.mark.parametrize("push", [0.5, 1.5])
def test_deep_overlaps_part_at_the_speed_that_they_may(push):
    world = World(gravity=(0, 0, 0), push_speed=push)
    for x in (0.0, 0.3):
        world.add_sphere(0.5, position=(x, 0, 0), mass=1)
    parted = []
    for _ in range(150):
        parted.append(world.position[2, 0] - world.position[1, 0])
        world.step(STEP)
    speeds = np.diff(parted) / STEP
    assert speeds.max() == pytest.approx(push, rel=1e-6)
    assert parted[-1] == pytest.approx(1.0, abs=1e-9)
    assert np.abs(world.velocity).max() < 1e-9
