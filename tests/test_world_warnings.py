"""What the solver cannot do is said once, with what would help; all else is silent (pytest makes an error of a warning)."""

import itertools
import re
import warnings

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.scenes import worlds

STEP = 1 / 60
WEIGHTLESS, UP = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def rotor(rate, off, gravity=WEIGHTLESS, motor=None, **settings):
    world = kd.World(gravity, **settings)
    body = world.add_box(
        (0.4, 0.2, 0.1),
        position=(off, 0, 0),
        mass=2.0,
        velocity=(0, rate * off, 0),
        angular_velocity=(0, 0, rate),
        name="rotor",
    )
    world.add_hinge(None, body, anchor=(0, 0, 0), axis=UP, motor=motor)
    return world


def tower(count):
    world = kd.World()
    world.add_plane()
    for k in range(count):
        world.add_box((1, 1, 1), position=(0, 0, k + 0.5))
    return world


@pytest.mark.parametrize("rate", [200.0, 260.0, 300.0, 600.0])
def test_a_rotor_that_turns_too_far_is_named_and_the_substeps_said_keep_its_energy(rate):
    world = rotor(rate, 0.5)
    start = world.energy().total
    with pytest.warns(kd.UnsolvedWarning, match="'rotor', turns by") as said:
        world.advance(STEP, 300)
    assert len(said) == 1
    assert said[0].filename == __file__
    assert world.energy().total < 0.99 * start
    substeps = int(re.search(r"world\.substeps = (\d+)", str(said[0].message)).group(1))
    world = rotor(rate, 0.5, substeps=substeps)
    world.advance(STEP, 300)
    assert world.energy().total == pytest.approx(start, rel=0.01)


@pytest.mark.parametrize("rate", [300.0, 295.6, 277.0, 263.0])
def test_the_step_said_keeps_the_energy_too(rate):
    with pytest.warns(kd.UnsolvedWarning) as said:
        rotor(rate, 0.5).step(STEP)
    step = float(re.search(r"a step of ([0-9.]+) s", str(said[0].message)).group(1))
    world = rotor(rate, 0.5)
    start = world.energy().total
    world.advance(step, round(5 / step))
    assert world.energy().total == pytest.approx(start, rel=0.01)


@pytest.mark.parametrize(("rate", "off"), [(300.0, 0.0), (1000.0, 0.0), (150.0, 0.5), (300.0, 0.1)])
@pytest.mark.parametrize("gravity", [WEIGHTLESS, (0, -9.81, 0)])
def test_rotors_that_keep_their_energy_are_silent(rate, off, gravity):
    rotor(rate, off, gravity).advance(STEP, 120)


@pytest.mark.parametrize("maximum", [2.0, 200.0])
@pytest.mark.parametrize(("start", "end"), [(0.0, 300.0), (300.0, 0.0), (300.0, -300.0)])
def test_motors_that_speed_up_and_brake_are_silent(start, end, maximum):
    rotor(start, 0.0, motor=kd.Motor(end, maximum)).advance(STEP, 120)


def test_torques_and_damping_are_no_loss():
    world = kd.World(WEIGHTLESS)
    body = world.add_box((0.4, 0.2, 0.1), mass=2.0, angular_velocity=(0, 0, 300), angular_damping=5.0)
    world.add_hinge(None, body, anchor=(0, 0, 0), axis=UP)
    for _ in range(60):
        world.apply_torque(body, (0, 0, -3))
        world.step(STEP)
    assert abs(world.angular_velocity[body.index, 2]) < 100


def test_a_motor_that_drives_a_rotor_too_fast_is_said():
    with pytest.warns(kd.UnsolvedWarning, match="'rotor', turns by"):
        rotor(0.0, 0.5, motor=kd.Motor(260.0, 200.0)).advance(STEP, 120)


def test_loops_that_are_stretched_taut_lose_energy_and_it_is_said():
    """Rods that stand zigzag between two walls 3 % closer to each other than all of them are long, and fall."""
    world, before = kd.World(), None
    run, rise = 0.5 * 0.97, 0.5 * np.sqrt(1 - 0.97**2)
    for k in range(6):
        start, up = np.array([run * k, 0, rise * (k % 2)]), 1 - 2 * (k % 2)
        turn = -up * np.arctan2(rise, run) / 2
        rod = world.add_box(
            (0.5, 0.05, 0.05),
            position=start + np.array([run / 2, 0, up * rise / 2]),
            orientation=(np.cos(turn), 0, np.sin(turn), 0),
            mass=1.0,
            collides_with=(),
        )
        world.add_hinge(before, rod, anchor=start, axis=(0, 1, 0))
        before = rod
    world.add_hinge(before, None, anchor=(6 * run, 0, 0), axis=(0, 1, 0))
    with pytest.warns(kd.UnsolvedWarning, match="move too far in a substep for impulses that satisfy them") as said:
        world.advance(STEP, 120)
    assert len(said) == 1


def test_nets_whose_joints_are_solved_in_turn_lose_energy_and_it_is_said():
    world = worlds.joint_grid(size=10)
    with pytest.warns(kd.UnsolvedWarning, match="too many loops to be solved together: they lost 1 %") as said:
        world.advance(STEP, 150)
    assert len(said) == 1
    assert "solve-in-turn" in str(world.word)


def test_energy_that_nets_lose_on_the_ground_is_not_judged():
    world = kd.World()
    world.add_plane(normal=(0, 0, 1))
    balls = {}
    for i, k in itertools.product(range(10), repeat=2):
        balls[i, k] = ball = world.add_sphere(0.4, position=(i, k, 0.4), velocity=(i % 3, k % 3, 0))
        for other in ((i - 1, k), (i, k - 1)):
            if other in balls:
                anchor = (world.position[balls[other].index] + world.position[ball.index]) / 2
                world.add_ball_joint(balls[other], ball, anchor=anchor)
    assert "solve-in-turn" in str(world.word)
    before = world.energy().total
    world.advance(STEP, 60)
    assert world.energy().total < 0.9 * before


@pytest.mark.parametrize("change", [0.0, 1e-3])
def test_a_chain_that_slowly_loses_energy_is_found_also_where_steps_vary_in_length(change):
    world, rng, before = kd.World(substeps=1), np.random.default_rng(22), None
    for k in range(4):
        rod = world.add_box((0.5, 0.05, 0.05), position=(0.25 + 0.5 * k, 0, 0), density=10 ** rng.uniform(2, 4))
        world.add_hinge(before, rod, anchor=(0.5 * k, 0, 0), axis=(0, 1, 0))
        before = rod
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        for n in range(165):
            world.step(STEP * (1 + change * (-1) ** n))
    assert len(said) == 1
    assert re.search(r"lost 1 % of the energy of their bodies from t=0\.016\d* s to 2\.[34]\d* s", str(said[0].message))


def test_a_tower_too_high_for_the_sweeps_is_said():
    world = tower(70)
    with pytest.warns(
        kd.UnsolvedWarning, match=r"left unsolved since t=.*world\.residual measures.*world\.substeps = 8"
    ) as said:
        world.advance(STEP, 500)
    assert len(said) == 1
    assert world.residual > 0.001


def test_a_tower_that_is_solved_is_silent():
    world = tower(40)
    world.advance(STEP, 500)
    assert world.residual < 1e-5


def test_a_warning_is_said_once_a_world_also_after_it_went_back():
    world = rotor(300.0, 0.5)
    before = world.snapshot()
    with pytest.warns(kd.UnsolvedWarning):
        world.step(STEP)
    world.restore(before)
    world.advance(STEP, 2)
    with pytest.warns(kd.UnsolvedWarning):
        rotor(300.0, 0.5).step(STEP)


def test_a_warning_made_an_error_leaves_the_step_done():
    world = rotor(300.0, 0.5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(kd.UnsolvedWarning):
            world.advance(STEP, 3)
    assert world.n_steps == 3
    assert world.time == pytest.approx(3 * STEP)


def test_recordings_keep_and_report_what_is_left():
    world = tower(3)
    world.velocity[2:, 0] = 1.0
    recording = world.run(0.5, STEP)
    residual = recording.derived["residual"]
    assert residual.shape == recording.t.shape
    assert residual[-1] == world.residual
    assert np.isfinite(residual).all()
    largest, last = (f"{1e3 * value:.3g} mm/s" for value in (residual.max(), residual[-1]))
    assert re.search(
        rf"^residual +{re.escape(largest)} at most, {re.escape(last)} at the end$", recording.report(), re.M
    )


def loaded_bridge(mass, substeps, beside=0):
    """A hanging bridge of 20 planks of 1 kg on hinges, 0.3 m long, and a ball that lies on it; boxes that rest beside it."""
    world, before, x, z, planks = kd.World(substeps=substeps), None, 0.0, 3.0, []
    world.add_plane()
    for k in range(beside):
        world.add_box((1, 1, 1), position=(20.0 + 2 * k, 0, 0.5))
    for angle in np.linspace(0.3, -0.3, 20):
        way = 0.3 * np.array([np.cos(angle), 0.0, -np.sin(angle)])
        plank = world.add_box(
            (0.27, 0.4, 0.05), position=(x + way[0] / 2, 0, z + way[2] / 2), mass=1.0, friction=0.5,
            orientation=(np.cos(angle / 2), 0, np.sin(angle / 2), 0),
        )  # fmt: skip
        world.add_hinge(before, plank, anchor=(x, 0, z), axis=(0, 1, 0))
        planks.append(plank)
        before, x, z = plank, x + way[0], z + way[2]
    world.add_hinge(before, None, anchor=(x, 0, z), axis=(0, 1, 0))
    above = planks[8].position + np.array([0, 0, 0.33])
    return world, world.add_sphere(0.3, position=above, mass=mass, friction=0.5)


@pytest.mark.parametrize("beside", [0, 5])
def test_a_ball_that_is_too_heavy_for_its_bridge_is_reported(beside):
    world, _ = loaded_bridge(150.0, 4, beside)
    with pytest.warns(
        kd.UnsolvedWarning, match=r"contacts of body \d+ .*no solution together since t=0\..*world.substeps = 8"
    ):
        world.advance(STEP, 120)


def test_a_ball_that_a_bridge_bears_is_not_reported():
    world, ball = loaded_bridge(150.0, 8)
    world.advance(STEP, 240)
    assert ball.position[2] > 2.7
