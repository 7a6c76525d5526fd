"""What lands and bounces: energy, momentum and spin of slender bodies, and impacts that happen at once."""

import itertools

import numpy as np
import pytest
from landings import FRICTIONS, GROUNDS, RESTITUTIONS, SIZES, STEP, axis_of, change_of_spin, energies, random_turn

from kickdrift import World
from kickdrift.core.vectors import turned, turned_back


@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("restitution", RESTITUTIONS)
def test_sticks_and_plates_that_land_gain_no_energy(restitution, friction):
    rng = np.random.default_rng(0)
    for size in SIZES[1:]:
        for _ in range(2):
            energy, most, least = energies(size, restitution, friction, rng)
            assert most <= energy * (1 + 1e-9)
            if restitution == 1.0 and friction == 0.0:
                assert least == pytest.approx(energy, rel=1e-9)


@pytest.mark.parametrize(
    ("kind", "sizes"), [("box", ((0.2, 0.5, 0.9),)), ("capsule", (0.1, 0.6)), ("cone", (0.3, 0.8))]
)
@pytest.mark.parametrize(("restitution", "friction"), [(1.0, 0.0), (0.5, 0.5)])
def test_bodies_that_turn_by_radians_in_a_substep_gain_no_energy_when_they_land(kind, sizes, restitution, friction):
    rng, surface = np.random.default_rng(5), {"restitution": restitution, "friction": friction}
    for speed in (150, 300, 600, 1200):
        world, axis = World(), rng.normal(size=3)
        world.add_plane(**surface)
        motion = {"position": (0, 0, 2), "angular_velocity": speed * axis / np.linalg.norm(axis)}
        body = getattr(world, f"add_{kind}")(*sizes, **motion, **surface)
        energy, most = world.energy().total, 0.0
        for _ in range(12):
            world.advance(STEP, 5)
            most = max(most, world.energy().total)
        assert body.position[2] > 0.0
        assert most <= energy * (1 + 1e-3)
        if friction == 0.0:
            assert world.energy().total == pytest.approx(energy, rel=1e-3)


def energy_of(world, body):
    """Energy of one body above the ground."""
    i, inertia = body.index, body.inertia
    spin = np.array(turned_back(tuple(world.orientation[i]), tuple(world.angular_velocity[i])))
    kinetic = body.mass * world.velocity[i] @ world.velocity[i] + spin @ inertia @ spin
    return kinetic / 2 + body.mass * 9.81 * world.position[i, 2]


@pytest.mark.parametrize("spin", [0.0, 2.0, 10.0, 20.0])
def test_smooth_sticks_of_all_aspect_ratios_bounce_without_losing_energy(spin):
    """Some turn by several radians a substep after an impact: 1300 rad/s, where they are 1:100."""
    rng, surface = np.random.default_rng(3), {"restitution": 1.0, "friction": 0.0}
    world, sticks = World(), []
    world.add_plane(**surface)
    for kind, aspect in itertools.product(("box", "capsule", "cylinder"), (2, 5, 10, 20, 40, 100)):
        length = min(0.1 * aspect, 2.0)
        width = length / aspect
        sizes = ((width, width, length),) if kind == "box" else (width / 2, length)
        for _ in range(4):
            axis = rng.normal(size=3)
            motion = {
                "position": (5.0 * len(sticks), 0.0, 2.0),
                "orientation": rng.normal(size=4),
                "angular_velocity": spin * axis / np.linalg.norm(axis),
            }
            sticks.append(getattr(world, f"add_{kind}")(*sizes, **motion, **surface))
    before = np.array([energy_of(world, stick) for stick in sticks])
    for _ in range(30):
        world.advance(STEP, 5)
        assert np.array([energy_of(world, stick) for stick in sticks]) / before == pytest.approx(1.0, abs=2e-3)


def test_what_spins_fast_on_the_floor_and_may_bounce_is_carried():
    """Its points turn by a radian a substep, but hardly come nearer."""
    world, tilt, surface = World(), 0.3, {"restitution": 0.5, "friction": 0.0}
    world.add_plane(restitution=0.5, friction=0.5)
    turn, axis = (np.cos(tilt / 2), np.sin(tilt / 2), 0, 0), np.array([0, -np.sin(tilt), np.cos(tilt)])
    at = (0, 0, 0.05 + 0.15 * np.cos(tilt))
    top = world.add_capsule(0.05, 0.3, position=at, orientation=turn, angular_velocity=200 * axis, **surface)
    rotor = world.add_cylinder(
        0.1, 0.4, position=(2, 0, 0.2), angular_velocity=(0, 0, 300), restitution=0.5, friction=0.5
    )
    for _ in range(60):
        world.advance(STEP, 5)
        lowest = top.position[2] - 0.15 * abs(axis_of(world, top)[2]) - 0.05
        assert min(lowest, rotor.position[2] - 0.2) > -0.01


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("restitution", [0.0, 0.5, 0.8, 1.0])
def test_nothing_changes_the_spin_of_a_smooth_capsule_about_its_axis(restitution, ground):
    rng = np.random.default_rng(1)
    for _ in range(12):
        assert change_of_spin(ground, restitution, rng) == pytest.approx(0.0, abs=1e-8)


def angular_momentum(world, bodies, moments):
    total = np.zeros(3)
    for body in bodies:
        i, q = body.index, world.orientation[body.index]
        axes = np.array([turned(tuple(q), tuple(e)) for e in np.eye(3)]).T
        total += np.cross(world.position[i], world.velocity[i]) + axes @ (
            moments * (axes.T @ world.angular_velocity[i])
        )
    return total


@pytest.mark.parametrize("restitution", [0.8, 1.0])
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_sticks_that_hit_each_other_keep_momentum_and_angular_momentum(friction, restitution):
    rng, size = np.random.default_rng(2), np.array([0.1, 0.2, 1.0])
    moments = (size @ size - size**2) / 12
    for _ in range(8):
        world = World(gravity=(0, 0, 0))
        options = {"mass": 1.0, "restitution": restitution, "friction": friction}
        bodies = [
            world.add_box(size, position=(x, 0.1 * x, 0), velocity=(-2 * x, 0, 0), **random_turn(rng), **options)
            for x in (-1, 1)
        ]
        before, energy = angular_momentum(world, bodies, moments), world.energy().total
        world.advance(STEP, 60)
        assert angular_momentum(world, bodies, moments) == pytest.approx(before, abs=1e-12)
        assert world.velocity.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-13)
        assert world.energy().total <= energy * (1 + 1e-12)


def test_a_row_without_weight_that_strikes_a_wall_bounces_no_more_once_it_is_at_rest():
    """Bounces that halve a speed for ever made it denormal, and a step take 0.4 s."""
    world, surface = World(gravity=(0, 0, 0)), {"restitution": 0.1, "friction": 0.0}
    world.add_box((1, 4, 4), position=(3, 0, 0), static=True, **surface)
    x = 0.0
    for mass, gap in ((1.05, 0.049), (0.145, 0.0), (4.0, 0.0), (5.5, 0.0), (0.9, 0.0)):
        world.add_sphere(0.1, position=(x, 0, 0), velocity=(3, 0, 0), mass=mass, **surface)
        x -= 0.2 + gap
    world.advance(STEP, 60)
    speeds = abs(world.velocity)
    assert speeds.max() < 0.1
    assert not ((speeds > 0.0) & (speeds < 1e-30)).any()


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize(("restitution", "masses", "speed"), [(0.05, (716, 863), 9.6), (0.2, (428, 10), 5.4)])
@pytest.mark.parametrize("place", [0.0, 0.03])
def test_a_ball_of_grams_keeps_boxes_of_up_to_a_ton_apart(restitution, masses, speed, friction, place):
    """Sweeps pass an impulse on through a ball of a ten-millionth of a mass in as many turns.

    Hit at once, it makes the boxes leave by Newton's rule; hit in turns without end, it takes all of their energy.
    """
    world, surface = World(gravity=(0, 0, 0)), {"restitution": restitution, "friction": friction}
    boxes = [
        world.add_box((0.4, 0.5, 0.5), mass=mass, position=(side / 2, 0, 0), velocity=(-speed * side, 0, 0), **surface)
        for mass, side in zip(masses, (-1, 1), strict=True)
    ]
    world.add_sphere(0.08, mass=1.1e-4, position=(place, 0, 0), **surface)
    momentum, energy = world.momentum(), world.energy().total
    for _ in range(60):
        world.step(STEP)
        assert boxes[1].position[0] - boxes[0].position[0] > 0.4 + 0.16 - 1e-5
        assert world.energy().total <= energy * (1 + 1e-12)
    left = boxes[1].velocity[0] - boxes[0].velocity[0]
    assert left == pytest.approx(0.0 if place else 2 * restitution * speed, abs=1e-4 * speed)
    assert world.momentum() == pytest.approx(momentum, rel=1e-12, abs=1e-9)


def test_what_happens_in_a_tube_does_not_depend_on_others_far_away():
    """Forty tubes have more points that press than are eliminated at once; each is solved as if it were alone."""
    apart = []
    for count in (1, 40):
        world, tubes, surface = World(gravity=(0, 0, 0)), [], {"restitution": 0.05, "friction": 0.5}
        for y in 3.0 * np.arange(count):
            boxes = [
                world.add_box(
                    (0.4, 0.5, 0.5), mass=mass, position=(side / 2, y, 0), velocity=(-9.6 * side, 0, 0), **surface
                )
                for mass, side in ((716, -1), (863, 1))
            ]
            world.add_sphere(0.08, mass=1.1e-4, position=(0, y, 0), **surface)
            tubes.append(boxes)
        world.advance(STEP, 6)
        apart.append([b.position[0] - a.position[0] for a, b in tubes])
    assert apart[1] == pytest.approx(40 * apart[0], abs=1e-9)


def test_elimination_releases_points_that_would_have_to_pull():
    """Three light balls of other sizes between plates that close obliquely: some press, some do not."""
    random = np.random.default_rng(4)
    for _ in range(10):
        world, surface = World(gravity=(0, 0, 0)), {"restitution": 0.1, "friction": 0.3}
        plates = [
            world.add_box((0.4, 1, 1), mass=mass, position=(side * 0.3, 0, 0), velocity=(-side * 5, 0, 0), **surface)
            for side, mass in ((-1, 500.0), (1, 900.0))
        ]
        plates[1].angular_velocity = random.normal(size=3)
        for angle in (0, 2, 4):
            place = (0, 0.3 * np.cos(angle), 0.3 * np.sin(angle))
            world.add_sphere(random.uniform(0.05, 0.08), mass=10 ** random.uniform(-4, -3), position=place, **surface)
        energy, momentum, spin = world.energy().total, world.momentum(), world.angular_momentum()
        for _ in range(20):
            world.step(STEP)
            assert world.energy().total <= energy * (1 + 1e-12)
        assert world.energy().total < 0.5 * energy
        assert world.momentum() == pytest.approx(momentum, abs=1e-9)
        assert world.angular_momentum() == pytest.approx(spin, abs=1e-7)
        assert plates[1].position[0] - plates[0].position[0] > 0.4


@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_jointed_rows_of_boxes_that_hit_each_other_with_their_faces_keep_their_angular_momentum(restitution):
    world = World(gravity=(0, 0, 0))
    options = {"restitution": restitution, "friction": 0.5}
    for x, speed, up in ((0.0, 1.0, 0.0), (0.6, -1.0, 0.1)):
        row = [
            world.add_box(
                (0.18, 0.18, 0.18), position=(x, 0.22 * k + up, up / 2), velocity=(speed, 0, 0), mass=1.0 + k, **options
            )
            for k in range(3)
        ]
        for k in range(2):
            world.add_ball_joint(row[k], row[k + 1], anchor=(x, 0.22 * k + 0.11 + up, up / 2))
    momentum, before = world.angular_momentum(), world.velocity.copy()
    world.advance(STEP, 30)
    assert abs(world.velocity - before).max() > 0.5  # they have hit
    assert world.angular_momentum() == pytest.approx(momentum, abs=1e-12)


@pytest.mark.parametrize(("restitution", "friction"), [(1.0, 0.0), (0.9, 0.2)])
def test_a_symmetric_break_stays_symmetric(restitution, friction):
    world, surface, balls = World(gravity=(0, 0, 0)), {"restitution": restitution, "friction": friction}, {}
    world.add_sphere(0.1, position=(-2, 0, 0), velocity=(5, 0, 0), **surface)
    for row in range(5):
        for k in range(row + 1):
            at = (row * np.sqrt(3) * 0.1000001, (2 * k - row) * 0.1000001, 0)
            balls[row, k] = world.add_sphere(0.1, position=at, **surface).index
    world.advance(STEP, 120)
    for (row, k), ball in balls.items():
        mirrored = world.position[balls[row, row - k]] * (1, -1, 1)
        assert world.position[ball] == pytest.approx(mirrored, abs=1e-12)
    assert np.abs(world.position[min(balls.values()) :]).max() > 1


@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_newtons_rule_holds_for_a_rod_that_slides_as_it_strikes_and_energy_does_not_grow(restitution):
    """With friction that is bounded by the normal impulse alone one of the two is lost: Kane's paradox."""
    surface = {"restitution": restitution, "friction": 0.6}
    for angle in np.linspace(0.1, 1.2, 12):
        for slip in (-8.0, -3.0, 3.0, 8.0):
            world = World(gravity=(0, 0, 0))
            world.add_plane(**surface)
            turn = (np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0)
            lowest = np.array(turned(turn, (0.025, 0.0, -0.5)))
            rod = world.add_box(
                (0.05, 0.05, 1), position=(0, 0, 0.01 - lowest[2]), orientation=turn, velocity=(slip, 0, -1), **surface
            ).index
            energy = world.energy().total
            while world.velocity[rod, 2] == -1.0:
                world.step(1 / 240)
            away = world.velocity[rod] + np.cross(world.angular_velocity[rod], lowest)
            assert away[2] == pytest.approx(restitution, rel=1e-9)
            world.advance(STEP, 30)
            assert world.energy().total <= energy * (1 + 1e-12)


@pytest.mark.parametrize("boxes", [1, 4])
@pytest.mark.parametrize("restitution", [1.0, 0.8, 0.5])
def test_a_ball_that_drops_on_heavy_boxes_at_rest_keeps_the_square_of_e_of_its_energy(boxes, restitution):
    """Taken as falling until the sweeps carry it, a box gave the ball up to 11 % of its energy, or took as much."""
    rng = np.random.default_rng(4)
    for _ in range(4):
        world, height = World(), rng.uniform(0.1, 1.5)
        world.add_plane()
        stack = [world.add_box((1, 1, 0.5), position=(0, 0, 0.25 + 0.5 * k), mass=1e6) for k in range(boxes)]
        world.advance(STEP, 60)
        top = stack[-1].position[2] + 0.35
        ball = world.add_sphere(0.1, position=(0, 0, top + height), mass=1.0, restitution=restitution)
        while ball.velocity[2] <= 0.0:
            world.step(STEP)
        left = 0.5 * ball.velocity[2] ** 2 + 9.81 * (ball.position[2] - top)
        assert left == pytest.approx(restitution**2 * 9.81 * height, rel=0.01)


def test_a_light_box_that_a_heavy_ball_strikes_is_not_hammered_into_the_floor():
    """Contacts that had bounced were ignored for the rest of the step; it sank by 12 cm."""
    world = World()
    world.add_plane(restitution=0.3)
    box = world.add_box((1, 1, 0.4), position=(0, 0, 0.2), mass=10.0, restitution=0.3)
    world.advance(STEP, 30)
    world.add_sphere(0.1, position=(0, 0, 0.52), velocity=(0, 0, -3), mass=100.0, restitution=0.3)
    for _ in range(60):
        world.step(STEP)
        assert box.position[2] > 0.2 - 0.02


@pytest.mark.parametrize("size", [3.0, 10.0])
def test_a_plate_that_bounces_hardly_sinks_into_the_floor(size):
    world = World()
    world.add_plane(restitution=0.5)
    plate = world.add_box((size, size, 0.2), position=(0, 0, 1), restitution=0.5)
    for _ in range(240):
        world.step(STEP)
        assert plate.position[2] > 0.1 - 1e-3
