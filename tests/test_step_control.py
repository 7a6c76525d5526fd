"""Steps whose sizes vary: reversible by a density, in a time of their own, by their error."""

import json
import warnings
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.densities import by_acceleration
from kickdrift.engine.quantities import evaluate_quantity

PERIOD = 2 * np.pi
REVERSIBLE = (
    kd.HairerSoderlind("distance"),
    kd.HairerSoderlind("acceleration"),
    kd.HuangLeimkuhler("distance"),
    kd.TimeTransformed("distance"),
    kd.LogarithmicHamiltonian(),
)


def _ids(control):
    return f"{type(control).__name__}-{getattr(control, 'density', '')}"


def _eccentric():
    return kd.systems.kepler(eccentricity=0.9)


def _energy_errors(sol):
    return np.abs(sol.energy / sol.energy[0] - 1)


# -- reversible steps -------------------------------------------------------------------------------------------------


def test_energy_of_an_eccentric_orbit_has_no_drift():
    sol = kd.solve(_eccentric(), (0, 300 * PERIOD), step=4.2e-4 * PERIOD / 4.2, step_control="distance")
    errors = _energy_errors(sol)
    assert 380 < sol.n_steps / 300 < 460
    assert 1e-4 < errors.max() < 2e-3  # of an energy of 1/2
    early, late = errors[: sol.t.size // 10].max(), errors[-sol.t.size // 10 :].max()
    assert late < 1.001 * early
    plain = kd.solve(_eccentric(), (0, 20 * PERIOD), step=PERIOD / 420, method="velocity-verlet")
    assert _energy_errors(plain).max() > 0.1


def test_logarithmic_hamiltonian_keeps_orbits_to_rounding():
    sol = kd.solve(
        _eccentric(), (0, 300 * PERIOD), step=PERIOD / 3140, step_control=kd.LogarithmicHamiltonian(), save_every=7
    )
    assert 300 < sol.n_steps / 300 < 330
    assert _energy_errors(sol).max() < 1e-12
    axis = np.array([sol.v[:, 1], -sol.v[:, 0]]).T * sol.invariants["angular momentum"][:, None]
    axis -= sol.x / np.linalg.norm(sol.x, axis=1)[:, None]
    assert np.abs(axis - axis[0]).max() < 1e-10  # the orbit does not turn, either
    other = kd.solve(
        _eccentric(),
        (0, 10 * PERIOD),
        step=PERIOD / 3140,
        step_control=kd.LogarithmicHamiltonian(),
        method="velocity-verlet",
    )
    assert _energy_errors(other).max() > 1e-4


def _steps_there_and_back(control, system, method, step, count):
    """Do so many steps, turn the velocities around, and do them again."""
    from kickdrift.engine.controller import controlled
    from kickdrift.engine.grid import lay_course
    from kickdrift.engine.processing import compile_method

    named = kd.methods.get(method)
    system, controller = controlled(control, system, named, 0.0, lambda role, function: function, True)
    course = lay_course((0.0, 1e6), step, None, None)
    stepper = compile_method(system, named, course, True, controller=controller).kernel
    start = np.concatenate([stepper.state.x, stepper.state.v])
    stepper.prime()
    rows = np.empty(2 * count), np.empty(2 * count), np.empty((2 * count, 2)), np.empty((2 * count, 2))
    marks = np.zeros(4, dtype=np.int64)
    stepper.advance_adaptively(count, 0, np.array([1e6]), marks, *rows)
    there = np.concatenate([stepper.state.x, stepper.state.v])
    stepper.state.v *= -1.0
    n = stepper.state.x.size
    stepper.state.work[2 * n : 3 * n] *= -1.0  # what its sums have rounded off, too
    from kickdrift.engine.flows.layout import DENSITY_RATE

    stepper.state.work[DENSITY_RATE] *= -1.0
    stepper.advance_adaptively(2 * count, 0, np.array([1e6]), marks, *rows)
    back = np.concatenate([stepper.state.x, -stepper.state.v])
    return start, there, back


@pytest.mark.parametrize("method", ["velocity-verlet", "position-verlet", "kahan-li-8"])
@pytest.mark.parametrize("control", REVERSIBLE, ids=_ids)
def test_the_same_steps_lead_back(control, method):
    if method == "kahan-li-8" and isinstance(control, kd.HuangLeimkuhler | kd.TimeTransformed):
        pytest.skip("is for order 2")
    start, there, back = _steps_there_and_back(
        control, kd.systems.kepler(eccentricity=0.7), method, 0.002 * PERIOD, 1000
    )
    assert np.abs(there - start).max() > 0.1
    assert np.abs(back - start).max() < 1e-12


def test_steps_by_their_error_do_not_lead_back():
    forth = kd.solve(_eccentric(), (0, 5 * PERIOD), rtol=1e-6, atol=1e-9, method="velocity-verlet")
    back = kd.solve(
        _eccentric(), (0, 5 * PERIOD), forth.x[-1], -forth.v[-1], rtol=1e-6, atol=1e-9, method="velocity-verlet"
    )
    assert np.abs(back.x[-1] - forth.x[0]).max() > 1e-8


@pytest.mark.parametrize("method", ["velocity-verlet", "blanes-moan-s6", "blanes-moan-srkn6b", "gauss-4"])
@pytest.mark.parametrize("density", ["distance", "acceleration", lambda x, v: (1 + v @ v) / (x @ x)])
def test_order_of_steps_by_a_density(method, density):
    system, span = kd.systems.kepler(eccentricity=0.6), (0.0, 9.0)
    order = kd.methods.get(method).order
    errors = []
    for step in (0.005, 0.0025) if order == 2 else (0.0035, 0.00175):
        sol = kd.solve(system, span, step=step, method=method, step_control=density)
        errors.append(np.abs(sol.x - system.exact(sol.t)[0]).max())
    assert abs(np.log2(errors[0] / errors[1]) - order) < 0.1


def test_the_density_by_acceleration_is_that_of_each_system():
    """Code on disk was found by the name of the acceleration, `_acceleration` in several files."""
    for system in (kd.systems.kepler(0.5), kd.systems.harmonic_oscillator(3.0), kd.systems.pendulum(1.0)):
        density, x, v, out = by_acceleration(system), system.x0[None], system.v0[None], np.zeros(system.x0.size)
        system.acceleration(0.0, system.x0.reshape(-1), system.v0.reshape(-1), system.params, out)
        value = evaluate_quantity(density, system, np.zeros(1), x, v)
        assert value == pytest.approx(np.sqrt(np.linalg.norm(out)), rel=1e-14)


@pytest.mark.parametrize("control", REVERSIBLE[2:], ids=_ids)
def test_order_of_the_other_controls(control):
    system, errors = kd.systems.kepler(eccentricity=0.6), []
    for step in (0.01, 0.005):
        sol = kd.solve(system, (0.0, 9.0), step=step, step_control=control)
        errors.append(np.abs(sol.x - system.exact(sol.t)[0]).max())
    assert abs(np.log2(errors[0] / errors[1]) - 2) < 0.1


def test_logarithmic_hamiltonian_has_the_order_of_the_word():
    system, errors = kd.systems.kepler(eccentricity=0.6), []
    for step in (0.04, 0.02):
        sol = kd.solve(
            system, (0.0, 9.0), step=step, step_control=kd.LogarithmicHamiltonian(), method="blanes-moan-s10"
        )
        errors.append(np.abs(sol.x - system.exact(sol.t)[0]).max())
    assert abs(np.log2(errors[0] / errors[1]) - 6) < 0.1


def test_forces_see_the_time_of_their_step():
    def force(t, x):
        return -x + np.cos(2 * t)

    errors = []
    for step in (0.02, 0.01):
        sol = kd.solve(
            force, (0.5, 7.0), [1.0], [0.0], step=step, method="blanes-moan-s6", step_control=lambda x: 1 + x[0] ** 2
        )
        c = np.cos(2 * 0.5) / -3.0  # the solution -cos(2 t) / 3 + a cos(t - 0.5) + b sin(t - 0.5)
        a, b = 1.0 - c, -2 / 3 * np.sin(1.0)
        exact = -np.cos(14.0) / 3 + a * np.cos(6.5) + b * np.sin(6.5)
        errors.append(abs(sol.x[-1, 0] - exact))
    assert abs(np.log2(errors[0] / errors[1]) - 4) < 0.3


def test_the_first_step_is_the_one_given_and_ranges_are_true():
    sol = kd.solve(_eccentric(), (0, 3 * PERIOD), step=0.001, step_control="distance")
    steps = np.diff(sol.t)
    assert steps[0] == pytest.approx(0.001, rel=0.02)
    assert sol.step_range[0] <= steps[:-1].min() * (1 + 1e-12)
    assert sol.step_range[1] == pytest.approx(steps.max(), rel=1e-9)
    assert sol.t[-1] == 3 * PERIOD
    assert np.all(steps > 0)


def test_interpreted_steps_are_those_of_compiled_code():
    def gravity(x):
        return -x / (x[0] ** 2 + x[1] ** 2) ** 1.5

    problem = kd.SecondOrder(gravity, energy=lambda x, v: v @ v / 2 - 1 / np.sqrt(x @ x))
    for control in (kd.HairerSoderlind(lambda x: 1 / (x @ x)), kd.LogarithmicHamiltonian(), kd.LocalError(1e-5, 1e-8)):
        one, other = (
            kd.solve(
                problem,
                (0, 3.0),
                [1.0, 0.0],
                [0.0, 0.7],
                step=0.01,
                step_control=control,
                compile=compiles,
                method="velocity-verlet",
            )
            for compiles in (True, False)
        )
        assert one.n_steps == other.n_steps
        assert np.abs(one.x[-1] - other.x[-1]).max() < 1e-11


# -- by the error -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "method", ["semi-implicit-euler", "velocity-verlet", "dop853", "auto", "composition-diagonal-6"]
)
def test_errors_follow_the_tolerance(method):
    problem = kd.SecondOrder(lambda x: -x / (x @ x) ** 1.5)
    system, errors = kd.systems.kepler(eccentricity=0.5), []
    tolerances = (1e-4, 1e-5) if method == "semi-implicit-euler" else (1e-5, 1e-8)
    for tolerance in tolerances:
        sol = kd.solve(problem, (0, 10.0), system.x0, system.v0, rtol=tolerance, atol=tolerance, method=method)
        assert sol.success
        assert sol.t[-1] == 10.0
        errors.append(np.abs(sol.x[-1] - system.exact(sol.t[-1:])[0][0]).max())
    assert errors[1] < 0.5 * errors[0]
    assert errors[1] < 1e4 * tolerances[1]


def test_pythagorean_bodies():
    data = json.loads((Path(__file__).parent / "data" / "nbody_reference.json").read_text())["pythagorean"]
    system = kd.systems.nbody([3, 4, 5], [[1, 3, 0], [-2, -1, 0], [1, -1, 0]], np.zeros((3, 3)))
    exact = np.array(data["states"][data["times"].index("10")], dtype=float).reshape(3, 6)[:, :3]
    sol = kd.solve(system, (0, 10), rtol=1e-12, atol=1e-13, method="dop853")
    assert np.abs(sol.x[-1] - exact).max() < 1e-7
    assert sol.n_force_evaluations < 30_000
    by_logarithm = kd.solve(system, (0, 10), step=0.02, step_control=kd.LogarithmicHamiltonian(), method="kahan-li-8")
    assert np.abs(by_logarithm.x[-1] - exact).max() < 1e-7
    by_density = kd.solve(system, (0, 10), step=0.01, step_control="own", method="kahan-li-8")
    assert np.abs(by_density.x[-1] - exact).max() < 1e-7


def test_stiff_decay_after_a_transient_takes_long_steps():
    def decay(y):
        return np.array([-1000 * (y[0] - np.cos(y[1])) - np.sin(y[1]), 1.0])

    sol = kd.solve(kd.FirstOrder(decay), (0, 10), [0.0, 0.0], rtol=1e-4, atol=1e-6, method="radau-5")
    assert abs(sol.y[-1, 0] - np.cos(10)) < 1e-3
    assert sol.step_range[1] > 100 * sol.step_range[0]


def test_a_given_first_step_is_tried_first_and_rejected_ones_are_counted():
    sol = kd.solve(_eccentric(), (0, 1.0), step=1.0, rtol=1e-9, atol=1e-12, method="velocity-verlet")
    assert sol.n_rejected >= 4
    assert "rejected" in sol.report()
    trials = sol.n_steps + sol.n_rejected
    assert sol.n_force_evaluations > 4 * trials


# -- rows, dense output, events ---------------------------------------------------------------------------------------

CONTROLS = [{"step_control": control, "step": 0.005} for control in REVERSIBLE] + [{"rtol": 1e-8, "atol": 1e-10}]


@pytest.mark.parametrize("options", CONTROLS, ids=lambda options: _ids(options.get("step_control")))
@pytest.mark.parametrize("backwards", [False, True])
def test_states_between_steps_and_at_wanted_times(options, backwards):
    system = kd.systems.kepler(eccentricity=0.6)
    span = (0.0, -10.0) if backwards else (0.0, 10.0)
    order = {} if "step" in options else {"method": "blanes-moan-srkn6b"}
    every = kd.solve(system, span, **options, **order)
    tolerance = 3 * np.abs(every.x - system.exact(every.t)[0]).max() + 1e-12
    wanted = np.linspace(*span, 37)
    dense = every(wanted)
    assert np.abs(dense.x - system.exact(wanted)[0]).max() < tolerance
    picked = kd.solve(system, span, t_eval=wanted, **options, **order)
    assert np.array_equal(picked.t, wanted)
    assert np.abs(picked.x - dense.x).max() < 1e-12
    tangled = wanted[[5, 5, 30, 2, 36, 0]]
    assert np.abs(kd.solve(system, span, t_eval=tangled, **options, **order).x - every(tangled).x).max() < 1e-12
    some = kd.solve(system, span, save_every=7, **options, **order)
    sevenths = every.x[:-1][::7]
    assert np.array_equal(some.x[: len(sevenths)], sevenths)
    with pytest.raises(ArgumentError, match="several steps after a row"):
        some(wanted)


@pytest.mark.parametrize("options", CONTROLS, ids=lambda options: _ids(options.get("step_control")))
def test_events_between_steps_that_vary(options):
    def crossing(x):
        return x[1]

    def stop(t, x):
        return t - 25.0

    crossing.direction, stop.terminal = 1, True
    system = kd.systems.kepler(eccentricity=0.6)
    order = {} if "step" in options else {"method": "blanes-moan-srkn6b"}
    sol = kd.solve(system, (0, 40.0), events=[crossing, stop], **options, **order)
    assert sol.status is Outcome.STOPPED
    assert sol.t[-1] == pytest.approx(25.0, abs=1e-13)
    error = np.abs(sol.x - system.exact(sol.t)[0]).max()
    assert np.abs(sol.t_events[0] - PERIOD * np.arange(1, 4)).max() < 3 * error + 1e-9
    assert np.abs(sol.x_events[0][:, 1]).max() < 1e-12
    plain = kd.solve(system, (0, 40.0), **options, **order)
    rows = sol.t.size - 2
    assert np.array_equal(sol.x[:rows], plain.x[:rows])


def test_runs_keep_their_bits_and_save_every_changes_none(tmp_path):
    one, two = (kd.solve(_eccentric(), (0, 20 * PERIOD), step=0.001, step_control="distance") for _ in range(2))
    assert np.array_equal(one.x, two.x)
    assert np.array_equal(one.t, two.t)
    loaded = kd.load(one.save(tmp_path / "orbit.npz"))
    assert loaded.about.step_control == one.about.step_control
    assert "Hairer-Soederlind, density by distance" in loaded.report()
    assert loaded.step_range == one.step_range


@pytest.mark.parametrize(
    ("problem", "start", "method"),
    [
        (kd.Damped(lambda x: -x - x**3, damping=0.1), (1.0, 0.5), "conformal-verlet"),
        (kd.FirstOrder(lambda y: np.array([y[1], -y[0] - y[0] ** 3])), ([1.0, 0.0], None), "implicit-midpoint"),
        (
            kd.Hamiltonian(dHdq=lambda q, p: q + p**2 * q, dHdp=lambda q, p: p * (1 + q**2)),
            (1.0, 0.0),
            "implicit-midpoint",
        ),
        (kd.SecondOrder(lambda x, v: -x - 0.1 * v**2 * x), (1.0, 0.0), "implicit-verlet"),
        (kd.systems.kepler(eccentricity=0.5), (None, None), "velocity-verlet"),
    ],
    ids=lambda given: given if isinstance(given, str) else "",
)
def test_a_density_takes_the_symmetric_method_of_order_two_for_the_kind(problem, start, method):
    compiles = isinstance(problem, kd.System)
    exact = kd.solve(problem, (0, 5.0), *start, method="dop853", rtol=1e-12, atol=1e-12, compile=compiles).x[-1]
    density = (lambda x: 1 + x @ x) if np.ndim(start[0]) or start[0] is None else (lambda x: 1 + x * x)
    errors = []
    for step in (0.01, 0.005):
        sol = kd.solve(problem, (0, 5.0), *start, step=step, step_control=density, compile=compiles)
        assert sol.about.method == method
        errors.append(np.abs(sol.x[-1] - exact).max())
    assert abs(np.log2(errors[0] / errors[1]) - 2) < 0.1


# -- what cannot be ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({}, "step is missing"),
        ({"step": 0.1, "step_control": 3}, "step_control=3 is not a step control"),
        ({"step": 0.1, "step_control": "speed"}, "density='speed'"),
        ({"step": 0.1, "step_control": "distance", "rtol": 1e-3}, "each chooses the steps"),
        ({"step": 0.1, "step_control": "distance", "method": "semi-implicit-euler"}, "not symmetric"),
        ({"step": 0.1, "step_control": kd.HuangLeimkuhler(), "method": "kahan-li-8"}, "order 2"),
        ({"step": 0.1, "step_control": kd.TimeTransformed(), "method": "kahan-li-8"}, "order 2"),
        (
            {"step": 0.1, "step_control": kd.LogarithmicHamiltonian(), "method": "blanes-moan-srkn6b"},
            "keep their order",
        ),
        ({"step": 0.1, "step_control": kd.LogarithmicHamiltonian(), "method": "gauss-4"}, "keep their order"),
        ({"step": 0.1, "step_control": "distance", "method": "wisdom-holman-corrected-3"}, "corrector"),
        ({"step": 0.1, "step_control": lambda x: -1.0}, "must be positive and finite"),
        ({"step": 0.1, "step_control": lambda x: 1 + x @ x, "compile": False}, "leave compile=False out"),
        ({"step": 0.1, "step_control": lambda x: 0.0}, "must be positive and finite"),
        ({"step": 0.1, "step_control": lambda x: np.nan}, "must be positive and finite"),
        ({"step": 0.1, "step_control": lambda x, v: 2 + v[1]}, "velocities reversed"),
        ({"step": 0.1, "step_control": kd.TimeTransformed(lambda x, v: 1 + v @ v)}, "depends on v"),
        ({"rtol": -1e-3}, "rtol=-0.001"),
        ({"rtol": 1e-17}, "rtol=1e-17"),
        ({"rtol": np.nan}, "rtol=nan"),
        ({"rtol": "much"}, "rtol='much'"),
        ({"rtol": 0.0, "atol": 0.0}, "positive atol"),
        ({"atol": -1.0}, "atol=-1.0"),
        ({"atol": [1e-3, 1e-3, 1e-3]}, "atol="),
        ({"step": -1.0, "rtol": 1e-3}, "step=-1.0"),
        ({"step": 100.0, "rtol": 1e-3}, "step=100.0"),
    ],
)
def test_what_cannot_be_is_said_before_the_run(options, text):
    with pytest.raises(ArgumentError) as error:
        kd.solve(_eccentric(), (0, 1.0), **options)
    assert text in str(error.value)


def test_logarithmic_hamiltonian_needs_a_binding_energy():
    spring = kd.systems.harmonic_oscillator()
    with pytest.raises(ArgumentError, match="negative potential energy"):
        kd.solve(spring, (0, 1.0), step=0.1, step_control=kd.LogarithmicHamiltonian())
    with pytest.raises(ArgumentError, match="needs the energy"):
        kd.solve(lambda x: -x, (0, 1.0), 1.0, 0.0, step=0.1, step_control=kd.LogarithmicHamiltonian())


def test_methods_whose_flows_remember_keep_their_accuracy():
    pendulum = kd.Constrained(
        force=lambda x: np.array([0.0, -9.81]),
        constraint=lambda x: x[0] ** 2 + x[1] ** 2 - 1,
        energy=lambda x, v: 0.5 * (v[0] ** 2 + v[1] ** 2) + 9.81 * x[1],
    )
    swing = kd.solve(pendulum, (0, 3.0), [1, 0], [0, 0.1], rtol=1e-6, atol=1e-6, method="rattle")
    assert np.abs(swing.energy - swing.energy[0]).max() < 2e-3
    beads = kd.Multirate(slow_force=lambda x: -x, fast_force=lambda x: -400 * (x - 1) ** 3)
    exact = kd.solve(beads, (0, 5.0), 1.5, 0.1, step=1e-3, method="blanes-moan-srkn6b")
    sol = kd.solve(beads, (0, 5.0), 1.5, 0.1, rtol=1e-6, atol=1e-6, method="respa-2")
    assert abs(sol.v[-1] - exact.v[-1]) < 2e-2
    curved = kd.Hamiltonian(dHdq=lambda q, p: q * (1 + p * p), dHdp=lambda q, p: p * (1 + q * q))
    whole = kd.solve(curved, (0, 5.0), 0.5, 0.3, step=0.02, method="gauss-6", compile=False)
    doubled = kd.solve(curved, (0, 5.0), 0.5, 0.3, rtol=1e-7, atol=1e-7, method="tao-4")
    assert abs(doubled.q[-1] - whole.q[-1]) < 1e-4
    with pytest.raises(ArgumentError, match="kicks and drifts"):
        kd.solve(pendulum, (0, 1.0), [1, 0], [0, 0.1], step=0.01, step_control=kd.HuangLeimkuhler(), method="rattle")


def test_noise_has_steps_of_one_size():
    bath = kd.Langevin(lambda x: -x, temperature=1.0, friction=1.0, seed=1)
    with pytest.raises(ArgumentError, match="noise"):
        kd.solve(bath, (0, 1.0), 1.0, 0.0, step=0.1, step_control="acceleration")


@pytest.mark.parametrize("control", [kd.HairerSoderlind, kd.HuangLeimkuhler, kd.TimeTransformed])
def test_a_density_that_reaches_zero_ends_the_run_where_it_was_good(control):
    sol = kd.solve(lambda x: 0 * x, (0, 10.0), [1.0], [-1.0], step=0.01, step_control=control(lambda x: x[0]))
    assert sol.status is Outcome.NO_STEP
    assert 0.7 < sol.t[-1] < 1.001
    assert "The step density" in sol.message
    assert "zero" in sol.message


@pytest.mark.parametrize("control", [kd.HairerSoderlind, kd.HuangLeimkuhler, kd.TimeTransformed])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan])
def test_a_density_that_jumps_to_no_density_is_said_to(control, value):
    sol = kd.solve(
        lambda x: 0 * x,
        (0, 10.0),
        [1.0],
        [-1.0],
        step=0.01,
        step_control=control(lambda x: 1.0 if x[0] > 0.5 else value),
    )
    assert 0.4 < sol.t[-1] < 0.51
    assert "is zero, negative or not a number there" in sol.message


def test_a_singularity_ends_steps_by_their_error():
    sol = kd.solve(lambda x: -1 / x**2, (0, 10.0), [1.0], [0.0], rtol=1e-8, atol=1e-10, method="velocity-verlet")
    assert sol.status in (Outcome.NO_STEP, Outcome.NOT_FINITE)
    assert sol.t[-1] == pytest.approx(np.pi / np.sqrt(8), abs=1e-4)


@pytest.mark.parametrize("control", [None, kd.HairerSoderlind(), kd.HuangLeimkuhler(), kd.TimeTransformed()], ids=_ids)
def test_a_motion_that_goes_to_infinity_ends_the_run_there(control):
    """x'' = 5 x^3 from rest at 1 does so at t = K(1/2) / sqrt(5), with the parameter 1/2 of the elliptic integral."""
    options = {"rtol": 1e-9, "atol": 1e-9} if control is None else {"step": 1e-2, "step_control": control}
    sol = kd.solve(lambda x: 5 * x**3, (0, 10.0), 1.0, 0.0, method="velocity-verlet", save_every=10**7, **options)
    assert sol.status is Outcome.NO_STEP
    assert sol.t[-1] == pytest.approx(1.8540746773013719 / np.sqrt(5), abs=1e-3)
    assert sol.x[-1] > 1e5
    assert "goes to infinity" in sol.message


def test_steps_lost_beside_the_time_in_a_close_encounter_end_no_run():
    start, fastest = [2.0, 0.0], np.sqrt(5e-9)  # eccentricity of 1 - 1e-8
    sol = kd.solve(
        lambda x: -x / np.linalg.norm(x) ** 3, (0, 20.0), start, [0.0, fastest], step=1e-3, step_control="distance"
    )
    assert sol.success
    assert sol.step_range[0] < np.spacing(1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isfinite(sol(np.linspace(0, 20, 100)).x).all()


EVERY_CONTROL = (
    kd.LocalError(1e-9, 1e-9),
    kd.HairerSoderlind(lambda x: 1 + x[0] ** 4),
    kd.HuangLeimkuhler(),
    kd.TimeTransformed(),
    kd.LogarithmicHamiltonian(),
)


@pytest.mark.parametrize("control", EVERY_CONTROL, ids=lambda control: type(control).__name__)
def test_max_steps_ends_any_run_whose_steps_vary_and_it_can_go_on(control):
    """x'' = 5 x^3 reaches infinity at t = 0.829, and with the density 1 + x^4 in steps of which each still counts."""
    run = partial(
        kd.solve,
        kd.SecondOrder(lambda x: 5 * x**3, energy=lambda x, v: v @ v / 2 - 5 * x @ x**3 / 4),
        (0, 10.0),
        [1.0],
        [0.0],
    )
    options = {"step": 1e-2, "step_control": control, "method": "velocity-verlet", "save_every": 7}
    some, more = run(max_steps=40, **options), run(max_steps=64, **options)
    assert (some.status, some.n_steps) == (Outcome.STEP_LIMIT, 40)
    assert "after 40 steps. Give a larger max_steps" in some.message
    on = some.continue_to(10.0)
    assert (on.status, on.n_steps) == (Outcome.STEP_LIMIT, 80)
    assert np.array_equal(on.x[:10], more.x[:10])
    assert np.array_equal(run(max_steps=80, **options).x, on.x)


def test_equal_steps_beyond_max_steps_are_refused():
    run = partial(kd.solve, _eccentric(), (0.0, 1.0), step=0.01)
    assert run(max_steps=100).success
    with pytest.raises(ArgumentError, match=r"max_steps=99: step=0\.01 cuts t_span into 100 steps"):
        run(max_steps=99)
    with pytest.raises(ArgumentError, match="max_steps=0 must be a positive whole number"):
        run(max_steps=0, step_control="distance")


def test_a_run_that_resumes_may_take_max_steps_again(tmp_path):
    run = partial(
        kd.solve,
        _eccentric(),
        (0.0, 20.0),
        step=1e-3,
        step_control="distance",
        checkpoint=tmp_path,
        checkpoint_every=30,
    )
    assert [run(max_steps=100).n_steps for _ in range(3)] == [100, 200, 300]
    whole = kd.solve(_eccentric(), (0.0, 20.0), step=1e-3, step_control="distance")
    assert np.array_equal(run().x, whole.x)


def test_a_function_that_fails_later_keeps_what_is_done():
    def force(t, x):
        if t > 3.0:
            raise ValueError("no more")
        return -x

    sol = kd.solve(force, (0, 10.0), [1.0], [0.0], rtol=1e-6, atol=1e-8, method="velocity-verlet", compile=False)
    assert sol.status is Outcome.FAILED
    assert 2.5 < sol.t[-1] <= 3.0
    assert "no more" in sol.message


@pytest.mark.parametrize("method", ["dop853", "velocity-verlet"])
def test_a_force_that_fails_at_once_ends_the_run_at_its_start(method):
    """At t = 0 no step is lost beside the time."""

    def fails(t, x):
        return -x if t == 0.0 else np.nan * x

    sol = kd.solve(fails, (0.0, 1.0), [1.0], [-1.0], rtol=1e-6, method=method)
    assert sol.status is Outcome.NO_STEP
    assert sol.t[-1] < 1e-15


@pytest.mark.parametrize(
    ("method", "tolerance"), [("stormer-verlet", 1e-5), ("kahan-li-8", 1e-9), ("tao-2", 1e-5), ("tao-4", 1e-7)]
)
def test_errors_are_those_wanted_where_the_rate_of_x_depends_on_time(method, tolerance):
    """The halves of a step begin with both clocks at its start."""
    problem = kd.Separable(
        kinetic_gradient=lambda t, p: p / np.sqrt(1 + p * p) * (1 + 0.5 * np.cos(3 * t)),
        potential_gradient=lambda t, q: (q + q**3) * (1 + 0.3 * np.sin(2 * t)),
    )
    exact = kd.solve(problem, (0.2, 8.0), 0.5, 0.3, rtol=1e-12, atol=1e-13, method="dop853")
    found = kd.solve(problem, (0.2, 8.0), 0.5, 0.3, rtol=tolerance, atol=tolerance, method=method)
    assert abs(found.x[-1] - exact.x[-1]) < 20 * tolerance
    steps = kd.solve(problem, (0.2, 8.0), 0.5, 0.3, step=7.8 / found.n_steps, method=method)
    assert abs(found.x[-1] - exact.x[-1]) < 20 * abs(steps.x[-1] - exact.x[-1])
