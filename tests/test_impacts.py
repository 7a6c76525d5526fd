"""Impacts on surfaces and between bodies, rest, friction, and forces that change their law."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.core.outcomes import Outcome

G = 9.81
VERLET = {"method": "velocity-verlet"}


def _falling(x):
    return np.array([0.0, -9.81])


def test_bouncing_disk_of_games_to_the_digit():
    floor = kd.Impacts(lambda x: x - 0.1, restitution=0.9, located=False)
    sol = kd.solve(lambda x: -9.81, (0, 2.0), 0.1, 5.0, step=0.01, method="semi-implicit-euler", impacts=floor)
    first = int(np.flatnonzero(np.diff(sol.v) > 0)[0]) + 1
    assert first == 101
    assert sol.t[first] == pytest.approx(1.01, abs=1e-14)
    assert sol.v[first - 1] - 0.01 * G == pytest.approx(-4.9081, abs=1e-12)
    assert sol.v[first] == pytest.approx(0.9 * 4.9081, abs=1e-12)
    assert sol.x[first] == pytest.approx(0.1, abs=1e-15)


@pytest.mark.parametrize("step", [0.01, 0.013, 0.3])
@pytest.mark.parametrize("compiles", [True, False])
def test_located_impacts_are_those_of_the_parabolas(step, compiles):
    if not compiles and step < 0.3:
        pytest.skip("is slow")
    floor = kd.Impacts(lambda x: x, restitution=0.9)
    sol = kd.solve(
        lambda x: -9.81, (0, 9.0), 0.0, 5.0, step=step, method="velocity-verlet", impacts=floor, compile=compiles
    )
    times = sol.t[1:][(np.abs(sol.x[1:]) < 1e-12) & (sol.v[1:] > 1e-9)]
    exact = np.cumsum(2 * 5.0 * 0.9 ** np.arange(times.size) / G)
    assert times.size == 20
    assert np.abs(times - exact).max() < 1e-10
    assert sol.x.min() > -1e-12
    parabola = 5.0 * 0.3 - G * 0.3**2 / 2
    assert sol(0.3).x == pytest.approx(parabola, abs=1e-12)


def test_a_ball_comes_to_rest_and_the_run_goes_on():
    floor = kd.Impacts(lambda x: x, restitution=0.5)
    sol = kd.solve(
        lambda x: -9.81, (0, 1e3), 0.0, 5.0, step=0.01, method="velocity-verlet", impacts=floor, save_every=100
    )
    end = 2 * 5.0 / G / (1 - 0.5)
    rests = sol.t > end + 0.02
    assert np.abs(sol.x[rests]).max() < 1e-12
    assert np.abs(sol.v[rests]).max() == 0.0
    assert sol.n_rejected < 2000
    lively = kd.solve(
        lambda x: -9.81, (0, 50.0), 0.0, 5.0, step=0.01, method="velocity-verlet", impacts=lambda x: x, save_every=10
    )
    energy = lively.v**2 / 2 + G * lively.x
    assert np.abs(energy / energy[0] - 1).max() < 1e-10  # and does not rest with e = 1


def test_what_rests_is_lifted_by_a_force():
    def lift(t):
        return -1.0 if t < 2.0 else 1.0

    sol = kd.solve(
        lift, (0, 4.0), 0.0, 0.0, step=0.01, method="velocity-verlet", impacts=kd.Impacts(lambda x: x, restitution=0.0)
    )
    assert np.abs(sol.x[sol.t <= 2.0]).max() < 1e-12
    assert sol.x[-1] == pytest.approx(2.0, abs=0.03)


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.5, 1.5])
def test_friction_in_an_impact_and_in_sliding(friction):
    floor = kd.Impacts(lambda x: x[1], restitution=0.5, friction=friction)
    flight = kd.solve(_falling, (0, 0.6), [0, 1.0], [3.0, 0], step=0.01, method="velocity-verlet", impacts=floor)
    speed = np.sqrt(2 * G)
    after = flight.v[flight.v[:, 1] > 0.1][0]
    assert after[1] == pytest.approx(speed / 2, abs=0.1)  # just after
    assert after[0] == pytest.approx(max(0.0, 3.0 - friction * 1.5 * speed), abs=1e-10)
    slide = kd.solve(_falling, (0, 0.5), [0, 0.0], [3.0, 0], step=0.001, method="velocity-verlet", impacts=floor)
    assert slide.v[-1, 0] == pytest.approx(max(0.0, 3.0 - friction * G * 0.5), abs=1e-9)


def test_billiard_in_a_circle_keeps_energy_and_momentum():
    sol = kd.solve(
        lambda x: 0 * x,
        (0, 200.0),
        [0.3, 0],
        [0.5, 0.77],
        step=0.05,
        method="velocity-verlet",
        impacts=lambda x: 1 - x[0] ** 2 - x[1] ** 2,
    )
    speed, momentum = np.hypot(*sol.v.T), sol.x[:, 0] * sol.v[:, 1] - sol.x[:, 1] * sol.v[:, 0]
    assert sol.n_rejected > 500
    assert np.abs(speed - speed[0]).max() < 1e-12
    assert np.abs(momentum - momentum[0]).max() < 1e-10
    assert (sol.x**2).sum(1).max() < 1 + 1e-11


@pytest.mark.parametrize("restitution", [1.0, 0.6])
def test_spheres_that_meet_head_on(restitution):
    masses = np.array([1.0, 3.0])
    spheres = kd.Impacts(kd.sphere_gaps([0.1, 0.2]), restitution=restitution, mass=masses)
    x0, v0 = np.array([[0.0, 0, 0], [1.0, 0, 0]]), np.array([[1.0, 0, 0], [-0.5, 0, 0]])
    sol = kd.solve(lambda x: 0 * x, (0, 2.0), x0, v0, step=0.07, method="velocity-verlet", impacts=spheres)
    centre = masses @ v0[:, 0] / 4.0
    expected = centre - restitution * (v0[:, 0] - centre)
    assert np.abs(sol.v[-1, :, 0] - expected).max() < 1e-12
    moment = (1.0 - 0.3) / 1.5
    assert sol.t[1:][np.abs(np.diff(sol.v[:, 0, 0])) > 1e-9][0] == pytest.approx(moment, abs=1e-12)


def test_spheres_under_gravity_keep_their_energy():
    x0 = np.array([[0.0, 0, 0], [1.0, 0, 0], [0.4, 1.0, 0.1]])
    masses = np.array([1.0, 2.0, 0.5])
    system = kd.systems.nbody(masses, x0, np.zeros((3, 3)))
    sol = kd.solve(
        system,
        (0, 5.0),
        step=0.002,
        method="blanes-moan-srkn6b",
        impacts=kd.Impacts(kd.sphere_gaps([0.1, 0.1, 0.1]), mass=masses),
    )
    assert sol.success
    assert sol.n_rejected > 20
    assert np.abs(sol.energy / sol.energy[0] - 1).max() < 1e-8
    assert np.abs(sol.invariants["momentum"]).max() < 1e-12
    apart = np.linalg.norm(sol.x[:, 0] - sol.x[:, 1], axis=1)
    assert apart.min() > 0.2 - 1e-9


def test_many_disks_keep_energy_and_momentum():
    random = np.random.default_rng(1)
    x0 = np.stack(np.meshgrid(range(4), range(4)), -1).reshape(-1, 2) + 0.05 * random.normal(size=(16, 2))
    v0 = random.normal(size=(16, 2))
    sol = kd.solve(
        lambda x: 0 * x, (0, 3.0), x0, v0, step=0.02, method="velocity-verlet", impacts=kd.sphere_gaps(np.full(16, 0.3))
    )
    energy, momentum = (sol.v**2).sum((1, 2)), sol.v.sum(1)
    assert np.abs(energy / energy[0] - 1).max() < 1e-11
    assert np.abs(momentum - momentum[0]).max() < 1e-11


def test_newtons_cradle_passes_the_momentum_on():
    x0 = np.array([[-1.0, 0], [0.0, 0], [0.2, 0], [0.4, 0]])
    v0 = np.array([[1.0, 0], [0, 0], [0, 0], [0, 0]])
    sol = kd.solve(
        lambda x: 0 * x, (0, 2.0), x0, v0, step=0.05, method="velocity-verlet", impacts=kd.sphere_gaps([0.1] * 4)
    )
    assert np.abs(sol.v[-1] - v0[::-1]).max() < 1e-12


def test_a_moving_wall_gives_twice_its_speed():
    wall = kd.Impacts(lambda t, x: x - 0.5 * t)
    sol = kd.solve(lambda x: 0.0, (0, 3.0), 1.0, -1.0, step=0.1, method="velocity-verlet", impacts=wall)
    assert sol.v[-1] == pytest.approx(2.0, abs=1e-10)


@pytest.mark.parametrize("method", ["velocity-verlet", "blanes-moan-srkn6b", "kahan-li-8"])
def test_methods_keep_their_order_across_switches(method):
    def spring(x, params):
        return (-2.5 - 1.5 * params[0]) * x - 1.0 - params[0]

    def blind(x):
        return np.where(x > 0, -4.0 * x - 2.0, -x)

    def errors(force, **switches):
        found = []
        for step in (0.1, 0.05):
            sol = kd.solve(force, (0, 20.0), 1.0, 0.0, step=step, method=method, **switches)
            found.append(abs(sol.x[-1] - exact))
        return found

    down = np.arccos(1 / 3) / 2  # from the top to zero
    left = 20.0 % (2 * down + np.pi)
    assert down < left < down + np.pi
    exact = -np.sqrt(8) * np.sin(left - down)
    order = kd.methods.get(method).order
    cut, plain = errors(spring, switches=lambda x: x), errors(blind)
    assert cut[1] < 1e-13 or abs(np.log2(cut[0] / cut[1]) - order) < 0.35
    if order > 2:
        assert plain[1] > 100 * cut[1]


def test_a_run_backwards_is_the_mirror_image_of_one_forwards_across_switches():
    """The force depends on x alone, so that a motion backwards is that of the opposite velocity forwards."""

    def jump(x, params):
        return -x - 2.0 * params[-1]

    options = {"step": 0.1, "method": "blanes-moan-srkn6b", "switches": lambda x: x, "compile": False}
    there = kd.solve(jump, (0.0, 4.0), 1.0, -0.3, **options)
    back = kd.solve(jump, (4.0, 0.0), 1.0, 0.3, **options)
    t = np.linspace(0.0, 4.0, 101)
    assert np.abs(back(4.0 - t).x - there(t).x).max() < 1e-12


@pytest.mark.parametrize("span", [(0.0, 2.0), (2.0, 0.0)])
def test_switches_of_the_time_alone_are_seen_between_rows(span):
    def side(t, x, params):
        return -2.0 * params[-1] + 0.0 * x

    def exact(t):
        return np.where(t < 1.9, t**2, 3.8 * t - 2 * 1.9**2 + 1.9**2 - (t - 1.9) ** 2)

    start = (0.0, 0.0) if span[0] == 0.0 else (exact(2.0), 3.6)
    options = {"step": 0.1, "method": "velocity-verlet", "switches": lambda t: t - 1.9, "compile": False}
    sol, t = kd.solve(side, span, *start, **options), np.linspace(0.0, 2.0, 201)
    assert np.abs(sol.x - exact(sol.t)).max() < 1e-14
    assert np.abs(sol(t).x - exact(t)).max() < 1e-14


def test_first_order_equations_with_switches_have_states_between_rows():
    law = kd.FirstOrder(lambda y, params: np.array([1.0 + 0.0 * y[0], -params[-1] * 2.0]))
    options = {"step": 0.1, "method": "gauss-4", "switches": lambda y: y[0] - 0.013, "compile": False}
    sol = kd.solve(law, (0.0, 2.0), [-1.0, 0.0], t_eval=[0.0, 0.55, 1.55, 2.0], **options)
    np.testing.assert_allclose(sol.x, [[-1.0, 0.0], [-0.45, 1.1], [0.55, 0.952], [1.0, 0.052]], atol=1e-12)


@pytest.mark.parametrize(
    "cut",
    [
        {"switches": lambda x: x},
        {"impacts": lambda x: x + 0.5},
        {"impacts": kd.Impacts(lambda x: x + 0.5, located=False)},
        {"impacts": kd.Impacts(lambda x: x + 0.5, restitution=0.0)},
    ],
)
def test_split_forces_are_those_of_the_law_and_the_place_after_a_cut(cut):
    """With one substep, and with oscillations of the angular frequency 1e-9, both are the method of Verlet."""
    switched = "switches" in cut

    def fast(x, params):
        return -100.0 * x - 30.0 + 5.0 * params[-1] if switched else -100.0 * x - 60.0

    split = kd.Multirate(slow_force=lambda x: -x, fast_force=fast)
    slow = kd.Oscillatory(lambda x, params: -x + fast(x, params), omega=1e-9)
    options = {"t_span": (0.0, 2.0), "x0": 1.0, "v0": 0.0, "step": 0.01, "compile": False, **cut}
    verlet = kd.solve(lambda x, params: -x + fast(x, params), method="velocity-verlet", **options)
    for problem, method in ((split, kd.methods.respa(substeps=1)), (slow, "mollified-impulse")):
        sol = kd.solve(problem, method=method, **options)
        np.testing.assert_allclose(sol.x, verlet.x, atol=1e-11)


def test_masses_are_those_of_the_problem():
    x0, v0 = [[0, 0, 0], [2, 0, 0]], [[0.5, 0, 0], [-1.5, 0, 0]]
    system = kd.systems.nbody([3.0, 1.0], x0, v0, G=1e-9)
    options = {"step": 0.01, "method": "velocity-verlet", "impacts": kd.sphere_gaps([0.5, 0.5])}
    for sol in (
        kd.solve(system, (0, 2.0), **options),
        kd.solve(kd.Newtonian(lambda x: 0 * x, mass=[3.0, 1.0]), (0, 2.0), x0, v0, **options),
    ):
        assert sol.v[-1, :, 0] == pytest.approx([-0.5, 1.5], abs=1e-8)


def test_a_stack_rests_in_whatever_order_its_gaps_are():
    def gap(x):
        return np.array([x[2] - x[1] - 2, x[1] - x[0] - 2, x[0] - 1])

    def turned_gap(x):
        return np.array([x[0] - 1, x[1] - x[0] - 2, x[2] - x[1] - 2])

    for turned in (False, True):
        gaps = turned_gap if turned else gap
        sol = kd.solve(
            lambda x: -9.81 + 0 * x,
            (0, 10.0),
            [1.5, 4.0, 7.0],
            np.zeros(3),
            step=0.02,
            method="velocity-verlet",
            impacts=kd.Impacts(gaps, restitution=0.3),
        )
        assert np.abs(sol.x[-1] - [1, 3, 5]).max() < 1e-9
        assert np.abs(sol.v[-1]).max() < 1e-9


def dry(x, params):
    return -x - 0.2 * params[-1]


def test_dry_friction_keeps_a_block_at_rest():
    """Each half period takes 0.4 of the amplitude; at 0.1 the spring is weaker than friction."""
    options = {"step": 0.05, "method": "blanes-moan-srkn6b", "switches": lambda v: v}
    sol = kd.solve(dry, (0, 25.0), 2.5, 0.0, **options)
    rests = sol.t > 6 * np.pi + 0.1
    assert np.ptp(sol.x[rests]) == 0.0
    assert sol.x[-1] == pytest.approx(0.1, abs=1e-12)
    assert np.abs(sol.v[rests]).max() < 1e-15
    assert sol(22.22).x == sol.x[-1]
    assert sol.n_steps < 520  # of 500, and a few cuts at each turn


@pytest.mark.parametrize(("start", "end"), [(0.3, 0.025), (0.0, 0.0)])
def test_a_body_on_a_slope_comes_to_rest_and_may_begin_so(start, end):
    def slope(x, params):
        return 0.2 - 2.0 * params[0]

    sol = kd.solve(
        slope, (0, 2.0), 0.0, start, step=0.01, method="velocity-verlet", switches=lambda v: v, compile=False
    )
    assert sol.success
    assert [sol.x[-1], sol.v[-1]] == pytest.approx([end, 0.0], abs=1e-12)


def test_a_body_on_a_belt_is_carried_until_the_spring_is_stronger_than_friction():
    """From x = mu on it moves as without a belt, on the other side of the switch."""
    mu, belt, errors = 0.3, 0.5, []
    for step in (0.04, 0.02):
        sol = kd.solve(
            lambda x, params: -x - mu * params[0],
            (0, 3.0),
            0.0,
            belt,
            step=step,
            method="velocity-verlet",
            switches=lambda v: v - belt,
            compile=False,
        )
        carried, free = np.minimum(sol.t, mu / belt), np.maximum(sol.t - mu / belt, 0.0)
        errors.append(np.abs(sol.x - belt * (carried + np.sin(free))).max())
    assert 3.0 < errors[0] / errors[1] < 5.0
    assert errors[1] < 1e-4


@pytest.mark.parametrize("method", ["velocity-verlet", "blanes-moan-srkn6b"])
def test_sliding_along_a_switch_is_of_second_order(method):
    """Along x + v = 0 x decays exponentially, whatever drives it."""
    errors = []
    for step in (0.04, 0.02):
        sol = kd.solve(
            lambda t, x, params: np.cos(t) - 3.0 * params[0],
            (0, 3.0),
            1.0,
            0.0,
            step=step,
            method=method,
            switches=lambda x, v: x + v,
            compile=False,
        )
        slides = np.flatnonzero(np.abs(sol.x + sol.v) < 1e-13)[0]
        assert np.abs(sol.x + sol.v)[slides:].max() < 1e-12
        errors.append(
            [abs(sol(t).x - sol.x[slides] * np.exp(sol.t[slides] - t)) for t in (3.0, 2.987)]  # also between rows
        )
    assert np.all(np.array(errors[0]) / errors[1] > 3.0)
    assert np.all(np.array(errors[0]) / errors[1] < 5.0)


def test_several_switches_hold_at_once_and_let_go_one_after_the_other():
    """Two blocks, the second of which is pulled ever harder, and is tied to the first by a spring."""

    def pulled(t, x, params):
        pull, spring = 0.5 * t, 5.0 * (x[1] - x[0] - 1.0)
        return np.array([spring - params[-2], pull - spring - 0.7 * params[-1]])

    options = {"step": 0.01, "method": "velocity-verlet", "switches": lambda v: v, "compile": False}
    sol = kd.solve(pulled, (0, 5.0), [0.0, 1.0], [0.0, 0.0], **options)
    first = [sol.t[np.flatnonzero(np.abs(sol.v[:, k]) > 1e-5)[0]] for k in (0, 1)]
    assert first[1] == pytest.approx(1.4, abs=0.03)  # where the pull is 0.7
    moving = np.flatnonzero(sol.t < first[0])[-1]
    assert 5.0 * (sol.x[moving, 1] - 1.0) == pytest.approx(1.0, abs=0.05)  # the spring pulls as hard as friction allows
    assert sol.success


@pytest.mark.parametrize("coupling", [0.97, 0.99])
def test_switches_hold_whose_sides_act_on_each_other(coupling):
    def coupled(x, params):
        one, other = params[-2], params[-1]
        return np.array([0.3 - one - coupling * other, 0.3 - coupling * one - other])

    options = {"step": 0.05, "method": "velocity-verlet", "switches": lambda v: v, "compile": False}
    sol = kd.solve(coupled, (0, 1.5), [0.0, 0.0], [0.05, 0.04], **options)
    assert sol.success
    assert np.abs(sol.v[-10:]).max() < 1e-13


@pytest.mark.parametrize(("jump", "success"), [(0.0, True), (3.0, False)])
def test_a_step_without_sides_that_end_it_at_its_switch_is_refused(jump, success):
    """From one moment on, the force jumps over zero as a function of the side."""

    def jumping(t, x, params):
        return 0.1 - params[-1] - (jump * np.sign(params[-1] - 0.05) if 0.45 < t < 0.55 else 0.0)

    options = {"step": 0.1, "method": "velocity-verlet", "switches": lambda v: v, "compile": False}
    sol = kd.solve(jumping, (0, 1.0), 0.0, 0.0, **options)
    assert sol.success == success
    assert ("no sides were found" in sol.message) != success
    assert np.abs(sol.v).max() < 1e-12


def test_a_run_that_slides_resumes_with_the_same_bits(tmp_path):
    options = {"step": 0.05, "method": "velocity-verlet", "switches": lambda v: v, "compile": False}
    whole = kd.solve(dry, (0, 12.0), 1.1, 0.0, **options)
    kept = {"checkpoint": tmp_path, "checkpoint_every": 40, "checkpoint_keep": None}
    kd.solve(dry, (0, 12.0), 1.1, 0.0, **options, **kept)
    for file in sorted(tmp_path.glob("step-*"))[-2:]:
        file.unlink()
    on = kd.solve(dry, (0, 12.0), 1.1, 0.0, **options, **kept)
    assert "It resumed from step" in on.message
    assert np.array_equal(on.x, whole.x)
    assert np.array_equal(on.t, whole.t)
    assert on.n_force_evaluations == whole.n_force_evaluations


@pytest.mark.parametrize(
    ("force", "switch", "start", "end"),
    [
        (lambda t, x, params: 0.2 - t - 0.2 * params[-1], lambda v: v, [0.0, 0.0], -(1.6**3) / 6.0),  # slips at 0.4
        (lambda t, x, params: 0.2 * np.cos(3.0 * t) - 0.2 * params[-1], lambda v: v, [0.0, 0.0], 0.0),
        (lambda x, params: -x - 0.2 * params[-1], lambda v: v, [0.2 - 1e-11, 0.0], 0.2),
        (lambda x, v, params: -x - 0.1 * v * params[-1], lambda x, v: x * x + v * v - 1.0, [1.0, 0.0], np.cos(2.0)),
        (lambda x, params: -x - 0.2 * params[-1], lambda t, x: x - np.sin(t), [0.0, 1.0], np.sin(2.0)),
        (lambda x, params: -params[-1] + 0.0 * x, lambda x: x, [0.0, 0.0], 0.0),
    ],
    ids=["limit", "limit-cos", "near-limit", "energy", "path", "relay"],
)
def test_a_switch_may_touch_the_motion_where_it_begins(force, switch, start, end):
    """There the rates of one or both sides vanish; the motion stays at the switch, and goes on."""
    options = {"step": 0.01, "method": "implicit-midpoint", "switches": switch, "compile": False}
    sol = kd.solve(force, (0.0, 2.0), *start, **options)
    assert sol.success
    assert sol.x[-1] == pytest.approx(end, abs=3e-5)
    assert sol.n_steps < 210


def test_sliding_along_a_switch_needs_a_force_linear_in_the_side():
    sol = kd.solve(
        lambda x, params: -x - (0.2 if params[-1] > 0 else -0.2),
        (0, 25.0),
        2.5,
        0.0,
        step=0.05,
        method="blanes-moan-srkn6b",
        switches=lambda v: v,
        compile=False,
    )
    assert sol.status is Outcome.NO_STEP
    assert "needs a force linear in the side" in sol.message
    assert sol.t[-1] == pytest.approx(6 * np.pi, abs=0.01)


def test_switches_of_the_velocity():
    sol = kd.solve(dry, (0, np.pi), 1.0, 0.0, step=0.01, method="blanes-moan-srkn6b", switches=lambda v: v)
    assert sol.x[-1] == pytest.approx(-0.6, abs=1e-9)  # each half period takes 0.4
    assert sol(np.pi - 0.004).x == pytest.approx(-0.6 + 0.8 * (1 - np.cos(0.004)), abs=1e-9)


def test_switches_of_first_order_equations_and_hamiltonians():
    def relay(y, params):
        return np.where(params[-1] > 0, -1.0, -0.25) + 0 * y

    sol = kd.solve(kd.FirstOrder(relay), (0, 1.0), [1.0], step=0.03, method="dop853", switches=lambda y: y - 0.5)
    assert sol.y[-1, 0] == pytest.approx(0.375, abs=1e-12)
    system = kd.Separable(kinetic_gradient=lambda p: 2 * p, potential_gradient=lambda q, params: 6.0 + 2.0 * params[-1])
    sol = kd.solve(system, (0, 0.4), 1.0, 0.0, step=0.03, method="velocity-verlet", switches=lambda q: q - 0.5)
    energy = sol.p**2 + 4.0 * sol.q + 4.0 * np.maximum(sol.q - 0.5, 0.0)
    assert sol.q[-1] < 0.5
    assert np.abs(energy / energy[0] - 1).max() < 1e-12


def test_impacts_and_switches_together():
    sol = kd.solve(
        lambda x, params: -6.0 - 2.0 * params[0],
        (0, 3.0),
        1.0,
        0.0,
        step=0.03,
        method="velocity-verlet",
        impacts=lambda x: x,
        switches=lambda x: x - 0.5,
    )
    energy = sol.v**2 / 2 + 4.0 * sol.x + 4.0 * np.maximum(sol.x - 0.5, 0.0)
    assert np.abs(energy / energy[0] - 1).max() < 1e-11


def test_rows_events_and_dense_output_go_with_impacts():
    def top(v):
        return v

    top.direction = -1
    floor = kd.Impacts(lambda x: x, restitution=0.8)
    options = {"step": 0.05, "method": "velocity-verlet", "impacts": floor}
    sol = kd.solve(lambda x: -9.81, (0, 3.0), 0.0, 5.0, events=top, **options)
    heights = 25.0 / 2 / G * 0.64 ** np.arange(sol.t_events[0].size)
    assert sol.t_events[0].size >= 3
    assert np.abs(sol.x_events[0] - heights).max() < 1e-12
    picked = kd.solve(lambda x: -9.81, (0, 3.0), 0.0, 5.0, t_eval=[0.5, 1.5, 2.5], **options)
    assert np.abs(picked.x - sol([0.5, 1.5, 2.5]).x).max() < 1e-12
    assert "cut at 1 impact" in sol.report()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"impacts": 3}, "not a function"),
        ({"impacts": lambda x: x[1] - 5.0}, "beyond the surface"),
        ({"impacts": lambda x: np.nan * x[0]}, "must be finite"),
        ({"impacts": lambda x: np.outer(x, x)}, "of shape (2, 2)"),
        ({"impacts": lambda v: v[0]}, "name them t, x, params"),
        ({"impacts": kd.Impacts(lambda x: x[1], restitution=1.5)}, "from 0 to 1"),
        ({"impacts": kd.Impacts(lambda x: x[1], restitution=[0.5, 0.5])}, "restitution=[0.5, 0.5]"),
        ({"impacts": kd.Impacts(lambda x: x[1], friction=-0.1)}, "friction=-0.1"),
        ({"impacts": kd.Impacts(lambda x: x[1], restitution=np.nan)}, "from 0 to 1"),
        ({"impacts": kd.Impacts(lambda x: x[1], mass=-1.0)}, "mass=-1.0"),
        ({"impacts": lambda x: x[1], "rtol": 1e-3}, "rtol=0.001, atol=None and impacts"),
        ({"impacts": lambda x: x[1], "rtol": 1e-3}, "end each run by a terminal event at the surface"),
        ({"impacts": lambda x: x[1] > 0.0}, "which is not a real number"),
        ({"switches": lambda x: x[1] > 0.5}, "which is not a real number"),
        ({"impacts": lambda x: x[1], "t_span": (1.0, 0.0)}, "backwards"),
        ({"switches": "x"}, "not a function"),
        ({"impacts": kd.Impacts(lambda x: x[1], located="no")}, "located='no'"),
    ],
)
def test_what_cannot_be_is_said_before_the_run(options, text):
    span = options.pop("t_span", (0, 1.0))
    with pytest.raises(ArgumentError) as error:
        kd.solve(_falling, span, [0, 1.0], [0, 0], step=0.01, method="velocity-verlet", **options)
    assert text in str(error.value)


def test_friction_between_bodies_is_refused():
    disks = kd.Impacts(kd.sphere_gaps([0.5, 0.5]), friction=0.3)
    with pytest.raises(ArgumentError, match="between two bodies and has friction"):
        kd.solve(
            lambda x: 0 * x, (0, 1.0), [[0, 0], [2, 0]], np.zeros((2, 2)), step=0.01, method="leapfrog", impacts=disks
        )


@pytest.mark.parametrize("radii", [[0.1], [0.1, -0.1], [0.1, np.nan], "big", [[0.1, 0.1]]])
def test_radii_that_are_none(radii):
    with pytest.raises(ArgumentError, match="radii="):
        kd.sphere_gaps(radii)


@pytest.mark.parametrize("located", [True, False])
@pytest.mark.parametrize(
    ("gap", "start"),  # they touch within a step, and at the end of one
    [
        (lambda x: abs(x - 0.5), 0.0033),
        (lambda x: (x - 0.5) ** 2, 0.0033),
        (lambda x: max(x - 0.5, 0.1 * (0.5 - x)), 0.0033),
        (lambda x: abs(x - 0.5), 0.0),
        (lambda x: (x - 0.5) ** 2, 0.0),
    ],
)
def test_gaps_without_a_sign_end_the_run_where_bodies_would_pass_them(gap, start, located):
    wall = kd.Impacts(gap, located=located)
    sol = kd.solve(lambda x: 0.0 * x, (0, 3.0), start, 1.0, step=0.01, impacts=wall, compile=False, **VERLET)
    assert sol.status is Outcome.NO_STEP
    assert "without becoming negative" in sol.message
    assert sol.t[-1] == pytest.approx(0.5, abs=0.011)


def test_a_graze_and_a_corner_are_no_gaps_without_a_sign():
    corner = kd.Impacts(lambda x: max(x[0], x[1]))
    sol = kd.solve(lambda x: 0.0 * x, (0, 3.0), [1, 1], [-1, -1], step=0.0103, impacts=corner, compile=False, **VERLET)
    assert sol.success
    assert sol.x.max(axis=1).min() > -1e-12
    ball = kd.Impacts(lambda x: np.hypot(x[0], x[1]) - 1)
    for above in (1e-12, 1e-9, 1e-4):
        sol = kd.solve(
            lambda x: 0.0 * x, (0, 3.0), [-2, 1 + above], [1.5, 0], step=0.1, impacts=ball, compile=False, **VERLET
        )
        assert sol.x[-1] == pytest.approx([2.5, 1 + above], abs=1e-12)


def _pinched(t, x):
    out = np.empty(2)
    out[0], out[1] = x[0], 1.0 - t - x[0]
    return out


def _five_floors(x):
    return x[0] * np.ones(5)


def test_what_ends_a_run_with_impacts_is_said():
    def run(gap, v, e):
        hit = kd.Impacts(gap, restitution=e)
        sol = kd.solve(lambda x: 0 * x - G, (0, 2.0), [0.5], [v], step=0.01, impacts=hit, **VERLET)
        assert sol.status is Outcome.NO_STEP
        return sol.message

    assert "No time passes between impacts" in run(_pinched, 0.3, 0.5)
    assert "twice the numbers of the state" in run(_five_floors, 0.0, 0.0)


def test_gaps_that_stop_being_numbers_end_the_run():
    sol = kd.solve(
        lambda x: 0.0,
        (0, 3.0),
        1.0,
        -1.0,
        step=0.01,
        method="velocity-verlet",
        impacts=lambda x: np.sqrt(x - 0.5) + 1.0,
        compile=False,
    )
    assert sol.status is Outcome.NO_STEP
    assert sol.t[-1] == pytest.approx(0.5, abs=0.02)


def test_energy_that_impacts_take_is_no_error():
    """Two bodies fall from 1 to 0.2, where each rebound is weaker: the energy sinks from -1 to -5."""
    pair = kd.systems.nbody([1.0, 1.0], [[0, 0, 0], [1, 0, 0]], np.zeros((2, 3)), G=1.0)
    sol = kd.solve(
        pair,
        (0.0, 5.0),
        step=0.002,
        method="velocity-verlet",
        impacts=kd.Impacts(kd.sphere_gaps([0.1, 0.1]), restitution=0.3),
    )
    assert sol.energy[-1] == pytest.approx(-5.0, abs=1e-9)
    assert sol.message == "The end of t_span was reached."
