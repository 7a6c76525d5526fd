"""Orbital elements: against REBOUND, and against the orbits that states were made of."""

from math import pi

import numpy as np
import pytest

import kickdrift as kd
from kickdrift import analysis
from kickdrift.core.errors import ArgumentError, KickdriftError

NAMES = {"a": "a", "e": "e", "i": "inc", "Omega": "Omega", "omega": "omega", "M": "M"}


def apart(one, other):
    """Differences of angles."""
    return np.abs((one - other + pi) % (2 * pi) - pi)


@pytest.fixture(scope="module")
def planets():
    system = kd.systems.outer_solar_system()
    return system, kd.solve(system, (0.0, 40_000.0), step=100.0, method="wisdom-holman", save_every=100)


@pytest.mark.parametrize("coordinates", ["jacobi", "heliocentric"])
def test_they_are_those_of_rebound(planets, coordinates):
    rebound = pytest.importorskip("rebound")
    system, sol = planets
    found = analysis.orbital_elements(sol, coordinates)
    assert found.bodies == ("Jupiter", "Saturn", "Uranus", "Neptune", "Pluto")
    for row in range(sol.t.size):
        other = rebound.Simulation()
        other.G = 1.0
        for gm, x, v in zip(system.gm, sol.x[row], sol.v[row], strict=True):
            other.add(m=gm, x=x[0], y=x[1], z=x[2], vx=v[0], vy=v[1], vz=v[2])
        orbits = other.orbits(primary=other.particles[0] if coordinates == "heliocentric" else None)
        for name, theirs in NAMES.items():
            own = getattr(found, name)[row]
            expected = np.array([getattr(orbit, theirs) for orbit in orbits])
            if name in ("a", "e"):
                assert own == pytest.approx(expected, rel=1e-10)
            else:
                assert apart(own, expected).max() < 1e-9


def test_both_coordinates_differ(planets):
    jacobi, other = (analysis.orbital_elements(planets[1], name) for name in ("jacobi", "heliocentric"))
    assert np.allclose(jacobi.a[:, 0], other.a[:, 0], rtol=1e-13)  # of the first planet they are the same
    assert np.abs(jacobi.a[:, 2] / other.a[:, 2] - 1).max() > 1e-3


def test_a_kepler_orbit_keeps_its_elements():
    sol = kd.solve(kd.systems.kepler(0.3, semi_major_axis=2.0, mu=3.0), (0.0, 30.0), step=0.1, method="wisdom-holman")
    found = analysis.orbital_elements(sol)
    assert found.a == pytest.approx(2.0, rel=1e-12)
    assert found.e == pytest.approx(0.3, rel=1e-12)
    assert not found.i.any()
    assert not found.Omega.any()
    assert apart(found.omega, 0.0).max() < 1e-12
    assert apart(found.M[:, 0], sol.t * np.sqrt(3.0 / 8.0)).max() < 1e-12


def test_hyperbolas_circles_and_orbits_that_go_backwards():
    rebound = pytest.importorskip("rebound")
    given = [
        {"a": -2.0, "e": 1.5, "inc": 0.4, "Omega": 1.0, "omega": 2.0, "M": 0.7},
        {"a": 4.0, "e": 0.0, "inc": 0.0, "Omega": 0.0, "omega": 0.0, "M": 1.0},
        {"a": 9.0, "e": 0.2, "inc": 2.5, "Omega": 4.0, "omega": 5.0, "M": 6.0},
    ]
    other = rebound.Simulation()
    other.add(m=1.0)
    for elements in given:
        other.add(m=0.0, primary=other.particles[0], **elements)
    x, v = (np.array([[getattr(body, name) for name in names] for body in other.particles]) for names in (
        ("x", "y", "z"), ("vx", "vy", "vz")))  # fmt: skip
    sol = kd.solve(kd.systems.nbody([1.0, 0.0, 0.0, 0.0], x, v), (0.0, 0.1), step=0.1)
    found = analysis.orbital_elements(sol)
    assert found.a[0] == pytest.approx([one["a"] for one in given], rel=1e-12)
    assert found.e[0] == pytest.approx([one["e"] for one in given], abs=1e-12)
    assert found.i[0] == pytest.approx([one["inc"] for one in given], abs=1e-12)
    for k, one in enumerate(given):
        assert apart(found.Omega[0, k], one["Omega"]) < 1e-12
    assert found.M[0, 0] == pytest.approx(0.7, rel=1e-12)
    for k in (0, 2):
        assert apart(found.omega[0, k], given[k]["omega"]) < 1e-12
    assert apart(found.M[0, 2], 6.0) < 1e-12
    assert apart(found.omega[0, 1] + found.M[0, 1], 1.0) < 1e-12


def test_a_solution_from_a_file_knows_its_masses(planets, tmp_path):
    loaded = kd.load(planets[1].save(tmp_path / "planets.npz"))
    assert np.array_equal(analysis.orbital_elements(loaded).M, analysis.orbital_elements(planets[1]).M)


def test_what_has_none_is_refused(planets):
    with pytest.raises(ArgumentError, match="'jacobi', 'heliocentric'"):
        analysis.orbital_elements(planets[1], "barycentric")
    with pytest.raises(KickdriftError, match="has no gravitational parameters"):
        analysis.orbital_elements(kd.solve(kd.systems.pendulum(), (0.0, 1.0), step=0.1))
    alone = kd.systems.nbody([1.0], [[0.0, 0.0, 0.0]], [[0.0, 0.0, 0.0]])
    with pytest.raises(ArgumentError, match="has only one body"):
        analysis.orbital_elements(kd.solve(alone, (0.0, 1.0), step=0.1))
