"""The Python bodies of compiled kernels, run uncompiled: the same results, and coverage of every line."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kickdrift as kd
from kickdrift.core import linear_algebra
from kickdrift.core.compilation import specialise, unbound
from kickdrift.engine.flows import implicit, kick_drift, sums

KERNELS = [linear_algebra.lu_factor, linear_algebra.lu_solve, sums.add, implicit.largest]


@pytest.mark.parametrize("body", [True, False], ids=["interpreted", "compiled"])
def test_lu_solves_systems_that_need_pivoting(body):
    factor, solve = linear_algebra.lu_factor, linear_algebra.lu_solve
    if body:
        factor, solve = factor.py_func, solve.py_func
    rng = np.random.default_rng(3)
    for n in (1, 2, 3, 7, 32, 33, 70, 101):
        matrix = rng.normal(size=(n, n))
        matrix[0, 0] = 0.0 if n > 1 else 2.0
        b = rng.normal(size=n)
        factors, pivots, x = matrix.ravel().copy(), np.zeros(n), b.copy()
        assert factor(factors, pivots)
        solve(factors, pivots, x)
        assert np.allclose(matrix @ x, b, atol=1e-12)


@pytest.mark.parametrize("body", [True, False], ids=["interpreted", "compiled"])
def test_panels_have_the_bits_of_one_column_after_the_other(body):
    def kernel(function):
        return function.py_func if body else function

    n = 75
    matrix = np.random.default_rng(5).normal(size=n * n)
    one, other, pivots, others = matrix.copy(), matrix.copy(), np.zeros(n), np.zeros(n)
    assert kernel(linear_algebra.eliminate_panel)(0, n, one, pivots)
    assert kernel(linear_algebra.lu_factor_panels)(other, others)
    assert np.array_equal(one, other)
    assert np.array_equal(pivots, others)
    singular = np.ones(n * n)
    assert not kernel(linear_algebra.lu_factor_panels)(singular, others)
    triangular = np.where(np.eye(n) > 0, 2.0, np.tri(n, k=-1) / n).ravel()  # its own factors, with 2 on the diagonal
    lower, upper = np.tri(n, k=-1) / n + np.eye(n), 2.0 * np.eye(n)
    b = np.arange(n, dtype=float)
    x = b.copy()
    kernel(linear_algebra.lu_solve_many)(triangular, x)
    assert np.allclose(lower @ upper @ x, b, atol=1e-12)


def test_lu_refuses_singular_and_nan_matrices():
    for matrix in (np.zeros(4), np.array([1.0, 2.0, 2.0, 4.0]), np.full(4, np.nan)):
        assert not linear_algebra.lu_factor(matrix.copy(), np.zeros(2))
        with np.errstate(all="ignore"):
            assert not linear_algebra.lu_factor.py_func(matrix.copy(), np.zeros(2))


@settings(max_examples=50, deadline=None)
@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=40), st.floats(-1, 1))
def test_sums_are_the_same_compiled_interpreted_and_as_arrays(values, h):
    rate = np.array(values)
    n = rate.size
    pairs = [
        (sums.add, sums.add_interpreted),
        (sums.add_to_x_compensated, sums.add_to_x_compensated_interpreted),
        (sums.add_to_v_compensated, sums.add_to_v_compensated_interpreted),
    ]
    for kernel, whole in pairs:
        results = []
        for function in (kernel, whole):
            y, work = np.linspace(0.1, 1, n), np.zeros(3 * n + 3)
            for _ in range(3):
                function(y, h, rate, work)
            results.append((y, work))
        assert np.array_equal(results[0][0], results[1][0])
        assert np.array_equal(results[0][1], results[1][1])


def test_the_python_bodies_of_the_sums():
    y, work, rate = np.ones(2), np.zeros(9), np.array([1.0, 2.0])
    sums.add.py_func(y, 0.5, rate, work)
    assert y.tolist() == [1.5, 2.0]
    sums._add_compensated.py_func(y, 1e-17, rate, work[2:4])
    assert y.tolist() == [1.5, 2.0]
    assert work[2:4].tolist() == [-1e-17, -2e-17]


def test_quantities_of_systems_in_python():
    for name in kd.systems.catalogue():
        system = kd.systems.get(name)
        if system.x0.size > 2:
            continue  # gravity has tests of its own
        x, v = system.x0.reshape(-1), system.v0.reshape(-1)
        for quantity in (*system.quantities.values(),):
            outs = np.zeros((2, quantity.size))
            quantity.function(0.0, x, v, system.params, outs[0])
            quantity.function.py_func(0.0, x, v, system.params, outs[1])
            assert np.allclose(outs[0], outs[1], rtol=1e-15)
        a, b = np.zeros(x.size), np.zeros(x.size)
        system.acceleration(0.0, x, v, system.params, a)
        system.acceleration.py_func(0.0, x, v, system.params, b)
        assert np.allclose(a, b, rtol=1e-15)


def test_largest_sees_nan():
    for largest in (implicit.largest, implicit.largest.py_func):
        assert largest(np.array([1.0, -3.0, 2.0])) == 3.0
        assert np.isnan(largest(np.array([np.nan])))


def test_an_unbound_template_says_so():
    with pytest.raises(NotImplementedError, match="specialise it first"):
        kick_drift.drift(0.0, 0.1, np.zeros(1), np.zeros(1), np.zeros(0), np.zeros(6))
    assert specialise(kick_drift.drift, "mine", add_to_x=lambda *a: None).__name__ == "mine"
    with pytest.raises(NotImplementedError):
        unbound()
