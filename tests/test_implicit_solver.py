"""The solver inside implicit flows, and the Python bodies of the compiled kernels around it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import kickdrift as kd
from kickdrift.core import linear_algebra
from kickdrift.engine.flows import adjoint, extrapolation, implicit, newton, runge_kutta
from kickdrift.engine.flows.layout import FORMED
from kickdrift.engine.stepper import State

NAN = np.nan


def both(kernel):
    return [kernel, kernel.py_func]


@pytest.mark.parametrize("values", [[], [0.0], [1.0, -3.0, 2.0], [NAN, 1.0], [1.0, NAN, 5.0], [np.inf, 1.0]])
def test_the_maximum_norm_sees_what_is_not_a_number(values):
    expected = np.abs(values).max(initial=0.0)
    for largest in both(implicit.largest):
        assert np.array_equal(largest(np.array(values)), expected, equal_nan=True)


def test_increments_are_measured_in_their_scales():
    head = np.array([3.0, 2.0, 2.0, 10.0, 4.0, 100.0])
    for relative_size in both(implicit.relative_size):
        assert relative_size(np.array([1.0, -2.0, 5.0]), head, 2) == 1.0
        assert relative_size(np.array([1.0, 0.0, 50.0]), head, 4) == 0.5
        assert np.isnan(relative_size(np.array([NAN, 1.0, 1.0]), head, 2))
    for scale in both(implicit.scale):
        assert [scale(1.0, 2.0), scale(3.0, 2.0), scale(0.0, 0.0)] == [2.0, 3.0, 1.0]
        assert np.isnan(scale(NAN, 1.0))


def test_moves_and_retreats():
    for proceed, retreat in zip(both(implicit.proceed), both(implicit.retreat), strict=True):
        z, last = np.array([1.0, 2.0]), np.zeros(2)
        proceed(z, np.array([4.0, -8.0]), last)
        assert z.tolist() == [5.0, -6.0]
        retreat(z, 0.5, last)
        retreat(z, 0.5, last)
        assert z.tolist() == [2.0, 0.0]
        retreat(z, 1.0, last)
        assert z.tolist() == [1.0, 2.0]


def test_sums_of_stages():
    rng = np.random.default_rng(1)
    weights, rates, y, stage = rng.normal(size=3), rng.normal(size=12), rng.normal(size=4), rng.normal(size=4)
    total = weights @ rates.reshape(3, 4)
    for kernel, expected, arguments in (
        (runge_kutta.combine, total, (weights, rates)),
        (runge_kutta.shift, y + 0.1 * total, (y, 0.1, weights, rates)),
        (runge_kutta.shortfall, y - stage + 0.1 * total, (y, 0.1, weights, rates, stage)),
    ):
        outs = [np.full(4, NAN) for _ in range(2)]
        for one, out in zip(both(kernel), outs, strict=True):
            one(*arguments, out)
        assert np.array_equal(outs[0], outs[1])
        assert np.allclose(outs[0], expected, rtol=1e-14)


@pytest.mark.parametrize("n", [3, 40, runge_kutta.BLOCK, 2 * runge_kutta.BLOCK + 7])
def test_sums_of_stages_in_blocks_are_those_number_by_number(n):
    rng = np.random.default_rng(2)
    weights, rates = rng.normal(size=3), rng.normal(size=3 * n)
    expected = [
        0.0 + rates[k] * weights[0] + rates[n + k] * weights[1] + rates[2 * n + k] * weights[2] for k in range(n)
    ]
    for combine in both(runge_kutta.combine):
        total = np.full(n, NAN)
        combine(weights, rates, total)
        assert total.tolist() == expected


def test_what_a_flow_adds_and_leaves():
    for added in both(extrapolation.added):
        out = np.zeros(1)
        added(np.array([3.0]), np.array([1.0]), np.array([1e-17]), np.array([3e-17]), out)
        assert out[0] == 2.0 + 2e-17
    for leave in both(adjoint.leave_residual):
        increment, head = np.zeros(2), np.zeros(6)
        leave(np.array([1.0, 2.0]), np.array([1.5, -4.0]), 0.5, np.array([1.0, 2.0]), increment, head)
        assert increment.tolist() == [0.0, 7.0]
        assert head[2] == 4.0


def test_extrapolation_is_exact_for_even_polynomials():
    steps = 1 / np.arange(1, 5)
    values = 3.0 + 2.0 * steps**2 - 5.0 * steps**4 + 7.0 * steps**6
    for follow_to_zero in both(extrapolation.follow_to_zero):
        rows = np.repeat(values, 2)
        follow_to_zero(rows, 4)
        assert rows[-2:] == pytest.approx([3.0, 3.0], rel=1e-13)


def test_clearing():
    for clear in both(implicit.clear):
        into = np.array([1.0, 2.0])
        clear(into)
        assert into.tolist() == [0.0, 0.0]


# What it solves.

GIVEN = {"compile": False}


def robertson(y):
    slow, fast = 0.04 * y[0] - 1e4 * y[1] * y[2], 3e7 * y[1] ** 2
    return np.array([-slow, slow - fast, fast])


def test_newton_steps_that_are_too_long_are_halved():
    # From y_1 = 0, where its reaction has no slope, Newton's first step is a hundred times too long.
    s = kd.solve(kd.FirstOrder(robertson), (0.0, 10.0), [1.0, 0.0, 0.0], step=0.1, method="implicit-euler", **GIVEN)
    assert s.success
    exact = solve_ivp(lambda t, y: robertson(y), (0.0, 10.0), [1.0, 0.0, 0.0], "Radau", rtol=1e-10, atol=1e-13).y[:, -1]
    assert np.allclose(s.x[-1], exact, rtol=5e-3)


def test_a_solution_met_by_chance_leaves_its_own_rates():
    # 1, 2 and 5/2, where the iteration contracts slowly enough for a matrix, and the equation is solved exactly.
    def rates(y):
        return np.where(y < 1.5, 1.0, np.where(y < 2.4, 1.5, 1.5 + 100.0 * (y - 2.5)))

    s = kd.solve(kd.FirstOrder(rates), (0.0, 1.0), [1.0], step=1.0, method="implicit-euler", **GIVEN)
    assert s.x[-1] == 2.5


@pytest.mark.parametrize("method", ["implicit-euler", "gauss-4", "gauss-8"])
def test_a_start_that_leaves_the_domain_is_tried_again_from_the_state(method):
    # The polynomial of the first step, into a boundary layer, leads to negative y and no logarithm.
    problem = kd.FirstOrder(lambda t, y: -300.0 * np.log(y) + np.sin(t))
    s = kd.solve(problem, (0.0, 2.0), [3.0], step=0.1, method=method, **GIVEN)
    assert s.success, s.message
    assert s.x[-1] == pytest.approx(np.exp(np.sin(2.0) / 300.0), rel=1e-2)


def test_a_matrix_is_kept_from_step_to_step():
    def stiff(x, v):
        return -1e4 * x - 50.0 * v

    s = kd.solve(stiff, (0.0, 10.0), [1.0, 2.0, 3.0], [0.0, 0.0, 0.0], step=0.1, method="gauss-4", **GIVEN)
    assert s.success
    # A matrix a step would be 6 columns of 2 stages beside the iterations.
    assert s.n_force_evaluations < 12 * s.n_steps


def chain(n):
    """Oscillators in a ring, each pulled by its neighbours: eigenvalues up to 2i."""
    return kd.FirstOrder(lambda y: np.roll(y, 1) - np.roll(y, -1)), np.cos(np.arange(n))


def test_many_unknowns_do_without_a_matrix_where_it_costs_more(monkeypatch):
    problem, start = chain(100)
    given = {"t_span": (0.0, 1.6), "x0": start, "step": 0.8, "method": "gauss-4", **GIVEN}
    patient = kd.solve(problem, **given)
    assert patient.success
    assert patient.n_force_evaluations < 250  # a matrix is 100 columns of 2 stages, 2 evaluations each
    monkeypatch.setattr(implicit, "patience", lambda m: 1.0)
    impatient = kd.solve(problem, **given)
    assert impatient.n_force_evaluations > 400
    assert np.allclose(patient.x, impatient.x, rtol=0, atol=1e-12)


def test_a_matrix_that_many_unknowns_need_once_is_left_again(monkeypatch):
    # Stiff at the start alone. Each solution with a matrix costs the square of the unknowns.
    def rates(t, y):
        return -(300.0 if t < 0.5 else 0.5) * (y - np.cos(t))

    given = {"t_span": (0.0, 12.0), "x0": np.ones(40), "step": 0.1, "method": "implicit-euler", **GIVEN}
    tried = []
    monkeypatch.setattr(
        newton, "lu_solve", lambda matrix, pivots, b: tried.append(linear_algebra.lu_solve(matrix, pivots, b))
    )
    assert kd.solve(kd.FirstOrder(rates), **given).success
    left = len(tried)
    tried.clear()
    monkeypatch.setattr(implicit, "_RETRIED_AFTER", 1e9)
    assert kd.solve(kd.FirstOrder(rates), **given).success
    assert 0 < left < len(tried) / 2


def test_too_many_unknowns_for_a_matrix_end_with_a_sentence(monkeypatch):
    monkeypatch.setattr(newton, "MOST_WITH_MATRIX", 10)
    s = kd.solve(kd.FirstOrder(lambda y: -1e4 * y), (0.0, 1.0), np.ones(20), step=0.1, method="implicit-euler", **GIVEN)
    assert not s.success
    assert s.status is kd.Outcome.NOT_CONVERGED


def test_the_scratch_is_copied_only_when_another_matrix_was_formed():
    work = np.zeros(40)
    state = State(np.ones(1), np.ones(1), work, np.arange(4.0))
    assert state.copy().scratch.size == 0
    work[FORMED] = 1.0
    first = state.copy()
    assert first.scratch.tolist() == [0.0, 1.0, 2.0, 3.0]
    assert state.copy(first).scratch is first.scratch
    work[FORMED], state.scratch[0] = 2.0, 7.0
    assert state.copy(first).scratch.tolist() == [7.0, 1.0, 2.0, 3.0]
    state.restore(first)
    assert state.scratch.tolist() == [0.0, 1.0, 2.0, 3.0]
    assert state.work[FORMED] == 1.0


def test_what_does_not_matter_to_the_next_step_is_not_copied():
    state = State(np.ones(1), np.ones(1), np.arange(40.0), np.zeros(0), (slice(0, 1), slice(4, None)))
    copy = state.copy()
    copy.work[1:4] = -1.0
    state.work[:5] = 9.0
    state.restore(copy)
    assert state.work[:6].tolist() == [0.0, 9.0, 9.0, 9.0, 4.0, 5.0]
    assert state.copy(into=copy) is copy
    assert copy.work[:6].tolist() == [0.0, -1.0, -1.0, -1.0, 4.0, 5.0]


@pytest.mark.parametrize("seconds", [1e-9, 1.0])
def test_a_run_that_fails_late_ends_with_the_bits_of_one_that_ends_there(monkeypatch, seconds):
    # Matrices are formed all along the way, and again after each return to a good state.
    monkeypatch.setattr("kickdrift.core.interruption._CHUNK_SECONDS", seconds)

    def rates(t, y):
        if t > 3.05:
            raise ArithmeticError("enough")
        return -np.exp(3 * y) * (y - np.sin(3 * t))

    given = {"x0": [1.0, 2.0], "step": 0.1, "method": "implicit-euler", **GIVEN}
    failed = kd.solve(kd.FirstOrder(rates), (0.0, 6.0), **given)
    whole = kd.solve(kd.FirstOrder(rates), (0.0, 3.0), **given)
    assert not failed.success
    assert whole.success
    assert failed.n_steps == 30
    assert np.array_equal(failed.x[:31], whole.x)


def test_compensated_steps_keep_quadratic_invariants_to_rounding():
    def spin(y):
        return np.array([y[1] * y[2] / 6, -2 * y[0] * y[2] / 3, y[0] * y[1] / 2])

    body = kd.FirstOrder(spin, invariants={"square": lambda y: (y * y).sum()})
    given = {"t_span": (0.0, 1000.0), "x0": [1.0, 0.1, 0.2], "step": 0.25, "method": "gauss-4"}
    kept = kd.solve(body, **given, **GIVEN).invariants["square"]
    assert np.ptp(kept) < 2e-15


def test_compiled_runs_have_the_bits_of_interpreted_ones():
    problem = kd.Hamiltonian(dHdq=lambda q, p: q * (1 + p * p), dHdp=lambda t, q, p: p * (1 + q * q) + np.sin(t))
    # At the larger step the iteration contracts slowly, and matrices are formed.
    for step in (0.1, 0.4):
        runs = [
            kd.solve(problem, (0.0, 4.0), 1.0, 0.3, step=step, method="implicit-verlet", compile=compile_)
            for compile_ in (True, False)
        ]
        assert runs[0].success
        assert np.array_equal(runs[0].x, runs[1].x)
        assert np.array_equal(runs[0].v, runs[1].v)
        assert runs[0].n_force_evaluations == runs[1].n_force_evaluations
