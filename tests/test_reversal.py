"""Runs that go back from their end by their own steps in reverse."""

from functools import partial

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, KickdriftError

SPAN = (0.0, 20.0)
CONTROLS = {
    "by distance": kd.HairerSoderlind("distance"),
    "by a function of v": kd.HairerSoderlind(lambda t, x, v: 1.5 + np.cos(t) / 2 + v @ v / (x @ x)),
    "reflected": kd.HuangLeimkuhler("distance"),
    "time-transformed": kd.TimeTransformed("distance"),
    "logarithmic": kd.LogarithmicHamiltonian(),
}


def comet(**options):
    return kd.solve(kd.systems.kepler(eccentricity=0.8), SPAN, step=2e-3, **options)


def away(back, there):
    return max(abs(back.x[-1] - there.x[0]).max(), abs(back.v[-1] - there.v[0]).max())


@pytest.mark.parametrize("name", CONTROLS)
def test_reversible_steps_lead_back_to_the_start(name):
    there = comet(step_control=CONTROLS[name])
    back = there.return_to(0.0)
    assert away(back, there) < 1e-12
    assert abs(back.n_steps - there.n_steps) <= 1  # the last may lead to the start but for rounding
    assert back.step_range == pytest.approx(there.step_range, rel=1e-6)
    assert back.t[0] >= 20.0
    assert back.return_to(15.0).t[-1] == 15.0


def test_a_clock_that_misses_the_start_by_rounding_leads_there_all_the_same():
    """A part of a step is another step: 1e-4 from the start by the time-transformed leapfrog."""
    orbit = kd.systems.kepler(eccentricity=0.87)
    for end in (90.0, 100.0, 110.0):
        there = kd.solve(orbit, (0.0, end), step=0.007, step_control=CONTROLS["time-transformed"])
        assert away(there.return_to(0.0), there) < 1e-9


@pytest.mark.parametrize("method", ["tao-2", "tao-4"])
def test_methods_with_a_memory_lead_back_to_the_start(method):
    entangled = kd.Hamiltonian(
        dHdq=lambda q, p: np.array([q[0] * (1 + p[0] ** 2)]), dHdp=lambda q, p: np.array([p[0] * (1 + q[0] ** 2)])
    )
    for span in (40.0, 160 / 3, 170 / 3):
        there = kd.solve(
            entangled, (0.0, span), [1.3], [0.1], step=0.03, method=method, step_control=lambda q: 1.0 + q[0] * q[0]
        )
        assert away(there.return_to(0.0), there) < 1e-11


def test_steps_from_the_density_at_the_end_lead_elsewhere():
    there = comet(step_control="distance")
    again = partial(kd.solve, kd.systems.kepler(eccentricity=0.8), step_control="distance")
    back = again((there.t[-2], 0.0), there.x[-2], there.v[-2], step=there.t[-2] - there.t[-3])
    assert away(back, there) > 1e-9


@pytest.mark.parametrize("method", ["gauss-4", "blanes-moan-s6", "implicit-verlet"])
def test_a_forced_motion_goes_back_in_time_through_events_and_interruptions(method):
    def half(x):
        return x[0] - 0.5

    run = partial(
        kd.solve,
        lambda t, x: -x - 0.3 * x**3 + 0.2 * np.cos(t),
        (-3.0, -9.0),
        [1.0],
        [0.2],
        step=1e-2,
        step_control=lambda x: 1 + x @ x,
        method=method,
        events=half,
    )
    there = run(max_steps=100)
    while not there.success:
        there = there.continue_to(-9.0)
    back = there.return_to(-3.0)
    assert away(back, there) < 1e-12
    assert back.t_events[0][::-1] == pytest.approx(there.t_events[0], abs=1e-5)  # zeros between steps


def test_the_way_back_has_the_rows_of_the_way_there():
    some = comet(step_control="distance", save_every=50)
    assert some.return_to(0.0).t.size == pytest.approx(some.t.size, abs=1)
    times = comet(step_control="distance", t_eval=[20.0, 7.0, 3.0]).return_to(5.0)
    assert times.t.tolist() == [20.0, 7.0, 5.0]
    assert times.x[1] == pytest.approx(comet(step_control="distance")(7.0).x, abs=1e-4)


def test_what_leads_nowhere_back_is_refused(tmp_path):
    by_density = comet(step_control="distance")
    for t in (-1.0, 21.0, np.nan, by_density.return_to(1.0).t[0]):
        with pytest.raises(ArgumentError, match=r"a time of the run before its end, from 0\.0"):
            by_density.return_to(t)
    with pytest.raises(ArgumentError, match=r"by local error.* do not lead back"):
        comet(rtol=1e-6).return_to(0.0)
    with pytest.raises(ArgumentError, match="equal"):
        comet().return_to(0.0)
    bouncing = kd.solve(lambda x: 0 * x - 1, (0.0, 1.0), [1.0], [0.0], step=0.01, impacts=lambda x: x[0])
    with pytest.raises(ArgumentError, match="do not lead back"):
        bouncing.return_to(0.0)
    loaded = kd.load(by_density.save(tmp_path / "comet.npz"))
    with pytest.raises(KickdriftError, match="read from a file"):
        loaded.return_to(0.0)
    with pytest.raises(KickdriftError, match="do not lead back"):
        kd.World().run(duration=0.1, step=0.01).return_to(0.0)


def test_units_go_back():
    u = pytest.importorskip("astropy.units")
    there = kd.solve(
        lambda x: -x / np.linalg.norm(x) ** 3,
        (0 * u.s, 10 * u.s),
        [1.5, 0] * u.m,
        [0, 0.6] * u.m / u.s,
        step=0.01 * u.s,
        step_control="distance",
    )
    back = there.return_to(0 * u.ms)
    assert abs(back.x[-1] - there.x[0]).max() < 1e-12 * u.m
