"""The order of every method in the catalogue, measured two-sided on problems that leave no term out."""

from dataclasses import replace
from fractions import Fraction
from itertools import accumulate

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.engine import program
from kickdrift.methods import Kind, Letter, Method, alternating

CATALOGUE = kd.methods.catalogue()
K, D = Letter.KICK, Letter.DRIFT


def forced(t, x):
    return -x - x**3 + np.cos(2 * t)


def damped(x, v):
    return -np.sin(x) - 0.1 * v - 0.05 * v * abs(v)


def interpreted(system):
    # A few thousand interpreted steps, of the same bits, take less time than compiling flows for every method.
    return replace(system, native=False)


# For each problem and order, steps at which the next term of the error changes the slope by less than 0.05, and the
# errors, 1e-1 to 1e-12, lie above rounding. Those for 6 and 8 are from triple jumps of `forest-ruth-4`.
PROBLEMS = {
    "pendulum": (
        {"problem": interpreted(kd.systems.pendulum(2.5)), "t_span": (0.0, 10.0)},
        {1: (0.01, 0.005), 2: (0.04, 0.02, 0.01), 4: (0.1, 0.05, 0.025), 6: (0.1, 0.05), 8: (0.1, 0.07)},
    ),
    "kepler": (
        {"problem": interpreted(kd.systems.kepler(0.6)), "t_span": (0.0, 3.0)},
        {
            1: (0.001, 0.0005),
            2: (0.006, 0.003, 0.0015),
            4: (0.008, 0.004, 0.002),
            6: (0.02, 0.01, 0.005),
            8: (0.02, 0.01),
        },
    ),
    "forced": (
        {"problem": forced, "t_span": (0.0, 5.0), "x0": 0.7, "v0": 0.3, "compile": False},
        {
            1: (0.008, 0.004, 0.002),
            2: (0.04, 0.02, 0.01),
            4: (0.1, 0.05, 0.025),
            6: (0.05, 0.025),
            8: (0.1, 0.05),
        },
    ),
    "damped": (
        {"problem": damped, "t_span": (0.0, 5.0), "x0": 2.0, "v0": 0.5, "compile": False},
        {1: (0.008, 0.004, 0.002), 2: (0.04, 0.02, 0.01), 4: (0.1, 0.05, 0.025)},
    ),
}


def measured(name, method, order=None):
    problem, steps = PROBLEMS[name]
    return kd.analysis.observed_order(method=method, steps=steps[order or method.order], **problem).order


def has(order, measurement):
    return abs(measurement - order) < 0.1


@pytest.mark.parametrize("name", ["pendulum", "kepler", "forced"])
@pytest.mark.parametrize("method", CATALOGUE.values(), ids=lambda m: m.name)
def test_every_method_has_its_order(method, name):
    assert measured(name, method) == pytest.approx(method.order, abs=0.1)


@pytest.mark.parametrize(
    "method", [m for m in CATALOGUE.values() if m.kind is Kind.GENERAL], ids=lambda method: method.name
)
def test_methods_for_any_acceleration_have_their_order_with_friction(method):
    assert measured("damped", method) == pytest.approx(method.order, abs=0.1)


def test_the_reference_agrees_with_a_fine_run():
    problem, _ = PROBLEMS["forced"]
    options = {name: problem[name] for name in ("t_span", "x0", "v0", "compile")}
    fine = kd.solve(forced, step=0.005, method="blanes-moan-srkn6b", save_every=1000, **options)
    reference = fine.x[-1], fine.v[-1]
    by_dop853 = kd.analysis.observed_order(method=CATALOGUE["velocity-verlet"], steps=(0.04, 0.02), **problem)
    by_run = kd.analysis.observed_order(
        method=CATALOGUE["velocity-verlet"], steps=(0.04, 0.02), reference=reference, **problem
    )
    assert np.allclose(by_dop853.errors, by_run.errors, rtol=0, atol=1e-11)


# What must be caught.


@pytest.mark.parametrize("name", ["pendulum", "kepler", "forced"])
def test_one_order_does_not_pass_for_another(name):
    assert not has(2, measured(name, CATALOGUE["kick-drift"], order=2))
    assert not has(4, measured(name, CATALOGUE["velocity-verlet"], order=4))
    assert not has(2, measured(name, CATALOGUE["forest-ruth-4"], order=2))


def clock_on_the_kick(method, *rest):
    right = program.compose(method, *rest)
    weights = [weight if letter is K else Fraction(0) for letter, weight in method.word]
    return replace(right, offsets=np.array([float(c) for c in accumulate(weights[:-1], initial=Fraction(0))]))


@pytest.mark.parametrize(
    "method",
    [m for m in CATALOGUE.values() if m.order > 1 and m.word[0][0] in (K, D)],
    ids=lambda method: method.name,
)
def test_a_clock_on_the_kick_is_caught(method, monkeypatch):
    monkeypatch.setattr("kickdrift.engine.solve.compose", clock_on_the_kick)
    assert has(1, measured("forced", method, order=1))
    assert measured("pendulum", method) == pytest.approx(method.order, abs=0.1)  # which has no clock


# The table with its roles swapped has order 4 too, and errors 8 to 50 times as large: 6.6e-8, 8.7e-9 and 5.0e-6.
@pytest.mark.parametrize(("name", "most"), [("pendulum", 5e-9), ("kepler", 5e-10), ("forced", 1.5e-6)])
def test_a_nystrom_table_with_its_roles_swapped_is_caught(name, most):
    problem, steps = PROBLEMS[name]
    right = CATALOGUE["blanes-moan-srkn6b"]
    assert right.word[0][0] is K
    swapped = replace(right, word=alternating(D, [weight for _, weight in right.word]))
    good, bad = (kd.analysis.observed_order(method=m, steps=steps[4], **problem).errors[0] for m in (right, swapped))
    assert good < most < bad


@pytest.mark.parametrize("name", ["pendulum", "kepler", "forced"])
def test_a_weight_cut_to_three_digits_is_caught(name):
    outer = Fraction("1.351")
    half = [outer / 2, outer, (1 - outer) / 2]
    cut = replace(CATALOGUE["forest-ruth-4"], word=alternating(D, [*half, 1 - 2 * outer, *reversed(half)]))
    assert not has(4, measured(name, cut))


def test_an_explicit_kick_with_friction_is_caught():
    verlet = replace(CATALOGUE["velocity-verlet"], kind=Kind.GENERAL)
    assert has(1, measured("damped", verlet, order=1))


# The record, and what it refuses.

PENDULUM = interpreted(kd.systems.pendulum())


def test_steps_are_those_used_and_sorted():
    made = kd.analysis.observed_order(PENDULUM, CATALOGUE["velocity-verlet"], (0.0, 1.0), [0.01, 0.03])
    assert np.allclose(made.steps, [1 / 34, 0.01], rtol=1e-14)
    assert made.method == "velocity-verlet"
    assert made.between == pytest.approx([made.order])


def test_backwards_from_another_start_and_time():
    kepler, start = interpreted(kd.systems.kepler(0.3)), {"x0": [1.0, 0.0], "v0": [0.0, 0.9]}
    made = kd.analysis.observed_order(kepler, "velocity-verlet", (2.0, 0.0), (0.02, 0.01), **start)
    assert has(2, made.order)
    assert made.steps.tolist() == [0.02, 0.01]


def test_a_method_of_ones_own_is_measured():
    word = alternating(K, [Fraction(1, 4), Fraction(1, 2), Fraction(1, 2), Fraction(1, 2), Fraction(1, 4)])
    mine = Method(name="mine", order=2, word=word, symmetric=True, kind=Kind.SEPARABLE, source="a test")
    assert has(2, measured("pendulum", mine))


def test_steps_that_are_one_step_are_refused():
    with pytest.raises(ArgumentError, match="a slope needs two"):
        kd.analysis.observed_order(PENDULUM, "kick-drift", (0.0, 1.0), [0.5, 0.6])


def test_a_run_that_fails_has_no_order():
    with pytest.raises(KickdriftError, match="no order to show"):
        kd.analysis.observed_order(lambda x: 1e200 * x, "kick-drift", (0, 4), [1, 2], 1.0, 0.0, compile=False)


def test_a_run_without_error_has_no_order():
    end = kd.solve(PENDULUM, (0.0, 1.0), step=1.0)
    with pytest.raises(KickdriftError, match="larger steps"):
        kd.analysis.observed_order(PENDULUM, "kick-drift", (0, 1), [1.0, 0.5], reference=(end.x[-1], end.v[-1]))
