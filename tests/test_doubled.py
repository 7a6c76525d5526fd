"""Explicit methods for Hamiltonians that are not separable: Tao's doubled phase space."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.engine import processing, program
from kickdrift.methods import tao

# Tao's first example, started as there.
EXAMPLE = kd.Hamiltonian(
    dHdq=lambda q, p: q * (1 + p * p),
    dHdp=lambda q, p: p * (1 + q * q),
    energy=lambda q, p: 0.5 * (1 + q * q) * (1 + p * p),
)
FORCED = kd.Hamiltonian(
    dHdq=lambda t, q, p: q * (1 + p * p) - 0.5 * np.cos(2 * t), dHdp=lambda t, q, p: p * (1 + q * q) + 0.3 * np.sin(t)
)


def pendulum_on_a_pendulum():
    """Two masses of 1 on rods of 1 under a gravity of 1, by angles and their momenta."""

    def speeds(q, p):
        c = np.cos(q[0] - q[1])
        return (p[0] - c * p[1]) / (2 - c * c), (2 * p[1] - c * p[0]) / (2 - c * c)

    def rates(q, p):
        return np.array(speeds(q, p))

    def slopes(q, p):
        first, second = speeds(q, p)
        turn = first * second * np.sin(q[0] - q[1])
        return np.array([2 * np.sin(q[0]) + turn, np.sin(q[1]) - turn])

    def energy(q, p):
        first, second = speeds(q, p)
        return 0.5 * (p[0] * first + p[1] * second) - 2 * np.cos(q[0]) - np.cos(q[1])

    return kd.Hamiltonian(dHdq=slopes, dHdp=rates, energy=energy)


def schwarzschild():
    """A bound geodesic around a black hole of mass 1 in the plane, by r, phi and their momenta; E = 0.96."""

    def slopes(q, p):
        r, f = q[0], 1 - 2 / q[0]
        return np.array([(0.96**2 / f**2 + p[0] ** 2) / r**2 - p[1] ** 2 / r**3, 0.0])

    def rates(q, p):
        return np.array([(1 - 2 / q[0]) * p[0], p[1] / q[0] ** 2])

    def energy(q, p):
        f = 1 - 2 / q[0]
        return 0.5 * (f * p[0] ** 2 + p[1] ** 2 / q[0] ** 2 - 0.96**2 / f)

    return kd.Hamiltonian(dHdq=slopes, dHdp=rates, energy=energy)


PROBLEMS = {
    "Tao's example": ({"problem": EXAMPLE, "x0": 1.0, "v0": 0.3}, 2.0),
    "forced": ({"problem": FORCED, "x0": 1.0, "v0": 0.3}, 2.0),
    "double pendulum": ({"problem": pendulum_on_a_pendulum(), "x0": [0.8, -0.4], "v0": [0.1, 0.3]}, 3.0),
    "pendulum": ({"problem": lambda x: -np.sin(x), "x0": 2.0, "v0": 0.3}, 3.0),
}


@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize(("method", "steps"), [("tao-2", (0.02, 0.01)), ("tao-4", (0.03, 0.015))])
def test_order(method, steps, name):
    problem, end = PROBLEMS[name]
    made = kd.analysis.observed_order(method=method, steps=steps, t_span=(0.0, end), compile=False, **problem)
    assert made.order == pytest.approx(kd.methods.get(method).order, abs=0.1)


def test_order_6():
    problem, end = PROBLEMS["Tao's example"]
    made = kd.analysis.observed_order(
        method=tao(6, 5.0), steps=(0.08, 0.06), t_span=(0.0, end), compile=False, **problem
    )
    assert made.order == pytest.approx(6, abs=0.1)


def largest_energy_errors(method, start=(-3.0, 0.0), parts=4, step=0.01, end=200.0):
    s = kd.solve(EXAMPLE, (0.0, end), *start, step=step, method=method)
    errors = abs(s.energy / s.energy[0] - 1)
    return [part.max() for part in np.array_split(errors, parts)]


def test_the_energy_error_stays_bounded():
    errors = largest_energy_errors(tao(2, 20.0))
    assert max(errors) < 1e-3
    assert errors[-1] < 1.1 * errors[0]


def test_with_too_weak_a_binding_it_does_not():
    errors = largest_energy_errors(tao(2, 0.1))
    assert not max(errors) < 1e-2


def test_an_explicit_runge_kutta_method_drifts_where_this_does_not():
    errors = largest_energy_errors("runge-kutta-4", step=0.05)
    assert errors[-1] > 2 * errors[0] > 1e-4


def test_geodesics_around_a_black_hole():
    s = kd.solve(schwarzschild(), (0.0, 750.0), [14.0, 0.0], [0.05, 4.0], step=0.5, method=tao(4, 1.0), compile=False)
    exact = kd.solve(schwarzschild(), (0.0, 750.0), [14.0, 0.0], [0.05, 4.0], step=1.0, method="gauss-8", compile=False)
    assert np.ptp(s.x[:, 0]) > 5  # a precessing ellipse, not a circle
    assert abs(s.energy - s.energy[0]).max() < 1e-6
    assert abs(s.v[:, 1] - 4.0).max() < 1e-7  # angular momentum, which the binding does not keep
    assert abs(s.x[-1] - exact.x[-1]).max() < 0.05


def test_copies_start_where_the_state_does():
    h = 0.1
    s = kd.solve(EXAMPLE, (0.0, h), 1.0, 0.3, step=h, method=tao(2, 3.0), compile=False, compensated=False)

    def slope(q, p):
        return q * (1 + p * p)

    q = x = 1.0
    p = y = 0.3
    half = h / 2
    p, x = p - half * slope(q, y), x + half * slope(y, q)
    q, y = q + half * slope(p, x), y - half * slope(x, p)
    turn = np.array([[np.cos(6 * h), np.sin(6 * h)], [-np.sin(6 * h), np.cos(6 * h)]])
    mean, difference = np.array([q + x, p + y]) / 2, turn @ np.array([q - x, p - y]) / 2
    (q, p), (x, y) = mean + difference, mean - difference
    q, y = q + half * slope(p, x), y - half * slope(x, p)
    p, x = p - half * slope(q, y), x + half * slope(y, q)
    assert s.x[-1] == pytest.approx(q, rel=1e-14)
    assert s.v[-1] == pytest.approx(p, rel=1e-14)


def test_it_costs_an_evaluation_for_each_of_its_flows():
    for method, flows in (("tao-2", 4), ("tao-4", 16)):
        s = kd.solve(EXAMPLE, (0.0, 1.0), 1.0, 0.3, step=0.1, method=method, compile=False)
        assert s.n_force_evaluations == flows * s.n_steps


def test_compiled_runs_have_the_bits_of_interpreted_ones():
    for compensated in (True, False):
        runs = [
            kd.solve(FORCED, (0.0, 2.0), 1.0, 0.3, step=0.1, method="tao-2", compensated=compensated, compile=compile_)
            for compile_ in (True, False)
        ]
        assert np.array_equal(runs[0].x, runs[1].x)
        assert np.array_equal(runs[0].v, runs[1].v)


def test_a_rate_at_the_time_of_the_wrong_copy_is_caught(monkeypatch):
    spell = program._spell

    def with_one_clock(*arguments):
        clock, spelled = 0, []
        for name, weight, _ in spell(*arguments):
            spelled.append((name, weight, clock))
            clock += weight * (name == "doubled-drift")
        return spelled

    monkeypatch.setattr(program, "_spell", with_one_clock)
    monkeypatch.setattr(processing, "_programs", processing._programs.__wrapped__)  # which forgets what it knows
    problem, end = PROBLEMS["forced"]
    made = kd.analysis.observed_order(method="tao-2", steps=(0.02, 0.01), t_span=(0.0, end), compile=False, **problem)
    assert made.order < 1.5


@pytest.mark.parametrize("order", [0, 1, 3, 2.0, True, "2"])
def test_an_order_that_is_not_even_is_refused(order):
    with pytest.raises(ArgumentError, match="positive even number"):
        tao(order)


@pytest.mark.parametrize("binding", [0.0, -1.0, np.inf, np.nan])
def test_a_binding_that_is_not_positive_is_refused(binding):
    with pytest.raises(ArgumentError, match="positive and finite"):
        tao(2, binding)


def test_the_catalogue_has_the_binding_of_the_paper():
    assert kd.methods.get("tao-2") == tao(2, 20)
    assert tao(4, 7.5).name == "tao-4-binding-7.5"
