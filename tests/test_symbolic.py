"""Equations of motion from formulas are those that people write by hand."""

import sys
from functools import partial

import numpy as np
import pytest
import sympy as sp
from sympy.physics.mechanics import LagrangesMethod, Point, ReferenceFrame, dynamicsymbols

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, MissingExtraError

Q, P, T = sp.symbols("q p t")
A, B, DA, DB, G = sp.symbols("a b adot bdot g")
DOUBLE = DA**2 + DB**2 / 2 + DA * DB * sp.cos(A - B) + G * (2 * sp.cos(A) + sp.cos(B))
OPTIONS = {"progress": False, "compile": False}


def by_hand(x, v):
    """Accelerations of two rods of 1 m with masses of 1 kg: M a = f, solved by NumPy."""
    c, s = np.cos(x[0] - x[1]), np.sin(x[0] - x[1])
    mass = np.array([[2.0, c], [c, 1.0]])
    push = np.array([-s * v[1] ** 2 - 2 * 9.81 * np.sin(x[0]), s * v[0] ** 2 - 9.81 * np.sin(x[1])])
    return np.linalg.solve(mass, push)


@pytest.mark.parametrize("compiled", [True, False])
def test_a_double_pendulum_goes_as_the_one_written_by_hand(compiled):
    options = {"step": 0.01, "method": "gauss-6", "progress": False, "compile": compiled}
    start = [1.0, 0.5], [0.3, -0.2]
    formula = kd.from_lagrangian(DOUBLE, (A, B), (DA, DB), constants={G: 9.81})
    sol = kd.solve(formula, (0.0, 3.0), *start, **options)
    hand = kd.solve(kd.SecondOrder(by_hand), (0.0, 3.0), *start, **options)
    np.testing.assert_allclose(sol.x, hand.x, atol=1e-10)
    (a, b), (da, db) = np.array(start)
    energy = da**2 + db**2 / 2 + da * db * np.cos(a - b) - 9.81 * (2 * np.cos(a) + np.cos(b))
    assert sol.energy[0] == pytest.approx(energy, rel=1e-14)
    assert np.ptp(sol.energy) < 1e-7


def test_equations_of_sympys_mechanics_are_the_same():
    a, b = dynamicsymbols("a b")
    lagrangian = DOUBLE.subs({A: a, B: b, DA: a.diff(), DB: b.diff()})
    start = (0.0, 1.0), [1.0, 0.5], [0.3, -0.2]
    options = {"step": 0.01, "method": "gauss-4", **OPTIONS}
    theirs = kd.from_lagrangian(LagrangesMethod(lagrangian, [a, b]), constants={"g": 9.81})
    ours = kd.from_lagrangian(DOUBLE, (A, B), (DA, DB), constants={"g": 9.81})
    np.testing.assert_array_equal(kd.solve(theirs, *start, **options).x, kd.solve(ours, *start, **options).x)


def test_applied_forces_of_sympys_mechanics_are_applied():
    x = dynamicsymbols("x")
    frame, point = ReferenceFrame("N"), Point("P")
    point.set_vel(frame, x.diff() * frame.x)
    damped = LagrangesMethod(x.diff() ** 2 / 2 - x**2 / 2, [x], [(point, -0.2 * x.diff() * frame.x)], frame=frame)
    sol = kd.solve(kd.from_lagrangian(damped), (0.0, 5.0), [1.0], [0.0], step=0.01, method="gauss-6", **OPTIONS)
    w = np.sqrt(1 - 0.01)
    exact = np.exp(-0.1 * sol.t) * (np.cos(w * sol.t) + 0.1 / w * np.sin(w * sol.t))
    np.testing.assert_allclose(sol.x[:, 0], exact, atol=1e-11)


def test_six_bodies_on_springs_are_solved_without_loops():
    q, v = sp.symbols("q0:6"), sp.symbols("v0:6")
    coupled = sum((v[i] + v[i + 1]) ** 2 for i in range(5)) / 4 + sum(s**2 for s in v) / 2
    lagrangian = coupled - sum((i + 1) * q[i] ** 2 for i in range(6)) / 2
    problem = kd.from_lagrangian(lagrangian, q, v)
    x, out = np.arange(1.0, 7.0), np.zeros(6)
    problem.acceleration(x=x, out=out)
    mass = np.array(sp.hessian(lagrangian, v), dtype=float)
    np.testing.assert_allclose(mass @ out, -np.arange(1, 7) * x, rtol=1e-13)


def test_what_is_separable_is_seen_to_be():
    hidden = (Q + P) ** 2 - 2 * Q * P  # q^2 + p^2
    assert isinstance(kd.from_sympy(hidden, Q, P), kd.Separable)
    assert isinstance(kd.from_sympy((1 + Q**2) * P**2, Q, P), kd.Hamiltonian)
    pendulum = kd.from_sympy(P**2 / 2 - G * sp.cos(Q), Q, P, constants={G: 1.0})
    options = {"step": 0.05, "method": "blanes-moan-s6", "progress": False}
    sol = kd.solve(pendulum, (0.0, 10.0), 1.0, 0.0, **options)
    same = kd.solve(kd.Separable(lambda p: p, lambda q: np.sin(q)), (0.0, 10.0), 1.0, 0.0, **options)
    np.testing.assert_allclose(sol.q, same.q, atol=1e-13)
    assert sol.q.shape == same.q.shape == (201,)
    assert sol.energy[0] == pytest.approx(-np.cos(1.0))


def test_relativity_entangles_several_coordinates():
    q, p = sp.symbols("q0:2"), sp.symbols("p0:2")
    energy = sp.sqrt(1 + (p[0] ** 2 + p[1] ** 2) * (1 + q[0] ** 2)) + (q[0] ** 2 + q[1] ** 4)
    sol = kd.solve(kd.from_sympy(energy, q, p), (0.0, 5.0), [1, 0.2], [0.1, 1], step=0.02, method="gauss-6", **OPTIONS)
    assert np.ptp(sol.energy) < 1e-11


def test_time_and_numbers_reach_the_functions():
    driven = kd.from_sympy(P**2 / 2 + Q**2 / 2 - Q * sp.cos(2 * T), Q, P, t=T)
    sol = kd.solve(driven, (0.0, 4.0), 1.0, 0.0, step=0.01, method="blanes-moan-s6", **OPTIONS)
    np.testing.assert_allclose(sol.q, 4 / 3 * np.cos(sol.t) - np.cos(2 * sol.t) / 3, atol=1e-7)
    fast, slow = (kd.from_lagrangian(DA**2 / 2 - G * A**2 / 2, A, DA, constants={G: k}) for k in (4.0, 1.0))
    options = {"step": 0.01, "method": "blanes-moan-srkn6b", "progress": False}
    for problem, w in ((fast, 2.0), (slow, 1.0)):
        sol = kd.solve(problem, (0.0, 4.0), 1.0, 0.0, **options)
        np.testing.assert_allclose(sol.x, np.cos(w * sol.t), atol=1e-6)


def test_users_may_call_things_what_the_code_calls_others():
    x, px, q, field = sp.symbols("x p_x q E")
    charge = kd.from_sympy(px**2 / 2 - q * field * x + x**2 / 2, x, px, constants={q: 2.0, field: 3.0})
    sol = kd.solve(charge, (0.0, 1.0), 1.0, 0.0, step=0.01, method="yoshida-6", **OPTIONS)
    assert sol.q[-1] == pytest.approx(6.0 - 5.0 * np.cos(1.0), abs=1e-9)
    swapped = kd.from_sympy(Q**2 / 2 + P**2, P, Q)
    sol = kd.solve(swapped, (0.0, 1.0), 1.0, 0.0, step=0.01, method="yoshida-6", **OPTIONS)
    assert sol.q[-1] == pytest.approx(np.cos(np.sqrt(2.0)), abs=1e-9)
    angle, rate, v = sp.symbols("th om v", real=True)
    stiff = kd.from_lagrangian(rate**2 / 2 - v * angle**2 / 2, angle, rate, constants={v: 4.0})
    sol = kd.solve(stiff, (0.0, 1.0), 1.0, 0.0, step=0.01, method="yoshida-6", **OPTIONS)
    assert sol.x[-1] == pytest.approx(np.cos(2.0), abs=1e-9)
    tau = sp.Symbol("tau")
    driven = kd.from_sympy(P**2 / 2 - Q * tau, Q, P, t=tau, constants={"t": 7.0})
    sol = kd.solve(driven, (0.0, 1.0), 0.0, 0.0, step=0.001, method="yoshida-6", **OPTIONS)
    assert sol.q[-1] == pytest.approx(1.0 / 6.0, abs=1e-9)


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: kd.from_sympy(P**2 / 2 + G * Q, Q, P), "hamiltonian has symbols without values: g"),
        (lambda: kd.from_sympy(P**2 / 2 + T * Q, Q, P), "time as t="),
        (lambda: kd.from_sympy(P**2 / 2, Q, Q), "all different"),
        (lambda: kd.from_sympy(P**2 / 2, (Q, A), (P,)), "the same number of symbols"),
        (lambda: kd.from_sympy(P**2 / 2, (), ()), "the same number of symbols"),
        (lambda: kd.from_sympy(P**2 / 2 + G * Q, Q, P, constants={G: "heavy"}), r"constants\[g\]='heavy'"),
        (lambda: kd.from_sympy(P**2 / 2 + G * Q, Q, P, constants={G: np.nan}), r"constants\[g\]=nan"),
        (lambda: kd.from_sympy(P**2 / 2 + sp.Function("f")(Q), Q, P), "cannot be written in Python"),
        (lambda: kd.from_lagrangian(DA**2 / 2 + A * B, (A, B), (DA, DB)), "not positive definite"),
        (lambda: kd.from_lagrangian((DA + DB) ** 2, (A, B), (DA, DB)), "not positive definite"),
        (lambda: kd.from_lagrangian(DA * DB - A * B, (A, B), (DA, DB)), "not positive"),
        (lambda: kd.from_lagrangian(-(DA**2) / 2, A, DA), "some masses are negative"),
        (lambda: kd.from_lagrangian(DA**2 - DB**2 - A * B, (A, B), (DA, DB)), "some masses are negative"),
        (lambda: kd.from_lagrangian(DA**2 + DB**2 + 3 * DA * DB, (A, B), (DA, DB)), "some masses are negative"),
        (lambda: kd.from_lagrangian(G * DA**2 - A, A, DA, constants={G: -2.0}), "some masses are negative"),
        (lambda: kd.from_lagrangian(-(1 + A**2) * DA**2, A, DA), "some masses are negative"),
    ],
)
def test_formulas_that_cannot_be(make, text):
    with pytest.raises(ArgumentError, match=text):
        make()


@pytest.mark.parametrize("a", [0.5, -0.5, 0.0, 0.25])
def test_starts_where_masses_are_not_positive_are_refused(a):
    one = kd.from_lagrangian((A - G) * DA**2 / 2, A, DA, constants={G: 0.25})
    two = kd.from_lagrangian((A - G) * (DA**2 + DB**2) + DA * DB * T / 4, (A, B), (DA, DB), t=T, constants={G: 0.25})
    for problem, x0, least in ((one, a, a - 0.25), (two, [a, 2.0], 2 * a - 0.5)):
        run = partial(kd.solve, problem, (0.0, 0.1), x0, np.zeros_like(x0), step=0.1, method="gauss-4", **OPTIONS)
        if a > 0.25:
            assert run().success
            continue
        with pytest.raises(
            ArgumentError, match=rf"not positive definite at x0=.* least eigenvalue .* is {least:.3g} there"
        ):
            run()


@pytest.mark.parametrize("start", [[1.0, 2.0, 3.0], [[1.0, 2.0]], 1.0])
def test_starts_of_another_shape_are_refused(start):
    double = kd.from_lagrangian((DA**2 + DB**2) / 2 - A * B, (A, B), (DA, DB))
    with pytest.raises(ArgumentError, match=r"the formulas need shape \(2,\)"):
        kd.solve(double, (0.0, 1.0), start, np.zeros_like(start), step=0.1)


def test_constraints_are_for_another_description():
    x, y = dynamicsymbols("x y")
    tied = LagrangesMethod((x.diff() ** 2 + y.diff() ** 2) / 2, [x, y], hol_coneqs=[x**2 + y**2 - 1])
    with pytest.raises(ArgumentError, match=r"kd\.Constrained"):
        kd.from_lagrangian(tied)


def test_sympy_is_an_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "sympy", None)
    with pytest.raises(MissingExtraError, match=r"kickdrift\[sympy\]"):
        kd.from_sympy(None, None, None)
