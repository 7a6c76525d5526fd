"""Cylinders and cones that roll and spin, against steady motions of rigid bodies: a coin that leans, a cone around its tip."""

import math

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.world.shapes.mass_properties import rotation_matrix

G, STEP = 9.81, 1 / 240
GROUND = ["plane", "box"]


def ground(world, kind):
    if kind == "plane":
        world.add_plane(friction=1.0)
    else:
        world.add_box((20, 20, 1), position=(0, 0, -0.5), static=True, friction=1.0)


def turning(world, body, rate, about):
    """Let a body turn about an axis through a point."""
    world.angular_velocity[body] = rate
    world.velocity[body] = np.cross(rate, world.position[body] - about)


@pytest.mark.parametrize("kind", GROUND)
@pytest.mark.parametrize("tilt", [0.5, 1.0])
def test_a_leaning_coin_rolls_round_in_place_and_keeps_its_energy(kind, tilt):
    """A thin disc turns about the diameter to its lowest point, which goes round at sqrt(4 g / (R sin tilt))."""
    radius, thickness = 0.5, 0.05
    world = kd.World()
    ground(world, kind)
    up, axis = np.array([0, math.cos(tilt), math.sin(tilt)]), np.array([0, -math.sin(tilt), math.cos(tilt)])
    middle = radius * up + 0.5 * thickness * axis
    turn = (math.cos(tilt / 2), math.sin(tilt / 2), 0, 0)
    coin = world.add_cylinder(radius, thickness, position=middle, orientation=turn, friction=1.0).index
    turning(world, coin, math.sqrt(4 * G / (radius * math.sin(tilt))) * math.sin(tilt) * up, (0, 0, 0))
    start = world.energy().total
    for _ in range(240):
        world.step(STEP)
        assert world.energy().total == pytest.approx(start, rel=4e-3)
    # By as much as the coin is not thin
    assert np.linalg.norm(world.position[coin] - (0, middle[1], middle[2])) < 4 * thickness


@pytest.mark.parametrize("kind", GROUND)
def test_a_cone_rolls_around_its_tip(kind):
    radius, height, rate = 0.3, 0.6, 4.0
    world = kd.World()
    ground(world, kind)
    angle = math.atan2(radius, height)
    along = np.array([math.cos(angle), 0, math.sin(angle)])  # from the tip, on the ground, to the base
    lean = math.atan2(-along[0], -along[2])
    turn = (math.cos(lean / 2), 0, math.sin(lean / 2), 0)
    cone = world.add_cone(radius, height, position=0.5 * height * along, orientation=turn, friction=1.0).index
    turning(world, cone, (-rate, 0, 0), (0, 0, 0))
    start, rise = world.energy().total, world.position[cone, 2]
    for _ in range(240):
        world.step(STEP)
        tip = world.position[cone] + rotation_matrix(world.orientation[cone]) @ (0, 0, 0.75 * height)
        assert tip == pytest.approx(np.zeros(3), abs=1e-3)
    # It turns about the line on which it lies, which goes round with that times the tangent of the half angle.
    assert np.linalg.norm(world.angular_velocity[cone]) == pytest.approx(rate, rel=1e-3)
    spun = -world.angular_velocity[cone, :2] / rate
    assert abs(math.atan2(spun[1], spun[0])) == pytest.approx(rate * math.tan(angle), rel=2e-3)
    assert world.position[cone, 2] == pytest.approx(rise, abs=5e-4)
    assert world.energy().total == pytest.approx(start, rel=1e-3)


@pytest.mark.parametrize(("kind", "friction"), [("plane", 0.0), ("box", 0.0), ("plane", 0.25)])
def test_a_cylinder_spins_on_its_end_until_friction_stops_it(kind, friction):
    """Its points push at the rim, so that friction mu m g acts at its radius: the spin falls by 2 mu g / r a second."""
    world = kd.World()
    ground(world, kind)
    options = {"position": (0, 0, 0.3), "angular_velocity": (0, 0, 30.0), "friction": friction**2}
    body = world.add_cylinder(0.3, 0.6, **options).index
    world.advance(1 / 60, 60)
    assert world.angular_velocity[body] == pytest.approx([0, 0, 30.0 - 2 * friction * G / 0.3], abs=1e-2)
    assert world.position[body] == pytest.approx([0, 0, 0.3], abs=2e-4)


@pytest.mark.parametrize("kind", GROUND)
def test_a_wheel_rolls_on_at_its_speed(kind):
    world = kd.World()
    ground(world, kind)
    wheel = world.add_cylinder(
        0.5,
        0.1,
        position=(-9, 0, 0.5),
        orientation=(math.sqrt(0.5), math.sqrt(0.5), 0, 0),
        velocity=(8, 0, 0),
        angular_velocity=(0, 16, 0),
        friction=1.0,
    ).index
    world.advance(1 / 60, 120)
    assert world.velocity[wheel] == pytest.approx([8, 0, 0], abs=8e-3)
    assert world.angular_velocity[wheel] == pytest.approx([0, 16, 0], abs=1e-2)
    assert world.position[wheel] == pytest.approx([7, 0, 0.5], abs=2e-2)


@pytest.mark.parametrize("resistance", [0.0, 1e-3])
def test_a_ball_in_a_groove_turns_on_about_the_line_through_its_contacts(resistance):
    """Nothing slides there, so that the ball rolls for ever unless something resists it, which then brings it to rest."""
    radius, rate, s = 0.2, 0.5, math.sqrt(0.5)
    world = kd.World()
    world.add_plane(normal=(0, s, s), friction=0.6)
    world.add_plane(normal=(0, -s, s), friction=0.6)
    motion = {"velocity": (rate * radius * s, 0, 0), "angular_velocity": (0, rate, 0)}
    ball = world.add_sphere(
        radius, position=(0, 0, radius / s), friction=0.6, rolling_resistance=resistance, **motion
    ).index
    start = world.energy().kinetic
    world.advance(1 / 60, 600)
    if resistance == 0.0:
        assert world.energy().kinetic == pytest.approx(start, rel=1e-9)
        assert world.position[ball] == pytest.approx([10 * rate * radius * s, 0, radius / s], rel=1e-6, abs=1e-4)
    else:
        assert np.abs(world.velocity[ball]).max() < 1e-12


def rock(rng):
    points = rng.normal(size=(rng.integers(12, 60), 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    return points * rng.uniform(0.8, 1.0, size=(len(points), 1)) * rng.uniform(0.4, 1.0, 3)


def prism(rng):
    corners, thickness = rng.integers(6, 32), rng.choice([0.05, 0.2, 0.6, 2.0])
    angles = np.arange(corners) * 2 * np.pi / corners
    return np.array([(math.cos(a), math.sin(a), z) for a in angles for z in (-thickness / 2, thickness / 2)])


@pytest.mark.parametrize(("substep", "most"), [(1 / 240, 2e-3), (1 / 3840, 1e-4)])
@pytest.mark.parametrize("shape", [rock, prism])
def test_rolling_polyhedra_with_many_corners_gain_no_energy(shape, substep, most):
    """The friction of a blow, applied again in the next substep, or corners that sink in and are pushed out, would add some."""
    gained = []
    for seed in (0, 38, 40, 48, 52, 64):
        rng = np.random.default_rng(seed)
        points = shape(rng) * 10 ** rng.uniform(-1.7, 0.0)
        size, friction = np.abs(points).max(), rng.choice([0.3, 0.5, 1.0])
        world, turn, fast = kd.World(), rng.normal(size=4), math.sqrt(G * size)
        world.add_plane(friction=friction)
        world.add_hull(
            points,
            position=(0, 0, 2.5 * size),
            orientation=turn / np.linalg.norm(turn),
            velocity=(*rng.normal(size=2) * 2 * fast, 0.0),
            angular_velocity=rng.normal(size=3) * fast / size,
            friction=friction,
        )
        last = start = world.energy().total
        for _ in range(int(2.0 * math.sqrt(size / 0.1) / (4 * substep))):
            world.step(4 * substep)
            energy = world.energy().total
            gained.append((energy - last) / start)
            last = energy
    assert max(gained) < most


def test_a_coin_of_24_corners_does_not_sink_in_as_it_rolls():
    tilt, radius, thickness, angles = np.pi / 4, 0.1, 0.01, np.arange(24) * 2 * np.pi / 24
    points = np.array(
        [(radius * math.cos(a), radius * math.sin(a), z) for a in angles for z in (-thickness / 2, thickness / 2)]
    )
    world = kd.World()
    world.add_plane(friction=1.0)
    coin = world.add_hull(
        points,
        position=(0, 0, radius * math.sin(tilt) + thickness / 2 * math.cos(tilt)),
        orientation=(math.cos(tilt / 2), 0, math.sin(tilt / 2), 0),
        angular_velocity=2 * math.sqrt(G / radius * math.sin(tilt)) * np.array((-math.cos(tilt), 0, math.sin(tilt))),
        friction=1.0,
    )
    lowest = 0.0
    for _ in range(200):
        world.step(1 / 960)
        lowest = min(lowest, (points @ rotation_matrix(coin.orientation).T)[:, 2].min() + coin.position[2])
    assert lowest > -1e-4


@pytest.mark.parametrize("step", [1 / 60, 1 / 30])
@pytest.mark.parametrize("gap", [1e-5, 1.5e-4, 2e-3])
@pytest.mark.parametrize("kind", ["prism", "cylinder"])
def test_what_lands_flat_on_many_corners_lands_on_four_around_its_middle(kind, gap, step):
    world, angles = kd.World(), np.arange(24) * 2 * np.pi / 24
    world.add_box((4, 4, 1), position=(0, 0, -0.5), static=True)
    if kind == "prism":
        points = [(0.3 * math.cos(a), 0.3 * math.sin(a), z) for a in angles for z in (-0.05, 0.05)]
        body = world.add_hull(points, position=(0, 0, 0.05 + gap))
    else:
        body = world.add_cylinder(0.3, 0.1, position=(0, 0, 0.05 + gap))
    fastest = 0.0
    for _ in range(20):
        world.step(step)
        fastest = max(fastest, np.linalg.norm(body.angular_velocity))
    assert fastest < 0.05
