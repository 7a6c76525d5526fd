"""Phase errors: against formulas, exact motions and finer runs."""

import pickle
from math import asin, pi

import numpy as np
import pytest

import kickdrift as kd
from kickdrift import analysis
from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.engine.phase import time_shift

OSCILLATOR, KEPLER = kd.systems.harmonic_oscillator(), kd.systems.kepler(0.3)


@pytest.mark.parametrize("method", ["kick-drift", "velocity-verlet", "position-verlet"])
@pytest.mark.parametrize("h", [0.02, 0.2])
def test_verlet_gains_what_its_frequency_says(method, h):
    sol = kd.solve(OSCILLATOR, (0.0, 500.0), step=h, method=method)
    faster = 2 / sol.step * asin(sol.step / 2) - 1
    ripple = sol.step / 2 if method == "kick-drift" else sol.step**2 / 8
    assert analysis.phase_drift(sol) == pytest.approx(faster, rel=1e-4, abs=ripple / 5e4)
    assert abs(analysis.phase_error(sol) - faster * sol.t).max() < 1.1 * ripple
    assert analysis.largest_phase_error(sol) > 0.9 * faster * 500.0


def test_a_gain_of_many_periods_is_counted():
    sol = kd.solve(OSCILLATOR, (0.0, 4000.0), step=0.5, method="velocity-verlet")
    assert analysis.phase_error(sol)[-1] == pytest.approx((4 * asin(0.25) - 1) * 4000.0, abs=0.1)
    assert analysis.largest_phase_error(sol) > 2 * 2 * pi


def test_it_grows_linearly_where_the_energy_is_kept_and_quadratically_where_it_is_not():
    def growth(method, step):
        sol = kd.solve(KEPLER, (0.0, 400.0), step=step, method=method)
        error = np.abs(analysis.phase_error(sol))
        half = sol.t.size // 2
        return error[-200:].mean() / error[half - 200 : half].mean()

    assert growth("blanes-moan-srkn6b", 0.1) == pytest.approx(2, abs=0.15)
    assert growth("runge-kutta-4", 0.05) == pytest.approx(4, abs=0.3)


def test_moved_in_time_by_it_the_exact_motion_is_nearest():
    sol = kd.solve(KEPLER, (0.0, 100.0), step=0.01, method="leapfrog")
    shift = analysis.phase_error(sol)
    plain, moved = (np.abs(KEPLER.exact(sol.t + own)[0] - sol.x).max() for own in (0.0, shift))
    assert moved < plain / 2
    for other in (-1e-3, 1e-3):
        x, v = KEPLER.exact(sol.t + shift + other)
        near = KEPLER.exact(sol.t + shift)
        far, best = (((a - sol.x) ** 2).sum() + ((b - sol.v) ** 2).sum() for a, b in ((x, v), near))
        assert far > best


@pytest.mark.parametrize("method", ["explicit-euler", "implicit-euler"])
def test_orbits_that_grow_and_shrink_have_a_phase(method):
    h = 0.1
    sol = kd.solve(OSCILLATOR, (0.0, 8 * pi), step=h, method=method)
    assert not 0.2 < sol.energy[-1] < 2
    # Near the axes, where the root mean squares of positions and velocities make no difference.
    expected = (np.arctan(sol.step) / sol.step - 1) * sol.t
    assert analysis.phase_error(sol)[-1] == pytest.approx(expected[-1], abs=2e-3)


def test_backwards_and_in_any_order_it_is_the_same():
    forwards = kd.solve(OSCILLATOR, (0.0, 50.0), step=0.1, method="leapfrog")
    backwards = kd.solve(OSCILLATOR, (0.0, -50.0), step=0.1, method="leapfrog")
    assert np.allclose(analysis.phase_error(backwards), -analysis.phase_error(forwards), rtol=0, atol=1e-10)
    # Fewer rows have other root mean squares, and so weigh the ripple in another way.
    mixed = kd.solve(OSCILLATOR, (0.0, 50.0), step=0.1, method="leapfrog", t_eval=[50.0, 20.0, 0.0])
    assert np.allclose(
        analysis.phase_error(mixed), analysis.phase_error(forwards)[[500, 200, 0]], rtol=0, atol=0.1**2 / 8
    )


def test_a_finer_run_is_a_reference_too():
    sol = kd.solve(OSCILLATOR, (0.0, 50.0), step=0.1, method="leapfrog")
    fine = kd.solve(OSCILLATOR, (0.0, 50.0), step=0.02, method="kahan-li-8", save_every=50)
    # At the end the finer run is not known beyond it, and goes on straight.
    difference = np.abs(analysis.phase_error(sol, fine) - analysis.phase_error(sol))
    assert difference[:-1].max() < 1e-8
    assert difference[-1] < 1e-4
    assert analysis.phase_drift(sol, fine) == pytest.approx(analysis.phase_drift(sol), rel=1e-3)


def test_first_order_equations_have_one_too():
    turning = kd.FirstOrder(lambda y: np.array([y[1], -y[0]]))
    coarse, fine = (
        kd.solve(turning, (0.0, 20.0), [1.0, 0.0], step=h, method="implicit-midpoint", compile=False)
        for h in (0.2, 0.005)
    )
    # tan(w h / 2) = h / 2
    slower = 2 / 0.2 * np.arctan(0.1) - 1
    assert analysis.phase_error(coarse, fine)[-2] == pytest.approx(slower * coarse.t[-2], rel=5e-3)


def test_states_that_are_lost_have_none_and_do_not_disturb_the_others():
    fine = kd.solve(kd.SecondOrder(lambda x: -x), (0.0, 3.0), 1.0, 1.0, step=0.01, compile=False)
    bad = kd.Solution(**{**vars(fine), "x": np.where(np.arange(301) == 7, np.nan, fine.x), "derived": {}})
    error = analysis.phase_error(bad, fine)
    assert np.isnan(error[7])
    assert np.abs(np.delete(error, 7)).max() < 1e-12


def test_it_goes_with_the_solution(tmp_path):
    sol = kd.solve(KEPLER, (0.0, 20.0), step=0.05, method="leapfrog")
    expected = analysis.phase_error(sol)
    for other in (kd.load(sol.save(tmp_path / "kepler.npz")), pickle.loads(pickle.dumps(sol))):
        assert np.array_equal(analysis.phase_error(other), expected)
    line = next(line for line in sol.report().splitlines() if line.startswith("phase error"))
    assert f"{analysis.largest_phase_error(sol):.3e}" in line


def test_what_has_no_reference_says_so(tmp_path):
    pendulum = kd.systems.pendulum()
    later = kd.solve(OSCILLATOR, (1.0, 2.0), step=0.1)
    moved = kd.solve(OSCILLATOR, (0.0, 2.0), x0=2.0, step=0.1)
    for sol in (later, moved):
        assert "phase error" not in sol.report()
        with pytest.raises(KickdriftError, match="no exact solution from this initial state"):
            analysis.phase_error(sol)
    long, short = (kd.solve(pendulum, (0.0, end), step=0.1) for end in (2.0, 1.0))
    with pytest.raises(ArgumentError, match="give one that covers it"):
        analysis.phase_error(long, short)
    with pytest.raises(ArgumentError, match="has states unlike"):
        analysis.phase_error(long, kd.solve(KEPLER, (0.0, 2.0), step=0.1))
    with pytest.raises(ArgumentError, match="read from a file"):
        analysis.phase_error(long, kd.load(long.save(tmp_path / "a.npz")))
    with pytest.raises(ArgumentError, match="needs at least two"):
        analysis.phase_drift(kd.solve(OSCILLATOR, (0.0, 1.0), step=0.1, t_eval=[1.0]))


def test_the_exact_motion_has_no_phase_error():
    sol = kd.solve(KEPLER, (0.0, 50.0), step=0.1, method="wisdom-holman")
    assert analysis.largest_phase_error(sol) < 1e-11


def test_of_many_rows_some_are_sought_and_the_others_lie_between():
    asked = []
    kepler = kd.systems.kepler(eccentricity=0.3)

    def exact(t):
        asked.append(t.size)
        return kepler.exact(t)

    sol = kd.solve(kepler, (0.0, 2000.0), step=0.02, method="velocity-verlet", progress=False)
    shift = time_shift(exact, sol.t, sol.x, sol.v, sol.step)
    assert sum(asked) < 500_000  # instead of 300,000 in each of two or three rounds
    every = np.concatenate([time_shift(exact, *(a[k::4] for a in (sol.t, sol.x, sol.v)), sol.step) for k in range(4)])
    order = np.argsort(np.concatenate([sol.t[k::4] for k in range(4)]))
    assert np.abs(shift - every[order]).max() < 1e-3 * np.abs(every).max()


def test_a_phase_that_jumps_between_rows_is_sought_at_every_row():
    t = np.arange(100_000) * 0.05
    ahead = np.where(np.arange(t.size) % 3 == 0, 0.3, 0.0)

    def circle(at):
        return np.stack([np.cos(at), np.sin(at)], -1), np.stack([-np.sin(at), np.cos(at)], -1)

    found = time_shift(circle, t, *circle(t + ahead), 0.05)
    assert np.abs(found - ahead).max() < 1e-9
