"""Ensembles: each member is what `solve` makes of it alone, to the bit."""

import dataclasses
import math
import os
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext

import numpy as np
import pytest
from forking import forked
from vector_instructions import needs_wide_vectors, packed

import kickdrift as kd
from kickdrift.core import archive
from kickdrift.core.calls import address_of
from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError, FileFormatError, MethodMismatchError
from kickdrift.core.outcomes import Outcome
from kickdrift.engine import lane_letters, lanes
from kickdrift.engine.loop import LETTER
from kickdrift.engine.problem_adapter import describe
from kickdrift.engine.processing import kernel_alone
from kickdrift.engine.start import Start
from kickdrift.scale import running
from kickdrift.systems.problem import Problem

SPAN = (0.0, 3.0)


def spring(x, params, out):
    out[0] = -params[0] * x[0]
    out[1] = -params[1] * x[1] ** 3


def gravity(x):
    return -x / (x[0] * x[0] + x[1] * x[1]) ** 1.5


def drag(t, x, v, params):
    return np.array([np.cos(t) - params[0] * v[0] - x[0], -params[0] * v[1] ** 2 - x[1]])


def starts(count, seed=0):
    noise = np.random.default_rng(seed).normal(size=(2, count, 2))
    return [1.0, 0.0] + 0.1 * noise[0], [0.0, 1.0] + 0.1 * noise[1]


def is_member(sol, i, problem, *start, **options):
    """Whether a member has the bits of a run of it alone."""
    alone = kd.solve(problem, SPAN, *start, progress=False, **options)
    assert sol.status[i] is alone.status
    for name in ("x", "v"):
        assert getattr(sol, name)[i].tobytes() == getattr(alone, name).tobytes()
    assert np.array_equal(sol.t, alone.t)
    assert (sol.step[i], sol.n_steps[i]) == (alone.step, alone.n_steps)
    assert (sol[i].step_range, sol[i].n_rejected) == (alone.step_range, alone.n_rejected)
    assert sol.n_force_evaluations[i] == alone.n_force_evaluations
    for name, values in alone.invariants.items():
        assert np.array_equal(sol.invariants[name][i], values, equal_nan=True)
    return True


@pytest.fixture
def in_lanes(monkeypatch):
    """Count the members that run in lanes, and that run alone."""
    counts = {"lanes": 0, "alone": 0}
    many, one = running.Runs._run_in_lanes, running.Runs._run_alone

    def count_many(self, cohort, *others):
        counts["lanes"] += cohort.indices.size
        many(self, cohort, *others)

    def count_one(self, *others):
        counts["alone"] += 1
        return one(self, *others)

    monkeypatch.setattr(running.Runs, "_run_in_lanes", count_many)
    monkeypatch.setattr(running.Runs, "_run_alone", count_one)
    return counts


@pytest.mark.parametrize("compensated", [True, False])
@pytest.mark.parametrize("method", ["semi-implicit-euler", "drift-kick", "velocity-verlet", "blanes-moan-srkn6b"])
def test_members_in_lanes_have_the_bits_of_runs_alone(method, compensated, in_lanes):
    x, v = starts(131)
    options = {"step": 0.01, "method": method, "compensated": compensated, "save_every": 70}
    sol = kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **options)
    assert in_lanes == {"lanes": 131, "alone": 0}
    assert sol.x.shape == (131, 6, 2)
    assert sol.success.all()
    for i in (0, 63, 64, 130):
        assert is_member(sol, i, kd.systems.kepler(), x[i], v[i], **options)


@pytest.mark.parametrize("function", [spring, drag])
def test_numbers_of_functions_are_swept(function, in_lanes):
    x, v = starts(3)
    args = np.array([[1.0, 0.1], [2.0, 0.2], [0.5, 0.3]])
    method = "semi-implicit-euler"
    if function is drag:
        method = "explicit-euler"
    sol = kd.solve_ensemble(function, SPAN, x, v, args=args, step=0.05, method=method)
    for i in range(3):
        assert is_member(sol, i, function, x[i], v[i], args=args[i], step=0.05, method=method)
    assert np.array_equal(sol.parameters["args"], args)
    assert in_lanes["lanes"] == (3 if function is spring else 0)


def test_named_ranges_are_a_product(in_lanes):
    sol = kd.solve_ensemble(
        spring, SPAN, [[1.0, 0.5]], [[0.0, 0.0]], args={"k": [1.0, 2.0], "c": [0.1, 0.2, 0.3]}, step=0.1
    )
    assert in_lanes["lanes"] == 6
    assert sol.parameters["k"].tolist() == [1, 1, 1, 2, 2, 2]
    assert sol.parameters["c"].tolist() == [0.1, 0.2, 0.3] * 2
    assert is_member(sol, 4, spring, [1.0, 0.5], [0.0, 0.0], args=(2.0, 0.2), step=0.1)
    one = kd.solve_ensemble(spring, SPAN, [[1.0, 0.5]], [[0.0, 0.0]], args={"k": [1.0, 2.0], "c": 0.2}, step=0.1)
    assert list(one.parameters) == ["k"]
    assert np.array_equal(one.x[1], sol.x[4])


def test_functions_that_make_systems_are_swept(in_lanes):
    sol = kd.solve_ensemble(
        kd.systems.kepler, SPAN, args={"eccentricity": [0.0, 0.5], "mu": [1.0, 2.0]}, step=0.01, save_every=100
    )
    assert in_lanes["lanes"] == 4
    made = kd.systems.kepler(eccentricity=0.5, mu=1.0)
    assert is_member(sol, 2, made, step=0.01, save_every=100)
    damped = kd.solve_ensemble(
        lambda c: kd.Damped(lambda x: -x, damping=c), SPAN, [1.0], [0.0], args={"c": [0.1, 0.9]}, step=0.1,
        method="conformal-verlet",
    )  # fmt: skip
    assert is_member(damped, 1, kd.Damped(lambda x: -x, damping=0.9), 1.0, 0.0, step=0.1, method="conformal-verlet")


def test_noise_has_a_seed_to_each_member(in_lanes):
    well = kd.Langevin(lambda x: 4 * x * (1 - x * x), friction=1.0, temperature=0.4)
    seeds = [3, 2**64 - 1, 2**40 + 7]
    sol = kd.solve_ensemble(well, SPAN, [1.0], [0.0], seeds=seeds, step=0.1, method="baoab")
    assert in_lanes["lanes"] == 3
    for i, seed in enumerate(seeds):
        assert is_member(sol, i, dataclasses.replace(well, seed=seed), 1.0, 0.0, step=0.1, method="baoab")


def test_steps_differ_where_the_times_kept_are_the_same(in_lanes):
    kepler, steps = kd.systems.kepler(), [0.1, 0.05, 0.1]
    sol = kd.solve_ensemble(kepler, SPAN, step=steps, t_eval=[0.0, 1.0, 3.0])
    assert in_lanes["lanes"] == 3
    for i in range(3):
        assert is_member(sol, i, kepler, step=steps[i], t_eval=[0.0, 1.0, 3.0])
    with pytest.raises(ArgumentError, match="give t_eval"):
        kd.solve_ensemble(kepler, SPAN, step=steps)


KINDS = {
    "gauss-4": kd.systems.pendulum(),
    "wisdom-holman-corrected-3": kd.systems.outer_solar_system(),
    "wisdom-holman": kd.systems.kepler(),
    "velocity-verlet": kd.systems.nbody(np.ones(3), np.eye(3), np.zeros((3, 3)), G=0.1),
    "boris": kd.ChargedParticle(charge_to_mass=1.0, magnetic_field=lambda x: np.array([0.0, 0.0, 1 + x[0]])),
    "runge-kutta-4": kd.FirstOrder(lambda y: np.array([y[1], -y[0]])),
    "rattle": kd.Constrained(lambda x: np.array([0.0, -9.81]), lambda x: x[0] ** 2 + x[1] ** 2 - 1),
}


@pytest.mark.parametrize("method", KINDS)
def test_every_kind_of_step_runs_in_turn_or_in_lanes(method, in_lanes):
    problem, rng = KINDS[method], np.random.default_rng(1)
    shape = problem.x0.shape if isinstance(problem, kd.System) else (3,) if method == "boris" else (2,)
    x, v = rng.normal(size=(2, 70, *shape))
    if isinstance(problem, kd.System):
        x, v = problem.x0 + 1e-3 * x, problem.v0 * (1 + 1e-3 * v)
    if method == "rattle":
        angle = rng.uniform(0, 6, 70)
        x, v = np.stack([np.cos(angle), np.sin(angle)], axis=1), np.zeros((70, 2))
    starts = (x,) if method == "runge-kutta-4" else (x, v)
    options = {"step": 0.1, "method": method, "save_every": 7}
    sol = kd.solve_ensemble(problem, SPAN, *starts, **options)
    assert in_lanes["alone"] <= 1
    assert all(is_member(sol, i, problem, *(start[i] for start in starts), **options) for i in (0, 1, 37, 69))


DESCRIBED = {
    "second-order": kd.SecondOrder(lambda x: -x),
    "newtonian": kd.Newtonian(lambda x: -x, mass=2.0),
    "separable": kd.Separable(kinetic_gradient=lambda p: p, potential_gradient=lambda q: q),
    "hamiltonian": kd.Hamiltonian(dHdq=lambda q, p: q, dHdp=lambda q, p: p),
    "partitioned": kd.Partitioned(lambda x, v: x * v, lambda x, v: v - x),
    "first-order": kd.FirstOrder(lambda y: -y),
    "damped": kd.Damped(lambda x: -x, damping=0.1),
    "langevin": kd.Langevin(lambda x: -x, friction=1.0, temperature=0.4),
    "oscillatory": kd.Oscillatory(lambda x: -(x**3), omega=[0.0, 5.0]),
    "multirate": kd.Multirate(lambda x: -x, lambda x: -x),
    "charged": kd.ChargedParticle(charge_to_mass=1.0, magnetic_field=lambda x: np.array([0.0, 0.0, 1 + x[0]])),
    "constrained": kd.Constrained(lambda x: 0 * x, lambda x: x[0] ** 2 + x[1] ** 2 - 1),
}


def test_descriptions_say_whether_their_params_depend_on_the_start():
    assert {type(problem) for problem in DESCRIBED.values()} == set(Problem.__subclasses__())
    for name, problem in DESCRIBED.items():
        params = []
        for x in ([0.6, 0.8], [1.0, 0.0]):
            x = np.array([*x, 0.3] if name == "charged" else x)
            v = np.array([-x[1], x[0], 0.0][: x.size]) if problem.has_velocity else np.zeros(0)
            params.append(describe(problem, 0.0, Start(x, v), np.array([5.0]), False).params)
        assert np.array_equal(*params) is not problem.start_in_params
        assert params[0][0] == 5.0


def test_steps_that_vary_are_those_of_each_member():
    kepler, options = kd.systems.kepler(), {"step": 0.02, "step_control": "distance", "t_eval": [0.0, 1.0, 3.0]}
    x, v = starts(3)
    x[1] *= 0.3
    sol = kd.solve_ensemble(kepler, SPAN, x, v, **options)
    assert all(is_member(sol, i, kepler, x[i], v[i], **options) for i in range(3))
    assert len(set(sol.n_steps)) == 3
    by_error = kd.solve_ensemble(gravity, SPAN, x, v, rtol=1e-8, t_eval=[3.0])
    assert is_member(by_error, 1, gravity, x[1], v[1], rtol=1e-8, t_eval=[3.0])
    with pytest.raises(ArgumentError, match="vary from member to member"):
        kd.solve_ensemble(gravity, SPAN, x, v, rtol=1e-8)


@pytest.mark.parametrize(
    "control",
    [
        {"step": 0.02, "step_control": "distance", "method": "stormer-verlet"},
        {"step": 0.02, "step_control": "acceleration", "method": "implicit-midpoint"},
        {"rtol": 1e-8, "atol": 1e-9, "method": "dop853"},
        {"rtol": 1e-6, "method": "velocity-verlet", "step": 0.01},
        {"step": 0.02, "step_control": kd.LogarithmicHamiltonian()},
        {"step": 0.02, "step_control": kd.TimeTransformed("distance")},
        {"step": 0.02, "step_control": kd.HuangLeimkuhler("distance"), "compensated": False},
    ],
    ids=["density", "implicit", "error", "doubling", "logarithmic", "transformed", "Huang"],
)
def test_members_whose_steps_vary_run_in_turn_with_the_bits_of_runs_alone(control, in_lanes, monkeypatch):
    monkeypatch.setattr(running, "_TASK_SECONDS", 10.0)
    monkeypatch.setattr(running, "_MOST_STEPS", 2)
    x, v = starts(9)
    x[4], v[4] = (0.3, 0.0), (0.0, 1.5)  # four orbits, while the others do a half
    x[6] = 0.0
    options = {**control, "t_eval": [3.0, 0.0, 1.234, 1.2345, 0.001, 3.0]}
    sol = kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **options, threads=1)
    assert np.flatnonzero(~sol.success).tolist() == [6]
    longer = np.flatnonzero(sol.n_steps > 2 * sol.n_steps[0]).tolist()
    assert longer == ([4] if "rtol" in control or control["step_control"] == "distance" else longer)
    assert in_lanes == {"lanes": 0, "alone": 2 + len(longer)}  # the first, the one that fails, those that take longer
    for i in (0, 1, 2, 3, 4, 5, 7, 8):
        assert is_member(sol, i, kd.systems.kepler(), x[i], v[i], **options)
    back = kd.solve_ensemble(kd.systems.kepler(), (3.0, 0.0), x[:3], v[:3], **options)
    alone = kd.solve(kd.systems.kepler(), (3.0, 0.0), x[1], v[1], **options)
    assert back.x[1].tobytes() == alone.x.tobytes()
    assert back.n_force_evaluations[1] == alone.n_force_evaluations


@pytest.mark.parametrize(
    "control",
    [
        {"step_control": kd.HairerSoderlind(lambda x, params: params[0] + x[0] ** 2)},
        {"step_control": "acceleration", "method": "stormer-verlet"},
        {"step_control": "distance"},
        {"rtol": 1e-6, "method": "dop853"},
        {"step_control": kd.TimeTransformed(lambda x, params: params[0] / (1.0 + x @ x))},
    ],
)
def test_members_with_numbers_of_their_own_choose_their_steps_in_turn(control, in_lanes, monkeypatch):
    monkeypatch.setattr(running, "_TASK_SECONDS", 10.0)
    x, v = starts(3)
    args, options = np.array([[1.0, 0.1], [2.0, 0.2], [0.5, 0.3]]), {"step": 0.05, "t_eval": [3.0, 0.7], **control}
    sol = kd.solve_ensemble(spring, SPAN, x, v, args=args, **options)
    assert in_lanes == {"lanes": 0, "alone": 1}
    assert all(is_member(sol, i, spring, x[i], v[i], args=args[i], **options) for i in range(3))


def dropped(x, params):
    return -9.81 * params[0] + 0.0 * x


def rubbed_spring(x, params):
    return -params[0] * x - 0.3 * params[-1]


@pytest.mark.parametrize(
    ("problem", "cut"),
    [
        (dropped, {"impacts": kd.Impacts(lambda x: x, restitution=0.8)}),
        (dropped, {"impacts": kd.Impacts(lambda x: x, located=False), "method": "yoshida-4"}),
        (dropped, {"impacts": lambda t, x, params: x - 0.1 * params[1] * t}),
        (rubbed_spring, {"switches": lambda v, params: v - 0.2 * params[1]}),
    ],
    ids=["floor", "after", "moving", "switch"],
)
def test_members_with_impacts_or_switches_run_in_turn_with_the_bits_of_runs_alone(problem, cut, in_lanes, monkeypatch):
    monkeypatch.setattr(running, "_TASK_SECONDS", 10.0)
    x, v = np.array([[1.0], [0.5], [2.0], [-0.1], [0.0]]), np.array([[0.0], [1.0], [-3.0], [0.5], [0.4]])
    args = np.array([[1.0, 0.1], [2.0, 0.2], [0.5, 0.3], [1.0, 0.4], [1.0, 2.0]])
    options = {"step": 0.02, "method": "velocity-verlet", "t_eval": [3.0, 0.0, 0.33, 0.001, 3.0], **cut}
    sol = kd.solve_ensemble(problem, SPAN, x, v, args=args, **options)
    beyond = [3] if "impacts" in cut else []  # starts there
    assert np.flatnonzero(~sol.success).tolist() == beyond
    assert in_lanes == {"lanes": 0, "alone": 1 + len(beyond)}
    for i in set(range(5)) - set(beyond):
        assert is_member(sol, i, problem, x[i], v[i], args=args[i], **options)


def test_a_member_alone_in_its_turn_may_start_beyond_a_surface():
    options = {"step": 0.01, "impacts": lambda x: x, "t_eval": [0.0, 1.0]}
    sol = kd.solve_ensemble(lambda x: -1.0 + 0.0 * x, (0.0, 1.0), x0=[1.0, -1.0], v0=[0.0, 0.0], **options)
    assert sol.status[0] is Outcome.COMPLETED
    assert "gap 0 is -1.0 at the start" in sol.messages[1]


def test_times_between_steps_are_kept():
    x, v = starts(3)
    sol = kd.solve_ensemble(gravity, SPAN, x, v, step=0.1, t_eval=[0.33, 2.0, 0.5])
    assert is_member(sol, 2, gravity, x[2], v[2], step=0.1, t_eval=[0.33, 2.0, 0.5])


def test_interpreted_functions_run():
    x, v = starts(2)
    sol = kd.solve_ensemble(gravity, SPAN, x, v, step=0.5, compile=False)
    assert is_member(sol, 1, gravity, x[1], v[1], step=0.5, compile=False)


@pytest.mark.parametrize("threads", [2, 3])
def test_any_number_of_threads_gives_the_same_bits(threads, monkeypatch):
    monkeypatch.setattr(running, "_TASK", 64 * 100)
    x, v = starts(333)
    runs = [kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, step=0.03, threads=n) for n in (1, threads)]
    assert runs[0].x.tobytes() == runs[1].x.tobytes()


def test_threads_get_as_many_tasks_each(monkeypatch):
    """Five tasks on two threads would take as long as six."""
    monkeypatch.setattr(running, "_TASK", 256 * 100)
    sizes, run = [], running.Runs._run_in_lanes

    def noted(self, cohort, *given):
        sizes.append(cohort.indices.size)
        run(self, cohort, *given)

    monkeypatch.setattr(running.Runs, "_run_in_lanes", noted)
    x, v = starts(5 * 256)
    kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, step=0.03, threads=2)
    assert sorted(sizes) == [200, 216, 216, 216, 216, 216]


def test_a_member_that_fails_is_marked_and_the_others_finish():
    def escape(x):
        return np.array([x[0] ** 3, -x[1]])

    x = np.array([[0.1, 1.0], [5.0, 1.0], [0.2, 1.0]])
    sol = kd.solve_ensemble(escape, SPAN, x, np.zeros((3, 2)), step=0.05)
    assert sol.success.tolist() == [True, False, True]
    assert is_member(sol, 2, escape, x[2], np.zeros(2), step=0.05)
    alone = kd.solve(escape, SPAN, x[1], np.zeros(2), step=0.05)
    assert sol.messages[1] == alone.message
    assert sol.status[1] is alone.status is kd.Outcome.NOT_FINITE
    reached = alone.t.size
    assert np.array_equal(sol.x[1, :reached], alone.x)
    assert np.isnan(sol.x[1, reached:]).all()
    assert np.array_equal(sol[1].t, alone.t)


def stiffening(t, x, params):
    return params[0] * x**3


def raising(t, x, params):
    if x[0] > 100.0 + params[0]:
        raise ValueError("far away")
    return x**3


@pytest.mark.parametrize("function", [stiffening, raising])
@pytest.mark.parametrize(
    "options",
    [
        {"save_every": 7},
        {"t_eval": [0.9, 0.333, 0.9]},
        {"step_control": "acceleration", "t_eval": [0.9, 0.333], "max_steps": 900},
    ],
)
def test_members_that_fail_end_with_the_row_and_the_message_of_runs_alone(function, options):
    args, options = np.linspace(0.5, 30.0, 9)[:, None], {"step": 0.01, "method": "velocity-verlet", **options}
    sol = kd.solve_ensemble(function, (0.0, 2.0), np.ones((9, 1)), np.ones((9, 1)), args=args, **options)
    for i in range(9):
        alone = kd.solve(function, (0.0, 2.0), [1.0], [1.0], args=args[i], **options)
        assert ends_as(sol, i, alone)
        assert alone.success or sol.t_last[i].size == (alone.t[-1] not in sol.t or "t_eval" in options)
    assert not sol.success.all()


FAULTS = {
    "in lanes": (lanes.Blocks, "advance", {"step": 0.1}),
    "in turn": (running, "run_in_turn", {"step": 0.1, "method": "gauss-4"}),
    "in turn, of steps that vary": (
        running,
        "run_in_turn",
        {"step": 0.1, "step_control": "acceleration", "t_eval": [1.0]},
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_not_taken_for_errors_of_functions(name, monkeypatch):
    """Members would run alone, ten times as slowly, and nobody would know."""
    of, function, options = FAULTS[name]
    monkeypatch.setattr(of, function, lambda *arguments: np.concatenate([]))
    with pytest.raises(ValueError, match="at least one array"):
        kd.solve_ensemble(kd.systems.pendulum(), SPAN, np.linspace(0.1, 0.9, 9), **options)


def test_faults_of_runs_alone_come_out(monkeypatch):
    monkeypatch.setattr(running, "solve", lambda *arguments, **options: np.concatenate([]))
    with pytest.raises(ValueError, match="at least one array"):
        kd.solve_ensemble(kd.systems.pendulum(), SPAN, [0.1, 0.2], step=0.1, method="gauss-4")


def test_a_function_that_makes_systems_fails_for_one_member():
    def made(amplitude):
        if amplitude == 1.5:
            raise LookupError("no such pendulum")
        return kd.systems.pendulum(amplitude)

    sol = kd.solve_ensemble(made, SPAN, args={"amplitude": [0.5, 1.0, 1.5, 2.0]}, step=0.1)
    assert sol.success.tolist() == [True, True, False, True]
    assert "made raised LookupError for amplitude=1.5: no such pendulum" in sol.messages[2]


@pytest.mark.parametrize("reach", [True, False])
def test_members_that_do_not_reach_the_end_with_steps_that_vary_do_not_stop_others(reach, in_lanes):
    args = np.append(0.1 if reach else 30.0, np.full(8, 30.0))[:, None]
    options = {"step": 0.01, "step_control": kd.HairerSoderlind(lambda x: 1 + x[0] ** 4), "t_eval": [0.5, 1.3]}
    options |= {"max_steps": 900, "method": "velocity-verlet"}
    sol = kd.solve_ensemble(stiffening, (0.0, 1.3), np.ones((9, 1)), np.ones((9, 1)), args=args, threads=1, **options)
    assert sol.success.tolist() == [reach] + [False] * 8
    assert all(
        ends_as(sol, i, kd.solve(stiffening, (0.0, 1.3), [1.0], [1.0], args=args[i], **options)) for i in range(9)
    )


def test_a_member_whose_function_fails_between_steps_has_the_rows_of_its_run_alone():
    def force(t, x, params):
        if abs(t - params[0]) < 1e-9:
            raise ValueError("no force")
        return -x

    options = {"step": 0.1, "method": "velocity-verlet", "t_eval": [0.05, 0.55], "compile": False}
    sol = kd.solve_ensemble(force, (0.0, 1.0), [[1.0]] * 3, [[0.0]] * 3, args=[[9.0], [0.55], [9.0]], **options)
    for i, own in enumerate([9.0, 0.55, 9.0]):
        assert ends_as(sol, i, kd.solve(force, (0.0, 1.0), [1.0], [0.0], args=[own], **options))


@pytest.mark.parametrize("in_lanes", [True, False])
def test_a_member_that_goes_to_infinity_ends_after_max_steps_and_the_others_finish(in_lanes, monkeypatch):
    """x'' = p x^3 from rest at 1 does so at 1.85 / sqrt(p / 2), in ever more steps of the density 1 + x^4."""
    if not in_lanes:
        monkeypatch.setattr(running, "numbers_in_turn", lambda prepared, grid: None)
    options = {"step": 1e-2, "step_control": kd.HairerSoderlind(lambda x: 1 + x**4), "t_eval": [0.5, 1.0]}
    runs = kd.solve_ensemble(
        lambda x, params: params[0] * x**3, (0.0, 1.0), 1.0, 0.0, args=[[1.0], [8.0], [2.0]], max_steps=900, **options
    )
    assert [status.name for status in runs.status] == ["COMPLETED", "STEP_LIMIT", "COMPLETED"]
    assert (runs.n_steps[1], runs.x[1, 1]) == (900, pytest.approx(np.nan, nan_ok=True))
    assert "Give a larger max_steps" in runs.messages[1]


def test_a_member_whose_function_raises_is_marked_and_the_others_finish():
    def table(x, params):
        return np.array([-params[int(abs(x[0]))] * x[0]])

    sol = kd.solve_ensemble(table, SPAN, [[0.5], [1.2], [0.7]], [[0.0], [2.5], [0.0]], args=(1.0, 1.0), step=0.05)
    assert [status.name for status in sol.status] == ["COMPLETED", "FAILED", "COMPLETED"]
    assert "IndexError" in sol.messages[1]
    assert is_member(sol, 2, table, [0.7], [0.0], args=(1.0, 1.0), step=0.05)


def test_ctrl_c_keeps_what_is_done(monkeypatch):
    monkeypatch.setattr(running, "_TASK", 1)
    x, v = starts(64 * 40)
    kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, step=0.1)  # compiles
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    sol = kd.solve_ensemble(kd.systems.kepler(), (0.0, 30_000.0), x, v, step=0.001, save_every=10**5, threads=1)
    timer.join()
    assert {status.name for status in sol.status} == {"INTERRUPTED"}
    done = int(sol.n_steps[0])
    assert 0 < done < 30_000_000
    assert np.isfinite(sol.x[0, : done // 10**5]).all()
    assert np.isnan(sol.x[0, done // 10**5 + 1 :]).all()
    assert np.isnan(sol.x[-1]).all()
    assert "did not start" in sol.messages[-1]


def to_be_killed(folder):
    noise, kepler = np.random.default_rng(0).normal(size=(64 * 30, 2)), kd.systems.kepler()
    options = {"step": 1e-3, "save_every": 50_000, "threads": 1, "checkpoint": folder, "checkpoint_every": 64}
    return kd.solve_ensemble(kepler, (0.0, 100.0), kepler.x0 + 0.01 * noise, **options)


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")  # of Python 3.12, where there are threads
def test_an_ensemble_that_is_killed_goes_on_with_the_same_bits(tmp_path, monkeypatch):
    monkeypatch.setattr(running, "_TASK", 1)
    folder, kills = tmp_path / "killed", 0
    for _ in range(3):
        before = {path.name for path in folder.glob("*.npz")} if folder.exists() else set()
        run = forked(to_be_killed, folder)
        while run.is_alive() and not (folder.exists() and {p.name for p in folder.glob("step*.npz")} - before):
            time.sleep(0.005)
        run.kill()
        run.join()
        kills += run.exitcode < 0
    assert kills >= 1
    whole, killed = to_be_killed(tmp_path / "whole"), to_be_killed(folder)
    for name in ("x", "v", "n_steps", "n_force_evaluations"):
        assert getattr(whole, name).tobytes() == getattr(killed, name).tobytes()
    assert whole.messages == killed.messages


def test_checkpoints_keep_members_that_are_done(tmp_path, in_lanes, monkeypatch):
    def full(*arguments, **options):
        raise FileFormatError("no space is left")

    x, v = starts(70)
    x[5] = 1e-160, 0.0
    options = {"step": 0.1, "checkpoint": tmp_path / "run", "checkpoint_every": 1}
    first = kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **options)
    assert in_lanes["lanes"] == 70
    again = kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **options)
    assert in_lanes["lanes"] == 70
    assert first.x.tobytes() == again.x.tobytes()
    assert (first.status, first.messages) == (again.status, again.messages)
    monkeypatch.setattr(archive, "write", full)
    with pytest.warns(RuntimeWarning, match="finished members: no space is left"):
        sol = kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **options | {"checkpoint": tmp_path / "full"})
    assert sol[3].success
    with pytest.raises(ArgumentError, match="another x0"):
        kd.solve_ensemble(kd.systems.kepler(), SPAN, x + 1, v, **options)
    with pytest.raises(ArgumentError, match="without checkpoint"):
        kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, step=0.1, checkpoint_every=3)


def test_saved_and_loaded_ensembles_are_equal(tmp_path):
    sol = kd.solve_ensemble(kd.systems.kepler, SPAN, args={"eccentricity": [0.0, 0.5, 0.99]}, step=0.5)
    loaded = kd.load(sol.save(tmp_path / "sweep"))
    for name in ("t", "x", "v", "energy", "step", "n_steps", "n_force_evaluations"):
        assert np.array_equal(getattr(loaded, name), getattr(sol, name), equal_nan=True)
    assert (loaded.status, loaded.messages, loaded.about) == (sol.status, sol.messages, sol.about)
    assert np.array_equal(loaded.parameters["eccentricity"], [0.0, 0.5, 0.99])
    assert loaded.report() == sol.report()
    assert "eccentricity 0 to 0.99" in sol.report()
    with np.load(tmp_path / "sweep.npz") as file:
        arrays = {name: file[name] for name in file.files if name != "header"}
    with pytest.raises(kd.KickdriftError, match="is not a kickdrift solution"):
        kd.load(archive.write(tmp_path / "cut", {"format": archive.ENSEMBLE, "outcomes": []}, arrays))


def test_labelled_arrays_have_members():
    sol = kd.solve_ensemble(kd.systems.kepler, SPAN, args={"eccentricity": [0.0, 0.5]}, step=0.1)
    data = sol.to_xarray()
    assert data.x.dims == ("member", "time", "space")
    assert data.energy.dims == ("member", "time")
    assert data.eccentricity.values.tolist() == [0.0, 0.5]
    assert data.status.values.tolist() == ["COMPLETED", "COMPLETED"]
    assert data.angular_momentum.sel(time=0.0).values == pytest.approx([1.0, math.sqrt(0.75)])


def test_a_data_frame_has_a_row_per_member_and_time():
    pytest.importorskip("pandas")
    sol = kd.solve_ensemble(
        kd.systems.kepler, SPAN, args={"eccentricity": [0.0, 0.5]}, step=[0.1, 0.05], t_eval=[0.0, 1.0]
    )
    frame = sol.to_pandas()
    assert frame.index.names == ["member", "t"]
    assert list(frame.columns) == ["eccentricity", "step", *sol[0].to_pandas().columns]
    for member in range(2):
        assert frame.loc[member][sol[member].to_pandas().columns].equals(sol[member].to_pandas())
    assert frame["eccentricity"].tolist() == [0.0, 0.0, 0.5, 0.5]
    plain = kd.solve_ensemble(lambda x: -x, SPAN, np.ones((3, 2, 1)), np.zeros((3, 2, 1)), step=0.5)
    assert np.array_equal(plain.to_pandas()["x[1, 0]"], plain.x[:, :, 1, 0].reshape(-1))


def test_names_of_ranges_that_arrays_have_are_refused_where_arrays_get_labels():
    sol = kd.solve_ensemble(lambda x, params: -params[0] * x, SPAN, 1.0, 0.0, args={"x": [1.0, 4.0]}, step=0.5)
    for convert in (sol.to_xarray, sol.to_pandas):
        with pytest.raises(kd.KickdriftError, match="args has the name 'x'"):
            convert()
    assert "w" in dataclasses.replace(sol, parameters={"w": sol.parameters["x"]}).to_pandas()
    timed = dataclasses.replace(sol, parameters={"t": sol.parameters["x"]})
    with pytest.raises(kd.KickdriftError, match="args has the name 't'"):  # a level of the index
        timed.to_pandas()
    assert timed.to_xarray()["t"].dims == ("member",)


def test_members_are_solutions():
    sol = kd.solve_ensemble(kd.systems.kepler, SPAN, args={"eccentricity": [0.0, 0.5]}, step=0.1)
    members = list(sol)
    assert len(members) == len(sol) == 2
    assert np.array_equal(sol[-1].energy, sol.energy[1])
    assert "semi-implicit-euler" in sol[0].report()
    with pytest.raises(IndexError):
        sol[2]


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"x0": np.ones((3, 2)), "args": np.ones((2, 2))}, "x0 3, .*args 2"),
        ({"x0": np.ones((3, 2)), "v0": np.ones((4, 2))}, "x0 has shape .* v0 has shape"),
        ({"x0": [[1.0, np.nan]]}, r"x0 is nan at index \(0, 1\)"),
        ({"args": [[1.0, np.inf]]}, "args is inf"),
        ({"args": np.ones((1, 1, 1))}, "args has shape"),
        ({"x0": np.ones((0, 2))}, "x0 of shape .* is empty"),
        ({"args": {"k": []}}, r"args\['k'\] is empty"),
        ({"args": {}}, "no names"),
        ({"args": {"step": [1.0]}}, "already in use"),
        ({"problem": kd.systems.kepler, "args": {"excentricity": [0.1]}}, "did you mean 'eccentricity'"),
        ({"problem": lambda k: k, "args": {"k": [0.1]}}, "must return a system"),
        ({"seeds": [1, 2]}, "not stochastic"),
        ({"step": [[0.1]]}, "step has shape"),
        ({"threads": 0}, "threads=0"),
        ({"threads": 10**30}, "more than any machine has cores"),
        ({"x0": None}, "x0 is missing"),
        ({"save_every": 1, "step": 1e-9}, "there is room for"),
    ],
)
def test_what_cannot_be_is_said_before_the_run(changes, sentence):
    given = {"problem": spring, "x0": [[1.0, 0.0]], "v0": [[0.0, 0.0]], "args": (1.0, 1.0), "step": 0.1} | changes
    with pytest.raises(ArgumentError, match=sentence):
        kd.solve_ensemble(given.pop("problem"), SPAN, given.pop("x0"), given.pop("v0"), **given)


def test_members_that_are_not_there_are_said_not_to_be():
    runs = kd.solve_ensemble(kd.systems.pendulum(), (0.0, 1.0), [0.1, 0.2], step=0.1)
    assert runs[-1].x[0] == 0.2
    for i in (2, -3):
        with pytest.raises(IndexError, match=rf"no member {i}: they are 0 to 1"):
            runs[i]
    for i in (slice(0, 2), [0, 1], "a", None, (0, 1), 1.0, np.array([0, 1]), True):
        with pytest.raises(ArgumentError, match="is not a member; give the number of one"):
            runs[i]


def test_a_method_that_does_not_fit_is_refused():
    with pytest.raises(MethodMismatchError):
        kd.solve_ensemble(kd.FirstOrder(lambda y: -y), SPAN, np.ones((3, 1)), step=0.1, method="leapfrog")


def packed_arithmetic(problem):
    """Count packed instructions, letter by letter."""
    start = Start(np.array([1.0, 0.5]), np.zeros(2))
    system = problem if isinstance(problem, kd.System) else describe(problem, 0.0, start, np.zeros(0), True)
    program = kernel_alone(system, kd.methods.get("semi-implicit-euler"))
    fields = lane_letters.fields_of(system, program, True)
    counts = {}
    for name in program.flows:
        letter = compiled(cached=False)(lane_letters.build(name, system, program, True, fields).py_func)
        address_of(letter, LETTER)
        assembly = letter.get_compile_result(LETTER).library.get_asm_str()
        counts[name] = packed(assembly, "v(?:mul|div|sqrt|sub|add)")
    return counts


@needs_wide_vectors
def test_lanes_are_vectorised():
    def written(x, out):
        out[0], out[1] = -x[0] * math.sqrt(x[1]), x[1]

    def looked_up(x):  # which looks for what may not be there, and is not vectorised
        return np.array([(1.0, 2.0, 3.0)[int(x[0])], 1.0])

    for counts in (packed_arithmetic(kd.systems.kepler()), packed_arithmetic(written)):
        assert min(counts.values()) >= 4
    assert packed_arithmetic(looked_up)["kick"] == 0


def floor(x):
    return x[1]


def falling(x):
    return np.array([0.0, -9.81])


def rubbed(x, params):
    return -x - 0.2 * params[-1]


def moving(v):
    return v


@pytest.mark.parametrize("executor", [False, True])
def test_members_rebound_each_for_itself(executor):
    starts = np.array([[0.0, 1.0], [0.0, 2.0], [1.0, 0.5]])
    options = {"step": 0.01, "method": "velocity-verlet", "impacts": kd.Impacts(floor, restitution=0.8)}
    times = np.linspace(0.0, 3.0, 7)
    with ThreadPoolExecutor(2) if executor else nullcontext() as pool:
        sol = kd.solve_ensemble(falling, (0.0, 3.0), starts, [0.5, 0.0], t_eval=times, executor=pool, **options)
    for k, start in enumerate(starts):
        alone = kd.solve(falling, (0.0, 3.0), start, [0.5, 0.0], t_eval=times, **options)
        assert np.array_equal(sol.x[k], alone.x)
    assert (sol.x[:, :, 1] > -1e-12).all()
    assert np.ptp(sol.x[:, -1, 1]) > 0.01


def test_members_begin_on_sides_of_their_own():
    options = {"step": 0.05, "method": "velocity-verlet", "switches": moving, "t_eval": [np.pi]}
    sol = kd.solve_ensemble(rubbed, (0.0, np.pi), [2.5, -2.5], 0.0, **options)
    assert sol.x[:, -1] == pytest.approx([-2.1, 2.1], abs=1e-3)  # friction of 0.2 takes 0.4 each half period
    with pytest.raises(ArgumentError, match="t_eval"):
        kd.solve_ensemble(rubbed, (0.0, np.pi), [2.5, -2.5], 0.0, step=0.05, switches=moving)


def ends_as(sol, i, alone):
    """Whether a member is the solution of a run of it alone, up to the end."""
    assert (sol.status[i], sol.messages[i]) == (alone.status, alone.message)
    for name in ("t", "x", "v"):
        assert getattr(sol[i], name).tobytes() == getattr(alone, name).tobytes()
    for name, values in alone.invariants.items():
        assert sol[i].invariants[name].tobytes() == values.tobytes()
    return True


def is_member_with_events(sol, i, alone):
    """Whether a member has the bits of a run of it alone, and its zeros."""
    assert ends_as(sol, i, alone)
    assert (sol.n_steps[i], sol.n_force_evaluations[i]) == (alone.n_steps, alone.n_force_evaluations)
    for name in ("t_events", "x_events", "v_events"):
        for own, others in zip(getattr(sol, name)[i], getattr(alone, name), strict=True):
            assert own.tobytes() == others.tobytes()
            assert own.shape == others.shape
    return True


def spring_alone(x, params):
    return -params[0] * x


def thrown(x, params):
    return np.array([0.0, -params[0]])


def height(x, v, params):
    return 0.5 * (v[0] ** 2 + v[1] ** 2) + params[0] * x[1]


def ground(x):
    return x[1]


def turn(x, v, params):
    return v[1] - 0.1 * params[0]


ground.terminal, ground.direction = True, -1
THROWS = (np.zeros((9, 2)), np.column_stack((np.ones(9), np.linspace(5.0, 20.0, 9))))


@pytest.mark.parametrize("others", [{}, {"t_eval": [0.3, 2.9, 1.0]}, {"rtol": 1e-6, "t_eval": [0.3, 1.0, 2.9]}])
def test_each_member_has_its_events_and_ends_with_its_own(others):
    options = {"step": 0.1, "method": "velocity-verlet", "events": [ground, turn], **others}
    sol = kd.solve_ensemble(thrown, SPAN, *THROWS, args=[9.81], **options)
    for i in range(9):
        assert is_member_with_events(sol, i, kd.solve(thrown, SPAN, THROWS[0][i], THROWS[1][i], args=[9.81], **options))
        landing = 2 * THROWS[1][i, 1] / 9.81
        assert np.allclose(sol.t_events[i][0], [landing] if landing < 3.0 else [], rtol=1e-12)
        assert sol[i].t_events[1].size == (THROWS[1][i, 1] - 0.981 < 9.81 * 3.0)
    assert sol.success.all()
    assert Outcome.COMPLETED in sol.status
    assert Outcome.STOPPED in sol.status


@pytest.mark.parametrize("method", ["velocity-verlet", "gauss-4"])
@pytest.mark.parametrize("span", [(0.0, 8.0), (2.0, -6.0)])
def test_members_with_events_run_in_turn_with_the_bits_of_runs_alone(method, span, in_lanes):
    def apex(v, params):
        return v[0] - 0.1 * params[0]

    def clock(t, x):
        return np.sin(3 * t) - 0.2 * x[0]

    apex.terminal, clock.terminal, clock.direction = 4, 6, 1
    x, v = np.random.default_rng(5).normal(size=(2, 20, 1))
    rates = np.linspace(0.5, 4.0, 20)[:, None]
    options = {"step": 0.1, "method": method, "events": [apex, clock, lambda x: x[0]], "t_eval": [0.33, 1.01, -0.7]}
    options["t_eval"] = [t for t in options["t_eval"] if min(span) <= t <= max(span)]
    sol = kd.solve_ensemble(spring_alone, span, x, v, args=rates, **options)
    assert in_lanes["alone"] == 2
    assert len(set(sol.n_steps)) > 5
    for i in range(20):
        alone = kd.solve(spring_alone, span, x[i], v[i], args=rates[i], **options)
        assert (~np.isnan(sol.x[i, :, 0])).sum() == alone.t.size - (alone.status is Outcome.STOPPED)
        assert is_member_with_events(sol, i, alone)


@pytest.mark.parametrize("direction", [0, -1])
def test_two_zeros_within_a_step_are_found_of_members_in_turn(direction, in_lanes):
    def crest(x, params):
        return x[0] - 0.999 + 0.0 * params[0]

    crest.rate_bound, crest.direction = 2.0, direction
    rates = np.linspace(0.5, 4.0, 20)[:, None]
    options = {
        "step": 0.15,
        "method": "velocity-verlet",
        "events": [crest, lambda x, v: v[0] - x[0]],
        "save_every": 100,
    }
    x, v = np.ones((20, 1)), np.zeros((20, 1))
    sol = kd.solve_ensemble(spring_alone, (0.0, 15.0), x, v, args=rates, **options)
    assert in_lanes["alone"] == 2
    for i in range(20):
        alone = kd.solve(spring_alone, (0.0, 15.0), x[i], v[i], args=rates[i], **options)
        assert is_member_with_events(sol, i, alone)
    assert sum(zeros[0].size for zeros in sol.t_events) > 50
    crest.terminal = True  # where a member ends, is found by a run of its own
    sol = kd.solve_ensemble(spring_alone, (0.0, 15.0), x, v, args=rates, **options)
    assert in_lanes["alone"] == 22


def test_times_between_steps_are_kept_in_turn(in_lanes):
    x, v = np.ones((9, 1)), np.zeros((9, 1))
    rates = np.linspace(0.5, 4.0, 9)[:, None]
    options = {"step": 0.1, "method": "leapfrog", "t_eval": [2.22, 0.33, 0.34]}
    sol = kd.solve_ensemble(spring_alone, SPAN, x, v, args=rates, **options)
    assert in_lanes == {"lanes": 0, "alone": 1}
    assert all(is_member(sol, i, spring_alone, x[i], v[i], args=rates[i], **options) for i in range(9))


def test_events_of_members_are_kept_on_disk(tmp_path):
    options = {
        "args": np.linspace(5, 9, 9)[:, None],
        "step": 0.1,
        "method": "velocity-verlet",
        "events": [ground, turn],
    }
    problem = kd.SecondOrder(thrown, energy=height)
    sol = kd.solve_ensemble(problem, SPAN, *THROWS, **options)
    kept = {"checkpoint": tmp_path / "kept"}, {"checkpoint": tmp_path / "kept"}
    stored = {"save_to": tmp_path / "run.zarr"}, {"save_to": tmp_path / "run.zarr"}
    others = [kd.solve_ensemble(problem, SPAN, *THROWS, **options, **where) for where in kept + stored]
    for other in (*others, kd.load(sol.save(tmp_path / "throws")), kd.load(tmp_path / "run.zarr")):
        for name in ("t_events", "x_events", "v_events"):
            for own, whole in zip(getattr(other, name), getattr(sol, name), strict=True):
                assert [(a.shape, a.tobytes()) for a in own] == [(a.shape, a.tobytes()) for a in whole]
        assert all(ends_as(other, i, sol[i]) for i in range(9))
    with pytest.raises(ArgumentError, match="another events"):
        kd.solve_ensemble(problem, SPAN, *THROWS, **options | {"events": turn, "checkpoint": tmp_path / "kept"})


def test_events_of_members_that_cannot_be_are_refused_before_the_run():
    with pytest.raises(ArgumentError, match="path is stochastic"):
        kd.solve_ensemble(
            kd.Langevin(lambda x: -x, friction=1.0, temperature=1.0),
            SPAN,
            [[1.0]],
            [[0.0]],
            step=0.1,
            seeds=[1, 2],
            events=lambda x: x[0],
        )
    with pytest.raises(ArgumentError, match="events"):
        kd.solve_ensemble(thrown, SPAN, *THROWS, args=[1.0], step=0.1, events=[3.0])
