"""The semi-implicit Euler method with linearly implicit damping."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError

METHOD = "implicit-damping"


def drag(x, v):
    return -np.sin(x) - 0.3 * v - 0.2 * v**3


def drag_slope(v):
    return -0.3 - 0.6 * v**2


def forced(t, x, v):
    return -x - x**3 + np.cos(2 * t) - 0.5 * v * abs(v)


def coupled(x, v):
    return np.array([-x[0] - 2.0 * v[0] + v[1] * v[1], -x[1] - 3.0 * v[1] + v[0] * v[1]])


def coupled_slopes(v):
    return np.array([[-2.0, 2 * v[1]], [v[1], -3.0 + v[0]]])


@pytest.mark.parametrize(
    ("problem", "start"),
    [
        (drag, (2.0, 0.5)),
        (kd.SecondOrder(drag, velocity_jacobian=drag_slope), (2.0, 0.5)),
        (forced, (0.7, 0.3)),
        (kd.SecondOrder(coupled, velocity_jacobian=coupled_slopes), ([1.0, 0.5], [0.2, -0.4])),
        (lambda x: -np.sin(x), (2.0, 0.5)),
    ],
    ids=["formed", "given", "forced", "coupled", "without damping"],
)
def test_order(problem, start):
    made = kd.analysis.observed_order(problem, METHOD, (0.0, 3.0), (0.01, 0.005), *start, compile=False)
    assert made.order == pytest.approx(1, abs=0.1)


@pytest.mark.parametrize("given", [True, False])
def test_linear_damping_divides_by_one_plus_h_c_over_m(given):
    c, m, h = 7.0, 2.0, 0.5
    problem = kd.Newtonian(lambda x, v: -3.0 * x - c * v, mass=m, velocity_jacobian=(lambda v: -c) if given else None)
    s = kd.solve(problem, (0.0, 5.0), 1.0, 0.5, step=h, method=METHOD, compile=False)
    x, v = 1.0, 0.5
    for k in range(1, s.t.size):
        v = (v + h * (-3.0 * x) / m) / (1 + h * c / m)
        x = x + h * v
        assert s.v[k] == pytest.approx(v, rel=1e-12 if given else 1e-6, abs=1e-9)
        assert s.x[k] == pytest.approx(x, rel=1e-12 if given else 1e-6, abs=1e-9)


def test_stiff_damping_is_stable_where_the_explicit_kick_is_not():
    # The explicit kick grows for h c / m > 2; here it is 50.
    def stiff(x, v):
        return -x - 500.0 * v

    s = kd.solve(stiff, (0.0, 100.0), 1.0, 0.0, step=0.1, method=METHOD, compile=False)
    assert abs(s.x).max() <= 1.0
    assert s.x[-1] == pytest.approx(np.exp(-100.0 / 500.0), rel=1e-3)
    assert (
        kd.solve(stiff, (0.0, 100.0), 1.0, 0.0, step=0.1, method="kick-drift", compile=False).status.name
        == "NOT_FINITE"
    )
    # Quadratic drag, at a speed where it is stiff.
    fast = kd.solve(lambda v: -50.0 * v * abs(v), (0.0, 1.0), 0.0, 100.0, step=0.01, method=METHOD, compile=False)
    assert np.all(np.diff(fast.v) < 0)
    assert 0 < fast.v[-1] < 0.05


def test_a_jacobian_given_and_one_formed_make_the_same_run():
    start = {"t_span": (0.0, 5.0), "x0": [1.0, 0.5], "v0": [0.2, -0.4], "step": 0.1, "method": METHOD, "compile": False}
    given = kd.solve(kd.SecondOrder(coupled, velocity_jacobian=coupled_slopes), **start)
    formed = kd.solve(coupled, **start)
    assert np.allclose(given.x, formed.x, rtol=0, atol=1e-8)
    assert given.n_force_evaluations == given.n_steps
    assert formed.n_force_evaluations == 3 * formed.n_steps


@pytest.mark.parametrize(
    ("slopes", "start", "says"),
    [
        (lambda v: np.array([[-2.0, 2 * v[1]], [v[1], -3.0]]), [0.2, -0.4], r"entry \(1, 1\) is -3.0 .* -2.8 per unit"),
        (lambda v: coupled_slopes(v).T * 1.001, [0.2, -0.4], r"entry \(0, 0\)"),
        # At rest this one is right.
        (lambda v: np.array([[-2.0, v[1]], [v[1], -3.0 + v[0]]]), [0.0, 0.0], r"entry \(0, 1\)"),
        (lambda v: np.full((2, 2), np.nan), [0.2, -0.4], r"entry \(0, 0\) is nan"),
    ],
)
def test_a_wrong_jacobian_is_refused_before_the_first_step(slopes, start, says):
    problem = kd.SecondOrder(coupled, velocity_jacobian=slopes)
    with pytest.raises(ArgumentError, match=says):
        kd.solve(problem, (0.0, 1.0), [1.0, 0.5], start, step=0.1, method=METHOD, compile=False)


def test_a_force_of_masses_wants_the_derivatives_of_the_force():
    wrong = kd.Newtonian(lambda x, v: -7.0 * v, mass=2.0, velocity_jacobian=lambda v: -3.5)
    with pytest.raises(ArgumentError, match=r"is -3.5 where number 0 of the force changes by -7"):
        kd.solve(wrong, (0.0, 1.0), 1.0, 0.5, step=0.1, method=METHOD, compile=False)


def test_a_jacobian_of_another_shape_or_without_use_is_refused():
    with pytest.raises(ArgumentError, match="shape"):
        kd.solve(
            kd.SecondOrder(coupled, velocity_jacobian=lambda v: np.zeros((3, 3))),
            (0.0, 1.0), [1.0, 0.5], [0.2, -0.4], step=0.1, method=METHOD, compile=False,
        )  # fmt: skip
    with pytest.raises(ArgumentError, match="no argument v"):
        kd.solve(
            kd.SecondOrder(lambda x: -x, velocity_jacobian=lambda v: 0.0),
            (0.0, 1.0), 1.0, 0.5, step=0.1, method=METHOD, compile=False,
        )  # fmt: skip


def test_a_right_jacobian_with_a_kink_or_a_border_of_its_domain_is_not_refused():
    problem = kd.SecondOrder(lambda v: -v * abs(v), velocity_jacobian=lambda v: -2 * abs(v))
    assert kd.solve(problem, (0.0, 1.0), 0.0, 0.0, step=0.1, method=METHOD, compile=False).success
    problem = kd.SecondOrder(lambda v: -np.sqrt(1 - v), velocity_jacobian=lambda v: 0.5 / np.sqrt(1 - v))
    assert kd.solve(problem, (0.0, 0.1), 0.0, 0.7, step=0.1, method=METHOD, compile=False).success


def test_a_growth_that_no_finite_velocity_meets_ends_the_run():
    s = kd.solve(lambda v: 10.0 * v, (0.0, 1.0), 0.0, 1.0, step=0.1, method=METHOD, compile=False)
    assert not s.success
    assert "Try a smaller step" in s.message


def test_compiled_runs_have_the_bits_of_interpreted_ones():
    for problem in (coupled, kd.SecondOrder(coupled, velocity_jacobian=coupled_slopes)):
        runs = [
            kd.solve(problem, (0.0, 2.0), [1.0, 0.5], [0.2, -0.4], step=0.1, method=METHOD, compile=compile_)
            for compile_ in (True, False)
        ]
        assert np.array_equal(runs[0].x, runs[1].x)
        assert runs[0].n_force_evaluations == runs[1].n_force_evaluations


def test_more_numbers_than_a_matrix_is_formed_for_are_refused():
    x0 = np.zeros(16_385)
    with pytest.raises(ArgumentError, match="x0 has 16385 numbers, and kicks"):
        kd.solve(lambda x, v: -x - v, (0.0, 1.0), x0, x0, step=0.1, method="implicit-damping", compile=False)
