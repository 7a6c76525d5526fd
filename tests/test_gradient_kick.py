"""Chin's method: order 4 with positive weights, by a kick under the gradient of the squared force."""

from dataclasses import replace

import numpy as np
import pytest

import kickdrift as kd

CHIN = kd.methods.get("chin-4a")

PROBLEMS = {
    "pendulum": {"problem": lambda x: -np.sin(x), "x0": 2.0, "v0": 0.3},
    "forced": {"problem": lambda t, x: -x - x**3 + np.cos(2 * t), "x0": 0.7, "v0": 0.3},
    # Masses, and a force that is no gradient.
    "masses": {
        "problem": kd.Newtonian(lambda x: np.array([-x[0] + x[1] ** 2, -4 * x[1] - x[0] * x[1]]), mass=[1.0, 3.0]),
        "x0": [0.7, -0.3],
        "v0": [0.3, 0.5],
    },
}


def measured(method, name):
    made = kd.analysis.observed_order(
        method=method, steps=(0.1, 0.05), t_span=(0.0, 4.0), compile=False, **PROBLEMS[name]
    )
    return made.order


@pytest.mark.parametrize("name", PROBLEMS)
def test_order(name):
    assert measured(CHIN, name) == pytest.approx(4, abs=0.1)


@pytest.mark.parametrize("name", PROBLEMS)
def test_with_the_other_sign_or_none_it_has_order_2(name):
    for coefficient in (-CHIN.parameters[0], 0):
        assert measured(replace(CHIN, parameters=(coefficient,)), name) == pytest.approx(2, abs=0.1)


def test_a_kick_is_that_of_the_modified_force():
    # For x'' = -k x the gradient of the squared force is linear: the kick is -k (1 - 2 c s^2 k) s x, exactly.
    k, h = 3.0, 0.2
    c = float(CHIN.parameters[0])
    s = kd.solve(lambda x: -k * x, (0.0, h), 1.0, 0.5, step=h, method=CHIN, compile=False, compensated=False)
    x, v = 1.0, 0.5
    for kick, drift, correction in ((h / 6, h / 2, 0.0), (2 * h / 3, h / 2, c), (h / 6, 0.0, 0.0)):
        v = v - kick * k * (1 - 2 * correction * kick**2 * k) * x
        x = x + drift * v
    assert s.x[-1] == pytest.approx(x, rel=1e-15)
    assert s.v[-1] == pytest.approx(v, rel=1e-15)


def test_three_evaluations_a_step_and_energy_that_stays():
    kepler = replace(kd.systems.kepler(0.6), native=False)
    s = kd.solve(kepler, (0.0, 200.0), step=0.02, method=CHIN)
    assert s.n_force_evaluations == 3 * s.n_steps + 1
    errors = [abs(part).max() for part in np.array_split(s.energy / s.energy[0] - 1, 4)]
    assert max(errors) < 1.1 * errors[0] < 1e-5
    # At equal cost, with three evaluations a step, Forest and Ruth's errors are larger.
    other = kd.solve(kepler, (0.0, 200.0), step=0.02, method="forest-ruth-4")
    assert abs(other.energy / other.energy[0] - 1).max() > 10 * max(errors)


def test_compiled_runs_have_the_bits_of_interpreted_ones():
    runs = [
        kd.solve(lambda x: -np.sin(x), (0.0, 2.0), 2.0, 0.3, step=0.1, method=CHIN, compile=compile_)
        for compile_ in (True, False)
    ]
    assert np.array_equal(runs[0].x, runs[1].x)
    assert np.array_equal(runs[0].v, runs[1].v)
