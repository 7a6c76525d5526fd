"""What `kickdrift.analysis` says about methods, against formulas; and what it says about methods that lack a virtue."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

import kickdrift as kd
from kickdrift import analysis
from kickdrift.core.errors import ArgumentError, KickdriftError, MethodMismatchError
from kickdrift.methods import Kind, Letter, alternating

CATALOGUE = kd.methods.catalogue()
WORDS = [m for m in CATALOGUE.values() if m.letters == {Letter.KICK, Letter.DRIFT}]
SYMPLECTIC = [
    m.name
    for m in CATALOGUE.values()
    if m in WORDS
    or m.letters & {Letter.ADJOINT_KICK, Letter.ADJOINT_DRIFT}
    or (m.tableau is not None and m.tableau().symplectic)
]
OSCILLATOR, PENDULUM, KEPLER = (
    replace(system, native=False)
    for system in (kd.systems.harmonic_oscillator(), kd.systems.pendulum(2.5), kd.systems.kepler(0.6))
)
UNHURRIED = settings(deadline=None)  # the first example compiles
AMPLITUDE = st.floats(-10, 10).filter(lambda x: x == 0.0 or abs(x) > 1e-100)  # whose square has all its digits
names = pytest.mark.parametrize("name", ["kick-drift", "drift-kick"])


def spectral_radius(matrix):
    return np.abs(np.linalg.eigvals(matrix)).max()


def half_trace(method):
    """Half the trace of one step on x'' = -x as a polynomial of the step, by multiplying shears."""
    x, v = [Polynomial([1]), Polynomial([0])], [Polynomial([0]), Polynomial([1])]
    for letter, weight in method.word:
        shift = Polynomial([0, float(weight)])
        if letter is Letter.KICK:
            v = [vj - shift * xj for xj, vj in zip(x, v, strict=True)]
        else:
            x = [xj + shift * vj for xj, vj in zip(x, v, strict=True)]
    return (x[0] + v[1]) / 2


def first_instability(polynomial):
    """The smallest positive simple root of p^2 - 1: beyond it the eigenvalues leave the unit circle."""
    roots = np.concatenate([(polynomial - 1).roots(), (polynomial + 1).roots()])
    real = np.sort(roots[(abs(roots.imag) < 1e-9) & (roots.real > 1e-4)].real)
    return next(r for r in real if abs(polynomial(r + 1e-6)) > 1)


# The matrix of one step.


@UNHURRIED
@given(st.floats(1e-3, 10), st.floats(0, 2))
def test_matrix_of_kick_drift(h, damping):
    kick, drift = np.array([[1, 0], [-h, 1 - 2 * damping * h]]), np.array([[1, h], [0, 1]])
    assert np.allclose(analysis.one_step_matrix("kick-drift", h, damping), drift @ kick, rtol=1e-13, atol=1e-13)
    assert np.allclose(analysis.one_step_matrix("drift-kick", h, damping), kick @ drift, rtol=1e-13, atol=1e-13)


@settings(UNHURRIED, max_examples=50)
@given(st.floats(1e-3, 1e3), st.floats(0, 2))
def test_matrices_of_the_one_flow_methods(h, damping):
    rate, one = np.array([[0, 1], [-1, -2 * damping]]), np.eye(2)
    explicit = one + h * rate
    assert np.allclose(analysis.one_step_matrix("explicit-euler", h, damping), explicit, rtol=1e-13, atol=1e-13)
    implicit = np.linalg.inv(one - h * rate)
    assert np.allclose(analysis.one_step_matrix("implicit-euler", h, damping), implicit, rtol=1e-9, atol=1e-9)
    midpoint = np.linalg.solve(one - h / 2 * rate, one + h / 2 * rate)
    assert np.allclose(analysis.one_step_matrix("implicit-midpoint", h, damping), midpoint, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("method", WORDS, ids=lambda method: method.name)
def test_traces_of_words(method):
    trace = half_trace(method)
    for h in np.linspace(0.1, 3, 15):
        matrix = analysis.one_step_matrix(method, h)
        assert np.trace(matrix) / 2 == pytest.approx(trace(h), rel=1e-11, abs=1e-11)
        assert np.linalg.det(matrix) == pytest.approx(1, abs=1e-12 + 1e-13 * np.abs(matrix).max() ** 2)


@names
@UNHURRIED
@given(h=st.floats(1e-3, 1.99))
def test_frequency_of_the_semi_implicit_euler_method(name, h):
    angles = np.angle(np.linalg.eigvals(analysis.one_step_matrix(name, h)))
    assert angles.max() == pytest.approx(2 * math.asin(h / 2), rel=1e-7)
    assert abs(angles.max() - h) > h**3 / 25  # not that of the oscillator


# Stability.


@pytest.mark.parametrize("name", ["kick-drift", "drift-kick", "velocity-verlet", "position-verlet"])
def test_limit_of_the_semi_implicit_and_verlet_methods(name):
    assert analysis.stability_limit(name) == pytest.approx(2, abs=1e-11)
    assert spectral_radius(analysis.one_step_matrix(name, 1.999)) == pytest.approx(1, abs=1e-12)
    assert spectral_radius(analysis.one_step_matrix(name, 2.001)) > 1.05


@pytest.mark.parametrize("method", WORDS, ids=lambda method: method.name)
def test_limits_of_words_are_roots_of_their_traces(method):
    limit = analysis.stability_limit(method)
    assert limit == pytest.approx(first_instability(half_trace(method)), abs=1e-8)
    assert spectral_radius(analysis.one_step_matrix(method, limit - 1e-4)) <= 1 + 1e-12
    assert spectral_radius(analysis.one_step_matrix(method, limit + 1e-4)) > 1 + 1e-5


def test_limits_to_nine_digits():
    assert analysis.stability_limit("forest-ruth-4") == pytest.approx(1.573401947, abs=1e-9)
    # Three double steps to pi: a window of instability from 3.1635 to 3.1685, narrower than the probes.
    assert analysis.stability_limit("blanes-moan-srkn6b") == pytest.approx(3.163465067, abs=1e-9)
    assert spectral_radius(analysis.one_step_matrix("blanes-moan-srkn6b", 3.166)) > 1.002
    assert spectral_radius(analysis.one_step_matrix("blanes-moan-srkn6b", 3.17)) == pytest.approx(1, abs=1e-12)


def test_explicit_euler_has_no_stable_step_and_the_implicit_methods_no_unstable_one():
    assert analysis.stability_limit("explicit-euler") == 0
    assert analysis.stability_limit("implicit-euler") == math.inf
    assert analysis.stability_limit("implicit-midpoint") == math.inf


@pytest.mark.parametrize("damping", [0.1, 0.5, 1.0])
def test_limits_with_damping(damping):
    assert analysis.stability_limit("explicit-euler", damping) == pytest.approx(2 * damping, abs=1e-10)
    semi_implicit = 2 * math.sqrt(1 + damping**2) - 2 * damping
    assert analysis.stability_limit("kick-drift", damping) == pytest.approx(semi_implicit, abs=1e-10)


def test_limit_of_a_method_of_ones_own():
    # Two steps of half the size reach twice as far.
    half = replace(CATALOGUE["kick-drift"], name="two", word=alternating(Letter.KICK, [Fraction(1, 2)] * 4))
    assert analysis.stability_limit(half) == pytest.approx(4, abs=1e-6)


def test_damping_is_refused_where_the_method_has_no_place_for_it():
    with pytest.raises(MethodMismatchError, match=r"a\(t, x, v\)"):
        analysis.one_step_matrix("velocity-verlet", 0.1, damping=0.1)


@pytest.mark.parametrize(("h", "damping", "name"), [(0, 0, "h_omega"), (math.inf, 0, "h_omega"), (1, -1, "damping")])
def test_a_step_or_damping_that_cannot_be_is_refused(h, damping, name):
    with pytest.raises(ArgumentError, match=name):
        analysis.one_step_matrix("kick-drift", h, damping)


# The amplification factor.

plane = st.complex_numbers(max_magnitude=50, allow_nan=False)


@UNHURRIED
@given(plane.filter(lambda z: min(abs(1 - z), abs(2 - z)) > 1e-3))
def test_factors_are_the_formulas(z):
    assert analysis.amplification_factor("explicit-euler", z) == pytest.approx(1 + z)
    assert analysis.amplification_factor("implicit-euler", z) == pytest.approx(1 / (1 - z))
    midpoint = analysis.amplification_factor("implicit-midpoint", z)
    assert midpoint == pytest.approx((2 + z) / (2 - z))
    assert midpoint * analysis.amplification_factor("implicit-midpoint", -z) == pytest.approx(1)


@pytest.mark.parametrize("name", ["explicit-euler", "implicit-euler", "implicit-midpoint"])
@pytest.mark.parametrize("z", [-3.0, -0.5, 0.25])
def test_factors_are_what_the_engine_does(name, z):
    # x'' = z x' is y' = z y for y = x'.
    end = kd.solve(lambda v: z * v, (0, 1), 0.0, 1.0, step=1.0, method=name, compile=False)
    assert end.v[-1] == pytest.approx(analysis.amplification_factor(name, z).real, rel=1e-7)


def test_implicit_euler_is_stable_where_explicit_euler_is_not():
    z = np.array([-10.0, -2.5, 1j, -1e6])
    assert (abs(analysis.amplification_factor("implicit-euler", z)) < 1).all()
    assert (abs(analysis.amplification_factor("explicit-euler", z)) > 1).all()
    assert abs(analysis.amplification_factor("implicit-euler", 1.0)) == math.inf


@pytest.mark.parametrize("method", WORDS, ids=lambda method: method.name)
def test_kicks_and_drifts_have_no_factor(method):
    with pytest.raises(ArgumentError, match="one_step_matrix"):
        analysis.amplification_factor(method, -1.0)


# Energy.


@names
@pytest.mark.parametrize("h", [0.1, 1.9])
def test_modified_energy_is_conserved_and_the_energy_is_not(name, h):
    s = kd.solve(kd.systems.harmonic_oscillator(), (0.0, 1e5 * h), step=h, method=name, save_every=7)
    conserved = analysis.modified_energy(name, s.step, 1.0, s.x, s.v)
    assert np.ptp(conserved) < 2e-13
    assert np.ptp(s.energy) > 0.4 * h
    other = {"kick-drift": "drift-kick", "drift-kick": "kick-drift"}[name]
    assert np.ptp(analysis.modified_energy(other, s.step, 1.0, s.x, s.v)) > 0.4 * h


@names
@UNHURRIED
@given(h=st.floats(1e-3, 1.0), omega=st.floats(0.1, 1.9), x=AMPLITUDE, v=AMPLITUDE, sign=st.booleans())
def test_modified_energy_of_one_step(name, h, omega, x, v, sign):
    h = h if sign else -h
    system = replace(kd.systems.harmonic_oscillator(omega), native=False)
    end = kd.solve(system, (0.0, h), x, v, step=abs(h), method=name)
    before = analysis.modified_energy(name, h, omega, x, v)
    after = analysis.modified_energy(name, h, omega, end.x[-1], end.v[-1])
    assert after == pytest.approx(before, abs=1e-14 * (v**2 + omega**2 * x**2))


def test_modified_energy_of_another_method_is_refused():
    with pytest.raises(ArgumentError, match="'velocity-verlet' has no modified energy"):
        analysis.modified_energy("leapfrog", 0.1, 1.0, 1.0, 0.0)


def test_energy_grows_falls_or_stays():
    runs = {
        name: kd.solve(OSCILLATOR, (0.0, 100.0), step=0.05, method=name)
        for name in ("explicit-euler", "implicit-euler", "kick-drift", "velocity-verlet")
    }
    drifts = {name: analysis.energy_drift(run) for name, run in runs.items()}
    # The energy changes by the factor 1 + h^2, or its inverse, every step.
    last = analysis.energy_error(runs["explicit-euler"])[-1]
    assert last == pytest.approx((1 + 0.05**2) ** 2000 - 1, rel=1e-10)
    assert analysis.energy_error(runs["implicit-euler"])[-1] == pytest.approx(-last / (1 + last), rel=1e-10)
    assert drifts["explicit-euler"] > 0.01
    assert drifts["implicit-euler"] < -0.001
    assert abs(drifts["kick-drift"]) < 1e-4
    # v^2 + x^2 lies between the axes of the ellipse x^2 + v^2 - h x v = 1.
    assert analysis.largest_energy_error(runs["kick-drift"]) == pytest.approx(0.025, rel=0.05)
    assert analysis.largest_energy_error(runs["velocity-verlet"]) == pytest.approx(0.05**2 / 4, rel=1e-3)


def test_energy_error_is_relative_to_the_size_of_the_start():
    s = kd.solve(KEPLER, (0.0, 1.0), step=0.01)
    assert s.energy[0] == pytest.approx(-0.5)
    assert np.array_equal(analysis.energy_error(s), (s.energy - s.energy[0]) / 0.5)
    still = kd.solve(OSCILLATOR, (0.0, 1.0), x0=0.0, v0=0.0, step=0.1)
    assert analysis.largest_energy_error(still) == 0


def test_drift_of_a_straight_line_is_its_slope():
    s = kd.solve(OSCILLATOR, (0.0, 1.0), step=0.1)
    line = replace(s, invariants={"energy": -2.0 + 0.5 * s.t})
    assert analysis.energy_drift(line) == pytest.approx(0.25, rel=1e-12)


def test_a_drift_needs_two_times_and_an_energy():
    with pytest.raises(ArgumentError, match="needs at least two"):
        analysis.energy_drift(kd.solve(OSCILLATOR, (0.0, 1.0), step=0.1, t_eval=[1.0]))
    nameless = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, step=0.1, compile=False)
    with pytest.raises(KickdriftError, match="has no energy"):
        analysis.energy_error(nameless)


# Symplecticity.


@pytest.mark.parametrize("name", SYMPLECTIC)
def test_symplectic_methods_have_no_defect(name):
    for system in (PENDULUM, KEPLER):
        assert analysis.symplecticity_defect(system, name, 0.1) < 2e-12


@pytest.mark.parametrize("name", ["explicit-euler", "implicit-euler"])
def test_the_other_euler_methods_have_a_defect_of_second_order(name):
    for system in (PENDULUM, KEPLER):
        large, small = (analysis.symplecticity_defect(system, name, h) for h in (0.02, 0.01))
        assert large > 1e-4
        assert large / small == pytest.approx(4, rel=0.1)


def test_defect_of_explicit_euler_on_the_oscillator_is_the_square_of_the_step():
    assert analysis.symplecticity_defect(OSCILLATOR, "explicit-euler", 0.1) == pytest.approx(0.01, rel=1e-10)


@settings(UNHURRIED, max_examples=30)
@given(st.floats(0.01, 0.5), st.floats(0.1, 3), st.floats(-2, 2), st.booleans())
def test_no_defect_at_any_place_and_step(h, x, v, forwards):
    for name in ("kick-drift", "velocity-verlet"):
        assert analysis.symplecticity_defect(PENDULUM, name, h if forwards else -h, at=(x, v)) < 1e-10


def test_friction_is_a_defect():
    def damped(x, v):
        return -x - 0.2 * v

    assert analysis.symplecticity_defect(damped, "kick-drift", 0.1, at=(1.0, 0.0)) == pytest.approx(0.02, rel=1e-9)


def test_a_force_that_depends_on_time_leaves_no_defect():
    def forced(t, x):
        return -x * math.cos(t)

    assert analysis.symplecticity_defect(forced, "velocity-verlet", 0.1, at=(1.0, 0.0), t=2.0) < 1e-12


def test_bodies_of_different_masses_need_their_masses():
    masses = np.array([1.0, 2.0, 3.0])
    x, v = np.diag([1.0, 1.5, 2.0]), np.eye(3)[::-1] / 2
    bodies = kd.systems.nbody(masses=masses, x0=x, v0=v)
    assert analysis.symplecticity_defect(bodies, "kick-drift", 0.1, masses=masses[:, None]) < 1e-11
    assert analysis.symplecticity_defect(bodies, "kick-drift", 0.1) > 1e-4


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({}, "at is missing"),
        ({"at": (1.0, 0.0), "increment": 0.0}, "increment=0.0"),
        ({"at": ([1.0, 1.0], [0.0, 0.0]), "masses": [1.0, 2.0, 3.0]}, "masses of shape"),
    ],
)
def test_what_the_defect_cannot_use_is_refused(options, reason):
    with pytest.raises(ArgumentError, match=reason):
        analysis.symplecticity_defect(lambda x: -x, "kick-drift", 0.1, **options)


def test_a_step_that_fails_says_so():
    with pytest.raises(KickdriftError, match=r"step=0\.1 of 'kick-drift' failed: The state became infinite"):
        analysis.symplecticity_defect(lambda x: math.inf * x, "kick-drift", 0.1, at=(1.0, 0.0))


def test_only_kinds_for_any_acceleration_take_damping():
    for method in CATALOGUE.values():
        if method.kind.includes(Kind.VELOCITY_DEPENDENT):
            assert analysis.one_step_matrix(method, 0.1, 0.1).shape == (2, 2)


def test_the_masses_of_a_newtonian_problem_are_those_of_its_two_form():
    problem = kd.Newtonian(lambda x: np.array([x[1] - 2 * x[0], x[0] - x[1]]), mass=[1.0, 2.0])
    place = {"at": ([1.0, 2.0], [0.0, 1.0])}
    assert analysis.symplecticity_defect(problem, "velocity-verlet", 0.1, **place) < 1e-12
    assert analysis.symplecticity_defect(problem, "velocity-verlet", 0.1, masses=1.0, **place) > 1e-3


@pytest.mark.parametrize(
    "problem",
    [
        kd.ChargedParticle(1.0, lambda x: x),
        kd.Constrained(lambda x: -x, lambda x: x @ x - 1),
        kd.Langevin(lambda x: -x, friction=1.0, temperature=1.0),
    ],
)
def test_problems_without_such_a_two_form_are_refused(problem):
    with pytest.raises(ArgumentError, match="has no symplecticity defect here"):
        analysis.symplecticity_defect(problem, "boris", 0.1, at=([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]))


def test_noise_has_no_reference():
    bath = kd.Langevin(lambda x: -x, friction=1.0, temperature=0.2)
    with pytest.raises(ArgumentError, match="a stochastic path has none"):
        analysis.observed_order(bath, "baoab", (0, 1), (0.1, 0.05), 1.0, 0.0, compile=False)


@pytest.mark.parametrize(
    ("call", "why"),
    [
        (lambda: kd.methods.tao(2, "a"), "binding='a' must be a number"),
        (lambda: kd.methods.tao(2, None), "binding=None must be a number"),
        (lambda: kd.analysis.one_step_matrix("leapfrog", "a"), "h_omega='a' must be a number"),
        (lambda: kd.analysis.one_step_matrix("leapfrog", 0.1, damping=[1]), r"damping=\[1\] must be a number"),
        (
            lambda: kd.analysis.observed_order(kd.systems.kepler(), "leapfrog", t_span=(0.0, 1.0), steps=0.1),
            "steps=0.1 must be a list of at least two steps",
        ),
        (
            lambda: kd.analysis.work_precision(kd.systems.kepler(), (0.0, 1.0), methods=1.0, steps=[0.1]),
            "methods=1.0 must be a list of at least one method",
        ),
        (lambda: kd.analysis.energy_error(1.0), "solution=1.0 is not a solution"),
        (lambda: kd.analysis.phase_error("run"), "solution='run' is not a solution"),
        (lambda: kd.analysis.mergers(None), "solution=None is not a solution"),
    ],
)
def test_what_is_no_number_list_or_solution_is_refused_in_a_sentence(call, why):
    with pytest.raises(kd.KickdriftError, match=why):
        call()
