"""Steps in which more happens than the search at their start can know: they are repeated, done in parts, or it is said."""

import itertools
import math
import warnings

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.world.step import stepping
from kickdrift.world.step.rollback import roll_back
from kickdrift.world.step.status import BOUNCING_BODY, EXPECTED_HALVINGS, LEFT_BOUNCING, WARNING
from kickdrift.world.tables import LOAD, MOTION, POSE, STEP_STATUS

STEP = 1 / 60
SMOOTH = {"friction": 0.0, "restitution": 1.0}


def walls(world, kind):
    """Add six smooth, elastic walls around a cube of 2 m: thin boxes, planes, or a mesh with two triangles a side."""
    if kind == "mesh":
        corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
        sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        world.add_mesh(corners, [face for a, b, c, d in sides for face in ((a, c, b), (a, d, c))], **SMOOTH)
        return
    for normal in (*np.eye(3), *-np.eye(3)):
        if kind == "planes":
            world.add_plane(normal=normal, point=-normal, **SMOOTH)
        else:
            world.add_box(2.1 - 2.08 * np.abs(normal), position=-1.01 * normal, static=True, **SMOOTH)


def gas(seed, kind, ratio, speed, **settings):
    """Thirty balls in a cube, with masses up to a ratio, and speeds."""
    rng, world, balls = np.random.default_rng(seed), kd.World(gravity=(0, 0, 0), **settings), []
    walls(world, kind)
    while len(balls) < 30:
        radius, at = rng.uniform(0.03, 0.1), rng.uniform(-0.88, 0.88, 3)
        if all(np.linalg.norm(at - ball.position) > radius + 0.11 for ball in balls):
            options = {"velocity": speed / np.sqrt(3) * rng.normal(size=3), "mass": ratio ** rng.uniform()}
            balls.append(world.add_sphere(radius, position=at, **options, **SMOOTH))
    return world, balls


def wedge(ratio, speed=10.0, gap=0.1):
    """A heavy ball that drives a light one into a thin wall."""
    world = kd.World(gravity=(0, 0, 0))
    world.add_box((0.02, 4, 4), position=(0.01, 0, 0), static=True)
    light = world.add_sphere(0.05, position=(-0.05 - gap, 0, 0), mass=1.0 / ratio)
    heavy = world.add_sphere(0.05, position=(-0.2 - gap, 0, 0), mass=1.0)
    heavy.velocity = (speed, 0, 0)
    return world, light, heavy


def squeezed(seed):
    """Four light balls between two heavy ones that close in on them: steps are repeated, and done in parts."""
    rng, world = np.random.default_rng(seed), kd.World(gravity=(0, 0, 0))
    for x in (-1, 3):
        world.add_box((0.1, 6, 6), position=(x, 0, 0), static=True, restitution=0.6)
    for x, speed in ((0.0, 60.0), (2.2, -60.0)):
        world.add_sphere(0.3, mass=1000.0, position=(x, 0, 0), velocity=(speed, 0, 0), restitution=0.6)
    for k in range(4):
        at, velocity = (0.6 + 0.25 * k, *rng.uniform(-0.02, 0.02, 2)), (rng.uniform(-60, 60), 0, 0)
        world.add_sphere(0.05, mass=1.0, position=at, velocity=velocity, restitution=0.6)
    return world


def crushed(seed):
    """Eight light boxes between two heavy ones that close in on them: some impacts have no end."""
    rng, world = np.random.default_rng(seed), kd.World(gravity=(0, 0, 0))
    for x in (-1, 3):
        world.add_box((0.1, 6, 6), position=(x, 0, 0), static=True, restitution=0.6)
    for x, speed in ((0.0, 60.0), (2.2, -60.0)):
        kind = {"orientation": rng.normal(size=4), "velocity": (speed, 0, 0), "restitution": 0.6}
        world.add_box((0.6, 0.6, 0.6), mass=1e6, position=(x, 0, 0), **kind)
    for k in range(8):
        at, velocity = (0.6 + k / 8, *rng.uniform(-0.05, 0.05, 2)), (rng.uniform(-60, 60), 0, 0)
        kind = {"orientation": rng.normal(size=4), "velocity": velocity, "restitution": 0.6}
        world.add_box((0.1, 0.1, 0.1), mass=1.0, position=at, **kind)
    return world


def state(world):
    return [world.tables.array(table).tobytes() for table in (POSE, MOTION, LOAD)]


@pytest.fixture
def counts(monkeypatch):
    """Count attempts that are rolled back, and note the parts that are begun."""
    seen = {"attempts": 0, "parts": []}
    compose = stepping.compose

    def rolled_back(tables):
        seen["attempts"] += 1
        roll_back(tables)

    def composed(spelt, at, step, substeps, part=0):
        if step < 0.99 * STEP:
            seen["parts"].append((part, round(STEP / step), substeps))
        return compose(spelt, at, step, substeps, part)

    monkeypatch.setattr(stepping, "roll_back", rolled_back)
    monkeypatch.setattr(stepping, "compose", composed)
    return seen


@pytest.mark.parametrize(
    ("kind", "seed", "ratio", "speed"),
    [
        ("boxes", 0, 1000.0, 30.0),
        ("boxes", 6, 10.0, 40.0),
        ("mesh", 5, 1000.0, 30.0),
        ("mesh", 8, 3.0, 51.0),
        ("planes", 10, 1000.0, 60.0),
    ],
)
def test_no_ball_of_a_hot_gas_leaves_its_box(kind, seed, ratio, speed):
    world, balls = gas(seed, kind, ratio, speed)
    before = world.energy().total
    world.advance(STEP, 60)
    assert max(np.abs(ball.position).max() for ball in balls) < 1.0
    assert world.energy().total == pytest.approx(before, rel=1e-12)


@pytest.mark.parametrize("ratio", [10.0, 1000.0, 1e8, 1e14])
@pytest.mark.parametrize("speed", [10.0, 30.0])
def test_a_light_ball_between_a_heavy_one_and_a_wall_stops_it(ratio, speed):
    world, light, heavy = wedge(ratio, speed)
    world.advance(STEP, 10)
    assert light.position[0] == pytest.approx(-0.05, abs=1e-5)
    assert heavy.position[0] == pytest.approx(-0.15, abs=0.02)
    assert np.abs(heavy.velocity).max() < 0.02 * speed


def test_a_plate_that_presses_many_light_balls_to_a_wall_stops():
    """Of 98 points of contact, at a ratio of the masses of 1e6; sweeps alone let it come 37 mm too far."""
    world = kd.World(gravity=(0, 0, 0))
    world.add_box((0.2, 8, 8), position=(0.1, 0, 0), static=True)
    for y, z in itertools.product(np.arange(7) * 0.2 - 0.7, repeat=2):
        world.add_sphere(0.05, mass=1e-6, position=(-0.06, y, z))
    plate = world.add_box((0.2, 8, 8), mass=1.0, position=(-0.25, 0, 0), velocity=(10, 0, 0))
    world.advance(STEP, 10)
    assert plate.position[0] == pytest.approx(-0.2, abs=1e-4)
    assert np.abs(plate.velocity).max() < 1e-6


def leave_impacts(tables, body):
    """Note what the stage of bounces notes if it leaves impacts, as it did in one of 600 crushed stacks."""
    row = tables.row(STEP_STATUS, 0)
    row[WARNING] |= LEFT_BOUNCING
    row[BOUNCING_BODY] = body


def test_impacts_that_have_no_end_are_said_once():
    world = crushed(13)
    leave_impacts(world.tables, 4)
    with pytest.warns(
        kd.UnsolvedWarning, match="body 4 and what it touches .*not all of these impacts were resolved"
    ) as said:
        world.advance(STEP, 2)
    assert len(said) == 1


def test_impacts_left_in_an_attempt_that_is_done_again_are_not_said(monkeypatch):
    world, attempts = crushed(13), []

    def rolled_back(tables):
        attempts.append(tables)
        leave_impacts(tables, 4)
        roll_back(tables)

    monkeypatch.setattr(stepping, "roll_back", rolled_back)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world.step(STEP)
    assert attempts


def test_what_is_so_fast_that_it_may_have_passed_is_said_once():
    world, _ = gas(1, "boxes", 2.0, 1e6)
    with pytest.warns(kd.UnsolvedWarning, match="may have passed through") as said:
        world.advance(STEP, 2)
    assert len(said) == 1


def test_a_step_is_halved_until_it_knows_what_it_meets(counts):
    world, _ = gas(0, "boxes", 1000.0, 60.0)
    world.advance(STEP, 20)
    assert {parts for _, parts, _ in counts["parts"]} >= {2, 4}
    assert all(substeps == max(4 // parts, 1) for _, parts, substeps in counts["parts"])
    assert (world.substeps, world.n_steps, world.time) == (4, 20, pytest.approx(20 * STEP))


def test_a_step_begins_with_parts_four_times_as_long_as_the_shortest_of_the_step_before(counts):
    world, _ = gas(1, "boxes", 1000.0, 60.0)  # one in six of such gases warns that a body was struck too often
    shortest, begun_in_parts = 0, 0
    for _ in range(60):
        counts["parts"] = []
        world.step(STEP)
        longest = int(math.log2(counts["parts"][0][1])) if counts["parts"] else 0
        assert longest == max(shortest - 2, 0) or (shortest <= 2 and longest == 1)
        begun_in_parts += longest > 1
        shortest = max((int(math.log2(parts)) for _, parts, _ in counts["parts"]), default=0)
    assert begun_in_parts > 0


def test_forces_are_asked_twice_a_substep_and_once_before_in_every_attempt(counts, capfd):
    def push(t, force):
        print("asked", t)

    world, _ = gas(0, "boxes", 1000.0, 60.0)
    start = world.snapshot()
    world.advance(STEP, 15)
    world.restore(start)  # with the room in its tables that it will need: a stage without is run again
    world.add_force(push)
    again, halved = 0, 0
    for n in range(15):
        counts["attempts"], counts["parts"] = 0, []
        begins_in_parts = world.tables.row(STEP_STATUS, 0)[EXPECTED_HALVINGS] > 0
        capfd.readouterr()
        world.step(STEP)
        times = [float(line.split()[1]) for line in capfd.readouterr().out.splitlines() if line.startswith("asked")]
        in_parts = sum(1 + 2 * substeps for _, _, substeps in counts["parts"])
        if counts["parts"]:
            # of up to three attempts at the whole step
            assert len(times) - in_parts in ((0,) if begins_in_parts else (9, 18, 27))
        else:
            assert len(times) == 9 * (counts["attempts"] + 1)
        again, halved = again + counts["attempts"], halved + bool(counts["parts"])
        assert min(times) == pytest.approx(n * STEP, abs=1e-12)
        assert max(times) == pytest.approx((n + 1) * STEP, abs=1e-12)
    assert again > halved > 2


def test_loads_act_on_the_whole_of_a_step_that_is_done_in_parts(counts):
    world, _ = gas(0, "boxes", 1000.0, 60.0)
    free = world.add_sphere(0.1, position=(50, 0, 0), mass=2.0)
    for n in range(1, 21):
        world.apply_force(free, (0, 6.0, 0))
        world.step(STEP)
        assert free.velocity[1] == pytest.approx(n * 3.0 * STEP, rel=1e-12)
    assert counts["parts"]
    world.step(STEP)
    assert free.velocity[1] == pytest.approx(20 * 3.0 * STEP, rel=1e-12)


@pytest.mark.parametrize(("share", "breaks"), [(1.1, False), (0.9, True)])
def test_joints_bear_the_mean_over_a_step_that_is_done_in_parts_and_break_under_it(share, breaks, counts):
    """An impulse in one of the parts is not a larger force than in a whole step."""
    forces, limit = [], np.inf
    for world in (kd.World(gravity=(0, 0, 0)), squeezed(7), squeezed(7)):
        rod = world.add_box((0.1, 0.1, 1.0), position=(0, 50, -0.5), mass=1.0)
        hinge = world.add_hinge(None, rod, anchor=(0, 50, 0), axis=(0, 1, 0), breaking_force=limit)
        world.add_sphere(0.1, mass=1.0, position=(0.2, 50, -0.05), velocity=(-20, 0, 0))
        world.step(STEP)
        if limit == np.inf:
            forces.append(hinge.force[0])
        if counts["parts"]:
            limit = share * abs(forces[0])
    assert abs(forces[0]) > 1000.0
    assert forces[1] == pytest.approx(forces[0], rel=1e-6)
    assert (world.broken == [hinge]) == breaks


def test_a_rotor_too_fast_is_told_the_same_substeps_in_a_step_that_is_done_in_parts(counts):
    said = []
    for world in (kd.World(gravity=(0, 0, 0)), squeezed(7)):
        world.substeps = 1
        rotor = world.add_box((0.4, 0.2, 0.1), position=(0.5, 50, 0), mass=2.0, velocity=(0, 300, 0), name="rotor")
        rotor.angular_velocity = (0, 0, 600)
        world.add_hinge(None, rotor, anchor=(0, 50, 0), axis=(0, 0, 1))
        with pytest.warns(kd.UnsolvedWarning, match="'rotor', turns by 10 rad in a substep") as warned:
            world.step(STEP)
        said.append([str(warning.message).split("Set ")[1] for warning in warned if "rotor" in str(warning.message)])
    assert counts["parts"]
    assert said[0] == said[1] == ["world.substeps = 20, or use a step of 0.00083 s."]


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_a_step_in_parts_that_fails_leaves_the_world_where_it_began(counts, error, monkeypatch):
    world, _ = gas(0, "boxes", 1000.0, 60.0)
    free = world.add_sphere(0.1, position=(50, 0, 0), mass=2.0)
    while not counts["parts"]:
        before = world.snapshot()
        world.apply_force(free, (0, 6.0, 0))
        world.step(STEP)
    after = state(world)
    world.restore(before)
    world.apply_force(free, (0, 6.0, 0))
    began, steps, time, compose = state(world), world.n_steps, world.time, stepping.compose

    def breaking(spelt, at, step, substeps, part=0):
        if part == 1:
            raise error
        return compose(spelt, at, step, substeps, part)

    with monkeypatch.context() as patched:
        patched.setattr(stepping, "compose", breaking)
        with pytest.raises(error):
            world.step(STEP)
    assert (world.n_steps, world.time) == (steps, time)
    assert state(world) == began
    assert not world.tables.array(STEP_STATUS)[0, :4].any()
    world.step(STEP)
    assert state(world) == after


def test_a_hot_gas_is_the_same_for_any_number_of_threads_and_after_a_restart(counts):
    ends = []
    for settings in ({}, {"threads": True}):
        world, _ = gas(2, "boxes", 100.0, 50.0, **settings)
        world.advance(STEP, 20)
        ends.append(state(world))
    world, _ = gas(2, "boxes", 100.0, 50.0)
    world.advance(STEP, 10)
    other = kd.World()
    other.restore(world.snapshot())
    other.advance(STEP, 10)
    assert counts["parts"]
    assert ends[0] == ends[1] == state(other)


def test_worlds_without_fast_bodies_know_nothing_of_parts(counts):
    world = kd.World()
    world.add_plane()
    for k in range(5):
        world.add_box((1, 1, 1), position=(0, 0, k + 0.6), restitution=0.3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world.advance(STEP, 60)
    assert not counts["parts"]
