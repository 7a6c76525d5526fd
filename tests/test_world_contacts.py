"""Contacts that last: stacks, sleep, events, layers, fast bodies, bodies that come and go, and the same bits every time."""

import itertools
import math

import numba
import numpy as np
import pytest
import scipy.spatial.distance

import kickdrift as kd
from kickdrift.scenes import worlds
from kickdrift.world.contact_points import deepest_overlap
from kickdrift.world.contacts.graph_colouring import OVERFLOW
from kickdrift.world.layout import AWAKE
from kickdrift.world.tables import BODY, COLOURS
from kickdrift.world.world import World

G = 9.81
STEP = 1 / 60


def loads(world):
    """Normal forces of contacts, N, by the rows of both bodies."""
    return {
        tuple(sorted((contact.body_a.index, contact.body_b.index))): contact.normal @ contact.force
        for contact in world.contacts
    }


def awake(world):
    return world.tables.array(BODY)[:, AWAKE].astype(bool)


def bits(world):
    state = (world.position, world.orientation, world.velocity, world.angular_velocity)
    return b"".join(np.ascontiguousarray(array).tobytes() for array in state)


def drift(world, before):
    return np.linalg.norm(world.position - before, axis=1)[2:].max()


def test_every_box_of_a_stack_bears_the_weight_of_those_above():
    world = World()
    world.add_plane()
    for k in range(10):
        world.add_box((1, 1, 1), position=(0, 0, k + 0.5), mass=2.0)
    world.advance(STEP, 600)
    borne = {(k + 1, k + 2): 2.0 * G * (10 - k) for k in range(10)}
    assert loads(world) == pytest.approx(borne, rel=1e-3)
    assert deepest_overlap(world.tables) < 0.005
    assert np.abs(world.position[2:, :2]).max() < 2e-3


def test_a_box_at_rest_does_not_creep():
    world = World()
    world.add_plane()
    world.add_box((1, 1, 1), position=(0, 0, 0.5))
    world.advance(STEP, 60)
    before = world.position[2].copy()
    world.advance(STEP, 1200)
    assert np.abs(world.position[2] - before).max() < 1e-12
    assert deepest_overlap(world.tables) < 1e-4


def test_a_pyramid_of_55_stands():
    world = worlds.pyramid(base=10)
    before = world.position.copy()
    deepest = 0.0
    for _ in range(10):
        world.advance(STEP, 60)
        deepest = max(deepest, deepest_overlap(world.tables))
    assert drift(world, before) < 0.01
    assert deepest < 0.005
    assert np.abs(world.velocity).max() < 1e-3


@pytest.mark.parametrize(("density", "most"), [(100, 0.06), (300, 0.18)])
def test_a_pyramid_bears_a_heavy_tip(density, most):
    world = World()
    world.add_plane()
    for row in range(10):
        for k in range(10 - row):
            x = 2 * k - (9 - row)
            world.add_box((2, 2, 2), position=(x, 0, 1 + 2 * row), density=1.0 if row < 9 else density)
    before = world.position.copy()
    world.advance(STEP, 300)
    assert drift(world, before) < most
    assert np.abs(world.velocity).max() < 0.1


@pytest.mark.parametrize(("mass", "sinks"), [(1.0, 0.002), (10.0, 0.005), (100.0, 0.04)])
def test_a_box_bears_a_heavier_one(mass, sinks):
    world = World()
    world.add_plane()
    world.add_box((1, 1, 1), position=(0, 0, 0.5), mass=1.0)
    world.add_box((1, 1, 1), position=(0, 0, 1.5), mass=mass)
    world.advance(STEP, 600)
    assert np.abs(world.position[2:, 2] - [0.5, 1.5]).max() < sinks
    assert deepest_overlap(world.tables) < 0.75 * sinks


def test_shorter_steps_bear_more():
    sunk = []
    for step in (1 / 60, 1 / 240):
        world = World()
        world.add_plane()
        world.add_box((1, 1, 1), position=(0, 0, 0.5), mass=1.0)
        world.advance(step, round(4 / step))
        sunk.append(0.5 - world.position[2, 2])
    assert sunk[1] < sunk[0] / 8  # springs of a frequency of 1/h: as h^2


@pytest.mark.parametrize(("edge", "mass", "step"), [(20.0, 8e6, 1 / 960), (1.0, 1e6, 1 / 240)])
def test_boxes_bear_thousands_of_their_masses_at_short_steps(edge, mass, step):
    world = World()
    world.add_plane()
    supports = (-0.45 * edge, 0.45 * edge) if edge > 2 else (0.0,)
    for x in supports:
        world.add_box((1, 1, 1), position=(x, 0, 0.5))
    top = world.add_box((edge, edge, edge), position=(0, 0, 1 + edge / 2), mass=mass).index
    world.advance(step, round(2 / step))
    assert world.position[top] == pytest.approx([0, 0, 1 + edge / 2], abs=0.02)


def test_the_wave_of_dominoes_is_faster_by_the_root_of_their_size():
    speeds = []
    for scale in (1.0, 4.0):
        size = (0.032 * scale, 0.12 * scale, 0.36 * scale)
        world, step, fallen = worlds.dominoes(count=12, size=size, spacing=0.12 * scale), STEP * math.sqrt(scale), {}
        for count in range(120):
            world.step(step)
            for domino in np.flatnonzero(np.abs(world.orientation[2:, 0]) < math.cos(0.25)):
                fallen.setdefault(int(domino), count * step)
        assert sorted(fallen) == list(range(12))
        speeds.append(0.12 * scale * 6 / (fallen[10] - fallen[4]))
    assert speeds[1] / speeds[0] == pytest.approx(2.0, rel=0.05)
    assert speeds[0] > 0.5 * math.sqrt(G * 0.36)


def test_a_plate_lies_on_more_balls_than_there_are_colours():
    world = World()
    world.add_plane()
    for x in range(-9, 10, 2):
        for y in range(-9, 10, 2):
            world.add_sphere(0.4, position=(x, y, 0.4), mass=1.0)
    plate = world.add_box((22, 22, 1), position=(0, 0, 1.3), mass=100.0).index
    world.advance(STEP, 120)
    first, last = world.tables.array(COLOURS)[OVERFLOW, 1:3]
    assert (
        last - first >= 100 - OVERFLOW
    )  # contacts without a colour; balls that touch the floor take some from the plate
    assert world.position[plate] == pytest.approx([0, 0, 1.3], abs=0.005)
    assert sum(force for pair, force in loads(world).items() if plate in pair) == pytest.approx(100 * G, rel=0.01)
    assert sum(force for pair, force in loads(world).items() if 1 in pair) == pytest.approx(200 * G, rel=0.01)


def test_impacts_on_one_body_from_all_sides_keep_momentum():
    world = World(gravity=(0, 0, 0))
    world.add_box((22, 22, 1), mass=1000.0)
    for x in range(-9, 10, 2):
        for y in range(-9, 10, 2):
            for side in (1, -1):
                world.add_sphere(0.4, position=(x, y, 0.9 * side), mass=1.0, velocity=(0, 0, -side))
    before = world.momentum(), world.angular_momentum()
    world.advance(STEP, 60)
    assert world.momentum() == pytest.approx(before[0], abs=1e-12)
    assert world.angular_momentum() == pytest.approx(before[1], abs=1e-7)
    assert np.abs(world.position[2:, 2]).min() > 0.89


def test_contacts_that_are_used_again_keep_sliding_exact():
    # 2 m at 2 m/s: points are found anew every centimetre, not every step.
    world = World()
    world.add_plane(friction=0.05)
    world.add_box((1, 1, 1), position=(0, 0, 0.5), velocity=(2, 0.5, 0), friction=0.05)
    speed = math.hypot(2, 0.5)
    world.advance(STEP, 120)
    way = world.position[2, :2] @ [2, 0.5] / speed
    assert way == pytest.approx(2 * speed - 0.5 * 0.05 * G * 4, rel=1e-3)
    assert np.abs(world.orientation[2, 1:]).max() < 1e-4


def test_a_sliding_box_tips_where_its_centre_has_passed_the_edge():
    world = World()
    world.add_box((4, 4, 1), position=(-2, 0, -0.5), static=True, friction=0.0)
    world.add_box((1, 1, 1), position=(-1, 0, 0.5), velocity=(0.5, 0, 0), friction=0.0)
    while world.position[2, 0] < 0.2 and abs(world.angular_velocity[2, 1]) < 0.02:
        world.step(STEP)
    # Past the edge, dw/dt = 3/2 g x with x = t / 2.
    assert world.position[2, 0] == pytest.approx(0.5 * math.sqrt(0.02 * 8 / (3 * 9.81)), abs=0.5 * STEP)


def rest(sleeping=True, count=3):
    world = World(sleeping=sleeping)
    world.add_plane()
    for k in range(count):
        world.add_box((1, 1, 1), position=(0, 0, k + 0.5))
    world.advance(STEP, 300)
    return world


def test_a_stack_falls_asleep_and_does_not_move():
    world = rest()
    assert not awake(world)[2:].any()
    assert not world.velocity.any()
    before = bits(world)
    world.advance(STEP, 120)
    assert bits(world) == before
    assert awake(rest(sleeping=False))[2:].all()


@pytest.mark.parametrize("wall", ["plane", "thin wall"])
def test_a_sleeper_that_is_shot_does_not_pass_what_it_slept_beside(wall):
    world = World(gravity=(0, 0, 0), sleeping=True)
    if wall == "plane":
        world.add_plane((1, 0, 0), (0.01, 0, 0))
    else:
        world.add_box((0.02, 4, 4), static=True)
    ball = world.add_sphere(0.1, position=(0.135, 0, 0))
    world.advance(STEP, 60)
    ball.velocity = (-300, 0, 0)
    world.step(STEP)
    assert ball.position[0] == pytest.approx(0.11, abs=2e-3)


@pytest.mark.parametrize("sleeping", [False, True])
def test_a_body_that_becomes_lighter_is_not_thrown_by_what_held_its_weight(sleeping):
    world = World(sleeping=sleeping)
    world.add_plane()
    hull = world.add_hull([(0, 0, 0), (0.3, 0, 0), (0, 0.2, 0), (0.1, 0.1, 0.3), (0.3, 0.3, 0.1)], position=(0, 0, 0.1))
    world.advance(STEP, 120)
    hull.mass = 1e-4 * hull.mass
    for _ in range(5):
        world.step(STEP)
        assert np.abs(world.velocity).max() < 1e-3


def test_what_moves_does_not_fall_asleep():
    world = World(sleeping=True)
    world.add_plane(friction=0.0)
    world.add_box((1, 1, 1), position=(0, 0, 0.5), velocity=(0.2, 0, 0), friction=0.0)
    world.add_box((1, 1, 1), position=(5, 0, 0.5), velocity=(0.01, 0, 0), friction=0.0)
    world.advance(STEP, 300)
    assert awake(world)[2:].tolist() == [True, False]


def test_a_hit_wakes_the_island_and_no_other():
    world = rest()
    far = world.add_box((1, 1, 1), position=(10, 0, 0.5))
    world.advance(STEP, 120)
    assert not awake(world)[2:].any()
    ball = world.add_sphere(0.2, position=(-3, 0, 0.8), velocity=(10, 0, 1), mass=100.0)
    world.advance(STEP, 10)
    assert awake(world)[2:].tolist() == [False, False, False, False, True]
    world.advance(STEP, 10)
    assert awake(world)[[2, 3, 4]].all()
    assert not awake(world)[far.index]
    assert world.position[2, 0] > 0.002
    world.remove(ball)
    world.advance(STEP, 300)
    assert not awake(world)[2:].any()


@pytest.mark.parametrize("prod", ["velocity", "force", "pose"])
def test_what_is_moved_by_hand_wakes(prod):
    world = rest()
    if prod == "velocity":
        world.velocity[4] = (0, 0, 1)
    elif prod == "force":
        world.apply_force(world.bodies.handle(4), (100.0, 0, 0))
    else:
        world.position[4] = (5, 0, 3)
    world.step(STEP)
    assert awake(world)[4]
    world.advance(STEP, 60)
    if prod == "pose":
        assert world.position[4] == pytest.approx([5, 0, 0.5], abs=0.01)


def test_what_is_under_a_sleeper_cannot_be_removed_unnoticed():
    world = rest()
    world.remove(world.bodies.handle(3))  # the middle one of three
    world.advance(STEP, 60)
    assert world.position[4, 2] == pytest.approx(1.5, abs=0.01)
    world.advance(STEP, 120)
    assert not awake(world)[[2, 4]].any()
    world.remove(world.bodies.handle(1))
    world.advance(STEP, 60)
    assert world.position[2, 2] < -1
    assert world.position[4, 2] < -1


@pytest.mark.parametrize("way", ["velocity", "pose"])
def test_a_box_sleeps_on_a_lift_that_rests_and_wakes_when_it_moves(way):
    world = World(sleeping=True)
    lift = world.add_box((3, 3, 0.2), position=(0, 0, -0.1), kinematic=True)
    world.add_box((1, 1, 1), position=(0, 0, 0.5))
    world.advance(STEP, 200)
    assert not awake(world)[1:].any()
    assert not world.velocity.any()
    if way == "velocity":
        world.velocity[lift.index] = (0, 0, 0.5)
        world.advance(STEP, 60)
        world.velocity[lift.index] = 0.0
    else:
        for _ in range(60):
            world.position[lift.index, 2] += 0.5 * STEP
            world.step(STEP)
    assert awake(world)[2]
    assert world.position[2, 2] == pytest.approx(1.0, abs=0.02)
    world.advance(STEP, 200)
    assert not awake(world)[1:].any()
    assert world.position[2, 2] == pytest.approx(1.0, abs=0.005)


def test_what_hangs_on_a_sleeping_trolley_wakes_when_it_moves():
    world = World(sleeping=True)
    trolley = world.add_box((1, 1, 0.2), kinematic=True)
    load = world.add_sphere(0.2, position=(0, 0, -1))
    world.add_hinge(trolley, load, anchor=(0, 0, 0), axis=(0, 1, 0))
    world.advance(STEP, 100)
    assert not awake(world)[1:].any()
    world.velocity[trolley.index] = (1, 0, 0)
    world.advance(STEP, 60)
    assert world.position[trolley.index, 0] == pytest.approx(1.0)
    assert awake(world)[load.index]
    assert np.hypot(world.position[load.index, 0] - 1.0, world.position[load.index, 2]) == pytest.approx(1.0, abs=1e-4)


def heard(world, count):
    events = []
    for step in range(count):
        world.step(STEP)
        events += [(step, e.begins, {e.body_a.index, e.body_b.index}, e.sensor) for e in world.events]
    return events


def test_touching_begins_and_ends_once():
    world = World()
    world.add_plane()
    world.add_box((1, 1, 1), position=(0, 0, 0.6))
    (event,) = heard(world, 60)
    assert event == (pytest.approx(math.sqrt(0.2 / G) / STEP, abs=1.5), True, {1, 2}, False)
    assert [{a.index, b.index} for a, b in world.touching] == [{1, 2}]
    world.velocity[2] = (0, 0, 3)
    events = heard(world, 60)
    assert [event[1:] for event in events] == [(False, {1, 2}, False), (True, {1, 2}, False)]
    assert events[0][0] <= 1
    assert events[1][0] == pytest.approx(2 * 3 / G / STEP, abs=1.5)


@pytest.mark.parametrize("restitution", [0.8, 1.0])
def test_every_bounce_is_an_event(restitution):
    world = World()
    world.add_plane(restitution=restitution)
    world.add_sphere(0.1, position=(0, 0, 1.1), restitution=restitution)
    begins = [step for step, begins, *_ in heard(world, 90) if begins]
    first = math.sqrt(2 / G)
    expected = [first / STEP, first * (1 + 2 * restitution) / STEP]
    assert begins[:2] == pytest.approx(expected, abs=1.5)
    assert len(begins) <= 3


def test_sensors_report_and_let_through():
    world = World(gravity=(0, 0, 0))
    world.add_box((1, 1, 1), static=True, sensor=True)
    world.add_sphere(0.1, position=(-2, 0, 0), velocity=(2, 0, 0))
    events = heard(world, 120)
    assert [(begins, bodies, sensor) for _, begins, bodies, sensor in events] == [
        (True, {1, 2}, True),
        (False, {1, 2}, True),
    ]
    assert [step * STEP for step, *_ in events] == pytest.approx([1.4 / 2, 2.6 / 2], abs=1.5 * STEP)
    assert world.position[2] == pytest.approx([2, 0, 0], abs=1e-12)


def test_layers_say_what_meets():
    world = World()
    world.add_plane(collides_with=(0, 2))
    options = [
        {"layer": 0},
        {"layer": 1},
        {"layer": 2, "collides_with": (0,)},
        {"layer": 2, "collides_with": (1, 2), "static": False},
    ]
    for k, option in enumerate(options):
        world.add_sphere(0.1, position=(k, 0, 0.5), **option)
    world.advance(STEP, 60)
    stays = world.position[2:, 2] > 0
    # The plane is of layer 0: the last ball does not meet it.
    assert stays.tolist() == [True, False, True, False]


STARTS = np.linspace(0.0, 3.3, 12)


def wall_and_ball(position, velocity, restitution=0.0):
    world = World(gravity=(0, 0, 0))
    world.add_box((0.01, 2, 2), position=(5, 0, 0), static=True, restitution=restitution)
    world.add_sphere(0.005, position=position, velocity=velocity, restitution=restitution)
    return world


@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_fast_balls_that_others_turn_aside_do_not_pass_through_each_other(restitution):
    world, rng = World((0, 0, 0)), np.random.default_rng(0)
    surface, side, radius = {"friction": 0.0, "restitution": restitution}, 1.6, 0.03
    for normal in ((1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)):
        world.add_plane(normal, tuple(-0.5 * side * k for k in normal), **surface)
    for x, y in itertools.product((np.arange(9) - 4) * side / 9, repeat=2):
        world.add_sphere(radius, mass=1.0, position=(x, y, 0), velocity=(*rng.normal(0, 7, 2), 0), **surface)
    for _ in range(20):
        world.step(STEP)
        assert scipy.spatial.distance.pdist(world.position[-81:]).min() > 1.75 * radius


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_fast_small_ball_does_not_pass_a_thin_wall(restitution):
    for start in STARTS:
        world = wall_and_ball((-start, 0.3, 0.2), (200, 0, 0), restitution)
        world.advance(STEP, 12)
        assert world.position[2, 0] < 4.991
        assert world.velocity[2, 0] == pytest.approx(-200 * restitution, abs=1e-6)


@pytest.mark.parametrize("add", ["add_sphere", "add_box"])
@pytest.mark.parametrize("gap", [0.01, 0.03, 0.045])
def test_a_body_at_rest_beside_a_thin_wall_does_not_pass_it_when_it_is_shot(add, gap):
    world = World(gravity=(0, 0, 0))
    world.add_box((0.02, 4, 4), static=True)
    body = getattr(world, add)(0.1 if add == "add_sphere" else (0.2, 0.2, 0.2), position=(0.11 + gap, 0, 0))
    world.step(STEP)
    body.velocity = (-100, 0, 0)
    world.step(STEP)
    assert body.position[0] == pytest.approx(0.11, abs=2e-3)


@pytest.mark.parametrize("gap", [0.025, 0.04])
def test_a_fast_ball_that_missed_a_wall_does_not_sink_into_it_slowly(gap):
    world = World(gravity=(0, 0, 0))
    world.add_box((0.02, 40, 40), static=True)
    ball = world.add_sphere(0.1, position=(0.11 + gap, -3, 0), velocity=(0, 300, 0))
    world.step(STEP)
    ball.velocity = (-1, 0, 0)
    world.advance(STEP, 60)
    assert ball.position[0] == pytest.approx(0.11, abs=2e-3)


@pytest.mark.parametrize("angle", [0.0, 0.1, 0.4])
@pytest.mark.parametrize("clearance", [1e-4, 1e-2])
def test_a_fast_ball_that_misses_the_edge_flies_on(angle, clearance):
    velocity = 200 * np.array([math.cos(angle), 0.0, -math.sin(angle)])
    aside = np.array([math.sin(angle), 0.0, math.cos(angle)])
    for start in STARTS:
        # Past the far upper edge of the wall, and behind it below its top.
        position = np.array([5.005, 0, 1]) + (0.005 + clearance) * aside - velocity * (0.03 + start / 200)
        world = wall_and_ball(position, velocity)
        world.advance(STEP, 6)
        assert world.velocity[2] == pytest.approx(velocity, abs=1e-6)
        assert world.position[2] == pytest.approx(position + 0.1 * velocity, abs=1e-6)


def test_a_fast_ball_that_grazes_the_edge_is_deflected():
    for start in STARTS:
        world = wall_and_ball((-start, 0, 1.003), (200, 0, 0))
        world.advance(STEP, 12)
        assert np.linalg.norm(world.velocity[2] - [200, 0, 0]) > 1.0


def test_bodies_come_and_go_while_the_world_runs():
    rng = np.random.default_rng(0)
    world, there = World(), []
    world.add_plane()
    for step in range(240):
        if step % 3 == 0:
            place = (*rng.uniform(-2, 2, 2), 5)
            there.append(world.add_box(rng.uniform(0.3, 1, 3), position=place, orientation=rng.normal(size=4)))
        if step % 5 == 4:
            world.remove(there.pop(rng.integers(len(there))))
        world.step(STEP)
    rows = [body.index for body in there]
    assert len(set(rows)) == len(rows) == 80 - 48
    assert len(world.position) < 2 + 80  # rows are used again
    assert np.isfinite(world.position[rows]).all()
    assert world.position[rows, 2].min() > 0.1
    gone = set(range(2, len(world.position))) - set(rows)
    assert np.isnan(world.position[sorted(gone)]).all()
    assert {a.index for pair in world.touching for a in pair} <= {1, *rows}
    world.advance(STEP, 300)
    assert deepest_overlap(world.tables) < 0.01


def tumble(threads=False):
    """Balls and boxes that fall onto each other."""
    world, rng = World(threads=threads), np.random.default_rng(3)
    world.add_plane()
    for k, place in enumerate(np.stack(np.meshgrid(*[np.arange(4)] * 3), axis=-1).reshape(-1, 3)):
        position = 1.2 * place + (0, 0, 1) + rng.uniform(-0.1, 0.1, 3)
        if k % 2:
            world.add_box((1, 1, 1), position=position, orientation=rng.normal(size=4), restitution=0.3)
        else:
            world.add_sphere(0.5, position=position, restitution=0.3)
    return world


def test_the_same_bits_run_to_run_and_for_any_number_of_threads():
    one, other = tumble(), tumble()
    one.advance(STEP, 60)
    for _ in range(60):
        other.step(STEP)
    assert bits(one) == bits(other)
    before = numba.get_num_threads()
    try:
        for threads in (1, 2):
            numba.set_num_threads(threads)
            world = tumble(threads=True)
            world.advance(STEP, 60)
            assert bits(world) == bits(one)
    finally:
        numba.set_num_threads(before)
    one.position[3, 0] += 1e-15
    other.advance(STEP, 30)
    one.advance(STEP, 30)
    assert bits(one) != bits(other)


@pytest.mark.parametrize("thickness", [0.01, 0.05])
@pytest.mark.parametrize("spin", [0.0, 20.0, 50.0])
def test_small_fast_boxes_that_spin_do_not_pass_through_a_wall(spin, thickness):
    for seed in range(8):
        rng = np.random.default_rng(seed)
        world = World(gravity=(0, 0, 0))
        world.add_box((thickness, 2, 2), position=(5, 0, 0), static=True)
        start = (0, *(0.2 * rng.normal(size=2)))
        turn = {"orientation": rng.normal(size=4), "angular_velocity": spin * rng.normal(size=3)}
        bullet = world.add_box((0.01, 0.01, 0.01), position=start, velocity=(200, 0, 0), **turn)
        world.advance(STEP, 6)
        assert world.position[bullet.index, 0] < 5


@pytest.mark.parametrize("across", [0.0, 200.0, 300.0, 400.0])
@pytest.mark.parametrize(
    "shape", [kd.Box((0.18, 0.27, 0.09)), kd.Cylinder(0.1, 0.12), kd.Cone(0.1, 0.2), kd.Capsule(0.05, 0.2)]
)
def test_what_flies_from_over_one_triangle_to_another_hits_that(shape, across):
    world = World(gravity=(0, 0, 0))
    corners = [(0, -5, -5), (0, 5, -5), (0, 5, 5), (0, -5, 5)]
    world.add_mesh(corners, [(0, 2, 1), (0, 3, 2)])
    bullet = world.add_body(shape, position=(-1.6, 2, 0.5), velocity=(136, -across, 99.5), mass=1.0)
    world.step(STEP)
    assert bullet.position[0] < 0.0
    assert bullet.position[1] == pytest.approx(2 - across / 60, abs=2.0)


@pytest.mark.parametrize("wall", ["box", "triangles"])
@pytest.mark.parametrize(
    "shape", [kd.Capsule(0.02, 0.08), kd.Cylinder(0.07, 0.04), kd.Cylinder(0.07, 0.007), kd.Cone(0.07, 0.14)]
)
def test_what_hits_a_thin_wall_with_its_rim_turns_and_does_not_pass_through(shape, wall):
    passed = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        world = World(gravity=(0, 0, 0))
        surface = {"friction": 0.0, "restitution": rng.choice([0.0, 0.5])}
        if wall == "box":
            world.add_box((0.01, 10, 10), static=True, **surface)
        else:
            corners = [(0, -5, -5), (0, 5, -5), (0, 5, 5), (0, -5, 5)]
            world.add_mesh(corners, [(0, 2, 1), (0, 3, 2)], **surface)
        turn = {"orientation": rng.normal(size=4), "angular_velocity": 10.0 * rng.normal(size=3)}
        velocity = (rng.uniform(50, 150), *rng.uniform(-20, 20, 2))
        bullet = world.add_body(
            shape, position=(-rng.uniform(1, 3), 0, 0), velocity=velocity, mass=1.0, **turn, **surface
        )
        world.advance(STEP, 8)
        passed += [seed] if bullet.position[0] > 0.0 else []
    assert passed == []


def test_forces_of_contacts_are_those_of_statics():
    """Of bodies at rest: weights, friction and all forces of contacts cancel, on joints and in heaps solved directly, too."""
    world, random = kd.World(gravity=(1.0, 0.5, -G)), np.random.default_rng(4)
    assert world.contacts == []
    world.add_plane(friction=0.8)
    world.add_box((1, 1, 1), position=(0, 0, 1), static=True, sensor=True)
    stack = [world.add_box((1, 1, 0.5), position=(0, 0, 0.25 + 0.5 * k), mass=10.0**k, friction=0.8) for k in range(4)]
    feet = [world.add_box((0.3, 0.3, 0.3), position=(3, y, 0.15), mass=1.0, friction=0.8) for y in (-0.4, 0.4)]
    beam = world.add_box((0.3, 1.1, 0.2), position=(3, 0, 0.4), mass=20.0)
    for foot in feet:
        world.add_fixed_joint(foot, beam, anchor=foot.position)
    apart = [
        world.add_box(random.uniform(0.2, 1.0, 3), position=(6 + 2 * k, 0, 0.5), mass=2.0, friction=0.8)
        for k in range(4)
    ]
    world.advance(STEP, 600)
    total = {body.index: body.mass * np.array((1.0, 0.5, -G)) for body in (*stack, *feet, beam, *apart)}
    for contact in world.contacts:
        assert len(contact.points) > 0
        assert contact.normal == pytest.approx((0, 0, 1), abs=1e-6)
        for body, sign in ((contact.body_a, -1.0), (contact.body_b, 1.0)):
            if body.index in total:
                total[body.index] += sign * contact.force
    legs = sum(total.pop(body.index) for body in (*feet, beam))
    assert np.abs([legs, *total.values()]).max() < 1e-5 * 1111 * G


def test_the_force_of_a_sliding_contact_is_on_the_cone_of_friction():
    world = kd.World()
    world.add_plane(friction=0.3)
    world.add_box((0.5, 0.5, 0.5), position=(0, 0, 0.25), mass=2.0, friction=0.3, velocity=(3, -4, 0))
    world.advance(STEP, 20)
    (contact,) = world.contacts
    assert contact.force == pytest.approx(2.0 * G * np.array((-0.18, 0.24, 1.0)), rel=1e-3)
    world.remove(contact.body_b)
    world.add_sphere(0.1)  # in its row
    assert world.contacts == []
    assert len(world.contact_points) == 0


@pytest.mark.parametrize("ground", ["plane", "box"])
def test_points_and_normals_of_contacts_do_not_turn_with_a_ball_that_rolls(ground):
    world = kd.World()
    if ground == "plane":
        world.add_plane(friction=0.5)
    else:
        world.add_box((20, 20, 2), position=(0, 0, -1), static=True, friction=0.5)
    ball = world.add_sphere(
        0.1, position=(0, 0, 0.1), mass=2.0, velocity=(2, 0, 0), angular_velocity=(0, 20, 0), friction=0.5
    )
    world.advance(STEP, 10)
    (contact,) = world.contacts
    up = 1.0 if contact.body_b == ball else -1.0
    assert contact.normal == pytest.approx((0, 0, up), abs=1e-6)
    assert contact.force == pytest.approx((0, 0, 2.0 * G * up), abs=1e-3)
    assert contact.points - ball.position == pytest.approx(np.array([(0, 0, -0.1)]), abs=1e-3)
    world.remove(ball)
    assert world.contacts == []


def test_forces_of_contacts_are_those_of_the_last_substep_whatever_its_length():
    """A step in parts, since a blade turns fast, has shorter substeps; others may be set before forces are read."""
    world = kd.World(substeps=1)
    world.add_plane()
    world.add_box((0.5, 0.5, 0.5), position=(0, 0, 0.25), mass=2.0)
    world.advance(STEP, 60)
    blade = world.add_box((1.0, 0.5, 0.02), position=(5, 0, 0.011), mass=1.0, angular_velocity=(5, 5, 300))
    world.step(STEP)
    assert any(contact.body_b == blade for contact in world.contacts)
    world.substeps = 8
    (resting,) = (contact for contact in world.contacts if contact.body_b != blade)
    assert resting.force[2] == pytest.approx(2.0 * G, rel=0.02)
