"""The order of every method in the catalogue, measured two-sided by the engine on problems that leave no term out.

Words of kicks and drifts of higher orders are measured in `test_tables`, in extended precision, which also shows that
the engine does what they say. Runge-Kutta methods run here as they are compiled for x' = v, and in `test_runge_kutta` and
`test_stiff` on every kind of problem; the highest ones and extrapolations have tests of their own.
"""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import accumulate
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.engine import processing, program
from kickdrift.methods import Kind, Letter, Method, alternating

CATALOGUE = kd.methods.catalogue()
K, D = Letter.KICK, Letter.DRIFT


@dataclass(frozen=True)
class Problem:
    """A problem, where it ends, and the largest step to try."""

    kind: Kind
    problem: Any
    x0: Any
    v0: Any
    end: float
    largest: float
    rates: Any = None  # x' and v' by which DOP853 finds the end, where no system knows it
    known: Any = None  # the system that knows the end


def forced(t, x):
    return -x - x**3 + np.cos(2 * t)


def damped(t, x, v):
    return -np.sin(x) - 0.1 * v - 0.05 * v**3 + 0.3 * np.cos(t)


def kepler(x):
    return -x / (x[0] ** 2 + x[1] ** 2) ** 1.5


relativistic = kd.Separable(
    kinetic_gradient=lambda p, t: p / np.sqrt(1 + p * p) * (1 + 0.1 * np.sin(t)),
    potential_gradient=lambda q, t: q + q**3 - np.cos(2 * t),
)
entangled = kd.Hamiltonian(dHdq=lambda q, p: q * (1 + p * p), dHdp=lambda q, p: p * (1 + q * q))
prey_and_predators = kd.Partitioned(lambda x, v: x * (1 - v), lambda t, x, v: v * (x - 1 + 0.1 * np.cos(t)))
forced_van_der_pol = kd.FirstOrder(lambda t, y: np.array([y[1], (1 - y[0] ** 2) * y[1] - y[0] + np.cos(t)]))

# Functions of a user's: the flows call them by their addresses, and are compiled once for all of the same sizes.
PROBLEMS = {
    "pendulum": Problem(
        Kind.NEWTONIAN, lambda x: -np.sin(x), [2.0, 1.0], [0.0, 0.0], 5.0, 1.0, lambda t, x, v: (v, -np.sin(x))
    ),
    "kepler": Problem(
        Kind.NEWTONIAN, kepler, [0.7, 0.0], [0.0, np.sqrt(13 / 7)], 2.0, 0.3, known=kd.systems.kepler(eccentricity=0.3)
    ),
    "forced": Problem(Kind.NEWTONIAN, forced, [0.7, -0.2], [0.3, 0.5], 5.0, 0.5, lambda t, x, v: (v, forced(t, x))),
    "damped": Problem(
        Kind.VELOCITY_DEPENDENT, damped, [2.0, 1.0], [0.5, -0.3], 5.0, 0.5, lambda t, x, v: (v, damped(t, x, v))
    ),
    "relativistic": Problem(
        *(Kind.SEPARABLE, relativistic, [0.5, -0.2], [1.0, 0.4], 4.0, 0.5),
        lambda t, q, p: (p / np.sqrt(1 + p * p) * (1 + 0.1 * np.sin(t)), -q - q**3 + np.cos(2 * t)),
    ),
    "entangled": Problem(
        Kind.HAMILTONIAN,
        entangled,
        [0.8, 0.3],
        [0.5, -0.6],
        5.0,
        0.5,
        lambda t, q, p: (p * (1 + q * q), -q * (1 + p * p)),
    ),
    "prey and predators": Problem(
        *(Kind.PARTITIONED, prey_and_predators, [0.5, 0.8], [1.5, 0.7], 5.0, 0.5),
        lambda t, x, v: (x * (1 - v), v * (x - 1 + 0.1 * np.cos(t))),
    ),
    "van der pol": Problem(
        *(Kind.FIRST_ORDER, forced_van_der_pol, [1.0, 0.5], None, 3.0, 0.3),
        lambda t, y, z: (y[1], (1 - y[0] ** 2) * y[1] - y[0] + np.cos(t)),
    ),
}
PAIRS = [
    (method, name)
    for method in CATALOGUE.values()
    for name, problem in PROBLEMS.items()
    if (name == "pendulum" and method.order <= 6 if method.tableau is not None else method.order <= 4)
    and method.kind.includes(problem.kind)
]


@cache
def reference(name):
    """State at the end: by the exact solution, or by DOP853 at a tolerance of 3e-14."""
    p = PROBLEMS[name]
    if p.known is not None:
        x, v = p.known.exact(np.array([p.end]))
        return np.concatenate([np.ravel(x), np.ravel(v)])
    y0 = np.ravel(p.x0 if p.v0 is None else [p.x0, p.v0])

    def rates(t, y):
        return np.ravel(p.rates(t, *([y, None] if p.v0 is None else y.reshape(2, -1))))

    return solve_ivp(rates, (0.0, p.end), y0, method="DOP853", rtol=3e-14, atol=1e-15).y[:, -1]


def error(name, method, step):
    p = PROBLEMS[name]
    options = {"step": step, "method": method, "save_every": 2**60, "progress": False}
    run = kd.solve(p.problem, (0.0, p.end), p.x0, p.v0, **options)
    if not run.success:
        return abs(run.step), np.inf
    return abs(run.step), np.abs(np.concatenate([run.x[-1].ravel(), run.v[-1].ravel()]) - reference(name)).max()


def measured(name, method):
    """Slope between the two smallest steps with errors above rounding, or affordable."""
    floor, most_steps = 4e-12, 1500
    p, kept = PROBLEMS[name], []
    step = p.largest
    while len(kept) < 2 or p.end / step < most_steps:
        made = error(name, method, step)
        if made[1] < floor:
            break
        kept.append(made)
        step = made[0] / 1.5
    (h1, e1), (h2, e2) = kept[-2:]
    return np.log(e1 / e2) / np.log(h1 / h2)


def has(order, measurement):
    return abs(measurement - order) < 0.1


@pytest.mark.parametrize(("method", "name"), PAIRS, ids=lambda part: getattr(part, "name", part))
def test_every_method_has_its_order(method, name):
    assert measured(name, method) == pytest.approx(method.order, abs=0.1)


# What must be caught.


@pytest.mark.parametrize("name", ["pendulum", "kepler", "forced"])
def test_one_order_does_not_pass_for_another(name):
    assert not has(2, measured(name, CATALOGUE["kick-drift"]))
    assert not has(4, measured(name, CATALOGUE["velocity-verlet"]))
    assert not has(2, measured(name, CATALOGUE["forest-ruth-4"]))


def clock_on_the_kick(method, *rest, **options):
    right = program.compose(method, *rest, **options)
    weights = [weight if letter is K else Fraction(0) for letter, weight in method.word]
    return replace(right, offsets=np.array([float(c) for c in accumulate(weights[:-1], initial=Fraction(0))]))


CLOCKED = ["velocity-verlet", "position-verlet", "forest-ruth-4", "blanes-moan-srkn6b", "blanes-moan-s10", "kahan-li-8"]


@pytest.mark.parametrize("name", CLOCKED)
def test_a_clock_on_the_kick_is_caught(name, monkeypatch):
    right = measured("pendulum", CATALOGUE[name])
    monkeypatch.setattr("kickdrift.engine.processing.compose", clock_on_the_kick)
    monkeypatch.setattr(processing, "_programs", processing._programs.__wrapped__)  # which forgets what it knows
    assert has(1, measured("forced", CATALOGUE[name]))
    assert measured("pendulum", CATALOGUE[name]) == right  # which has no clock


def errors_on_the_forced_oscillator(method):
    """Errors on q'' = -q + cos 2t after five units of time, in 20, 30 and 40 steps."""
    ends = [
        kd.solve(lambda t, x: -x + np.cos(2 * t), (0, 5), 1.0, 0.0, step=5 / n, method=method, compile=False).x[-1]
        for n in (20, 30, 40)
    ]
    return np.abs(np.array(ends) - (4 / 3 * np.cos(5) - np.cos(10) / 3))


def test_kahan_li_8_has_its_order_on_the_forced_oscillator(monkeypatch):
    # Large libraries that move the clock with the kicks have 4.6e-1 there instead of 2.8e-10.
    errors = errors_on_the_forced_oscillator("kahan-li-8")
    assert np.log(errors[0] / errors[2]) / np.log(2) == pytest.approx(8, abs=0.1)
    assert errors[0] < 3e-10
    monkeypatch.setattr("kickdrift.engine.processing.compose", clock_on_the_kick)
    monkeypatch.setattr(processing, "_programs", processing._programs.__wrapped__)  # which forgets what it knows
    errors = errors_on_the_forced_oscillator("kahan-li-8")
    assert np.log(errors[0] / errors[2]) / np.log(2) == pytest.approx(1, abs=0.1)


# The table with its roles swapped has order 4 too, but larger errors.
@pytest.mark.parametrize(("name", "step"), [("pendulum", 0.2), ("kepler", 0.05), ("forced", 0.1)])
def test_a_nystrom_table_with_its_roles_swapped_is_caught(name, step):
    right = CATALOGUE["blanes-moan-srkn6b"]
    assert right.word[0][0] is K
    swapped = replace(right, word=alternating(D, [weight for _, weight in right.word]))
    assert error(name, swapped, step)[1] > 5 * error(name, right, step)[1]


@pytest.mark.parametrize("name", ["pendulum", "kepler", "forced"])
def test_a_weight_cut_to_three_digits_is_caught(name):
    outer = Fraction("1.351")
    half = [outer / 2, outer, (1 - outer) / 2]
    word = alternating(D, [*half, 1 - 2 * outer, *reversed(half)])
    assert not has(4, measured(name, replace(CATALOGUE["forest-ruth-4"], word=word, order=2)))
    with pytest.raises(ArgumentError, match="its word has only order 2"):
        replace(CATALOGUE["forest-ruth-4"], word=word)


@pytest.mark.parametrize("name", ["conformal-verlet", "boris", "he-sun-liu-qin-2"])
def test_damping_and_a_magnetic_field_make_no_order_higher(name):
    with pytest.raises(ArgumentError, match="its word has only order 2"):
        replace(CATALOGUE[name], order=3)


def test_an_explicit_kick_with_friction_is_caught():
    verlet = replace(CATALOGUE["velocity-verlet"], kind=Kind.VELOCITY_DEPENDENT, symmetric=False)
    assert has(1, measured("damped", verlet))


@pytest.mark.parametrize("name", ["entangled", "prey and predators"])
def test_an_explicit_word_is_caught_where_each_rate_sees_both(name):
    verlet = replace(CATALOGUE["velocity-verlet"], kind=Kind.PARTITIONED, counterpart="", symmetric=False)
    assert not has(2, measured(name, verlet))


# The record, and what it refuses.

PENDULUM = replace(kd.systems.pendulum(), native=False)


def test_steps_are_those_used_and_sorted():
    made = kd.analysis.observed_order(PENDULUM, CATALOGUE["velocity-verlet"], (0.0, 1.0), [0.01, 0.03])
    assert np.allclose(made.steps, [1 / 34, 0.01], rtol=1e-14)
    assert made.method == "velocity-verlet"
    assert made.between == pytest.approx([made.order])


def test_backwards_from_another_start_and_time():
    system, start = replace(kd.systems.kepler(0.3), native=False), {"x0": [1.0, 0.0], "v0": [0.0, 0.9]}
    made = kd.analysis.observed_order(system, "velocity-verlet", (2.0, 0.0), (0.02, 0.01), **start)
    assert has(2, made.order)
    assert made.steps.tolist() == [0.02, 0.01]


def test_a_method_of_ones_own_is_measured():
    word = alternating(K, [Fraction(1, 4), Fraction(1, 2), Fraction(1, 2), Fraction(1, 2), Fraction(1, 4)])
    mine = Method(name="mine", order=2, word=word, symmetric=True, kind=Kind.SEPARABLE, source="a test")
    assert has(2, measured("pendulum", mine))


def test_steps_that_are_one_step_are_refused():
    with pytest.raises(ArgumentError, match="a slope needs at least two"):
        kd.analysis.observed_order(PENDULUM, "kick-drift", (0.0, 1.0), [0.5, 0.6])


def test_a_run_that_fails_has_no_order():
    with pytest.raises(KickdriftError, match="the order cannot be measured"):
        kd.analysis.observed_order(lambda x: 1e200 * x, "kick-drift", (0, 4), [1, 2], 1.0, 0.0, compile=False)


def test_a_run_without_error_has_no_order():
    end = kd.solve(PENDULUM, (0.0, 1.0), step=1.0)
    with pytest.raises(KickdriftError, match="larger steps"):
        kd.analysis.observed_order(PENDULUM, "kick-drift", (0, 1), [1.0, 0.5], reference=(end.x[-1], end.v[-1]))
