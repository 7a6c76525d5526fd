"""m x'' = F(t, x) - c v with the damping solved exactly."""

import math
from dataclasses import replace

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.analysis.one_step import take_step
from kickdrift.core.errors import ArgumentError, MethodMismatchError
from kickdrift.engine.flows import damping
from kickdrift.methods import Kind

WORDS = {2: "conformal-verlet", 4: "blanes-moan-conformal-4", 6: "blanes-moan-conformal-6"}
STEPS = {1: (0.008, 0.004), 2: (0.04, 0.02, 0.01), 4: (0.15, 0.075, 0.0375), 6: (0.25, 0.125)}


def driven(t, x):
    return -2 * np.sin(x) - 0.6 * x**3 + np.cos(2 * t)


FORCED = {"problem": kd.Damped(driven, damping=0.8, mass=2.0), "t_span": (0.0, 6.0), "x0": 1.2, "v0": 0.7}


def observed(method, order, damping=0.8):
    problem = replace(FORCED["problem"], damping=damping)
    made = kd.analysis.observed_order(method=method, steps=STEPS[order], compile=False, **FORCED | {"problem": problem})
    return made.order


@pytest.mark.parametrize("damping", [0.8, 6.0])
@pytest.mark.parametrize(("order", "method"), WORDS.items())
def test_every_word_has_its_order_on_a_nonlinear_forced_damped_problem(order, method, damping):
    assert observed(method, order, damping) == pytest.approx(order, abs=0.1)


def test_one_order_does_not_pass_for_another():
    assert observed("kick-drift", 1) == pytest.approx(1, abs=0.1)
    assert abs(observed("kick-drift", 2) - 2) > 0.1
    assert abs(observed(WORDS[2], 4) - 4) > 0.1
    assert abs(observed(WORDS[4], 6) - 6) > 0.1


def test_methods_for_any_acceleration_see_the_damping():
    assert observed("implicit-midpoint", 2) == pytest.approx(2, abs=0.1)


def oscillation(t, rate, omega):
    """Exact x and v of x'' = -omega^2 x - 2 rate x', from x = 1 at rest."""
    w = math.sqrt(omega**2 - rate**2)
    c, s = np.cos(w * t), np.sin(w * t)
    return np.exp(-rate * t) * (c + rate / w * s), -np.exp(-rate * t) * omega**2 / w * s


@pytest.mark.parametrize(("order", "method"), WORDS.items())
def test_the_damped_oscillator_against_its_exact_solution(order, method):
    spring = kd.Damped(lambda x: -4 * x, damping=1.0, mass=2.0)  # omega^2 = 2, rate = 1/4
    x, v = oscillation(6.0, 0.25, math.sqrt(2))
    made = kd.analysis.observed_order(
        spring, method, (0.0, 6.0), STEPS[order], 1.0, 0.0, reference=(x, v), compile=False
    )
    assert made.order == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize("method", WORDS.values())
@pytest.mark.parametrize("step", [0.1, 1.0, 25.0])
def test_free_decay_is_exact_at_any_step(method, step):
    free = kd.Damped(lambda x: 0 * x, damping=[1.0, 4.0], mass=2.0)
    sol = kd.solve(free, (0.0, 2 * step), [0.0, 0.0], [3.0, -5.0], step=step, method=method, compile=False)
    exact = np.array([3.0, -5.0]) * np.exp(-np.outer(sol.t, [0.5, 2.0]))
    assert np.allclose(sol.v, exact, rtol=1e-12, atol=1e-14)


def jacobian(method, step, problem, x, v):
    """Of one step, by central differences of order four."""
    y, n = np.concatenate([x, v]), x.size
    image = lambda y: np.concatenate(take_step(problem, method, step, y[:n], y[n:]))  # noqa: E731
    columns = []
    for j in range(2 * n):
        e = np.zeros(2 * n)
        e[j] = 1e-3
        columns.append((8 * (image(y + e) - image(y - e)) - (image(y + 2 * e) - image(y - 2 * e))) / 12e-3)
    return np.column_stack(columns)


def conformal_defect(method, damping=0.5):
    step, omega = 0.3, np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    well = kd.Damped(lambda x: -x - x * x[::-1] ** 2, damping=damping)
    made = jacobian(method, step, well, np.array([0.4, -0.7]), np.array([0.3, 0.2]))
    return abs(made.T @ omega @ made - math.exp(-0.5 * step) * omega).max()


@pytest.mark.parametrize("method", WORDS.values())
def test_areas_shrink_exactly_as_those_of_the_motion(method):
    assert conformal_defect(method) < 1e-10


def test_other_methods_and_unequal_damping_miss_it():
    assert conformal_defect("implicit-midpoint") > 1e-4
    assert conformal_defect(WORDS[2], damping=[0.4, 0.6]) > 1e-3


def test_without_damping_it_is_verlet_to_the_bit():
    start = {"t_span": (0.0, 3.0), "x0": 1.2, "v0": 0.7, "step": 0.1, "compensated": False, "compile": False}
    damped = kd.solve(kd.Damped(driven, damping=0.0), method=WORDS[2], **start)
    verlet = kd.solve(driven, method="velocity-verlet", **start)
    assert np.array_equal(damped.x, verlet.x)
    assert np.array_equal(damped.v, verlet.v)
    assert damped.n_force_evaluations == verlet.n_force_evaluations == 31


@pytest.mark.parametrize(("method", "compensated"), [(WORDS[2], False), (WORDS[4], True)])
def test_compiled_and_interpreted_give_the_same_bits(method, compensated):
    runs = [
        kd.solve(
            kd.Damped(cubic, damping=[[0.1], [0.7]], mass=[[1.0], [3.0]]),
            (0.0, 4.0),
            np.linspace(-1, 1, 6).reshape(2, 3),
            np.zeros((2, 3)),
            step=0.1,
            method=method,
            compensated=compensated,
            compile=compile_,
        )
        for compile_ in (True, False)
    ]
    assert np.array_equal(runs[0].x, runs[1].x)
    assert np.array_equal(runs[0].v, runs[1].v)


def cubic(x):
    return -x * x * x


def test_shapes_masses_and_damping_of_each_number():
    together = kd.Damped(lambda x: -x, damping=[[0.2], [1.5]], mass=[[1.0], [4.0]])
    start = {"t_span": (0.0, 2.0), "step": 0.1, "method": WORDS[2], "compile": False}
    both = kd.solve(together, x0=np.ones((2, 3)), v0=np.zeros((2, 3)), **start)
    for i, (damping_, mass) in enumerate(((0.2, 1.0), (1.5, 4.0))):
        alone = kd.solve(kd.Damped(lambda x: -x, damping_, mass), x0=1.0, v0=0.0, **start)
        assert np.array_equal(both.x[:, i, 2], alone.x)


def test_backwards_in_time_it_grows_again():
    there = kd.solve(kd.Damped(cubic, 0.5), (0.0, 3.0), 1.0, 0.2, step=0.1, method=WORDS[4], compile=False)
    back = kd.solve(
        kd.Damped(cubic, 0.5), (3.0, 0.0), there.x[-1], there.v[-1], step=0.1, method=WORDS[4], compile=False
    )
    assert abs(back.x[-1] - 1.0) < 1e-13
    assert abs(back.v[-1] - 0.2) < 1e-13


def test_params_are_the_callers_own():
    spring = kd.Damped(lambda x, params: -params[0] * x, damping=1.0, energy=lambda x, v, params: params.size + 0 * x)
    sol = kd.solve(spring, (0.0, 1.0), 1.0, 0.0, step=0.1, args=(4.0,), method=WORDS[2], compile=False)
    assert set(sol.energy) == {1.0}


def test_the_body_of_the_kernel():
    rates, v = np.array([0.0, 2.0, 2.0, 0.5]), np.array([1.0, 2.0, -3.0, 4.0])
    outs = np.full((2, 4), np.nan)
    damping.decay(0.3, rates, v, outs[0])
    damping.decay.py_func(0.3, rates, v, outs[1])
    assert np.array_equal(outs[0], outs[1])
    assert np.allclose(v + outs[0], v * np.exp(-0.3 * rates), rtol=1e-15)


def test_the_body_of_the_kernel_of_damped_drifts():
    rates, v = np.array([0.0, 2.0, 2.0, 1e-9, 1e-320, 0.0]), np.array([1.0, 2.0, -3.0, 4.0, 5.0, 6.0])
    outs = np.full((2, 6), np.nan)
    damping.coast(0.3, rates, v, outs[0])
    damping.coast.py_func(0.3, rates, v, outs[1])
    assert np.array_equal(outs[0], outs[1])
    times = [0.3, (1 - math.exp(-0.6)) / 2, (1 - math.exp(-0.6)) / 2, 0.3 - 0.045e-9, 0.3, 0.3]
    assert np.allclose(outs[0], times * v, rtol=1e-15, atol=0)


def test_without_damping_the_higher_orders_are_the_words_of_undamped_motion():
    start = {"t_span": (0.0, 3.0), "x0": 1.2, "v0": 0.7, "step": 0.1, "compensated": False, "compile": False}
    for order, nystroem in ((4, "blanes-moan-srkn6b"), (6, "blanes-moan-srkn11b")):
        damped = kd.solve(kd.Damped(driven, damping=0.0), method=WORDS[order], **start)
        undamped = kd.solve(driven, method=nystroem, **start)
        assert np.array_equal(damped.x, undamped.x)
        assert np.array_equal(damped.v, undamped.v)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"damping": -1.0}, "damping=-1.0 must be at least 0"),
        ({"damping": math.inf}, "at least 0 and finite"),
        ({"damping": [1.0, 2.0, 3.0]}, "does not fit states of shape"),
        ({"damping": "much"}, "damping='much' does not fit"),
        ({"damping": 1.0, "mass": 0.0}, "mass=0.0 must be positive"),
    ],
)
def test_refusals(arguments, sentence):
    with pytest.raises(ArgumentError, match=sentence):
        kd.solve(kd.Damped(cubic, **arguments), (0, 1), [0.0, 0.0], [0.0, 0.0], step=0.1, compile=False)


def test_a_force_that_depends_on_the_velocity_is_refused():
    with pytest.raises(ArgumentError, match="name them t, x, params, out"):
        kd.solve(kd.Damped(lambda x, v: -v, 1.0), (0, 1), 0.0, 0.0, step=0.1, compile=False)


def test_methods_that_do_not_fit_are_refused():
    with pytest.raises(MethodMismatchError, match="conformal-verlet"):
        kd.solve(kd.Damped(cubic, 1.0), (0, 1), 0.0, 0.0, step=0.1, method="velocity-verlet", compile=False)
    with pytest.raises(MethodMismatchError, match="linear damping"):
        kd.solve(cubic, (0, 1), 0.0, 0.0, step=0.1, method=WORDS[2], compile=False)


def test_records_are_palindromes_for_damped_problems():
    for order, name in WORDS.items():
        method = kd.methods.get(name)
        assert (method.order, method.symmetric, method.kind, method.explicit) == (order, True, Kind.DAMPED, True)
