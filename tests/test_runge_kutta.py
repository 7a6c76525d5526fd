"""Runge-Kutta methods: their tables, their order on every kind of problem, and what the symplectic ones keep."""

from dataclasses import replace
from fractions import Fraction
from math import sqrt

import numpy as np
import pytest
from scipy.integrate import DOP853

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.engine import processing
from kickdrift.engine.problem_adapter import describe
from kickdrift.engine.start import Start
from kickdrift.methods import Letter, Tableau

CATALOGUE = kd.methods.catalogue()
WITH_TABLEAU = [method for method in CATALOGUE.values() if method.tableau is not None]
SYMPLECTIC = ["implicit-midpoint", "gauss-4", "gauss-6", "gauss-8", "qin-zhang-2"]
LOBATTO = ["lobatto-iiia-iiib-4", "lobatto-iiia-iiib-6"]


# The tables.


@pytest.mark.parametrize("method", WITH_TABLEAU, ids=lambda method: method.name)
def test_records_say_what_their_tables_are(method):
    tableau = method.tableau()
    assert (tableau.symmetric, tableau.explicit) == (method.symmetric, method.explicit)
    assert tableau.symplectic == (method.name in SYMPLECTIC + LOBATTO)


@pytest.mark.parametrize("name", SYMPLECTIC + LOBATTO)
def test_a_table_with_one_wrong_digit_is_neither_symmetric_nor_symplectic(name):
    right = CATALOGUE[name].tableau()
    a = [list(row) for row in right.a]
    a[-1][0] += Fraction(1, 10**10)
    wrong = replace(right, a=a)
    assert not wrong.symmetric
    assert not wrong.symplectic


def test_weights_that_do_not_add_up_are_refused():
    with pytest.raises(ArgumentError, match="not to 1"):
        Tableau(a=[[0, 0], [1, 0]], b=[Fraction(1, 2), Fraction(1, 3)])
    with pytest.raises(ArgumentError, match="square"):
        Tableau(a=[[0, 0]], b=[1])


def defects(a, b):
    """The largest defects of Butcher's simplifying assumptions B(k), C(k) and D(k) for each k, from 1 on."""
    c, stages = [sum(row) for row in a], range(len(b))
    quadrature, stage, step = [], [], []
    for k in range(1, 2 * len(b) + 2):
        quadrature.append(abs(sum(b[i] * c[i] ** (k - 1) for i in stages) - Fraction(1, k)))
        stage.append(max(abs(sum(a[i][j] * c[j] ** (k - 1) for j in stages) - c[i] ** k / k) for i in stages))
        step.append(
            max(abs(sum(b[i] * c[i] ** (k - 1) * a[i][j] for i in stages) - b[j] * (1 - c[j] ** k) / k) for j in stages)
        )
    return quadrature, stage, step


def fulfilled(row):
    """How many defects, from the first on, are below the 60 digits of the nodes."""
    return next((k for k, defect in enumerate(row) if defect > Fraction(1, 10**50)), len(row))


@pytest.mark.parametrize(("name", "s"), [("gauss-4", 2), ("gauss-6", 3), ("gauss-8", 4)])
def test_gauss_tables_fulfil_what_makes_their_order_and_no_more(name, s):
    tableau = CATALOGUE[name].tableau()
    assert [fulfilled(row) for row in defects(tableau.a, tableau.b)] == [2 * s, s, s]
    assert np.allclose(np.polynomial.legendre.leggauss(s)[1] / 2, np.array(tableau.b, dtype=float), atol=1e-15)


@pytest.mark.parametrize(("name", "s"), [("lobatto-iiia-iiib-4", 3), ("lobatto-iiia-iiib-6", 4)])
def test_lobatto_pairs_fulfil_what_makes_their_order_and_no_more(name, s):
    tableau = CATALOGUE[name].tableau()
    assert [fulfilled(row) for row in defects(tableau.a, tableau.b)] == [2 * s - 2, s, s - 2]
    # The rows of IIIB add up to the same nodes.
    assert [fulfilled(row) for row in defects(tableau.a_of_v, tableau.b_of_v)] == [2 * s - 2, s - 2, s]


# Hairer, Lubich, Wanner, Geometric Numerical Integration, table II.1.1; Hairer, Wanner, Solving Ordinary Differential
# Equations II, tables IV.5.7 to IV.5.10.
PRINTED = {
    "gauss-4": [[1 / 4, 1 / 4 - sqrt(3) / 6], [1 / 4 + sqrt(3) / 6, 1 / 4]],
    "gauss-6": [
        [5 / 36, 2 / 9 - sqrt(15) / 15, 5 / 36 - sqrt(15) / 30],
        [5 / 36 + sqrt(15) / 24, 2 / 9, 5 / 36 - sqrt(15) / 24],
        [5 / 36 + sqrt(15) / 30, 2 / 9 + sqrt(15) / 15, 5 / 36],
    ],
    "lobatto-iiia-iiib-4": [[0, 0, 0], [5 / 24, 1 / 3, -1 / 24], [1 / 6, 2 / 3, 1 / 6]],
    "lobatto-iiia-iiib-6": [
        [0, 0, 0, 0],
        [(11 + sqrt(5)) / 120, (25 - sqrt(5)) / 120, (25 - 13 * sqrt(5)) / 120, (-1 + sqrt(5)) / 120],
        [(11 - sqrt(5)) / 120, (25 + 13 * sqrt(5)) / 120, (25 + sqrt(5)) / 120, (-1 - sqrt(5)) / 120],
        [1 / 12, 5 / 12, 5 / 12, 1 / 12],
    ],
}
PRINTED_OF_V = {
    "lobatto-iiia-iiib-4": [[1 / 6, -1 / 6, 0], [1 / 6, 1 / 3, 0], [1 / 6, 5 / 6, 0]],
    "lobatto-iiia-iiib-6": [
        [1 / 12, (-1 - sqrt(5)) / 24, (-1 + sqrt(5)) / 24, 0],
        [1 / 12, (25 + sqrt(5)) / 120, (25 - 13 * sqrt(5)) / 120, 0],
        [1 / 12, (25 + 13 * sqrt(5)) / 120, (25 - sqrt(5)) / 120, 0],
        [1 / 12, (11 - sqrt(5)) / 24, (11 + sqrt(5)) / 24, 0],
    ],
}


@pytest.mark.parametrize("name", PRINTED)
def test_tables_as_printed(name):
    tableau = CATALOGUE[name].tableau()
    assert np.allclose(np.array(tableau.a, dtype=float), PRINTED[name], rtol=0, atol=1e-15)
    if name in PRINTED_OF_V:
        assert np.allclose(np.array(tableau.a_of_v, dtype=float), PRINTED_OF_V[name], rtol=0, atol=1e-15)


# The order, on each kind of problem.


def tao(binding_force=0.0):
    """Tao's Hamiltonian that is not separable, under a force; see test_doubled.py."""
    return kd.Hamiltonian(
        dHdq=lambda t, q, p: q * (1 + p * p) - binding_force * np.cos(2 * t),
        dHdp=lambda t, q, p: p * (1 + q * q) + binding_force * np.sin(t),
        energy=lambda q, p: 0.5 * (1 + q * q) * (1 + p * p),
    )


def turning(t, y):
    return np.array([y[1] * y[2] - np.sin(t), -y[0] * y[2] + np.cos(3 * t), -0.5 * y[0] * y[1] + y[2] * np.sin(2 * t)])


PROBLEMS = {
    "pendulum": {"problem": lambda x: -np.sin(x), "x0": 2.0, "v0": 0.3},
    "forced": {"problem": lambda t, x: -x - x**3 + np.cos(2 * t), "x0": 0.7, "v0": 0.3},
    "damped": {"problem": lambda x, v: -np.sin(x) - 0.3 * v - 0.2 * v**3, "x0": 2.0, "v0": 0.5},
    "not separable": {"problem": tao(), "x0": 1.0, "v0": 0.3},
    "not separable, forced": {"problem": tao(0.5), "x0": 1.0, "v0": 0.3},
    "partitioned": {
        "problem": kd.Partitioned(lambda x, v: x * (1 - v), lambda x, v: v * (x - 1)),
        "x0": 0.5,
        "v0": 1.5,
    },
    "first-order": {"problem": kd.FirstOrder(turning), "x0": [1.0, 0.5, 0.3]},
}
# Steps at which the next term of the error changes the slope by less than 0.05, and the errors lie above rounding.
STEPS = {1: (0.01, 0.005), 2: (0.04, 0.02), 4: (0.05, 0.025), 6: (0.15, 0.1)}
SPAN = {1: 3.0, 2: 3.0, 4: 3.0, 6: 5.0}


def measured(name, method, steps, end):
    return kd.analysis.observed_order(
        method=method, steps=steps, t_span=(0.0, end), compile=False, **PROBLEMS[name]
    ).order


@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize(
    "method",
    [
        "explicit-euler",
        "implicit-euler",
        "implicit-midpoint",
        "qin-zhang-2",
        "gauss-4",
        "gauss-6",
        "runge-kutta-4",
        *LOBATTO,
    ],
)
def test_order(method, name):
    order = CATALOGUE[method].order
    assert measured(name, method, STEPS[order], SPAN[order]) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize(
    ("name", "steps", "end"),
    [
        ("pendulum", (0.4, 0.3, 0.25), 15.0),
        ("forced", (0.2, 0.16, 0.125), 3.0),
        ("not separable", (0.25, 0.2, 0.15), 5.0),
        ("not separable, forced", (0.2, 0.16, 0.125), 3.0),
        ("partitioned", (0.3, 0.25, 0.2), 12.0),
        ("first-order", (0.15, 0.125, 0.1), 8.0),
    ],
)
def test_order_8(name, steps, end):
    assert measured(name, "gauss-8", steps, end) == pytest.approx(8, abs=0.1)
    assert measured(name, "gauss-6", steps, end) < 7


@pytest.mark.parametrize("name", PROBLEMS)
def test_dop853_takes_the_steps_of_scipy(name):
    given = {key: value for key, value in PROBLEMS[name].items() if key != "problem"}
    problem, h = PROBLEMS[name]["problem"], 0.3
    ours = kd.solve(problem, (0.0, 2 * h), step=h, method="dop853", compile=False, compensated=False, **given)
    rates = {"partitioned": lambda t, y: np.array([y[0] * (1 - y[1]), y[1] * (y[0] - 1)]), "first-order": turning}.get(
        name
    )
    if rates is None:
        system = describe(problem, 0.0, Start(ours.x[0], ours.v[0]), np.zeros(0), compile_=False)

        def rates(t, y):
            out = np.array([0.0, y[1]])
            system.acceleration(t, y[:1], y[1:], system.params, out[:1])
            force = out[0]
            if system.velocity is not None:
                system.velocity(t, y[:1], y[1:], system.params, out[1:])
            return np.array([out[1], force])

    y0 = np.concatenate([np.ravel(ours.x[0]), np.ravel(ours.v[0])])
    scipy = DOP853(rates, 0.0, y0, 2 * h, first_step=h, max_step=h, rtol=1e3, atol=1e3)
    scipy.step()
    scipy.step()
    assert scipy.t == pytest.approx(2 * h, rel=1e-15)
    assert np.allclose(scipy.y, np.concatenate([np.ravel(ours.x[-1]), np.ravel(ours.v[-1])]), rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize(
    ("name", "steps", "end"),
    [("pendulum", (0.4, 0.3, 0.25), 3.0), ("forced", (0.2, 0.16, 0.125), 4.0), ("first-order", (0.25, 0.2, 0.15), 8.0)],
)
def test_dop853_has_order_8(name, steps, end):
    assert measured(name, "dop853", steps, end) == pytest.approx(8, abs=0.1)


def test_a_node_in_the_wrong_place_is_caught():
    right = CATALOGUE["gauss-4"].tableau()
    a = [list(row) for row in right.a]
    a[0][0], a[0][1] = a[0][0] + Fraction(1, 100), a[0][1] - Fraction(1, 100)
    wrong = replace(CATALOGUE["gauss-4"], symmetric=False, tableau=lambda: replace(right, a=a))
    assert measured("not separable", wrong, STEPS[4], 3.0) < 3.5


@pytest.mark.parametrize("letter", [Letter.RUNGE_KUTTA, Letter.IMPLICIT_RUNGE_KUTTA])
@pytest.mark.parametrize("general", [False, True])
def test_weights_of_v_of_its_own(letter, general):
    # Heun's weights for x, the end of Euler's step for v.
    table = Tableau(a=[[0, 0], [1, 0]], b=[Fraction(1, 2), Fraction(1, 2)], a_of_v=[[0, 0], [1, 0]], b_of_v=[0, 1])
    mine = kd.methods.Method(
        "mine", 1, kd.methods.word((letter, 1)), False, kd.methods.Kind.PARTITIONED, "a test", tableau=lambda: table
    )
    problem = kd.Partitioned(lambda v: v, lambda x, v: -x - v) if general else (lambda x, v: -x - v)
    s = kd.solve(problem, (0.0, 0.1), 1.0, 0.5, step=0.1, method=mine, compile=False)
    h, x, v, a = 0.1, 1.0, 0.5, -1.5
    assert s.x[-1] == pytest.approx(x + h * (v + v + h * a) / 2, rel=1e-15)
    assert s.v[-1] == pytest.approx(v - h * (x + h * v + v + h * a), rel=1e-15)


# What they keep.


@pytest.mark.parametrize("method", [*SYMPLECTIC, *LOBATTO, "implicit-kick-drift", "implicit-verlet"])
def test_a_step_is_symplectic_where_the_hamiltonian_is_not_separable(method):
    assert kd.analysis.symplecticity_defect(tao(), method, 0.1, at=(1.0, 0.3)) < 1e-12


@pytest.mark.parametrize("method", ["runge-kutta-4", "implicit-euler"])
def test_other_steps_are_not(method):
    assert kd.analysis.symplecticity_defect(tao(), method, 0.1, at=(1.0, 0.3)) > 1e-8


def test_a_lobatto_pair_is_symplectic_only_as_a_pair():
    right = CATALOGUE["lobatto-iiia-iiib-4"].tableau()
    for half in (replace(right, a_of_v=right.a), replace(right, a=right.a_of_v)):
        alone = replace(CATALOGUE["lobatto-iiia-iiib-4"], tableau=lambda half=half: half)
        assert not half.symplectic
        assert kd.analysis.symplecticity_defect(tao(), alone, 0.1, at=(1.0, 0.3)) > 1e-8


def test_lobatto_pairs_see_the_ends_of_a_step_and_swapped_ones_do_not():
    right = CATALOGUE["lobatto-iiia-iiib-4"]
    table = right.tableau()
    exchanged = Tableau(a=table.a_of_v, b=table.b_of_v, a_of_v=table.a, b_of_v=table.b)
    swapped = replace(right, tableau=lambda: exchanged)
    for method, sees in ((right, True), (swapped, False)):
        seen = []

        def force(x, seen=seen):
            seen.append(x)
            return -np.sin(x)

        solution = kd.solve(force, (0.0, 0.2), 1.0, 0.5, step=0.2, method=method, compile=False)
        assert np.any(abs(np.array(seen) - solution.x[-1]) < 1e-15) == sees


def drift_of_energy():
    solution = kd.solve(tao(), (0.0, 500.0), 1.0, 0.3, step=0.15, method="gauss-4", compile=False)
    error = solution.energy / solution.energy[0] - 1
    third = error.size // 3
    return abs(error[-third:].mean() - error[:third].mean()), abs(error).max()


def test_the_energy_of_gauss_methods_does_not_drift():
    drift, largest = drift_of_energy()
    assert 1e-6 < largest < 1e-5
    assert drift < 1e-9  # 3e-10, and with the looser solutions below 9e-7


def test_with_looser_solutions_of_its_equations_it_would(monkeypatch):
    monkeypatch.setattr("kickdrift.engine.flows.implicit.ROUNDING", 1e-3)
    monkeypatch.setattr("kickdrift.engine.flows.implicit.MOST_ITERATIONS", 5)
    drift, _ = drift_of_energy()
    assert drift > 1e-7


def test_gauss_keeps_quadratic_invariants_and_explicit_methods_do_not():
    kepler = replace(kd.systems.kepler(0.6), native=False)
    for method, most in (("gauss-6", 1e-14), ("lobatto-iiia-iiib-4", 1e-14)):
        kept = kd.solve(kepler, (0.0, 20.0), step=0.05, method=method).invariants["angular momentum"]
        assert np.ptp(kept) < most
    lost = kd.solve(kepler, (0.0, 20.0), step=0.05, method="runge-kutta-4").invariants["angular momentum"]
    assert np.ptp(lost) > 1e-6


# How they run.


def test_steps_forth_and_back_meet():
    there = kd.solve(tao(), (0.0, 2.0), 1.0, 0.3, step=0.1, method="gauss-6", compile=False)
    back = kd.solve(tao(), (2.0, 0.0), there.x[-1], there.v[-1], step=0.1, method="gauss-6", compile=False)
    assert abs(back.x[-1] - 1.0) < 1e-14
    one_way = kd.solve(tao(), (0.0, 2.0), 1.0, 0.3, step=0.1, method="runge-kutta-4", compile=False)
    other = kd.solve(tao(), (2.0, 0.0), one_way.x[-1], one_way.v[-1], step=0.1, method="runge-kutta-4", compile=False)
    assert abs(other.x[-1] - 1.0) > 1e-8


@pytest.mark.parametrize(("name", "most"), [("pendulum", 0.85), ("not separable", 0.85), ("first-order", 0.85)])
def test_the_last_step_makes_the_start_of_the_next(name, most, monkeypatch):
    arguments = {"t_span": (0.0, 5.0), "step": 0.1, "method": "gauss-6", "compile": False}
    saving = kd.solve(**arguments, **PROBLEMS[name])
    monkeypatch.setattr(Tableau, "onward", property(lambda self: np.zeros((self.stages, self.stages))))
    monkeypatch.setattr(processing, "_programs", processing._programs.__wrapped__)  # which forgets what it knows
    plain = kd.solve(**arguments, **PROBLEMS[name])
    assert saving.n_force_evaluations < most * plain.n_force_evaluations
    assert np.allclose(saving.x, plain.x, rtol=0, atol=1e-14)


def test_compiled_runs_have_the_bits_of_interpreted_ones():
    compiled = {
        "x' = v": {"problem": lambda x, v: -np.sin(x) - 0.1 * v, "x0": [1.0, 0.5], "v0": [0.3, 0.0]},
        "general": {"problem": tao(0.5), "x0": 1.0, "v0": 0.3},
        "first-order": {"problem": kd.FirstOrder(lambda t, y: y * np.sin(t) - y[::-1] ** 2), "x0": [0.1, 0.5, 0.3]},
    }
    for given in compiled.values():
        for method in ("lobatto-iiia-iiib-6", "runge-kutta-4"):
            runs = [
                kd.solve(t_span=(0.0, 2.0), step=0.1, method=method, compile=compile_, **given)
                for compile_ in (True, False)
            ]
            assert np.array_equal(runs[0].x, runs[1].x)
            assert np.array_equal(runs[0].v, runs[1].v)
            assert runs[0].n_force_evaluations == runs[1].n_force_evaluations


def test_first_order_equations_have_no_two_form():
    with pytest.raises(ArgumentError, match="no two-form"):
        kd.analysis.symplecticity_defect(kd.FirstOrder(turning), "gauss-4", 0.1)
