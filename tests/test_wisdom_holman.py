"""Nearly-Keplerian motion: splittings, methods and correctors, against independent solutions and conservation laws."""

from dataclasses import replace
from fractions import Fraction
from math import factorial

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.compilation import specialise
from kickdrift.core.errors import ArgumentError, MethodMismatchError, UnknownNameError
from kickdrift.engine.pericentres import fastest_pericentre
from kickdrift.methods import Kind, Letter, Method, palindrome, word
from kickdrift.systems import jacobi

SPLITTINGS = ["jacobi", "democratic-heliocentric"]
METHODS = {name: m for name, m in kd.methods.catalogue().items() if Letter.KEPLER in m.letters}
K, KEPLER = Letter.KICK, Letter.KEPLER
JUPITER = 4332.59  # days


def two_planets(mass, splitting="jacobi", native=False):
    """A star and two planets of this mass and half of it, in an inertial frame in which they fly away."""
    x = np.array([[0.1, 0.2, 0.0], [1.1, 0.2, 0.0], [0.1, -1.6, 0.1]])
    v = np.array([[0.0, 0.01, 0.02], [0.0, 1.06, 0.02], [0.78, 0.01, 0.02]])
    return replace(kd.systems.planetary([1.0, mass, mass / 2], x, v, splitting=splitting), native=native)


def run(system, method, step, end=2.0, **options):
    options = {"save_every": 2**40, "progress": False} | options
    return kd.solve(system, (0.0, end), step=step, method=method, **options)


def error(system, method, step, reference, end=2.0):
    got = run(system, method, step, end)
    assert got.success
    return max(np.abs(got.x[-1] - reference.x[-1]).max(), np.abs(got.v[-1] - reference.v[-1]).max())


# Splittings


@pytest.mark.parametrize("splitting", SPLITTINGS)
@pytest.mark.parametrize("bodies", [2, 6, 40])
def test_the_remainder_is_the_acceleration_less_the_kepler_problems(splitting, bodies):
    rng = np.random.default_rng(bodies)
    masses = np.concatenate([[1.0], 1e-3 * rng.uniform(size=bodies - 1)])
    masses[-1] = 0.0 if bodies > 2 else masses[-1]
    system = kd.systems.planetary(
        masses, rng.normal(size=(bodies, 3)), rng.normal(size=(bodies, 3)), G=2.0, splitting=splitting
    )
    a, remainder = np.zeros((2, 3 * bodies))
    system.acceleration(0.0, system.x0.ravel(), system.v0.ravel(), system.params, a)
    x, rates = system.frame.enter(system.x0, a.reshape(-1, 3))
    system.parts["remainder"](0.0, x.ravel(), x.ravel(), system.params, remainder)
    mu = 2.0 * (np.cumsum(masses) if splitting == "jacobi" else np.full(bodies, masses[0]))[1:, None]
    r = np.linalg.norm(x[1:], axis=1, keepdims=True)
    wanted = rates[1:] + mu * x[1:] / r**3
    assert np.abs(remainder.reshape(-1, 3)[1:] - wanted).max() < 1e-13 * np.abs(mu / r**2).max()
    assert np.array_equal(remainder[:3], np.zeros(3))


@pytest.mark.parametrize("splitting", SPLITTINGS)
def test_the_frame_is_linear_canonical_and_comes_back(splitting):
    system = kd.systems.outer_solar_system(splitting)
    m = system.params[2:8]
    x, v = system.frame.enter(system.x0, system.v0)
    back = system.frame.leave(np.stack([x, 2 * x]), np.stack([v, 2 * v]))
    assert np.allclose(back[0], np.stack([system.x0, 2 * system.x0]), rtol=0, atol=1e-14)
    assert np.allclose(back[1], np.stack([system.v0, 2 * system.v0]), rtol=0, atol=1e-17)
    assert np.allclose(x[0], m @ system.x0 / m.sum(), rtol=0, atol=1e-16)
    assert np.allclose(v[0], m @ system.v0 / m.sum(), rtol=0, atol=1e-18)
    # The kinetic energy is a sum of squares, but for the velocity of body 0 in heliocentric coordinates.
    reduced = m * np.concatenate([[0.0], np.cumsum(m)[:-1]]) / np.cumsum(m) if splitting == "jacobi" else m.copy()
    reduced[0] = m.sum()
    recoil = 0.0 if splitting == "jacobi" else ((m[1:] @ v[1:]) ** 2).sum() / m[0]
    assert (reduced @ v**2).sum() + recoil == pytest.approx((m @ system.v0**2).sum(), rel=1e-14)


def test_the_python_bodies_of_the_jacobi_remainder_give_the_same_bits():
    system = kd.systems.outer_solar_system()
    x, _ = system.frame.enter(system.x0, system.v0)
    inner = {name: getattr(jacobi, name).py_func for name in ("weights", "mus", "planets", "inverse_cube")}
    position, out, compiled = np.zeros((3, x.size))
    specialise(jacobi.locate.py_func, "locate", **inner)(x.ravel(), system.params, position)
    specialise(jacobi.combine.py_func, "combine", **inner)(x.ravel(), system.params, position, True, out)
    system.parts["remainder"](0.0, x.ravel(), x.ravel(), system.params, compiled)
    assert np.array_equal(out, compiled)


@pytest.mark.parametrize("splitting", SPLITTINGS)
def test_both_splittings_go_where_kicks_and_drifts_go(splitting):
    system = two_planets(0.01, splitting)
    nbody = replace(kd.systems.nbody(system.params[2:5], system.x0, system.v0), native=False)
    reference = run(nbody, "kahan-li-8", 0.02)
    assert error(system, "blanes-aba-1064", 0.02, reference) < 1e-13
    assert error(system, "wisdom-holman", 0.02, reference) > 1e-8


@pytest.mark.parametrize("splitting", SPLITTINGS)
def test_other_methods_run_as_on_nbody(splitting):
    system = two_planets(0.01, splitting)
    nbody = replace(kd.systems.nbody(system.params[2:5], system.x0, system.v0), native=False)
    one, other = (run(each, "leapfrog", 0.1, save_every=1) for each in (system, nbody))
    assert np.array_equal(one.x, other.x)
    assert np.array_equal(one.energy, other.energy)


@pytest.mark.parametrize(
    ("splitting", "compensated"), [("jacobi", True), ("democratic-heliocentric", True), ("jacobi", False)]
)
def test_compiled_and_interpreted_runs_have_the_same_bits(splitting, compensated):
    system = kd.systems.outer_solar_system(splitting)
    for method in ("wisdom-holman-corrected-5", "laskar-robutel-sbab2"):
        one, other = (
            run(replace(system, native=native), method, 200.0, 4000.0, compensated=compensated, save_every=3)
            for native in (True, False)
        )
        assert np.array_equal(one.x, other.x)
        assert np.array_equal(one.v, other.v)


# Methods


def first_order_terms(method, terms):
    """Coefficients of X^k / k! in what a step adds to the exact flow, to first order in the kicks.

    A kick of weight w after a time tau of Kepler flows is w exp(tau X) B.
    """
    k = range(terms)

    def moments(letters):
        time, sums = Fraction(0), [Fraction(0) for _ in k]
        for letter, weight in letters:
            if letter is KEPLER:
                time += weight
            else:
                sums = [total + weight * time**j for j, total in enumerate(sums)]
        return sums

    step, corrector = moments(method.word), moments(method.corrector)
    # Done before the step, the corrector is C(X) B; undone after it, -exp(X) C(X) B.
    undone = [
        sum(Fraction(factorial(j), factorial(i) * factorial(j - i)) * corrector[i] for i in range(j + 1)) for j in k
    ]
    return [step[j] + corrector[j] - undone[j] - Fraction(1, j + 1) for j in k]


@pytest.mark.parametrize("method", METHODS.values(), ids=lambda m: m.name)
def test_terms_of_first_order_in_the_kicks_vanish_as_said(method):
    order = method.generalised_order[0]
    terms = first_order_terms(method, order + 1)
    assert max(abs(term) for term in terms[:order]) < 1e-35
    assert abs(terms[order]) > 1e-9
    assert method.order == min(method.generalised_order)


def test_correctors_are_those_of_wisdom_holman_and_touma():
    # Twice the numbers of the authors, who do each pair of kicks on both sides at half the weight. In units of
    # h / (48 sqrt(7/40)), where they are rational: the first of order 3, both of 5, the third of 7.
    beta = 1 / (48 * (7 / 40) ** 0.5)
    kicks = {
        order: [float(weight) / beta for letter, weight in METHODS[f"wisdom-holman-corrected-{order}"].corrector[3::5]]
        for order in (3, 5, 7)
    }
    assert kicks[3] == pytest.approx([1], rel=1e-15)
    assert kicks[5] == pytest.approx([5 / 3, -1 / 3], rel=1e-14)
    assert kicks[7][2] == pytest.approx(12361 / 123480, rel=1e-14)


STEPS = {2: (0.1, 0.05), 4: (0.2, 0.1)}


@pytest.mark.parametrize(
    ("name", "splitting"),
    # In Jacobi coordinates the errors of order 4 are those of the reference.
    [
        (m.name, splitting)
        for m in METHODS.values()
        for splitting in SPLITTINGS
        if m.order == 2 or splitting != "jacobi"
    ],
)
def test_every_method_has_its_order_with_heavy_planets(name, splitting):
    method = METHODS[name]
    measured = kd.analysis.observed_order(two_planets(0.3, splitting), method, (0.0, 2.0), STEPS[method.order])
    assert measured.order == pytest.approx(method.order, abs=0.1)


@pytest.mark.parametrize(
    "name",
    [
        "wisdom-holman",
        "wisdom-holman-corrected-3",
        "wisdom-holman-corrected-5",
        "laskar-robutel-saba2",
        "laskar-robutel-sbab1",
        "laskar-robutel-sbab2",
    ],
)
def test_with_light_planets_the_first_of_the_generalised_orders_shows(name):
    method, system = METHODS[name], two_planets(1e-6)
    reference = run(system, "blanes-aba-1064", 0.05, 8.0)
    one, other = (error(system, method, step, reference, 8.0) for step in (0.5, 0.25))
    assert np.log2(one / other) == pytest.approx(method.generalised_order[0], abs=0.1)


def test_errors_are_proportional_to_the_mass_of_the_planets():
    errors = {}
    for method in ("wisdom-holman", "velocity-verlet"):
        for mass in (1e-4, 1e-5):
            system = two_planets(mass)
            errors[method, mass] = error(system, method, 0.1, run(system, "blanes-aba-1064", 0.05))
    assert errors["wisdom-holman", 1e-4] / errors["wisdom-holman", 1e-5] == pytest.approx(10, rel=0.01)
    assert errors["velocity-verlet", 1e-4] / errors["velocity-verlet", 1e-5] == pytest.approx(1, rel=0.01)


def forced_kepler():
    """A planet that something else pulls about: where the Kepler flow of a step begins is not the time of its kick."""

    def pull(t, x, v, params, out):
        out[0], out[1] = np.cos(3 * t), np.sin(2 * t) * x[0] * x[1] ** 2

    def total(t, x, v, params, out):
        pull(t, x, v, params, out)
        out -= x / np.hypot(*x) ** 3

    return replace(kd.systems.kepler(0.3), acceleration=total, parts={"remainder": pull}, exact=None, native=False)


@pytest.mark.parametrize("name", ["wisdom-holman", "laskar-robutel-saba3", "laskar-robutel-sbab1", "blanes-aba-864"])
def test_forced_motion_keeps_the_order(name):
    measured = kd.analysis.observed_order(forced_kepler(), name, (0.0, 2.0), (0.1, 0.05))
    assert measured.order == pytest.approx(METHODS[name].order, abs=0.1)


def lame(system, splitting):
    """The same system, a part of what is left forgotten: the pull on the inner planet, or the recoil of the star."""

    def remainder(t, x, v, params, out):
        system.parts["remainder"](t, x, v, params, out)
        out[3:6] = 0.0

    parts = {"remainder": remainder} if splitting == "jacobi" else {"remainder": system.parts["remainder"]}
    return replace(system, parts=parts)


@pytest.mark.parametrize("splitting", SPLITTINGS)
def test_a_splitting_that_forgets_a_term_does_not_converge(splitting):
    system = two_planets(0.01, splitting)
    reference = run(system, "blanes-aba-1064", 0.05)
    assert error(system, "blanes-aba-1064", 0.1, reference) < 1e-11
    one, other = (error(lame(system, splitting), "blanes-aba-1064", step, reference) for step in (0.1, 0.05))
    assert one == pytest.approx(other, rel=1e-3)
    assert one > 1e-3


# Energy


def largest_energy_error(method, step, periods=100, **options):
    system = kd.systems.outer_solar_system(**options)
    end = periods * JUPITER
    energy = kd.solve(system, (0.0, end), step=step * JUPITER, method=method, progress=False).energy
    assert energy[0] == pytest.approx(-3.215453183208163e-8, rel=1e-14)
    return np.abs(energy / energy[0] - 1).max()


def test_energy_of_the_outer_solar_system_at_a_thousandth_of_jupiters_period():
    assert largest_energy_error("wisdom-holman", 1e-3, splitting="democratic-heliocentric") < 1e-9
    assert largest_energy_error("wisdom-holman-corrected-3", 1e-3) < 2e-12
    assert largest_energy_error("wisdom-holman", 1e-3) == pytest.approx(1.01e-9, rel=0.01)
    assert largest_energy_error("laskar-robutel-sbab1", 1e-3) > 1.9e-9
    assert largest_energy_error("position-verlet", 1e-3) > 1e-7


def test_correctors_remove_what_is_linear_in_the_masses():
    plain = largest_energy_error("wisdom-holman", 0.02)
    assert largest_energy_error("wisdom-holman-corrected-5", 0.02) < plain / 500
    method = METHODS["wisdom-holman-corrected-5"]
    other_way = tuple((letter, -weight if letter is K else weight) for letter, weight in method.corrector)
    assert largest_energy_error(replace(method, corrector=other_way), 0.02) == pytest.approx(2 * plain, rel=0.1)


def test_high_generalised_order_reaches_rounding_at_twenty_steps_a_period():
    assert largest_energy_error("blanes-aba-1064", 0.05) < 5e-14
    assert largest_energy_error("blanes-aba-864", 0.05) > 5e-13


# Rows


def test_rows_do_not_depend_on_which_are_kept():
    system = two_planets(0.01)
    for method in ("wisdom-holman", "wisdom-holman-corrected-3", "laskar-robutel-sbab2"):
        every = run(system, method, 0.1, save_every=1)
        third = run(system, method, 0.1, save_every=3)
        some = run(system, method, 0.1, t_eval=[0.5, 1.5], save_every=None)
        assert np.array_equal(third.x, every.x[[0, 3, 6, 9, 12, 15, 18, 20]])
        assert np.array_equal(some.v, every.v[[5, 15]])
        assert np.array_equal(every.x[0], system.x0)
        assert np.array_equal(every.v[0], system.v0)
    # Where the kicks depend on time, the time of the row is in what is undone.
    method = METHODS["wisdom-holman-corrected-3"]
    every, some = (run(forced_kepler(), method, 0.1, save_every=None, t_eval=t) for t in (None, [0.5, 1.5]))
    assert np.array_equal(some.x, every.x[[5, 15]])


def test_a_corrector_may_begin_and_end_with_a_kick():
    kicks = word((K, "1/4"), (KEPLER, "1/3"), (K, "-1/2"), (KEPLER, "-1/3"), (K, "1/4"))
    nothing = word((KEPLER, 0))
    one, other = (
        run(two_planets(0.1), replace(METHODS["laskar-robutel-sbab1"], corrector=corrector), 0.1)
        for corrector in (kicks, nothing + kicks + nothing)
    )
    assert np.abs(one.x - other.x).max() < 1e-15
    assert np.abs(one.x - run(two_planets(0.1), "laskar-robutel-sbab1", 0.1).x).max() > 1e-6


def test_a_step_back_undoes_a_step():
    system = two_planets(0.1)
    for method in ("wisdom-holman", "laskar-robutel-sbab1", "blanes-aba-1064"):
        there = run(system, method, 0.25)
        back = kd.solve(
            system, (2.0, 0.0), there.x[-1], there.v[-1], step=0.25, method=method, save_every=100, progress=False
        )
        assert np.abs(back.x[-1] - system.x0).max() < 1e-14
        assert np.abs(back.v[-1] - system.v0).max() < 1e-14


def test_evaluations_are_one_a_step_and_those_of_the_corrector():
    system = two_planets(0.1)
    assert run(system, "wisdom-holman", 0.1).n_force_evaluations == 20
    assert run(system, "laskar-robutel-sbab1", 0.1).n_force_evaluations == 21
    assert run(system, "laskar-robutel-sbab2", 0.1).n_force_evaluations == 41
    # Four kicks on the way in, and four on the way out of each of two rows.
    assert run(system, "wisdom-holman-corrected-5", 0.1).n_force_evaluations == 20 + 4 + 2 * 4


@pytest.mark.parametrize("splitting", SPLITTINGS)
@pytest.mark.parametrize("method", ["wisdom-holman-corrected-3", "blanes-aba-864"])
def test_steps_are_symplectic(method, splitting):
    system, masses = two_planets(0.1, splitting), np.array([[1.0], [0.1], [0.05]])
    assert kd.analysis.symplecticity_defect(system, method, 0.3, masses=masses) < 1e-12
    if splitting == "jacobi":
        assert kd.analysis.symplecticity_defect(lame(system, splitting), method, 0.3, masses=masses) > 1e-4


def test_momenta_are_conserved_to_rounding():
    solution = run(two_planets(0.1), "wisdom-holman", 0.1, 20.0, save_every=1)
    for name in ("momentum", "angular momentum"):
        values = solution.invariants[name]
        assert np.abs(values - values[0]).max() < 1e-14
    assert np.abs(solution.energy - solution.energy[0]).max() > 1e-8


# Refusals


def test_a_planetary_system_is_refused_for_what_it_cannot_be():
    x, v = np.eye(3), np.zeros((3, 3))
    with pytest.raises(UnknownNameError, match="jacobi"):
        kd.systems.planetary([1, 1e-3, 1e-3], x, v, splitting="jacoby")
    with pytest.raises(ArgumentError, match=r"masses\[1\]=.* must be finite and at least 0"):
        kd.systems.planetary([1, -1e-3, 1e-3], x, v)
    with pytest.raises(ArgumentError, match="heaviest body first"):
        kd.systems.planetary([1, 1e-3, 2], x, v)
    with pytest.raises(ArgumentError, match="heaviest body first"):
        kd.systems.planetary([0, 0, 0], x, v)
    with pytest.raises(ArgumentError, match="at least two"):
        kd.systems.planetary([1], x[:1], v[:1])


def test_methods_that_need_a_kepler_flow_are_refused_elsewhere():
    system = kd.systems.nbody([1, 1e-3], np.eye(3)[:2], np.zeros((2, 3)))
    with pytest.raises(MethodMismatchError, match="wisdom-holman"):
        kd.solve(system, (0.0, 1.0), step=0.1, method="wisdom-holman")
    with pytest.raises(ArgumentError, match="'remainder'"):
        replace(system, kind=Kind.NEARLY_KEPLERIAN)


def test_a_corrector_that_advances_or_has_other_letters_is_refused():
    options = {
        "name": "mine",
        "order": 2,
        "word": palindrome(KEPLER, [], K),
        "symmetric": True,
        "kind": Kind.NEARLY_KEPLERIAN,
        "source": "a test",
    }
    assert Method(**options, corrector=word((KEPLER, 1), (K, "1/2"), (KEPLER, -1), (K, "-1/2"))).corrector
    with pytest.raises(ArgumentError, match=r"add up to 0\.5, not to 0"):
        Method(**options, corrector=word((KEPLER, "1/2")))
    with pytest.raises(ArgumentError, match="letters that are not in its word"):
        Method(**options, corrector=word((Letter.DRIFT, 1), (Letter.DRIFT, -1)))


def test_by_default_nearly_keplerian_motion_is_split():
    assert run(two_planets(0.1), "auto", 0.1).about.method == "blanes-aba-1064"
    assert run(two_planets(0.1), "auto", 1.0).about.method == "wisdom-holman-corrected-3"
    assert kd.methods.preferred(Kind.NEARLY_KEPLERIAN, 2).name == "wisdom-holman"


@pytest.mark.parametrize("splitting", ["jacobi", "democratic-heliocentric"])
def test_how_fast_a_pericentre_is_passed(splitting):
    e, a = 0.6, 0.8
    x, v = (
        [[0, 0, 0], [a * (1 + e), 0, 0], [0, 30, 0]],
        [[0, 0, 0], [0, np.sqrt((1 - e) / (1 + e) / a), 0], [-0.1, 0, 0]],
    )
    found = fastest_pericentre(kd.systems.planetary([1.0, 1e-12, 1e-12], x, v, splitting=splitting))
    assert found == pytest.approx(np.sqrt((1 + e) / a**3) / (1 - e) ** 1.5, rel=1e-9)
    assert fastest_pericentre(kd.systems.kepler(e)) == pytest.approx(np.sqrt(1 + e) / (1 - e) ** 1.5, rel=1e-12)


def test_planets_of_the_ephemeris_can_be_split():
    names = ["Sun", "Jupiter", "Saturn"]
    system = kd.systems.solar_system(names, splitting="democratic-heliocentric")
    assert system.coordinates["body"] == names
    assert system.units["x"] == "au"
    assert np.array_equal(system.x0, kd.systems.solar_system(names).x0)
    energy = run(replace(system, native=False), "wisdom-holman", 40.0, 4000.0, save_every=1).energy
    assert np.abs(energy / energy[0] - 1).max() < 1e-6
