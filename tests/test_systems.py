"""Systems against exact solutions, published tables and conservation laws."""

import json
import math
from pathlib import Path

import mpmath
import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kickdrift as kd
from kickdrift.core.compilation import is_kept
from kickdrift.systems.kepler import eccentric_anomaly

EXACT = [name for name in kd.systems.catalogue() if kd.systems.get(name).exact is not None]


@pytest.mark.parametrize("name", EXACT)
def test_exact_solutions_start_at_the_start_and_solve_the_equation(name):
    system = kd.systems.get(name)
    t = np.linspace(0.0, 20.0, 41)
    x, v = system.exact(t)
    assert np.allclose(x[0], system.x0, atol=1e-15)
    assert np.allclose(v[0], system.v0, atol=1e-15)
    h = 1e-5
    out = np.zeros(system.x0.size)
    for i in range(1, t.size):
        ahead, behind = system.exact(t[i : i + 1] + h)[1][0], system.exact(t[i : i + 1] - h)[1][0]
        system.acceleration(t[i], np.atleast_1d(x[i]), np.atleast_1d(v[i]), system.params, out)
        assert np.allclose((ahead - behind) / (2 * h), out if system.x0.shape else out[0], atol=1e-7)


@pytest.mark.parametrize("name", EXACT)
def test_a_fourth_order_run_meets_the_exact_solution(name):
    system = kd.systems.get(name)
    s = kd.solve(system, (0.0, 20.0), step=0.005, method="blanes-moan-srkn6b", save_every=100)
    x, v = system.exact(s.t)
    assert np.abs(s.x - x).max() < 1e-7
    assert np.abs(s.v - v).max() < 1e-7
    assert np.abs(kd.solve(system, (0.0, 20.0), step=0.005, save_every=100).x - x).max() > 1e-4


def test_pendulum_against_jacobi_functions_of_many_digits():
    amplitude, t = 2.5, 7.3
    x, v = kd.systems.pendulum(amplitude).exact(np.array([t]))
    with mpmath.workdps(30):
        k = mpmath.sin(mpmath.mpf(amplitude) / 2)
        u = mpmath.ellipk(k**2) - t
        assert abs(x[0] - 2 * mpmath.asin(k * mpmath.ellipfun("sn", u, k=k))) < 1e-13
        assert abs(v[0] + 2 * k * mpmath.ellipfun("cn", u, k=k)) < 1e-13


@settings(max_examples=200, deadline=None)
@given(e=st.floats(0, 0.9999), m=st.floats(-100, 100))
def test_keplers_equation_is_solved_to_rounding(e, m):
    anomaly = eccentric_anomaly(np.array([m]), e)[0]
    residual = anomaly - e * math.sin(anomaly) - m
    assert abs(residual) <= 1e-15 * max(1.0, abs(m)) * 4


def reference(name):
    data = json.loads((Path(__file__).parent / "data" / "nbody_reference.json").read_text())[name]
    start = np.array(data["initial"], dtype=float).reshape(-1, 6)
    states = np.array(data["states"], dtype=float).reshape(len(data["times"]), -1, 6)
    masses = np.array(data["masses"], dtype=float)
    system = kd.systems.nbody(masses, start[:, :3], start[:, 3:], G=float(data["G"]))
    return system, np.array(data["times"], dtype=float), states


def test_figure_eight_against_a_solution_of_thirty_digits():
    system, times, states = reference("figure8")
    s = kd.solve(system, (0.0, times[-1]), step=times[-1] / 40_000, method="blanes-moan-srkn6b", save_every=40_000)
    assert np.abs(s.x[-1] - states[-1, :, :3]).max() < 1e-11
    verlet = kd.solve(system, (0.0, times[-1]), step=times[-1] / 40_000, method="velocity-verlet", save_every=40_000)
    assert np.abs(verlet.x[-1] - states[-1, :, :3]).max() > 1e-6


def test_pythagorean_bodies_against_a_solution_of_thirty_digits():
    system, times, states = reference("pythagorean")
    s = kd.solve(system, (0.0, 3.0), step=1e-5, method="blanes-moan-srkn6b", t_eval=times[:3])
    assert s.energy[0] == pytest.approx(-769 / 60, rel=1e-6)
    assert np.abs(s.x - states[:3, :, :3]).max() < 1e-9


@pytest.mark.parametrize(
    ("method", "step", "error"),
    [("kick-drift", 100.0, 2.53e-2), ("velocity-verlet", 200.0, 1.96e-3), ("velocity-verlet", 100.0, 7.5e-4)],
)
def test_outer_solar_system_energy_errors(method, step, error):
    # Hairer, Lubich, Wanner, Geometric Numerical Integration, section I.2.4, over 200,000 days.
    system, _, _ = reference("outer_solar_hairer")
    energy = kd.solve(system, (0.0, 200_000.0), step=step, method=method).energy
    assert energy[0] == pytest.approx(-3.215453183208163e-08, rel=1e-14)
    measured = np.abs(energy / energy[0] - 1).max()
    assert measured == pytest.approx(error, rel=0.02)
    other = kd.solve(system, (0.0, 200_000.0), step=step, method="position-verlet").energy
    assert np.abs(other / energy[0] - 1).max() != pytest.approx(error, rel=0.02)


def test_nbody_conserves_momentum_and_angular_momentum():
    rng = np.random.default_rng(7)
    cluster = kd.systems.nbody(
        rng.uniform(0.5, 1, 40), rng.normal(size=(40, 3)), rng.normal(size=(40, 3)), softening=0.1
    )
    s = kd.solve(cluster, (0.0, 1.0), step=0.01, method="velocity-verlet")
    for name in ("momentum", "angular momentum"):
        values = s.invariants[name]
        assert values.shape == (101, 3)
        assert np.abs(values - values[0]).max() < 1e-12 * np.abs(values).max() * 40
    lost = kd.solve(cluster, (0.0, 1.0), step=0.01, method="explicit-euler").invariants["angular momentum"]
    assert np.abs(lost - lost[0]).max() > 1e-3


@pytest.mark.parametrize("massive", [100, 4])
@pytest.mark.parametrize("make", [kd.systems.nbody, kd.systems.planetary])
def test_accelerations_of_many_bodies_are_kept_once_they_are_compiled(make, massive):
    x = np.random.default_rng(1).normal(size=(100, 3))
    for system in (make(np.repeat([1.0, 0.0], [massive, 100 - massive]), x, 0 * x), make(np.ones(3), x[:3], 0 * x[:3])):
        functions = [system.acceleration, *system.parts.values()]
        assert all(is_kept(function) for function in functions), system
    system = kd.systems.nbody(np.ones(100), x, 0 * x, threads=True)
    assert is_kept(system.acceleration)
    assert is_kept(system.unthreaded)


def test_threads_change_no_bit():
    rng = np.random.default_rng(1)
    n = 600
    options = {
        "masses": np.full(n, 1 / n),
        "x0": rng.normal(size=(n, 3)),
        "v0": rng.normal(size=(n, 3)),
        "softening": 0.1,
    }
    runs = [kd.solve(kd.systems.nbody(**options), (0.0, 0.1), step=0.01)]
    threads = numba.get_num_threads()
    try:
        for count in range(1, threads + 1):
            numba.set_num_threads(count)
            runs.append(kd.solve(kd.systems.nbody(**options, threads=True), (0.0, 0.1), step=0.01))
    finally:
        numba.set_num_threads(threads)
    assert all(np.array_equal(runs[0].x, other.x) for other in runs[1:])


def test_bodies_without_mass_are_attracted_and_do_not_attract():
    x = [[0, 0, 0], [1, 0, 0], [0, 5, 0]]
    v = [[0, 0, 0], [0, 1, 0], [0.4, 0, 0]]
    s = kd.solve(kd.systems.nbody([1, 0, 0], x, v), (0.0, 5.0), step=0.01)
    assert np.array_equal(s.x[:, 0], np.zeros_like(s.x[:, 0]))
    alone = kd.solve(kd.systems.nbody([1, 0], x[:2], v[:2]), (0.0, 5.0), step=0.01)
    assert np.abs(s.x[:, 1] - alone.x[:, 1]).max() < 1e-13


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: kd.systems.harmonic_oscillator(x0=math.nan), "x0 of 'harmonic-oscillator' would contain nan"),
        (lambda: kd.systems.harmonic_oscillator(omega=1e200), r"omega=1e\+200 .* its square, .* is inf"),
        (lambda: kd.systems.harmonic_oscillator(omega=1e-200), r"omega=1e-200 .* its square, .* is 0.0"),
        (lambda: kd.systems.kepler(mu=1e308), "v0 of 'kepler' would contain inf"),
        (
            lambda: kd.systems.nbody([1], [[0, 0, 0]], [[0, 0, 0]], softening=1e200),
            "params of 'nbody' would contain inf",
        ),
    ],
)
def test_numbers_that_are_not_finite_are_refused_where_systems_are_made(make, sentence):
    with pytest.raises(kd.ArgumentError, match=sentence):
        make()


@pytest.mark.parametrize("axis", [1e-200, 1e200])
def test_orbits_of_any_size_are_made(axis):
    x, v = kd.systems.kepler(eccentricity=0.6, semi_major_axis=axis).exact(0.0)
    assert x == pytest.approx([0.4 * axis, 0.0], rel=1e-14)
    assert v == pytest.approx([0.0, 2.0 / math.sqrt(axis)], rel=1e-14)


def test_solar_system_chooses_bodies_in_the_order_given():
    system = kd.systems.solar_system(["jupiter", "Sun"])
    assert system.coordinates["body"] == ["Jupiter", "Sun"]
    assert system.units["x"] == "au"
    whole = kd.systems.solar_system()
    assert whole.x0.shape == (11, 3)
    momentum = kd.solve(whole, (0.0, 1.0), step=1.0).invariants["momentum"][0]
    assert np.abs(momentum).max() < 1e-12  # barycentric, to what the asteroids that are left out carry


def test_earth_without_the_moon_stands_for_both():
    both, earth = kd.systems.solar_system(["Earth", "Moon"]), kd.systems.solar_system(["Earth"])
    share = both.params[2:] / both.params[2:].sum()
    assert np.allclose(earth.x0[0], share @ both.x0, atol=1e-16)
    assert earth.params[2] == both.params[2:].sum()


def test_the_ephemeris_has_the_epochs_and_masses_of_jpl():
    sky = kd.systems.ephemeris()
    assert sky.epochs.tolist() == [2451545.0, 2451546.0, 2451555.0, 2451645.0, 2451910.25, 2452545.0, 2455197.5]
    assert sky.gm[3] / sky.gm[4] == pytest.approx(81.3005690699153, rel=1e-12)
    assert sky.gm[0] == pytest.approx(0.01720209895**2, rel=1e-8)  # Gauss' constant, IAU 1976
    assert sky.au_km == pytest.approx(149_597_870.7, rel=1e-9)  # IAU 2012


@pytest.mark.parametrize("name", ["solar-system", "outer-solar-system", "benchmarks-game"])
def test_conserved_quantities_of_real_bodies_have_units(name):
    assert all(quantity.unit for quantity in kd.systems.get(name).quantities.values())
