"""Methods of kicks and drifts as solvers of SciPy do what SciPy asks of its own."""

import numpy as np
import pytest
from scipy.integrate import OdeSolver, solve_ivp

import kickdrift as kd
import kickdrift.scipy as ks
from kickdrift.core.errors import ArgumentError

SOLVERS = [ks.SemiImplicitEuler, ks.StormerVerlet, ks.Ruth3, ks.BlanesMoanS6, ks.BlanesMoanSrkn6b, ks.Yoshida6]
START = [1.0, 0.2]


def driven(t, y):
    return [y[1], -np.sin(y[0]) + 0.3 * np.cos(t)]


def relativistic(t, y):
    return [y[1] / np.sqrt(1 + y[1] ** 2), -y[0] - y[0] ** 3]


class Reused:
    """A function that returns the same array each time."""

    def __init__(self):
        self.out = np.zeros(2)

    def __call__(self, t, y):
        self.out[:] = y[1], -y[0] - 0.1 * y[1]
        return self.out


REFERENCES = {
    fun: solve_ivp(fun, (0.0, 5.0), START, "DOP853", rtol=1e-13, atol=1e-14, dense_output=True).sol
    for fun in (driven, relativistic)
}


@pytest.mark.parametrize("solver", SOLVERS, ids=lambda solver: solver.__name__)
@pytest.mark.parametrize("fun", [driven, relativistic])
def test_orders_at_the_end_and_between_steps(solver, fun):
    if fun is relativistic and solver is ks.BlanesMoanSrkn6b:
        with pytest.raises(ArgumentError, match="x' is not linear in v"):
            solve_ivp(fun, (0.0, 5.0), START, solver, step=0.1)
        return
    n = {1: 400, 2: 100, 3: 100, 4: 60, 6: 80}[solver.method.order]
    times, errors = np.array([0.777, 2.345, 4.4444, 5.0]), []
    for m in (n, 2 * n):
        sol = solve_ivp(fun, (0.0, 5.0), START, solver, step=5.0 / m, dense_output=True)
        assert sol.success
        assert sol.t.size == m + 1
        errors.append(np.abs(sol.sol(times) - REFERENCES[fun](times)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(solver.method.order, abs=0.1)


@pytest.mark.parametrize("solver", [ks.SemiImplicitEuler, ks.StormerVerlet], ids=lambda solver: solver.__name__)
def test_steps_are_those_of_kickdrift(solver):
    sol = solve_ivp(lambda t, y: [y[1], -np.sin(y[0])], (0.0, 5.0), START, solver, step=0.05)
    own = kd.solve(lambda x: -np.sin(x), (0.0, 5.0), *START, step=0.05, method=solver.method.name, compile=False)
    np.testing.assert_allclose(sol.y, [own.x, own.v], atol=1e-13)


def test_wanted_times_events_and_the_way_back():
    def fun(t, y):
        return [y[1], -y[0]]

    def crossing(t, y):
        return y[0]

    crossing.terminal, crossing.direction = False, -1
    options = {"method": ks.BlanesMoanS6, "step": 0.05}
    wanted = np.linspace(0.0, 10.0, 37)
    sol = solve_ivp(fun, (0.0, 10.0), [1.0, 0.0], t_eval=wanted, events=crossing, **options)
    np.testing.assert_allclose(sol.y[0], np.cos(wanted), atol=1e-6)
    np.testing.assert_allclose(sol.t_events[0], [np.pi / 2, 5 * np.pi / 2], atol=1e-6)
    crossing.terminal = True
    assert solve_ivp(fun, (0.0, 10.0), [1.0, 0.0], events=crossing, **options).t[-1] == pytest.approx(
        np.pi / 2, abs=1e-6
    )
    back = solve_ivp(fun, (10.0, 0.0), sol.y[:, -1], dense_output=True, **options)
    assert back.t[-1] == 0.0
    np.testing.assert_allclose(back.y[:, -1], [1.0, 0.0], atol=1e-12)  # a symmetric method goes back the way it came
    assert back.sol(3.333).shape == (2,)
    assert back.sol([3.3, 4.4]).shape == (2, 2)


def test_vectorised_functions_of_many_bodies():
    def fun(t, y):
        return np.concatenate((y[3:], -np.arange(1.0, 4.0).reshape(3, *[1] * (y.ndim - 1)) * y[:3]))

    start = np.concatenate((np.ones(3), np.zeros(3)))
    plain, vectorised = (
        solve_ivp(fun, (0.0, 2.0), start, ks.Yoshida6, step=0.02, vectorized=yes) for yes in (False, True)
    )
    np.testing.assert_array_equal(plain.y, vectorised.y)
    np.testing.assert_allclose(plain.y[:3, -1], np.cos(2.0 * np.sqrt(np.arange(1.0, 4.0))), atol=1e-8)


def test_energy_stays_where_a_runge_kutta_method_loses_it():
    def fun(t, y):
        return [y[1], -np.sin(y[0])]

    ours, theirs = (
        solve_ivp(fun, (0.0, 2000.0), [2.0, 0.0], method=method, **options)
        for method, options in ((ks.BlanesMoanS6, {"step": 0.2}), ("RK45", {"rtol": 1e-4, "atol": 1e-6}))
    )
    drifts = [np.abs(sol.y[1] ** 2 / 2 - np.cos(sol.y[0]) + np.cos(2.0))[-500:].max() for sol in (ours, theirs)]
    assert drifts[0] < 1e-4 < drifts[1]


def test_solvers_are_scipys_and_named():
    assert issubclass(ks.SemiImplicitEuler, OdeSolver)
    with pytest.raises(ArgumentError, match="needs more than kicks and drifts"):
        ks.solver("gauss-4")
    assert ks.solver("kahan-li-8").method.order == 8


@pytest.mark.parametrize(
    ("fun", "y0", "options", "text"),
    [
        (driven, START, {}, "step=None must be positive"),
        (driven, START, {"step": 0.0}, "step=0.0"),
        (driven, START, {"step": np.nan}, "step=nan"),
        (driven, START, {"step": "small"}, "step='small'"),
        (lambda t, y: -y, [1.0, 2.0, 3.0], {"step": 0.1}, "y0 has 3 numbers"),
        (lambda t, y: [y[1], -y[0] - 0.1 * y[1]], START, {"step": 0.1}, "v' depends on v"),
        (lambda t, y: [y[1] + y[0], -y[0]], START, {"step": 0.1}, "x' depends on x"),
        (lambda t, y: [y[1], -y[0] * y[1]], [0.0, 1.0], {"step": 0.1}, "v' depends on v"),  # though not at the start
        (lambda t, y: [y[1], -y[0] - t * y[1]], START, {"step": 0.1}, "v' depends on v"),
        (lambda t, y: [*y[2:], y[3] - y[2], y[2] - y[3]], [1.0, 0.0, 0.0, 0.0], {"step": 0.1}, "v' depends on v"),
        (Reused(), START, {"step": 0.1}, "v' depends on v"),
        (lambda t, y: [y[1]], START, {"step": 0.1}, r"returned an array of shape \(1,\), but y0 has 2 numbers"),
    ],
)
def test_what_cannot_be_solved(fun, y0, options, text):
    with pytest.raises(ArgumentError, match=text):
        solve_ivp(fun, (0.0, 1.0), y0, ks.StormerVerlet, **options)


def test_methods_for_linear_drifts_refuse_others_from_rest():
    with pytest.raises(ArgumentError, match="x' is not linear in v"):
        solve_ivp(relativistic, (0.0, 1.0), [1.0, 0.0], ks.BlanesMoanSrkn6b, step=0.1)


@pytest.mark.parametrize("end", [np.inf, np.nan])
def test_ends_are_finite(end):
    with pytest.raises(ArgumentError, match="must be finite"):
        ks.StormerVerlet(driven, 0.0, START, end, step=0.1)


def test_options_of_other_solvers_are_warned_of_and_states_that_overflow_are_said():
    with pytest.warns(UserWarning, match="rtol given"):
        solve_ivp(driven, (0.0, 1.0), START, ks.StormerVerlet, step=0.1, rtol=1e-6)
    with np.errstate(all="ignore"):
        sol = solve_ivp(lambda t, y: [y[1], y[0] ** 3], (0.0, 50.0), [9.0, 9.0], ks.StormerVerlet, step=0.1)
    assert not sol.success
    assert "not finite" in sol.message


def test_classes_have_the_names_under_which_they_are_found():
    assert all(getattr(ks, solver.__name__) is solver for solver in SOLVERS)
