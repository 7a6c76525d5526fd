"""The Kepler flow against solutions by orbital elements in many digits, and what it conserves."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import kickdrift as kd
from kickdrift.core.compilation import specialise
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.flows import kepler
from kickdrift.methods import Kind, Letter, palindrome

EPSILON = 2.0**-52
KICK_KEPLER_KICK = "laskar-robutel-sbab1"  # of which a step without a remainder is one Kepler flow


def on_orbit(e, anomaly, mu=1.0):
    """Where a body on an orbit of pericentre distance 1 is at a true anomaly."""
    p = 1 + e
    r = p / (1 + e * math.cos(anomaly))
    x = r * np.array([math.cos(anomaly), math.sin(anomaly)])
    v = math.sqrt(mu / p) * np.array([-math.sin(anomaly), e + math.cos(anomaly)])
    return x, v


def by_elements(mu, h, x, v):
    """Advance by semi-major axis, eccentricity and Kepler's equation for the anomaly, in the digits of mpmath."""
    sqrt, m = mpmath.sqrt, mpmath.mpf
    x, v, mu, h = [m(a) for a in x], [m(a) for a in v], m(mu), m(h)
    r, v2, eta = sqrt(x[0] ** 2 + x[1] ** 2), v[0] ** 2 + v[1] ** 2, x[0] * v[0] + x[1] * v[1]
    a, turn = 1 / (2 / r - v2 / mu), mpmath.sign(x[0] * v[1] - x[1] * v[0])
    vector = [((v2 - mu / r) * x[i] - eta * v[i]) / mu for i in range(2)]  # towards the pericentre, of length e
    e = sqrt(vector[0] ** 2 + vector[1] ** 2)
    main = [vector[0] / e, vector[1] / e] if e > mpmath.mpf(10) ** -30 else [x[0] / r, x[1] / r]
    side = [-turn * main[1], turn * main[0]]
    xi, zeta = x[0] * main[0] + x[1] * main[1], x[0] * side[0] + x[1] * side[1]
    n = sqrt(mu / abs(a) ** 3)
    if a > 0:
        b = a * sqrt(1 - e**2)
        start = mpmath.atan2(zeta / b, xi / a + e)
        mean = start - e * mpmath.sin(start) + n * h
        turns = mpmath.nint(mean / (2 * mpmath.pi))
        mean -= 2 * mpmath.pi * turns
        far = mpmath.pi * (1 if mean > 0 else -1)
        anomaly = newton(lambda u: u - e * mpmath.sin(u) - mean, lambda u: 1 - e * mpmath.cos(u), far)
        c, s = mpmath.cos(anomaly), mpmath.sin(anomaly)
        rate = n / (1 - e * c)
        along, across = (a * (c - e), -a * rate * s), (b * s, b * rate * c)
    else:
        b = a * sqrt(e**2 - 1)
        start = mpmath.asinh(-zeta / b)
        mean = e * mpmath.sinh(start) - start + n * h
        far = min(mpmath.cbrt(6 * abs(mean)), 2 + mpmath.log(1 + abs(mean))) * (1 if mean > 0 else -1)
        anomaly = newton(lambda u: e * mpmath.sinh(u) - u - mean, lambda u: e * mpmath.cosh(u) - 1, far)
        c, s = mpmath.cosh(anomaly), mpmath.sinh(anomaly)
        rate = n / (e * c - 1)
        along, across = (a * (c - e), a * rate * s), (-b * s, -b * rate * c)
    return [along[k] * main[i] + across[k] * side[i] for k in range(2) for i in range(2)]


def newton(function, derivative, anomaly):
    """Find a root from a side from which Newton's method cannot leap over it."""
    for _ in range(1000):
        change = function(anomaly) / derivative(anomaly)
        anomaly -= change
        if abs(change) < mpmath.mpf(10) ** -45 * (1 + abs(anomaly)):
            return anomaly
    raise AssertionError("no root")


def flow(mu, h, x, v):
    """One step of the flow, compiled, without compensation."""
    f, g, df, dg, trouble = kepler.gauss_functions(mu, h, math.hypot(*x), float(x @ v), float(v @ v))
    assert trouble == 0
    return [*(x + (f * x + g * v)), *(v + (df * x + dg * v))]


def cancellation(mu, h, x, v):
    """How much larger the terms of r are than r: a fast hyperbola past its pericentre loses digits by that."""
    r0, eta, v2 = math.hypot(*x), float(x @ v), float(v @ v)
    f, g, df, _, _ = kepler.gauss_functions(mu, h, r0, eta, v2)
    r = math.hypot(*(x + (f * x + g * v)))
    g1, g2 = df * r0 * r / mu, f * r0 / mu
    return (r0 + abs(eta * g1) + abs((v2 * r0 - mu) * g2)) / r


def relative_error(mu, h, x, v):
    """Error of the flow in units of what a relative change of the start by one rounding, in every number, makes."""
    with mpmath.workdps(50):
        exact = by_elements(mu, h, x, v)
        bounds = [EPSILON * abs(number) for number in exact]
        tiny = mpmath.mpf(10) ** -25
        for k in range(4):
            start = [mpmath.mpf(number) for number in (*x, *v)]
            start[k] *= 1 + tiny
            moved = by_elements(mu, h, start[:2], start[2:])
            bounds = [bound + EPSILON / tiny * abs(a - b) for bound, a, b in zip(bounds, moved, exact, strict=True)]
        got = flow(mu, h, x, v)
        # Along one axis the change may vanish by chance: positions and velocities are judged by their larger ones.
        scales = [max(bounds[:2])] * 2 + [max(bounds[2:])] * 2
        return float(max(abs(a - b) / scale for a, b, scale in zip(got, exact, scales, strict=True)))


ECCENTRICITIES = [0.0, 1e-8, 0.3, 0.9, 0.999, 0.99999, 1 - 1e-9, 1 + 1e-9, 1.01, 3.0, 100.0]


@pytest.mark.parametrize("e", ECCENTRICITIES)
def test_the_flow_is_exact_to_rounding(e):
    for anomaly in (0.0, 0.4, -1.4, 3.0 if e < 1 else 1.0):
        x, v = on_orbit(e, anomaly)
        for h in (1e-7, 0.01, 0.3, 2.0, -0.5, -30.0, 1e3):
            assert relative_error(1.0, h, x, v) < (10 if e < 2 else 10 + cancellation(1.0, h, x, v))


@settings(max_examples=60, deadline=None)
@given(
    e=st.one_of(st.floats(0, 0.99999), st.floats(1.00001, 50)),
    anomaly=st.floats(-3.1, 3.1),
    h=st.floats(-1e3, 1e3),
    mu=st.floats(1e-3, 1e3),
)
def test_the_flow_is_exact_to_rounding_on_any_orbit(e, anomaly, h, mu):
    assume(1 + e * math.cos(anomaly) > 0.02)
    x, v = on_orbit(e, anomaly, mu)
    assert relative_error(mu, h, x, v) < (20 if e < 1 else 20 + cancellation(mu, h, x, v))


def test_a_parabola_by_barkers_equation():
    # From the pericentre at distance 1 with mu = 2: t = s + s^3 / 3, x = 1 - s^2, y = 2 s, where s = tan(anomaly / 2).
    x, v = np.array([1.0, 0.0]), np.array([0.0, 2.0])
    for s in (-3.0, 0.01, 0.5, 7.0, 1e4):
        got = flow(2.0, s + s**3 / 3, x, v)
        wanted = np.array([1 - s * s, 2 * s, -2 * s / (1 + s * s), 2 / (1 + s * s)])
        assert np.abs(got - wanted).max() < 1e-14 * max(1.0, abs(s) ** 2)


@settings(max_examples=200, deadline=None)
@given(e=st.floats(0, 20), anomaly=st.floats(-3.1, 3.1), h=st.floats(-1e4, 1e4))
def test_the_flow_keeps_areas_and_energy(e, anomaly, h):
    assume(1 + e * math.cos(anomaly) > 0.02)
    x, v = on_orbit(e, anomaly)
    f, g, df, dg, trouble = kepler.gauss_functions(1.0, h, math.hypot(*x), float(x @ v), float(v @ v))
    assert trouble == 0
    terms = abs(f) + abs(dg) + abs(f * dg) + abs(g * df)
    tolerance = 1e-14 + EPSILON * cancellation(1.0, h, x, v)
    assert abs(f + dg + f * dg - g * df) <= tolerance * terms + 1e-300  # the angular momentum changes by this
    after = flow(1.0, h, x, v)
    r, speed = math.hypot(*after[:2]), math.hypot(*after[2:])
    # What the roundings of x and v by themselves do to the energy.
    scale = speed * (abs(df) * math.hypot(*x) + abs(dg) * math.hypot(*v) + math.hypot(*v))
    scale += (abs(f) * math.hypot(*x) + abs(g) * math.hypot(*v) + math.hypot(*x)) / r**2
    energy = 0.5 * v @ v - 1 / math.hypot(*x)
    assert abs(0.5 * speed**2 - 1 / r - energy) <= tolerance * (scale + 1 / r + speed**2)


def test_python_bodies_give_the_same_bits():
    names = ("stiefel_functions", "first_guess", "next_guess")
    inner = {name: getattr(kepler, name).py_func for name in names}
    body = specialise(kepler.gauss_functions.py_func, "gauss_functions", **inner)
    rng = np.random.default_rng(5)
    for e in ECCENTRICITIES:
        for h in (1e-3, 0.2, 3.0, -40.0, 1e4):
            x, v = on_orbit(e, rng.uniform(-1.5, 1.5))
            arguments = (1.0, h, math.hypot(*x), float(x @ v), float(v @ v))
            assert body(*arguments) == kepler.gauss_functions(*arguments)


def test_what_is_not_an_orbit_gives_nan():
    for r0, v2 in ((0.0, 1.0), (math.nan, 1.0), (1.0, math.inf), (1.0, math.nan)):
        assert all(math.isnan(number) for number in kepler.gauss_functions(1.0, 0.1, r0, 0.0, v2)[:4])
        assert all(math.isnan(number) for number in kepler.gauss_functions.py_func(1.0, 0.1, r0, 0.0, v2)[:4])


def fall(step):
    """Run a body that falls towards a star from rest: it gets there after pi / sqrt(8)."""
    system = replace(kd.systems.kepler(), v0=np.zeros(2), x0=np.array([1.0, 0.0]), exact=None, native=False)
    return kd.solve(system, (0.0, 3 * step), step=step, method=KICK_KEPLER_KICK, progress=False)


def test_a_fall_is_mirrored_at_the_centre_unless_a_step_ends_there():
    collision = math.pi / math.sqrt(8)
    beyond = fall(1.2 * collision)
    assert beyond.success
    narrow = flow(1.0, 1.2 * collision, np.array([1.0, 0.0]), np.array([0.0, 1e-7]))
    assert beyond.x[1] == pytest.approx(narrow[:2], abs=1e-6)
    assert np.abs(beyond.energy + 1).max() < 1e-13
    there = fall(collision)
    assert there.status is Outcome.NOT_CONVERGED
    assert there.x.tolist() == [[1.0, 0.0]]
    assert "smaller step" in there.message


@pytest.mark.parametrize("e", [0.0, 0.6, 0.99])
@pytest.mark.parametrize("native", [True, False])
def test_the_kepler_problem_is_solved_exactly_whatever_the_step(e, native):
    system = kd.systems.kepler(e)
    assert system.kind is Kind.NEARLY_KEPLERIAN
    for step in (0.5, 100.0):
        s = kd.solve(replace(system, native=native), (0.0, 200.0), step=step, method="wisdom-holman", progress=False)
        x, v = system.exact(s.t)
        tolerance = 1e-11 / (1 - e) ** 2
        assert np.abs(s.x - x).max() < tolerance
        assert np.abs(s.v - v).max() < 10 * tolerance


def energy_error_of_many_steps(step, compensated):
    s = kd.solve(
        kd.systems.kepler(0.05),
        (0.0, 300_000 * step),
        step=step,
        method=KICK_KEPLER_KICK,
        save_every=500,
        compensated=compensated,
        progress=False,
    )
    return np.abs(s.energy / s.energy[0] - 1).max()


def test_rounding_does_not_drift():
    # A random walk of 300,000 roundings of what a step adds, 0.05 or 0.5 of the whole, makes 3e-15 or 3e-14.
    assert energy_error_of_many_steps(0.05, True) < 1e-14 < energy_error_of_many_steps(0.05, False)
    assert energy_error_of_many_steps(0.5, True) < 1e-13


def test_a_word_of_kepler_flows_is_done_in_one_where_steps_meet():
    # Without kicks the parts add up to the whole, but for rounding.
    system = replace(kd.systems.kepler(0.3), native=False)
    method = replace(
        kd.methods.get("wisdom-holman"), word=palindrome(Letter.KEPLER, ["0.2", "0.5"], Letter.KICK), name="mine"
    )
    one, other = (
        kd.solve(system, (0.0, 6.0), step=0.5, method=each, progress=False) for each in (method, KICK_KEPLER_KICK)
    )
    assert np.abs(one.x - other.x).max() < 1e-14


@pytest.mark.parametrize("splitting", ["jacobi", "democratic-heliocentric"])
@pytest.mark.parametrize(
    ("mass", "distance"), [(1e-320, 1e308), (1e-320, 1.0), (1.0, 1e308), (1.0, 1e-308), (1e308, 1.0)]
)
def test_orbits_beyond_all_numbers_end(mass, distance, splitting):
    x0, v0 = [[0, 0, 0], [distance, 0, 0]], [[0, 0, 0], [0, 1e-3, 0]]
    system = kd.systems.planetary([mass, 0.0], x0, v0, splitting=splitting)
    run = kd.solve(system, (0.0, 10.0), step=1.0, method="wisdom-holman", progress=False)
    assert run.status in (kd.Outcome.COMPLETED, kd.Outcome.NOT_FINITE, kd.Outcome.NOT_CONVERGED)
    assert np.isfinite(run.x).all()
