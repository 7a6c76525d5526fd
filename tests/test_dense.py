"""Dense output: states between the steps have the order of the method, and are on its way."""

import copy
import pickle

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.core.outcomes import Outcome

TIMES = np.array([0.777, 1.2345, 2.5, 3.456])  # between steps, whatever these are


def forced(t, x):
    return -x - x**3 + np.cos(2 * t)


def damped(t, x, v):
    return -np.sin(x) - 0.1 * v - 0.05 * v**3 + 0.3 * np.cos(t)


def reference(rates, start, times=TIMES):
    exact = solve_ivp(rates, (0.0, 4.0), start, "DOP853", t_eval=np.sort(times), rtol=1e-13, atol=1e-14).y
    return exact[:, np.argsort(np.argsort(times))]


def second_order(acceleration):
    return reference(lambda t, z: [z[1], acceleration(t, z[0], z[1])], [1.0, 0.3])


entangled = kd.Hamiltonian(dHdq=lambda q, p: q * (1 + p * p), dHdp=lambda q, p: p * (1 + q * q))
van_der_pol = kd.FirstOrder(lambda t, y: np.array([y[1], (1 - y[0] ** 2) * y[1] - y[0] + np.cos(t)]))

FORCED, DAMPED = second_order(lambda t, x, v: forced(t, x)), second_order(damped)
ENTANGLED = reference(lambda t, z: [z[1] * (1 + z[0] ** 2), -z[0] * (1 + z[1] ** 2)], [1.0, 0.3])
VAN_DER_POL = reference(lambda t, y: [y[1], (1 - y[0] ** 2) * y[1] - y[0] + np.cos(t)], [1.0, 0.3])


def between(problem, method, n, times=TIMES, **options):
    start = ([1.0, 0.3],) if problem is van_der_pol else (1.0, 0.3)
    options = {"compile": False, "progress": False} | options
    sol = kd.solve(problem, (0.0, 4.0), *start, step=4.0 / n, method=method, **options)
    x, v = sol(times)
    return x.T if problem is van_der_pol else np.array([x, v])


@pytest.mark.parametrize(
    ("problem", "exact", "method", "n"),
    [
        (forced, FORCED, "semi-implicit-euler", 400),
        (forced, FORCED, "drift-kick", 400),
        (forced, FORCED, "velocity-verlet", 80),
        (forced, FORCED, "position-verlet", 80),
        (forced, FORCED, "ruth-3", 80),
        (forced, FORCED, "forest-ruth-4", 120),
        (forced, FORCED, "blanes-moan-srkn6b", 40),
        (forced, FORCED, "yoshida-6", 80),
        (forced, FORCED, "gauss-6", 30),
        (damped, DAMPED, "gauss-4", 60),
        (damped, DAMPED, "rk4", 120),
        (entangled, ENTANGLED, "implicit-midpoint", 80),
        (entangled, ENTANGLED, "gauss-4", 60),
        (van_der_pol, VAN_DER_POL, "radau-5", 80),
        (van_der_pol, VAN_DER_POL, "rk4", 240),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_between_steps_the_order_is_that_of_the_method(problem, exact, method, n):
    errors = [np.abs(between(problem, method, m) - exact).max() for m in (n, 2 * n)]
    order = np.log2(errors[0] / errors[1])
    assert errors[1] > 1e-12
    assert order == pytest.approx(kd.methods.get(method).order, abs=0.1)


def test_straight_lines_between_steps_would_have_order_two():
    def error(n):
        sol = kd.solve(forced, (0.0, 4.0), 1.0, 0.3, step=4.0 / n, method="yoshida-6", compile=False)
        return np.abs(np.interp(TIMES, sol.t, sol.x) - FORCED[0]).max()

    assert np.log2(error(80) / error(160)) < 2.5


OPTIONS = {"step": 0.05, "method": "yoshida-6", "progress": False}


@pytest.mark.parametrize("span", [(0.0, 3.0), (3.0, 0.0), (-1.0, 2.0)])
@pytest.mark.parametrize("save_every", [1, 7])
def test_rows_are_what_they_were_and_whole_steps_lead_to_them(span, save_every):
    every = kd.solve(kd.systems.kepler(eccentricity=0.3), span, **OPTIONS)
    sol = kd.solve(kd.systems.kepler(eccentricity=0.3), span, save_every=save_every, **OPTIONS)
    x, v = sol(sol.t)
    assert (x == sol.x).all()
    assert (v == sol.v).all()
    x, v = sol(every.t)
    np.testing.assert_allclose(x, every.x, atol=1e-13)
    np.testing.assert_allclose(v, every.v, atol=1e-13)
    x, v = sol(sol.t[1:] - 1e-7 * sol.step)
    np.testing.assert_allclose(x, sol.x[1:] - 1e-7 * sol.step * sol.v[1:], atol=1e-13)
    x, v = sol(sol.t[:-1] + 1e-7 * sol.step)
    np.testing.assert_allclose(x, sol.x[:-1] + 1e-7 * sol.step * sol.v[:-1], atol=1e-13)


def test_shapes_are_those_of_the_times_and_the_state():
    sol = kd.solve(kd.systems.kepler(), (0.0, 1.0), **OPTIONS)
    shape = sol.x.shape[1:]
    assert sol(0.5)[0].shape == shape
    assert sol([0.1, 0.2, 0.3]).v.shape == (3, *shape)
    assert sol(np.full((2, 3), 0.123)).x.shape == (2, 3, *shape)
    assert sol([]).x.shape == (0, *shape)
    alone = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, compile=False, **OPTIONS)
    assert alone(0.51).x == pytest.approx(np.cos(0.51), abs=1e-8)
    assert alone(0.51).x.shape == ()


def test_constraints_hold_between_steps():
    pendulum = kd.Constrained(lambda x: np.array([0.0, -1.0]), lambda x: np.array([x[0] ** 2 + x[1] ** 2 - 1.0]))
    sol = kd.solve(
        pendulum, (0.0, 5.0), [1.0, 0.0], [0.0, 0.0], step=0.05, method="rattle", progress=False, save_every=20
    )
    x, v = sol(np.linspace(0.0, 5.0, 77))
    np.testing.assert_allclose((x**2).sum(axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose((x * v).sum(axis=1), 0.0, atol=1e-12)


@pytest.mark.parametrize("method", ["wisdom-holman", "saba-2"])
def test_split_and_corrected_methods_go_through_their_coordinates(method):
    planets = kd.systems.get("outer-solar-system")
    options = {"step": 50.0, "progress": False}
    sol = kd.solve(planets, (0.0, 5000.0), method=method, **options)
    fine = kd.solve(planets, (0.0, 5000.0), method="dop853", **options)
    t = np.array([1234.5, 3999.0, 77.7])
    error = np.abs(sol(t).x - fine(t).x).max()
    assert error < 3.0 * np.abs(sol.x - fine.x).max()


def test_wanted_times_may_be_any_in_any_order():
    system, wanted = kd.systems.kepler(eccentricity=0.3), [2.0, 1.111, 1.111, 1.111 + 1e-12, 0.0, 3.0, 0.05]
    sol = kd.solve(system, (0.0, 3.0), t_eval=wanted, **OPTIONS)
    every = kd.solve(system, (0.0, 3.0), **OPTIONS)
    assert (sol.t == wanted).all()
    assert (sol.x == every(wanted).x).all()
    assert (sol.v == every(wanted).v).all()
    np.testing.assert_allclose(sol.energy, every.energy[0], atol=1e-7)
    np.testing.assert_allclose(sol(1.7).x, every(1.7).x, atol=1e-13)  # from the row that it kept before, in time
    back = kd.solve(system, (3.0, 0.0), t_eval=[0.123, 2.9], **OPTIONS)
    np.testing.assert_allclose(back.x, kd.solve(system, (3.0, 0.0), **OPTIONS)([0.123, 2.9]).x, atol=1e-13)


def test_force_evaluations_between_steps_are_counted():
    calls = []

    def pull(x):
        calls.append(1)
        return -x

    options = {"step": 0.1, "compile": False, "progress": False}
    for method in ("velocity-verlet", "rk4", "implicit-midpoint"):
        grid = kd.solve(pull, (0.0, 2.0), 1.0, 0.0, method=method, t_eval=[1.0], **options)
        calls.clear()
        sol = kd.solve(pull, (0.0, 2.0), 1.0, 0.0, method=method, t_eval=[1.0, 0.55, 1.23], **options)
        begun = 1  # is the function one that can be called?
        assert sol.n_force_evaluations > grid.n_force_evaluations
        assert abs(len(calls) - sol.n_force_evaluations) <= begun


@pytest.mark.parametrize("events", [None, lambda x: x - 5.0])
def test_the_first_step_is_as_long_as_it_was_where_it_was_cut(events):
    """A ball flies to the wall in 0.05 of a step of 0.1, and returns."""
    options = {"step": 0.1, "method": "velocity-verlet", "impacts": lambda x: x, "events": events, "compile": False}
    sol = kd.solve(lambda x: 0.0 * x, (0.0, 2.0), 0.1, -2.0, t_eval=[1.0, 2.0], progress=False, **options)
    np.testing.assert_allclose(sol.x, [1.9, 3.9], atol=1e-12)
    np.testing.assert_allclose(sol([0.03, 0.05, 1.05]).x, [0.04, 0.0, 2.0], atol=1e-12)
    with pytest.raises(ArgumentError, match="several steps after a row"):
        sol(0.08)


def test_a_run_that_ended_early_has_the_times_before_its_end():
    def until_one(t, x):
        return -x if t < 1.0 else np.inf

    sol = kd.solve(until_one, (0.0, 3.0), 1.0, 0.0, step=0.1, t_eval=[0.55, 0.25, 2.5], compile=False, progress=False)
    assert sol.status is Outcome.NOT_FINITE
    np.testing.assert_allclose(sol.t, [0.55, 0.25, 1.0])
    assert np.isfinite(sol.x).all()


@pytest.mark.parametrize("t", [3.1, -0.1, np.nan, "now", None, 1j, [0.5, np.inf], [[1.0], [2.0, 3.0]]])
def test_times_that_cannot_be_asked_for(t):
    sol = kd.solve(lambda x: -x, (0.0, 3.0), 1.0, 0.0, step=0.1, compile=False, progress=False)
    with pytest.raises(ArgumentError, match=r"^t="):
        sol(t)


def test_where_the_way_is_not_known(tmp_path):
    sol = kd.solve(kd.systems.kepler(), (0.0, 1.0), **OPTIONS)
    assert (copy.deepcopy(sol)(0.33).x == sol(0.33).x).all()
    for other in (kd.load(sol.save(tmp_path / "kepler.npz")), pickle.loads(pickle.dumps(sol))):
        with pytest.raises(KickdriftError, match="without its equations"):
            other(0.33)
    noisy = {"t_span": (0.0, 1.0), "x0": 1.0, "v0": 0.0, "step": 0.1, "method": "baoab", "progress": False}
    langevin = kd.Langevin(lambda x: -x, 1.0, 0.3)
    with pytest.raises(KickdriftError, match="the path is stochastic"):
        kd.solve(langevin, **noisy)(0.33)
    for wanted in ([0.33], [0.5, 0.2]):
        with pytest.raises(ArgumentError, match=f"t_eval={wanted[0]}.* the nearest is"):
            kd.solve(langevin, t_eval=wanted, **noisy)


def test_a_function_that_fails_between_steps_costs_those_times_alone():
    def nowhere_else(t, x):
        if t not in (0.0, 0.5, 1.0):
            raise ValueError("off")
        return -x

    options = {"method": "velocity-verlet", "compile": False, "progress": False}
    sol = kd.solve(nowhere_else, (0.0, 1.0), 1.0, 0.0, step=0.5, t_eval=[0.5, 0.7], **options)
    assert sol.success
    assert "ValueError was raised: off" in sol.message
    assert (sol.t == [0.5]).all()
