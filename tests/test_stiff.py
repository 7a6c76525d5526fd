"""Radau methods: their tables, their order, and what they are for, where decays are much faster than the steps."""

from dataclasses import replace
from fractions import Fraction
from math import sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import roots_jacobi

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.flows import stiff
from kickdrift.methods import Kind, Letter, Method, Tableau, word

CATALOGUE = kd.methods.catalogue()
RADAU = ["radau-3", "radau-5", "radau-7"]

# Hairer, Wanner, Solving Ordinary Differential Equations II, tables IV.5.5 and IV.5.6.
S = sqrt(6)
PRINTED = {
    "radau-3": [[5 / 12, -1 / 12], [3 / 4, 1 / 4]],
    "radau-5": [
        [(88 - 7 * S) / 360, (296 - 169 * S) / 1800, (-2 + 3 * S) / 225],
        [(296 + 169 * S) / 1800, (88 + 7 * S) / 360, (-2 - 3 * S) / 225],
        [(16 - S) / 36, (16 + S) / 36, 1 / 9],
    ],
}


@pytest.mark.parametrize("name", PRINTED)
def test_tables_as_printed(name):
    tableau = CATALOGUE[name].tableau()
    assert np.allclose(np.array(tableau.a, dtype=float), PRINTED[name], rtol=0, atol=1e-15)
    assert tableau.stiffly_accurate


@pytest.mark.parametrize("name", RADAU)
def test_nodes_are_those_of_radau_quadrature(name):
    tableau = CATALOGUE[name].tableau()
    inner, _ = roots_jacobi(tableau.stages - 1, 1, 0)
    nodes = np.array(tableau.a, dtype=float).sum(axis=1)
    assert np.allclose(nodes, [*(inner + 1) / 2, 1], rtol=0, atol=2e-15)
    assert tableau.stiffly_accurate


def growth(name, z):
    """The stability function R(z) = 1 + z b (I - z a)^-1 1."""
    tableau = CATALOGUE[name].tableau()
    a, b = np.array(tableau.a, dtype=float), np.array(tableau.b, dtype=float)
    return 1 + z * b @ np.linalg.solve(np.eye(b.size) - z * a, np.ones(b.size))


@pytest.mark.parametrize("name", RADAU)
def test_they_are_l_stable_and_gauss_is_not(name):
    assert all(abs(growth(name, 1j * y)) <= 1 + 1e-14 for y in np.linspace(-50, 50, 1001))
    assert abs(growth(name, -1e8)) < 1e-7
    assert abs(growth("gauss-4", -1e8)) > 0.99


PROBLEMS = {
    "pendulum": ({"problem": lambda x: -np.sin(x), "x0": 2.0, "v0": 0.3}),
    "forced": ({"problem": lambda t, x: -x - x**3 + np.cos(2 * t), "x0": 0.7, "v0": 0.3}),
    "damped": ({"problem": lambda x, v: -np.sin(x) - 0.3 * v - 0.2 * v**3, "x0": 2.0, "v0": 0.5}),
    "partitioned": (
        {"problem": kd.Partitioned(lambda x, v: x * (1 - v), lambda x, v: v * (x - 1)), "x0": 0.5, "v0": 1.5}
    ),
    "first-order": (
        {
            "problem": kd.FirstOrder(
                lambda t, y: np.array([y[1] * y[2] - np.sin(t), -y[0] * y[2] + np.cos(3 * t), -0.5 * y[0] * y[1]])
            ),
            "x0": [1.0, 0.5, 0.3],
        }
    ),
}


@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize(
    ("method", "steps"), [("radau-3", (0.02, 0.01)), ("radau-5", (0.1, 0.05)), ("radau-7", (0.3, 0.15))]
)
def test_order(method, steps, name):
    found = kd.analysis.observed_order(
        method=method, steps=steps, t_span=(0.0, 3.0), compile=False, **PROBLEMS[name]
    ).order
    assert found == pytest.approx(CATALOGUE[method].order, abs=0.15)


def robertson(y, out):
    slow, middle, fast = 0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] * y[1]
    out[0] = middle - slow
    out[1] = slow - middle - fast
    out[2] = fast


def run(rates, y0, end, step, method, **options):
    return kd.solve(kd.FirstOrder(rates), (0.0, end), y0, step=step, method=method, compile=False, **options)


ROBERTSON_AT_1 = [0.9664597373330346, 3.0746265776127e-05, 0.03350951640118935]  # DOP853 and Radau of SciPy at 1e-13


@pytest.mark.parametrize(
    ("method", "step", "most"),
    [
        ("radau-3", 0.1, 1e-7),
        ("radau-3", 0.01, 1e-9),
        ("radau-5", 0.1, 1e-8),
        ("radau-5", 0.01, 1e-9),
        ("radau-7", 0.1, 1e-8),
    ],
)
def test_robertson_at_steps_thousands_of_times_its_fastest_decay(method, step, most):
    found = run(robertson, [1.0, 0.0, 0.0], 1.0, step, method)
    assert abs(found.y[-1] - ROBERTSON_AT_1).max() < most
    assert found.y.min() >= 0


def test_with_starts_that_are_not_held_back_it_finds_a_root_with_a_negative_concentration(monkeypatch):
    monkeypatch.setattr(stiff, "hold_back", lambda y, h, rate, stage: None)
    found = run(robertson, [1.0, 0.0, 0.0], 1.0, 0.01, "radau-3")
    assert found.y[-1, 1] < 0


def test_gauss_does_not_get_there():
    assert abs(run(robertson, [1.0, 0.0, 0.0], 1.0, 0.1, "gauss-4").y[-1] - ROBERTSON_AT_1).max() > 1e-3


def van_der_pol(y, out):
    out[0] = y[1]
    out[1] = 1000.0 * (1.0 - y[0] * y[0]) * y[1] - y[0]


def test_a_relaxation_oscillator_jumps_in_halved_steps(monkeypatch):
    found = run(van_der_pol, [2.0, 0.0], 900.0, 1.0, "radau-5", save_every=900)
    exact = solve_ivp(
        lambda t, y: [y[1], 1000.0 * (1.0 - y[0] * y[0]) * y[1] - y[0]],
        (0.0, 900.0),
        [2.0, 0.0],
        method="Radau",
        rtol=1e-8,
        atol=1e-10,
    ).y[0, -1]
    assert found.success
    assert exact < -1
    assert found.y[-1, 0] == pytest.approx(exact, abs=0.1)
    monkeypatch.setattr(stiff, "_LEAST_SHARE", 1.0)
    assert run(van_der_pol, [2.0, 0.0], 900.0, 1.0, "radau-5").status.name == "NOT_CONVERGED"


@pytest.mark.parametrize("method", [*RADAU, "auto"])
def test_jumps_of_a_relaxation_oscillator_are_within_the_tolerance(method):
    """A step that fails is rejected: halved by itself, it took the same substeps as its halves, whose error nothing showed."""
    problem = kd.FirstOrder(lambda y, params: np.array([y[1], params[0] * (1 - y[0] ** 2) * y[1] - y[0]]))
    mu, end, tolerance = 1000.0, 2000.0, 1e-6
    exact = solve_ivp(
        lambda t, y: [y[1], mu * (1 - y[0] ** 2) * y[1] - y[0]],
        (0.0, end), [2.0, 0.0], method="Radau", rtol=1e-9, atol=1e-11,
    ).y[:, -1]  # fmt: skip
    found = kd.solve(problem, (0.0, end), [2.0, 0.0], rtol=tolerance, atol=1e-8, method=method, args=[mu])
    assert found.success
    np.testing.assert_allclose(found.y[-1], exact, rtol=0, atol=20 * tolerance)


# The estimates of their errors.


def estimate(method, step, problem=PROBLEMS["pendulum"]):
    return kd.solve(t_span=(0.0, 2.0), step=step, method=method, compile=False, **problem).error_estimate


@pytest.mark.parametrize("name", ["pendulum", "damped", "partitioned"])
@pytest.mark.parametrize(("method", "order"), [("radau-3", 3), ("radau-5", 4), ("radau-7", 5)])
def test_estimates_are_those_of_a_step_of_lower_order(method, order, name):
    one, other = (estimate(method, step, PROBLEMS[name]).max() for step in (0.02, 0.01))
    assert np.log2(one / other) == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize(("method", "step"), [("radau-3", 0.1), ("radau-5", 0.2), ("radau-7", 0.4)])
def test_an_estimate_is_larger_than_the_error_of_a_step(method, step):
    def last(h):
        return kd.solve(lambda x: -np.sin(x), (0.0, step), 2.0, 0.3, step=h, method=method, compile=False)

    error = abs(last(step).x[-1] - last(step / 50).x[-1])
    assert error < last(step).error_estimate < 1000 * error


def test_what_decays_faster_than_a_step_does_not_decide_an_estimate(monkeypatch):
    def follow():
        # y0 follows cos y1 at a distance of 1e-6.
        return run(lambda y: np.array([-1e6 * (y[0] - np.cos(y[1])), 1.0]), [1.0, 0.0], 5.0, 0.1, "radau-5")

    found = follow().error_estimate
    assert found[0] < 1e-9
    assert found[1] < 1e-14
    monkeypatch.setattr(stiff, "lu_solve", lambda matrix, pivots, b: None)
    assert follow().error_estimate[0] > 1e4 * found[0]


def test_estimates_have_the_shape_of_a_state_and_are_kept_in_files_and_reports(tmp_path):
    shaped = kd.solve(
        lambda x: -(x**3), (0.0, 1.0), np.ones((2, 3)), np.zeros((2, 3)), step=0.1, method="radau-3", compile=False
    )
    assert shaped.error_estimate.shape == (2, 3)
    again = kd.load(shaped.save(tmp_path / "shaped.npz"))
    assert np.array_equal(again.error_estimate, shaped.error_estimate)
    assert "estimated error" in shaped.report()
    other = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, step=0.1, method="gauss-4", compile=False)
    assert other.error_estimate is None
    assert kd.load(other.save(tmp_path / "other.npz")).error_estimate is None


def test_compiled_and_interpreted_agree_to_rounding():
    compiled = kd.solve(kd.FirstOrder(robertson), (0.0, 1.0), [1.0, 0.0, 0.0], step=0.01, method="radau-5")
    interpreted = run(robertson, [1.0, 0.0, 0.0], 1.0, 0.01, "radau-5")
    assert abs(compiled.y - interpreted.y).max() < 1e-13
    assert np.allclose(compiled.error_estimate, interpreted.error_estimate, rtol=1e-4, atol=1e-14)


def test_a_table_that_does_not_end_with_a_stage_is_refused_the_letter():
    gauss = CATALOGUE["gauss-4"]
    wrong = replace(gauss, word=word((Letter.STIFF_RUNGE_KUTTA, 1)))
    with pytest.raises(ArgumentError, match="stiffly accurate"):
        _ = wrong.coefficients
    # Of SDIRK2 with gamma = 1 - 1/sqrt(2), which does, the word is one line.
    gamma = Fraction(1 - 1 / sqrt(2))
    mine = Method(
        "mine",
        2,
        word((Letter.STIFF_RUNGE_KUTTA, 1)),
        False,
        Kind.FIRST_ORDER,
        "Alexander, SIAM J. Numer. Anal. 14, 1006 (1977)",
        tableau=lambda: Tableau(a=[[gamma, 0], [1 - gamma, gamma]], b=[1 - gamma, gamma]),
    )
    found = kd.analysis.observed_order(
        method=mine, steps=(0.02, 0.01), t_span=(0.0, 3.0), compile=False, **PROBLEMS["damped"]
    ).order
    assert found == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("compiles", [True, False])
def test_auto_asks_beside_the_start_and_takes_no_error_from_there(compiles):
    def rate(y):
        if y[0] > 1.0:
            raise RuntimeError("too large")
        return -y

    solution = kd.solve(kd.FirstOrder(rate), (0.0, 1.0), x0=[1.0], step=0.1, method="auto", compile=compiles)
    assert solution.success
