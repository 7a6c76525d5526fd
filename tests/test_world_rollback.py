"""Steps that are done again: an attempt that is rolled back leaves no trace, and what users see happens once."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.world.collision.predicted_motion import TURN_ERROR
from kickdrift.world.contacts.residual import measure_residual
from kickdrift.world.joints.layout import BRAKE
from kickdrift.world.joints.limits_motors_options import Motor
from kickdrift.world.step import stepping
from kickdrift.world.step.rollback import roll_back
from kickdrift.world.step.stage_loop import run
from kickdrift.world.step.status import DO_IN_PARTS, LEFT_BOUNCING, STATUS, TURNS_TOO_FAST, WARNING
from kickdrift.world.tables import EVENTS, INVERSE_MASS, JOINT_NUMBERS, MOTION, PARTICLE, POSE, PREDICTED, STEP_STATUS

STEP = 1 / 60
Y = (0, 1, 0)


def tumbling(world):
    rng = np.random.default_rng(3)
    world.add_plane(friction=0.5)
    for k in range(6):
        turn = rng.normal(size=4) * ((1, 0, 1, 0) if world.planar else 1)
        options = {"position": (0.6 * k, 0, 1 + 0.3 * k), "restitution": 0.5 * (k % 2)}
        world.add_box((0.2, 0.3, 0.5), orientation=turn / np.linalg.norm(turn), **options)
    world.add_sphere(0.1, position=(4, 0, 1), restitution=0.8)


def jointed(world):
    """A whirling chain that carries far more than it weighs, and has to be braked; a motor, limits and friction."""
    tumbling(world)
    body = None
    for k in range(11):
        body, before = world.add_box((0.05, 0.05, 0.3) if k < 10 else (0.5,) * 3, position=(0.3 * k, 3, 8)), body
        body.mass = 1.0 if k < 10 else 2000.0
        world.add_hinge(before, body, anchor=(0.3 * k - 0.15, 3, 8), axis=Y)
    arm = world.add_box((0.2, 0.1, 1), position=(0, -3, 3))
    world.add_hinge(None, arm, anchor=(0, -3, 3.5), axis=Y, motor=Motor(3, 50))
    hand = world.add_box((0.2, 0.1, 1), position=(0, -3, 2), angular_velocity=(0, 20, 0))
    world.add_hinge(arm, hand, anchor=(0, -3, 2.5), axis=Y, friction=2.0, limits=(-1, 1))


def draped(world, height=1.25):
    tumbling(world)
    cloth = world.add_cloth_grid((1.5, 1.5), (10, 10), position=(0, 0, height))
    cloth.pin(99, world.add_box((0.1, 0.1, 0.1), position=(0.75, 0.75, height), mass=0.05))


def draped_lower(world):
    draped(world, 1.2)


RE_FOUND = pytest.param(
    draped_lower,
    {},
    marks=pytest.mark.xfail(
        reason="a contact found again in an attempt keeps its new points; 1 of 15 such scenes", strict=False
    ),
)


def pushed(world):
    tumbling(world)

    def wind(velocity, force, torque):
        for body in range(len(force)):
            for k in range(3):
                force[body, k] -= 0.1 * velocity[body, k]
                torque[body, k] += 0.01

    world.add_force(wind)


def state(world):
    return [world.tables.array(table).tobytes() for table in (POSE, MOTION, JOINT_NUMBERS, PARTICLE, EVENTS)]


def attempt(world):
    """Do the stages of a step up to where one may ask for it to be done again, and roll them back."""
    stage, status = 0, world.tables.row(STEP_STATUS, 0)
    while True:
        program, word = world._ready(STEP), world.word
        end = len(program.addresses) - len(word.after) + word.after.index(measure_residual) + 1
        cut = (numbers[:end] for numbers in program[:3])
        _, stage = run(*cut, program.begin, end, world.time, STEP, 0, 1, stage, world.tables.address)
        asked = int(status[STATUS])
        if asked == 0:
            break
        stage = world._help(STEP, stage)
        if asked == DO_IN_PARTS:
            return
    roll_back(world.tables)


@pytest.mark.parametrize(
    ("fill", "settings"),
    [
        (tumbling, {}),
        (tumbling, {"sleeping": True}),
        (tumbling, {"plane_normal": Y}),
        (jointed, {}),
        (jointed, {"plane_normal": Y}),
        (draped, {}),
        RE_FOUND,
        (pushed, {}),
    ],
)
@pytest.mark.filterwarnings("ignore::kickdrift.UnsolvedWarning")  # the chain is whipped
def test_an_attempt_that_is_rolled_back_leaves_no_trace(fill, settings):
    world, other, braked = kd.World(**settings), kd.World(**settings), False
    fill(world)
    fill(other)
    for _ in range(80):
        attempt(other)
        world.step(STEP)
        other.step(STEP)
        assert state(other) == state(world)
        braked = braked or bool(world.tables.array(JOINT_NUMBERS)[:, BRAKE : BRAKE + 3].any())
    assert braked == (fill is jointed)


def test_warnings_of_an_attempt_go_with_it_and_those_of_earlier_steps_stay():
    world = kd.World()
    tumbling(world)
    status = world.tables.row(STEP_STATUS, 0)
    status[WARNING] = TURNS_TOO_FAST
    attempt(world)
    status[WARNING] |= LEFT_BOUNCING
    roll_back(world.tables)
    assert status[WARNING] == TURNS_TOO_FAST


@pytest.mark.filterwarnings("ignore::kickdrift.UnsolvedWarning")
def test_a_braked_chain_in_a_file_goes_on_with_the_same_bits(tmp_path):
    world = kd.World()
    jointed(world)
    while not world.tables.array(JOINT_NUMBERS)[:, BRAKE : BRAKE + 3].any():
        world.step(STEP)
        assert world.time < 5.0
    again = kd.load_world(world.save(tmp_path / "world.npz"))
    for one in (world, again):
        one.advance(STEP, 3)
    assert state(world) == state(again)


def boxed(speed, **settings):
    """A heavy ball that strikes light ones at a speed, between walls."""
    world = kd.World((0, 0, 0), **settings)
    for x in (-1.02, 1.02):
        world.add_box((0.04, 3, 3), position=(x, 0, 0), static=True, restitution=1.0, friction=0.0)
    for k in range(3):
        world.add_sphere(0.1, position=(0.25 * k, 0, 0), mass=1.0, restitution=1.0, friction=0.0)
    world.add_sphere(0.1, position=(-0.7, 0, 0), mass=100.0, velocity=(speed, 0, 0), restitution=1.0, friction=0.0)
    return world


@pytest.fixture
def again(monkeypatch):
    """Count how often steps are done again."""
    times = []

    def counted(tables):
        times.append(1)
        roll_back(tables)

    monkeypatch.setattr(stepping, "roll_back", counted)
    return times


def test_what_users_see_of_a_step_that_is_done_again_happens_once(again):
    world, ends = boxed(40.0), {}
    touched = 0
    with world.record() as recording:
        for _ in range(40):
            world.step(STEP)
            for event in world.events:
                pair = (event.body_a.index, event.body_b.index)
                assert ends.get(pair, False) is not event.begins  # they alternate
                ends[pair] = event.begins
                touched += event.begins
            assert {pair for pair, on in ends.items() if on} == {(a.index, b.index) for a, b in world.touching}
    assert again
    assert touched > 20
    assert len(recording.t) == 41
    assert np.array_equal(recording.x[-1], world.position)
    assert world.energy().total == pytest.approx(80000.0, rel=1e-9)
    assert np.abs(world.position[:, 0]).max() < 1.03


def test_steps_that_are_done_again_are_the_same_for_any_number_of_threads(again):
    worlds = boxed(60.0), boxed(60.0, threads=True)
    for world in worlds:
        world.advance(STEP, 60)
    assert again
    assert state(worlds[0]) == state(worlds[1])


def test_ctrl_c_in_a_step_that_is_done_again_leaves_the_world_where_it_began(again, monkeypatch):
    world, other = boxed(60.0), boxed(60.0)
    while not again:
        before = state(world)
        world.step(STEP)
    steps = world.n_steps - 1
    other.advance(STEP, steps)

    def interrupted(self, step, stage):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(kd.World, "_help", interrupted)
        with pytest.raises(KeyboardInterrupt):
            other.step(STEP)
    assert (other.n_steps, state(other)[:4]) == (steps, before[:4])
    other.step(STEP)
    assert state(other) == state(world)
    world.advance(STEP, 20)
    other.advance(STEP, 20)
    assert state(other) == state(world)


def test_what_a_torque_turns_has_turned_as_far_as_was_expected():
    world = kd.World((0, 0, 0))
    body = world.add_box((0.2, 0.2, 0.2), mass=1.0, restitution=0.5)
    world.apply_torque(body, (0, 0, 10.0))
    world.step(STEP)
    assert body.angular_velocity[2] == pytest.approx(10.0 * STEP * 6.0 / 0.04)
    assert not world.tables.array(PREDICTED)[:, TURN_ERROR].any()


def test_the_inertia_of_a_cube_on_a_joint_stays_what_it_was():
    world = kd.World()
    cube = world.add_box((0.5, 0.5, 0.5), angular_velocity=(3, 2, 1))
    world.add_ball_joint(None, cube, anchor=(0, 0, 1))
    before = world.tables.array(INVERSE_MASS).tobytes()
    world.advance(STEP, 60)
    assert world.tables.array(INVERSE_MASS).tobytes() == before
