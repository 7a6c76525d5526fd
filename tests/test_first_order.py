"""First-order equations y' = f(t, y): sweeps over the components, their composition, and its extrapolation."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, MethodMismatchError


def van_der_pol(mu):
    def rates(i, y):
        return y[1] if i == 0 else mu * (1 - y[0] ** 2) * y[1] - y[0]

    return kd.FirstOrder(rates)


def lotka_volterra(y):
    return np.array([y[0] * (1 - y[1]), y[1] * (y[0] - 1)])


def turning(t, y):
    return np.array([y[1] * y[2] - np.sin(t), -y[0] * y[2] + np.cos(3 * t), -0.5 * y[0] * y[1] + y[2] * np.sin(2 * t)])


FISH = kd.FirstOrder(lotka_volterra, invariants={"constant of motion": lambda y: (y - np.log(y)).sum()})
PROBLEMS = {
    "Lotka-Volterra": {"problem": FISH, "x0": [0.5, 1.5]},
    "van der Pol": {"problem": van_der_pol(1.0), "x0": [2.0, 0.5]},
    "forced": {"problem": kd.FirstOrder(turning), "x0": [1.0, 0.5, 0.3]},
}


def measured(name, method, steps, end):
    return kd.analysis.observed_order(
        method=method, steps=steps, t_span=(0.0, end), compile=False, **PROBLEMS[name]
    ).order


# The order.


@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize(
    ("method", "order"),
    [
        ("kick-drift", 1),
        ("drift-kick", 1),
        ("implicit-kick-drift", 1),
        ("implicit-drift-kick", 1),
        ("implicit-verlet", 2),
        ("implicit-position-verlet", 2),
        ("composition-diagonal-4", 4),
    ],
)
def test_order(method, order, name):
    steps = {1: (0.01, 0.005), 2: (0.04, 0.02), 4: (0.05, 0.025)}[order]
    assert measured(name, method, steps, 4.0) == pytest.approx(order, abs=0.1)


# Steps at which the terms beyond the order change the slope by less than 0.05, above rounding.
@pytest.mark.parametrize(
    ("name", "order", "steps", "end"),
    [
        ("Lotka-Volterra", 6, (0.2, 0.1), 4.0),
        ("van der Pol", 6, (0.05, 0.035, 0.025), 4.0),
        ("forced", 6, (0.1, 0.05), 4.0),
        ("Lotka-Volterra", 8, (0.4, 0.3, 0.25), 4.0),
        ("forced", 8, (0.25, 0.2, 0.15), 1.0),
    ],
)
def test_order_of_extrapolation(name, order, steps, end):
    assert measured(name, f"composition-diagonal-{order}", steps, end) == pytest.approx(order, abs=0.1)
    assert measured(name, f"composition-diagonal-{order - 2}", steps, end) < order - 1


def test_two_is_the_composition_itself():
    assert kd.methods.get("composition-diagonal-2") is kd.methods.get("implicit-verlet")


@pytest.mark.parametrize(
    ("problem", "start", "end", "steps"),
    [
        (lambda x: -np.sin(x), (2.0, 0.3), 4.0, (0.04, 0.02)),
        (lambda x, v: -np.sin(x) - 0.3 * v - 0.2 * v**3, (2.0, 0.5), 4.0, (0.05, 0.025)),
        (
            kd.Partitioned(lambda t, x, v: x * (1 - v) + np.sin(2 * t), lambda t, x, v: v * (x - np.cos(t))),
            (0.5, 1.5),
            3.0,
            (0.04, 0.02),
        ),
    ],
    ids=["pendulum", "damped", "partitioned"],
)
def test_extrapolation_of_kicks_and_drifts(problem, start, end, steps):
    made = kd.analysis.observed_order(problem, "composition-diagonal-4", (0.0, end), steps, *start, compile=False)
    assert made.order == pytest.approx(4, abs=0.1)


# What the sweeps are.


def test_a_sweep_is_the_loop_of_gauss_and_seidel():
    y, h = np.array([2.0, 0.5]), 0.1
    solution = kd.solve(FISH, (0.0, 10 * h), y, step=h, method="kick-drift", compile=False, compensated=False)
    h = solution.step
    for step in range(10):
        y[0] = y[0] + h * (y[0] * (1 - y[1]))
        y[1] = y[1] + h * (y[1] * (y[0] - 1))
        assert np.array_equal(solution.x[step + 1], y)


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_adjoint_sweep_undoes_the_sweep(name):
    problem, start = PROBLEMS[name]["problem"], np.array(PROBLEMS[name]["x0"])
    there = kd.solve(problem, (0.3, 0.4), start, step=0.1, method="kick-drift", compile=False)
    back = kd.solve(problem, (0.4, 0.3), there.x[-1], step=0.1, method="implicit-drift-kick", compile=False)
    assert np.allclose(back.x[-1], start, rtol=0, atol=1e-14)
    # The sweep itself does not.
    again = kd.solve(problem, (0.4, 0.3), there.x[-1], step=0.1, method="kick-drift", compile=False)
    assert abs(again.x[-1] - start).max() > 1e-4


def test_steps_of_the_symmetric_word_forth_and_back_meet():
    there = kd.solve(FISH, (0.0, 5.0), [0.5, 1.5], step=0.1, method="implicit-verlet", compile=False)
    back = kd.solve(FISH, (5.0, 0.0), there.x[-1], step=0.1, method="implicit-verlet", compile=False)
    assert np.allclose(back.x[-1], [0.5, 1.5], rtol=0, atol=1e-13)


# What they keep, and stand.


def test_the_constant_of_motion_stays_with_the_symmetric_word_and_leaves_with_euler():
    def change(method, step=0.1):
        s = kd.solve(FISH, (0.0, 200.0), [0.5, 1.5], step=step, method=method, compile=False)
        kept = s.invariants["constant of motion"]
        halves = np.array_split(abs(kept - kept[0]), 2)
        return [half.max() for half in halves]

    early, late = change("implicit-verlet")
    assert late < 1.02 * early < 0.01
    early, late = change("kick-drift")
    assert late < 1.02 * early < 0.1
    early, late = change("explicit-euler", 0.01)
    assert late > 1.5 * early > 0.1


def test_stiff_relaxation_oscillations():
    mu = 20.0
    reference = solve_ivp(
        lambda t, y: [y[1], mu * (1 - y[0] ** 2) * y[1] - y[0]], (0.0, 40.0), [2.0, 0.0], "Radau", rtol=1e-9, atol=1e-9
    ).y[:, -1]
    given = {"t_span": (0.0, 40.0), "x0": [2.0, 0.0], "compile": False}
    s = kd.solve(van_der_pol(mu), step=0.01, method="implicit-verlet", **given)
    assert s.success
    assert abs(s.x[-1] - reference).max() < 0.02
    # The explicit method of the same order of cost leaves for infinity at this step.
    assert not kd.solve(van_der_pol(mu), step=0.1, method="runge-kutta-4", **given).success
    assert kd.solve(van_der_pol(mu), step=0.1, method="implicit-drift-kick", **given).success


def test_a_component_may_leave_the_domain_of_its_rate_on_the_way():
    # From 3, the first iterate of y = 3 - 30 log(y) is negative.
    problem = kd.FirstOrder(lambda i, y: -300.0 * np.log(y[0]))
    with np.errstate(invalid="ignore"):
        s = kd.solve(problem, (0.0, 0.1), [3.0], step=0.1, method="implicit-drift-kick", compile=False)
    assert s.success
    assert s.x[-1] + 30.0 * np.log(s.x[-1]) == pytest.approx(3.0, abs=1e-12)


def test_an_equation_without_a_solution_ends_the_run_with_a_sentence():
    # y = 1 + h y^2 has none for 4 h > 1.
    given = {"problem": kd.FirstOrder(lambda y: y**2), "t_span": (0.0, 0.8), "x0": [1.0], "compile": False}
    for method in ("implicit-drift-kick", "implicit-euler"):
        s = kd.solve(step=0.4, method=method, **given)
        assert s.status is kd.Outcome.NOT_CONVERGED
        assert s.x.tolist() == [[1.0]]
        assert "t=0.0, after 0 of 2 steps. The residual was" in s.message
        assert s.message.endswith("Try a smaller step; where the force jumps, give switches.")
        s = kd.solve(step=0.4, method=method, switches=lambda y: y - 9.0, **given)
        assert s.status is kd.Outcome.NOT_CONVERGED
        assert s.message.endswith("Try a smaller step.")
        assert kd.solve(step=0.01, method=method, **given).success


# How they run.


@pytest.mark.parametrize("method", ["kick-drift", "implicit-verlet", "composition-diagonal-4"])
def test_one_component_at_a_time_gives_the_bits_of_all_at_once(method):
    def together(y):
        return np.array([y[1], (1 - y[0] ** 2) * y[1] - y[0]])

    given = {"t_span": (0.0, 5.0), "x0": [2.0, 0.5], "step": 0.1, "method": method, "compile": False}
    alone, all_ = kd.solve(van_der_pol(1.0), **given), kd.solve(kd.FirstOrder(together), **given)
    assert np.array_equal(alone.x, all_.x)
    # Two calls for a component are one evaluation, two calls for all components are two.
    assert alone.n_force_evaluations == all_.n_force_evaluations // 2


def test_an_explicit_sweep_costs_one_evaluation():
    s = kd.solve(van_der_pol(1.0), (0.0, 1.0), [2.0, 0.0], step=0.1, method="kick-drift", compile=False)
    assert s.n_force_evaluations == s.n_steps


COMPILED = [
    ("kick-drift", PROBLEMS["van der Pol"]),
    ("implicit-verlet", PROBLEMS["forced"]),
    ("composition-diagonal-4", PROBLEMS["van der Pol"]),
    ("composition-diagonal-4", {"problem": lambda x, v: -x - 0.1 * v * abs(v), "x0": 1.0, "v0": 0.5}),
]


@pytest.mark.parametrize(("method", "given"), COMPILED)
def test_compiled_runs_have_the_bits_of_interpreted_ones(method, given):
    runs = [kd.solve(t_span=(0.0, 2.0), step=0.1, method=method, compile=c, **given) for c in (True, False)]
    assert np.array_equal(runs[0].x, runs[1].x)
    assert np.array_equal(runs[0].v, runs[1].v)
    assert runs[0].n_force_evaluations == runs[1].n_force_evaluations


@pytest.mark.parametrize("method", ["kick-drift", "composition-diagonal-4"])
def test_compensated_sums_are_those_of_each_component(method):
    problem, start = kd.FirstOrder(lambda y: np.array([1e-2, 1.0])), [1.0, 1e2]
    ends = [
        kd.solve(problem, (0.0, 1e2), start, step=0.1, method=method, compensated=c, compile=False).x[-1]
        for c in (True, False)
    ]
    assert np.array_equal(ends[0], [2.0, 2e2])
    assert not np.array_equal(ends[1], [2.0, 2e2])


def test_methods_that_would_lose_their_order_are_refused():
    with pytest.raises(MethodMismatchError, match="velocity-verlet"):
        kd.solve(FISH, (0.0, 1.0), [0.5, 1.5], step=0.1, method="velocity-verlet", compile=False)
    with pytest.raises(ArgumentError, match="v0="):
        kd.solve(FISH, (0.0, 1.0), [0.5, 1.5], [0.0, 0.0], step=0.1, compile=False)
