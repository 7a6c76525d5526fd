"""What a step costs: force evaluations, counted exactly."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.engine.program import evaluations_of

METHODS = kd.methods.catalogue()

# Forces of a step. Where a step begins and ends with a kick the two share one, which costs one more in the whole run.
PUBLISHED = {
    "kick-drift": (1, 0),
    "drift-kick": (1, 0),
    "velocity-verlet": (1, 1),
    "position-verlet": (1, 0),
    "implicit-verlet": (1, 1),
    "implicit-position-verlet": (1, 0),
    "ruth-3": (3, 0),
    "forest-ruth-4": (3, 0),
    "suzuki-4": (5, 0),
    "omelyan-pefrl-4": (4, 0),
    "omelyan-vefrl-4": (4, 1),
    "chin-4a": (3, 1),
    "mclachlan-atela-4": (4, 0),
    "mclachlan-atela-5": (6, 0),
    "calvo-sanz-4": (4, 1),
    "mclachlan-ss5-4": (5, 0),
    "mclachlan-ss9-6": (9, 0),
    "mclachlan-ss17-8": (17, 0),
    "suzuki-umeno-8": (15, 0),
    "yoshida-6": (7, 0),
    "yoshida-8": (15, 0),
    "kahan-li-6": (9, 0),
    "kahan-li-8": (17, 0),
    "sofroniou-spaletta-10": (35, 0),
    "blanes-moan-s6": (6, 1),
    "blanes-moan-s10": (10, 1),
    "blanes-moan-srkn6b": (6, 1),
    "blanes-moan-srkn11b": (11, 1),
    "blanes-moan-srkn14a": (14, 0),
    "explicit-euler": (1, 0),
    "runge-kutta-4": (4, 0),
    "dop853": (12, 0),
}


class Spring:
    """A force that counts how often it is asked for."""

    def __init__(self):
        self.calls = 0

    def __call__(self, x):
        self.calls += 1
        return -x


@pytest.mark.parametrize("name", PUBLISHED)
@pytest.mark.parametrize("save_every", [1, 7])
def test_no_force_is_evaluated_twice(name, save_every):
    spring = Spring()
    run = kd.solve(
        spring, (0.0, 1.0), 1.0, 0.0, step=0.05, method=name, save_every=save_every, compile=False, progress=False
    )
    per_step, once = PUBLISHED[name]
    assert run.n_force_evaluations == 20 * per_step + once
    assert spring.calls == run.n_force_evaluations + 1  # the function is tried at the start
    assert evaluations_of(METHODS[name]) == per_step


def test_kicks_under_an_acceleration_that_sees_the_velocity_share_nothing():
    run = kd.solve(lambda x, v: -x - v, (0.0, 1.0), 1.0, 0.0, step=0.05, method="kick-drift", compile=False)
    assert run.n_force_evaluations == 20


@pytest.mark.parametrize(("name", "per_step", "once"), [("baoab", 1, 1), ("aboba", 1, 0), ("obabo", 1, 1)])
def test_a_thermostat_costs_no_force(name, per_step, once):
    bath = kd.Langevin(lambda x: -x, friction=1.0, temperature=1.0)
    run = kd.solve(bath, (0.0, 1.0), 1.0, 0.0, step=0.05, method=name, compile=False)
    assert run.n_force_evaluations == 20 * per_step + once


def test_numbers_do_not_depend_on_what_is_saved():
    runs = [
        kd.solve(lambda x: -(x**3), (0.0, 5.0), 1.0, 0.2, step=0.05, method="blanes-moan-s6", save_every=n)
        for n in (1, 100)
    ]
    assert np.array_equal(runs[0].x[-1], runs[1].x[-1])
    assert np.array_equal(runs[0].v[-1], runs[1].v[-1])
