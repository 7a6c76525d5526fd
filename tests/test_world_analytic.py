"""Contacts against exact solutions: restitution, friction, rolling, the bouncing disk."""

import math

import numpy as np
import pytest

from kickdrift.world.world import World

G = 9.81
STEP = 1 / 60
STEPS = [1 / 60, 1 / 240]


def peaks(world, body, step, count, rest):
    """Heights over `rest` that a body reaches between its bounces: z + v^2/(2 g) of the last moment that it rises."""
    found = []
    for _ in range(count):
        z, v = world.position[body, 2] - rest, world.velocity[body, 2]
        world.step(step)
        if v > 0 >= world.velocity[body, 2]:
            found.append(z + v * v / (2 * G))
    return np.array(found)


# Shape that falls from 1 m, and what it falls on: the plane or a pad of some width.
LANDINGS = {"ball on a plane": None, "box on a plane": None, "box on a smaller pad": 0.375, "box on a wide pad": 4.0}


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("landing", LANDINGS)
def test_every_bounce_reaches_the_square_of_the_restitution(landing, step):
    pad = LANDINGS[landing]
    for e in (0.5, 0.8, 0.9, 1.0):
        world = World()
        if pad is None:
            world.add_plane(restitution=e)
        else:
            world.add_box((pad, pad, 1), position=(0, 0, -0.5), static=True, restitution=e)
        rest = 0.05 if "ball" in landing else 0.5
        options = {"position": (0, 0, 1 + rest), "restitution": e}
        falling = world.add_sphere(rest, **options) if "ball" in landing else world.add_box((1, 1, 1), **options)
        found = peaks(world, falling.index, step, round(3 / step), rest)[:3]
        assert found == pytest.approx(e ** (2.0 * np.arange(1, 4)), rel=1e-8)
        assert found.max() <= 1 + 1e-8  # never above the drop height
        assert np.abs(world.position[falling.index, :2]).max() < 2e-3


def test_no_bounce_is_lost_wherever_in_the_substep_it_happens():
    for height in np.linspace(0.05, 2.0, 60):
        world = World()
        world.add_plane(restitution=0.9)
        world.add_sphere(0.05, position=(0, 0, height + 0.05), restitution=0.9)
        world.advance(STEP, math.ceil(math.sqrt(2 * height / G) * 60) + 2)
        energy = world.energy().total / (4 / 3 * math.pi * 0.05**3 * 1000 * G) - 0.05
        assert energy == pytest.approx(0.81 * height, rel=1e-9)


def test_slow_approaches_do_not_bounce():
    world = World(bounce_speed=1.0)
    world.add_plane(restitution=1.0)
    for k, speed in enumerate((0.9, 1.1)):
        world.add_sphere(0.1, position=(k, 0, 0.1), velocity=(0, 0, -speed), restitution=1.0)
    world.step(1e-3)
    assert world.velocity[2, 2] == pytest.approx(0.0, abs=1e-3)
    assert world.velocity[3, 2] == pytest.approx(1.1, rel=0.02)


def test_boxes_without_restitution_land_flat():
    for height in np.linspace(0.1, 2.0, 12):
        world = World()
        world.add_plane()
        world.add_box((1, 1, 1), position=(0, 0, 0.5 + height))
        fastest = 0.0
        for _ in range(60):
            world.step(STEP)
            fastest = max(fastest, np.abs(world.angular_velocity[2]).max(), world.velocity[2, 2])
        assert fastest < 2.0
        assert np.abs(world.position[2] - [0, 0, 0.5]).max() < 0.01


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("mass", [1.0, 3.0, 100.0])
def test_two_balls_that_meet_follow_newtons_rule(e, mass):
    world = World(gravity=(0, 0, 0))
    world.add_sphere(0.1, position=(-1, 0, 0), velocity=(5, 0, 0), restitution=e, mass=1.0)
    world.add_sphere(0.1, position=(1, 0, 0), velocity=(-10, 0, 0), restitution=e, mass=mass)
    world.advance(STEP, 30)
    common = (5 - 10 * mass) / (1 + mass)
    after = [common - e * mass / (1 + mass) * 15, common + e / (1 + mass) * 15]
    assert world.velocity[1:, 0] == pytest.approx(after, abs=1e-12)
    met = -1 + 5 * 0.12
    assert world.position[1, 0] == pytest.approx(met + after[0] * (0.5 - 0.12), abs=1e-3 if e == 0 else 1e-12)
    assert not world.velocity[1:, 1:].any()
    assert not world.angular_velocity.any()


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("e", [0.5, 1.0])
def test_a_tilted_box_that_bounces_on_an_edge_begins_to_turn(e, step):
    tilt, speed, (width, depth, height) = 0.3, 3.0, (1.0, 1.0, 0.4)
    world = World(gravity=(0, 0, 0))
    world.add_plane(restitution=e, friction=0.0)
    # The lower edge is at (x, z) from the centre.
    x = width / 2 * math.cos(tilt) - height / 2 * math.sin(tilt)
    z = -width / 2 * math.sin(tilt) - height / 2 * math.cos(tilt)
    turn = (math.cos(tilt / 2), 0, math.sin(tilt / 2), 0)
    options = {"mass": 1.0, "friction": 0.0, "restitution": e, "orientation": turn, "velocity": (0, 0, -speed)}
    box = world.add_box((width, depth, height), position=(0, 0, 0.5 - z), **options).index
    energy = world.energy().total
    world.advance(step, round(0.2 / step))
    moment = (width**2 + height**2) / 12
    impulse = (1 + e) * speed / (1 + x**2 / moment)
    assert world.velocity[box] == pytest.approx([0, 0, impulse - speed], abs=1e-9)
    assert world.angular_velocity[box] == pytest.approx([0, -x * impulse / moment, 0], abs=1e-9)
    lost = 0.5 * (1 - e**2) * speed**2 / (1 + x**2 / moment)
    assert world.energy().total == pytest.approx(energy - lost, rel=1e-9)


@pytest.mark.parametrize("gap", [0.0, 1e-3])
@pytest.mark.parametrize("raised", [1, 2, 3])
def test_as_many_balls_of_newtons_cradle_leave_as_arrive(raised, gap):
    world = World(gravity=(0, 0, 0))
    for k in range(5):
        x = k * (0.2 + gap) - (0.5 if k < raised else 0)
        world.add_sphere(
            0.1, position=(x, 0, 0), velocity=(2.0 if k < raised else 0.0, 0, 0), restitution=1.0, friction=0.0
        )
    world.advance(STEP, 60)
    assert world.velocity[1:, 0] == pytest.approx([0.0] * (5 - raised) + [2.0] * raised, abs=1e-9)


def test_a_hit_passes_through_a_row_of_balls_with_gaps_within_a_step():
    """The last ball goes on with the whole velocity, from the time of its impact; all others stand."""
    world, gap = World(gravity=(0, 0, 0)), 1e-3
    first = world.add_sphere(0.1, position=(-0.2 - gap, 0, 0), velocity=(5, 0, 0), restitution=1, friction=0)
    row = [world.add_sphere(0.1, position=((0.2 + gap) * k, 0, 0), restitution=1, friction=0) for k in range(6)]
    world.advance(1 / 60, 3)
    ends = [ball.position[0] for ball in (first, *row)]
    assert np.allclose(ends[:-1], [(0.2 + gap) * k + gap for k in range(-1, 5)], rtol=0, atol=1e-14)
    assert abs(ends[-1] - 5 * (0.2 + gap) - (5 * 3 / 60 - 6 * gap)) < 1e-14


def test_a_ball_that_hits_two_at_once_comes_back_with_a_fifth_of_its_speed():
    """Impulses J at 30 degrees to the path: J (1 + 2 cos^2 30) / m = 2 v cos 30, so J = 0.4 sqrt(3) m v."""
    world = World(gravity=(0, 0, 0))
    ball = world.add_sphere(0.1, velocity=(1, 0, 0), restitution=1, friction=0)
    two = [
        world.add_sphere(0.1, position=(0.2 * math.cos(math.pi / 6) + 0.005, side, 0), restitution=1, friction=0)
        for side in (-0.1, 0.1)
    ]
    world.advance(1 / 60, 2)
    assert np.allclose(ball.velocity, (-0.2, 0, 0), rtol=0, atol=1e-9)
    for other, side in zip(two, (-1, 1), strict=True):
        assert np.allclose(other.velocity, (0.6, side * 0.2 * math.sqrt(3), 0), rtol=0, atol=1e-9)


def test_a_light_ball_is_thrown_off_a_heavy_one():
    for mass in (3.0, 10.0, 100.0):
        world = World()
        world.add_plane(restitution=1.0)
        world.add_sphere(0.1, position=(0, 0, 1.1), restitution=1.0, mass=mass)
        world.add_sphere(0.05, position=(0, 0, 1.25), restitution=1.0, mass=1.0)
        world.advance(STEP, 28)
        thrown = (3 * mass - 1) / (mass + 1) * math.sqrt(2 * G) - G * (28 / 60 - math.sqrt(2 / G))
        assert world.velocity[3, 2] == pytest.approx(thrown, rel=1e-9)


def test_a_gas_of_elastic_balls_keeps_its_energy():
    rng = np.random.default_rng(0)
    world = World(gravity=(0, 0, 0))
    smooth = {"restitution": 1.0, "friction": 0.0}
    for wall in np.concatenate((np.eye(3), -np.eye(3))):
        world.add_plane(wall, -2 * wall, **smooth)
    for position in np.stack(np.meshgrid(*[np.linspace(-1.6, 1.6, 3)] * 3), axis=-1).reshape(-1, 3):
        world.add_sphere(0.2, position=position, velocity=3 * rng.normal(size=3), **smooth)
    energy, before = world.energy().total, world.velocity.copy()
    world.advance(STEP, 600)
    assert world.energy().total == pytest.approx(energy, rel=1e-12)
    assert np.abs(world.position[7:]).max() < 1.81
    assert (np.abs(world.velocity - before)[7:].max(axis=1) > 0.1).all()


def on_slope(angle, friction, size=(1.0, 1.0, 0.2)):
    """A box on a tilted plane, and the direction down it."""
    world = World()
    normal = np.array([math.sin(angle), 0.0, math.cos(angle)])
    world.add_plane(normal, friction=friction)
    turn = (math.cos(angle / 2), 0, math.sin(angle / 2), 0)
    world.add_box(size, position=normal * size[2] / 2, orientation=turn, friction=friction)
    return world, np.array([math.cos(angle), 0.0, -math.sin(angle)])


@pytest.mark.parametrize("degrees", [3, 10, 20, 30, 40])
@pytest.mark.parametrize("friction", [0.1, 0.3, 0.5, 0.7, 1.0])
def test_boxes_slide_down_where_the_slope_is_above_the_friction(friction, degrees):
    angle = math.radians(degrees)
    world, down = on_slope(angle, friction)
    start = world.position[2].copy()
    world.advance(STEP, 15)
    way, speed = (world.position[2] - start) @ down, world.velocity[2] @ down
    acceleration = G * (math.sin(angle) - friction * math.cos(angle))
    if acceleration < 0:
        assert abs(speed) < 1e-6
        assert abs(way) < 2e-4
        return
    assert way > 0.015
    world.advance(STEP, 60)
    assert world.velocity[2] @ down - speed == pytest.approx(acceleration, rel=1e-3)


@pytest.mark.parametrize(("step", "tolerance"), [(1 / 60, 0.01), (1 / 240, 0.003)])
@pytest.mark.parametrize("friction", [0.2, 0.4, 0.7])
def test_a_sliding_box_stops_where_its_energy_is_used_up(friction, step, tolerance):
    world = World()
    world.add_plane(friction=friction)
    world.add_box((1, 1, 0.2), position=(0, 0, 0.1), velocity=(2, 0, 0), friction=friction)
    world.advance(step, round(2 / step))
    assert world.position[2, 0] == pytest.approx(4 / (2 * friction * G), rel=tolerance)
    assert np.abs(world.velocity[2]).max() < 1e-12


def test_sliding_is_the_same_in_all_directions():
    for heading in np.arange(12) * math.pi / 6 + 0.1:
        along = np.array([math.cos(heading), math.sin(heading)])
        world = World()
        world.add_plane(friction=0.5)
        world.add_box((1, 1, 0.2), position=(0, 0, 0.1), velocity=(*(20 * along), 0), friction=0.5)
        world.advance(STEP, 120)
        place = world.position[2, :2]
        assert place @ along == pytest.approx(20 * 2 - 0.5 * 0.5 * G * 4, rel=1e-3)
        assert abs(place[1] * along[0] - place[0] * along[1]) < 1e-5


@pytest.mark.parametrize("friction", [0.2, 0.6])
def test_a_spinning_box_is_braked_by_the_levers_of_its_corners(friction):
    world = World()
    world.add_plane(friction=friction)
    world.add_box((1, 1, 0.2), position=(0, 0, 0.1), angular_velocity=(0, 0, 10), friction=friction)
    world.advance(STEP, 2)
    before = world.angular_velocity[2, 2]
    world.advance(STEP, 15)
    deceleration = friction * math.sqrt(0.5) * G / (2 / 12)  # mu r N / I
    assert (before - world.angular_velocity[2, 2]) / 0.25 == pytest.approx(deceleration, rel=2e-3)
    world.advance(STEP, 180)
    assert abs(world.angular_velocity[2, 2]) < 1e-12


@pytest.mark.parametrize("step", STEPS)
def test_a_sliding_ball_begins_to_roll(step):
    friction, radius, speed = 0.3, 0.2, 5.0
    world = World()
    world.add_plane(friction=friction)
    world.add_sphere(radius, position=(0, 0, radius), velocity=(speed, 0, 0), friction=friction)
    slips = []
    for _ in range(round(1 / step)):
        world.step(step)
        slips.append(world.velocity[2, 0] - radius * world.angular_velocity[2, 1])
    rolls = 2 * speed / (7 * friction * G)
    assert step * np.count_nonzero(np.array(slips) > 1e-2) == pytest.approx(rolls, abs=1.5 * step)
    assert world.velocity[2, 0] == pytest.approx(5 / 7 * speed, rel=1e-4)
    way = 12 * speed**2 / (49 * friction * G) + 5 / 7 * speed * (1 - rolls)
    assert world.position[2, 0] == pytest.approx(way, rel=1e-3)


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("floor", ["plane", "box"])
def test_rolling_resistance_is_a_lever_of_the_normal_force(floor, step):
    lever, radius, speed = 0.01, 0.2, 2.0
    world = World()
    options = {"friction": 0.8, "rolling_resistance": lever}
    if floor == "plane":
        world.add_plane(friction=0.8)
    else:
        world.add_box((20, 2, 1), position=(0, 0, -0.5), static=True, friction=0.8)
    motion = {"velocity": (speed, 0, 0), "angular_velocity": (0, speed / radius, 0)}
    world.add_sphere(radius, position=(0, 0, radius), **motion, **options)
    deceleration = lever * G / (1.4 * radius)
    world.advance(step, round(1 / step))
    assert speed - world.velocity[2, 0] == pytest.approx(deceleration, rel=2e-3)
    world.advance(step, round(10 / step))
    assert world.position[2, 0] == pytest.approx(speed**2 / (2 * deceleration), rel=2e-3)
    assert np.abs(world.velocity[2]).max() < 1e-12


@pytest.mark.parametrize("spin", [0.0, 1.0])
@pytest.mark.parametrize("resistance", [0.001, 0.05])
def test_a_box_with_rolling_resistance_stops_turning_about_the_normal(resistance, spin):
    world, surface = World(), {"friction": 0.6, "rolling_resistance": resistance}
    world.add_plane(**surface)
    box = world.add_box((0.3, 0.3, 0.1), position=(0, 0, 0.05), angular_velocity=(0, 0, spin), **surface)
    world.advance(STEP, 300)
    assert np.abs(box.angular_velocity).max() < 1e-9  # rad/s; solved at once with torsional friction, 0.005 and 0.27


@pytest.mark.parametrize("across", [None, (0, 1, 0), (0, -1, 0), (1, 0, 0), (1e-3, 1, 0)])
def test_rolling_resistance_brakes_a_cart_on_two_wheels(across):
    """Its mass, with that of rolling wheels of 1.4 times theirs, is 3.8 kg, and its weight that of 3 kg."""
    ahead, left = ((0, 1, 0), (-1, 0, 0)) if across == (1, 0, 0) else ((1, 0, 0), (0, 1, 0))
    ahead, left = np.array(ahead), np.array(left)
    lever, radius, speed = 0.01, 0.1, 2.0
    world = World(plane_normal=across)
    world.add_plane(friction=1.0)
    cart = world.add_box(abs(0.5 * ahead) + 0.1, position=(0, 0, radius), velocity=speed * ahead, mass=1.0)
    for side in (-1, 1):
        at = 0.4 * side * ahead + (0, 0, radius)
        motion = {"velocity": speed * ahead, "angular_velocity": speed / radius * left}
        wheel = world.add_sphere(radius, position=at, mass=1.0, rolling_resistance=lever, friction=1.0, **motion)
        world.add_hinge(cart, wheel, anchor=at, axis=left if across is None else across)
    world.advance(1 / 60, 60)
    assert cart.velocity @ ahead == pytest.approx(speed - lever / radius * G * 3.0 / 3.8, rel=1e-5)


@pytest.mark.parametrize("step", STEPS)
def test_without_rolling_resistance_a_ball_rolls_on(step):
    for speed in (0.1, 0.5, 2.0):
        world = World()
        world.add_plane(friction=0.8)
        motion = {"velocity": (speed, 0, 0), "angular_velocity": (0, 5 * speed, 0)}
        world.add_sphere(0.2, position=(0, 0, 0.2), friction=0.8, **motion)
        highest = 0.0
        for _ in range(100):
            world.advance(step, round(0.1 / step))
            highest = max(highest, abs(world.velocity[2, 2]))
        assert world.velocity[2, 0] == pytest.approx(speed, rel=1e-3)
        assert highest < 1e-3


def test_a_conveyor_takes_boxes_to_its_speed_and_balls_to_two_sevenths():
    friction, belt = 0.5, 1.5
    world = World()
    turn = (math.cos(0.3), 0, 0, math.sin(0.3))
    along = np.array([math.cos(0.6), math.sin(0.6), 0.0])  # the velocity is in the axes of the body
    options = {"static": True, "friction": friction, "surface_velocity": (belt, 0, 0)}
    world.add_box((20, 4, 1), position=(0, 0, -0.5), orientation=turn, **options)
    box = world.add_box((1, 1, 0.2), position=(0, 0, 0.1), friction=friction).index
    ball = world.add_sphere(0.2, position=-2 * along + (0, 0, 0.2), friction=friction).index
    world.advance(STEP, 120)
    assert world.velocity[box] == pytest.approx(belt * along, abs=1e-9)
    assert world.position[box] @ along == pytest.approx(2 * belt - belt**2 / (2 * friction * G), rel=2e-3)
    assert world.velocity[ball] == pytest.approx(2 / 7 * belt * along, abs=1e-3)


def test_a_kinematic_platform_takes_along_what_stands_on_it():
    world = World()
    options = {"kinematic": True, "velocity": (1, 0, 0), "friction": 0.5}
    world.add_box((6, 4, 0.5), position=(0, 0, -0.25), **options)
    world.add_box((1, 1, 0.5), position=(0, 0, 0.25), friction=0.5)
    world.advance(STEP, 120)
    assert world.velocity[2] == pytest.approx([1, 0, 0], abs=1e-9)
    assert world.position[2, 0] == pytest.approx(2 - 1 / (2 * 0.5 * G), abs=1e-3)


def test_a_turntable_carries_a_box_round():
    world = World()
    world.add_box((6, 6, 0.5), position=(0, 0, -0.25), kinematic=True, angular_velocity=(0, 0, 1), friction=0.8)
    motion = {"velocity": (0, 1, 0), "angular_velocity": (0, 0, 1)}
    world.add_box((0.5, 0.5, 0.5), position=(1, 0, 0.25), friction=0.8, **motion)
    world.advance(1 / 240, round(480 * math.pi))
    # The arms of a step are those of its start, so that circles become spirals: 1.3 % a turn at 1/240 s.
    assert np.linalg.norm(world.position[2, :2]) == pytest.approx(1.0, abs=0.02)
    assert world.angular_velocity[2] == pytest.approx([0, 0, 1], abs=2e-3)
    assert abs(math.atan2(world.position[2, 1], world.position[2, 0])) < 0.01


def test_the_bouncing_disk():
    world = World(substeps=1, midpoint=False, plane_normal=(0, 1, 0))
    world.add_plane(restitution=0.9)
    world.add_sphere(0.1, position=(0, 0, 0.1), velocity=(0, 0, 5), restitution=0.9)
    heights, bounced = [], []
    for step in range(1, 1500):
        before = world.velocity[2, 2]
        world.step(0.01)
        heights.append(world.position[2, 2] - 0.1)
        if before < 0 < world.velocity[2, 2]:
            bounced.append((step, before - G * 0.01, world.velocity[2, 2]))
    assert bounced[0] == (101, pytest.approx(-4.908, abs=5e-4), pytest.approx(4.417, abs=5e-4))
    z = np.array(heights)
    highest = z[1:-1][(z[1:-1] > z[:-2]) & (z[1:-1] >= z[2:])][:10]
    assert (highest[9] / highest[0]) ** (1 / 9) == pytest.approx(0.81, rel=0.02)
    exact = 2 * 5 / G * (1 - 0.9**10) / 0.1  # of the tenth bounce
    assert 0.98 < bounced[9][0] * 0.01 / exact < 1.0


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("step", [1 / 60, 1 / 240])
def test_an_oblique_impact_of_balls_keeps_angular_momentum(step, restitution, friction):
    world = World(gravity=(0, 0, 0))
    surface = {"restitution": restitution, "friction": friction}
    world.add_sphere(0.5, position=(-2, 0.3, 0), velocity=(4, 0, 0), **surface)
    world.add_sphere(0.5, position=(0, -0.2, 0), velocity=(0, 0, 0), mass=200.0, **surface)
    before = world.angular_momentum()
    world.advance(step, int(1.0 / step))
    assert np.abs(world.velocity[2]).max() > 0.1
    assert world.angular_momentum() == pytest.approx(before, abs=1e-12 * np.abs(before).max())


@pytest.mark.parametrize("step", [1 / 60, 1 / 240])
def test_smooth_balls_that_graze_part_along_the_line_of_centres(step):
    """Equal elastic balls: the one at rest leaves along the line of centres at the moment of the impact, with v cos(a)."""
    world = World(gravity=(0, 0, 0))
    smooth = {"restitution": 1.0, "friction": 0.0}
    world.add_sphere(0.5, position=(-2, 0.6, 0), velocity=(4, 0, 0), **smooth)
    world.add_sphere(0.5, position=(0, 0, 0), **smooth)
    world.advance(step, int(1.0 / step))
    normal = np.array([np.sqrt(1 - 0.6**2), -0.6, 0])
    assert world.velocity[2] == pytest.approx(4 * normal[0] * normal, abs=4e-3)
    assert world.angular_velocity[1:] == pytest.approx(0.0, abs=2e-3)


@pytest.mark.parametrize("shape", ["sphere", "capsule", "cylinder"])
def test_what_rolls_goes_on_at_its_speed_however_slow(shape):
    world = World()
    world.add_plane()
    options = {"position": (0, 0, 0.5), "velocity": (1e-8, 0, 0), "orientation": (math.sqrt(0.5), math.sqrt(0.5), 0, 0)}
    add = {"sphere": world.add_sphere, "capsule": world.add_capsule, "cylinder": world.add_cylinder}[shape]
    body = add(0.5, **options) if shape == "sphere" else add(0.5, 1.0, **options)
    world.advance(STEP, 600)
    assert abs(world.velocity[body.index, 0]) < 1e-7


@pytest.mark.parametrize("seed", range(20))
def test_balls_that_meet_at_any_angle_leave_as_by_newtons_rule_to_rounding(seed):
    """Where they touch, and along which normal they part, follows from the exact time of the impact within the step."""
    rng, world = np.random.default_rng(seed), World(gravity=(0, 0, 0))
    radii, masses, e, speed = rng.uniform(0.02, 0.1, 2), rng.uniform(0.1, 10, 2), rng.uniform(), rng.uniform(10, 100)
    along = rng.normal(size=3)
    along /= np.linalg.norm(along)
    across = np.cross(along, rng.normal(size=3))
    across *= rng.uniform(0.0, 0.99) * radii.sum() / np.linalg.norm(across)
    start, drift = across - (radii.sum() + rng.uniform(0.01, 0.9) * speed / 60) * along, rng.normal(size=3)
    options = {"restitution": e, "friction": 0.0}
    a = world.add_sphere(radii[0], mass=masses[0], position=start, velocity=speed * along + drift, **options)
    b = world.add_sphere(radii[1], mass=masses[1], velocity=drift, **options)
    world.advance(1 / 60, 5)
    near = start @ along
    hits = (-near - np.sqrt(near**2 - start @ start + radii.sum() ** 2)) / speed
    normal = -(start + hits * speed * along) / radii.sum()
    impulse = (1 + e) * speed * (along @ normal) / (1 / masses[0] + 1 / masses[1]) * normal
    left = 5 / 60 - hits
    leave_a, leave_b = speed * along - impulse / masses[0], impulse / masses[1]
    np.testing.assert_allclose(a.position, start + hits * speed * along + left * leave_a + 5 / 60 * drift, atol=1e-10)
    np.testing.assert_allclose(b.position, left * leave_b + 5 / 60 * drift, atol=1e-10)
    np.testing.assert_allclose(np.r_[a.velocity, b.velocity], np.r_[leave_a + drift, leave_b + drift], atol=1e-10)
