"""Modified Hamiltonians: against closed forms, and conserved as far as the series goes, and no farther."""

from fractions import Fraction
from math import asin, sqrt

import numpy as np
import pytest

import kickdrift as kd
from kickdrift import analysis
from kickdrift.analysis.bch import brackets
from kickdrift.core.errors import ArgumentError, KickdriftError, MethodMismatchError

OSCILLATOR, PENDULUM = kd.systems.harmonic_oscillator(1.5), kd.systems.pendulum()
STEPS = [0.2, 0.1, 0.05]


def states(count, seed=1):
    return np.random.default_rng(seed).normal(size=(2, count))


def test_coefficients_of_the_euler_and_verlet_methods():
    # log(exp A exp B) by Baker, Campbell and Hausdorff; HLW (2006), eqs. (III.4.11) and (III.4.15).
    half, twelfth = Fraction(1, 2), Fraction(1, 12)
    assert brackets(kd.methods.get("kick-drift"), 3) == {
        "D": -half, "DD": twelfth, "KD": -twelfth, "KDD": Fraction(1, 24),
    }  # fmt: skip
    assert brackets(kd.methods.get("drift-kick"), 3) == {
        "D": half, "DD": twelfth, "KD": -twelfth, "KDD": -Fraction(1, 24),
    }  # fmt: skip
    verlet = brackets(kd.methods.get("velocity-verlet"))
    assert {word: verlet[word] for word in ("DD", "KD")} == {"DD": twelfth, "KD": Fraction(1, 24)}
    assert verlet["DDDD"] == -Fraction(1, 720)
    assert verlet["KKKD"] == -Fraction(7, 5760)


@pytest.mark.parametrize("name", ["ruth-3", "forest-ruth-4", "suzuki-4", "blanes-moan-s6", "yoshida-6"])
def test_a_method_of_order_p_has_no_terms_below(name):
    method = kd.methods.get(name)
    lengths = {len(word) for word, value in brackets(method).items() if abs(value) > 1e-14}
    assert not lengths & set(range(1, min(method.order, 5)))
    assert method.order >= 5 or method.order in lengths
    assert not (method.symmetric and lengths & {1, 3})


@pytest.mark.parametrize(("method", "sign"), [("kick-drift", -1), ("drift-kick", 1)])
@pytest.mark.parametrize("h", [0.1, -0.1])
def test_series_of_the_oscillator(method, sign, h):
    x, v = states(20)

    def off(h, order):
        turned = h * 1.5
        factor = 2 * asin(turned / 2) / turned / sqrt(1 - turned**2 / 4)
        closed = factor * 0.5 * (v * v + 1.5**2 * (x * x + sign * h * x * v))
        return np.abs(analysis.modified_hamiltonian(OSCILLATOR, method, h, x, v, order=order) - closed).max()

    for order in range(5):
        assert off(h, order) / off(h / 2, order) == pytest.approx(2 ** (order + 1), rel=0.1)


def test_verlet_on_the_pendulum_has_its_closed_form():
    x, v = states(30)
    h, slope, bend = 0.2, 9.81 * np.sin(x), 9.81 * np.cos(x)
    gravity = kd.SecondOrder(lambda x: -9.81 * np.sin(x), energy=lambda x, v: 0.5 * v * v - 9.81 * np.cos(x))
    closed = 0.5 * v * v - 9.81 * np.cos(x) + h**2 * (v * v * bend / 12 - slope**2 / 24)
    found = analysis.modified_hamiltonian(gravity, "leapfrog", h, x, v, order=2, compile=False)
    assert np.allclose(found, closed, rtol=0, atol=2e-8)
    found = analysis.modified_hamiltonian(gravity, "position-verlet", h, x, v, order=2, compile=False)
    assert not np.allclose(found, closed, rtol=0, atol=1e-3)


@pytest.mark.parametrize(
    ("method", "order", "power"),
    [
        ("kick-drift", None, 2), ("kick-drift", 0, 1), ("kick-drift", 2, 3), ("kick-drift", 3, 4), ("kick-drift", 4, 5),
        ("velocity-verlet", None, 4), ("velocity-verlet", 0, 2), ("velocity-verlet", 1, 2), ("velocity-verlet", 4, 6),
        ("position-verlet", None, 4), ("ruth-3", None, 4), ("ruth-3", 2, 3), ("ruth-3", 4, 5),
        ("forest-ruth-4", None, 6), ("forest-ruth-4", 3, 4), ("suzuki-4", None, 6),
    ],
)  # fmt: skip
def test_a_method_conserves_it_as_far_as_the_series_goes(method, order, power):
    found = analysis.modified_order(PENDULUM, method, (0.0, 20.0), STEPS, order=order)
    assert found.order == pytest.approx(power, abs=0.15)
    assert (np.diff(found.errors) < 0).all()


def test_kinetic_energies_that_are_not_quadratic_and_masses():
    relativistic = kd.Separable(
        lambda p: p / np.sqrt(1 + p * p), lambda q: q + q**3, lambda q, p: np.sqrt(1 + p * p) + q * q / 2 + q**4 / 4
    )
    found = analysis.modified_order(relativistic, "leapfrog", (0.0, 10.0), STEPS, 1.0, 0.0, order=2, compile=False)
    assert found.order == pytest.approx(4, abs=0.15)
    masses = np.array([1.0, 3.0])
    chain = kd.Newtonian(
        lambda x: np.array([x[1] - 2 * x[0] - x[0] ** 3, x[0] - x[1]]),
        masses,
        lambda x, v: 0.5 * (masses * v * v).sum() + x[0] ** 2 / 2 + x[0] ** 4 / 4 + (x[1] - x[0]) ** 2 / 2,
    )
    found = analysis.modified_order(
        chain, "kick-drift", (0.0, 10.0), STEPS, [1.0, 0.5], [0.0, 1.0], order=2, compile=False
    )
    assert found.order == pytest.approx(3, abs=0.15)


def test_bodies_under_gravity_keep_it():
    system = kd.systems.get("benchmarks-game")
    sol = kd.solve(system, (0.0, 20.0), step=0.01, method="leapfrog", save_every=50)
    modified = analysis.modified_hamiltonian(system, "leapfrog", sol.step, sol.x, sol.v)
    assert np.ptp(modified) < np.ptp(sol.energy) / 1000
    one = analysis.modified_hamiltonian(system, "leapfrog", sol.step, sol.x[3], sol.v[3])
    assert one == pytest.approx(modified[3], rel=1e-14)


def test_formulas_are_the_closed_ones_and_agree_with_numbers():
    sp = pytest.importorskip("sympy")
    q, p, h = sp.symbols("q p h")
    potential = sp.Function("V")(q)
    slope, bend = potential.diff(q), potential.diff(q, 2)
    verlet = analysis.modified_formula(p**2 / 2 + potential, q, p, "leapfrog", order=3)
    assert sp.simplify(verlet - (p**2 / 2 + potential + h**2 * (p**2 * bend / 12 - slope**2 / 24))) == 0
    euler = analysis.modified_formula(p**2 / 2 + potential, q, p, "kick-drift", order=1)
    assert sp.simplify(euler - (p**2 / 2 + potential - h * p * slope / 2)) == 0
    energy = sp.sqrt(1 + p**2) + q**2 / 2 + q**4 / 4
    problem, (x, v) = kd.from_sympy(energy, q, p), states(10)
    for method in ("kick-drift", "ruth-3", "forest-ruth-4"):
        formula = sp.lambdify((q, p), analysis.modified_formula(energy, q, p, method, step=sp.Rational(1, 20)))
        numbers = analysis.modified_hamiltonian(problem, method, 0.05, x, v, compile=False)
        assert np.allclose(numbers, formula(x, v), rtol=0, atol=1e-9)
        assert not np.allclose(problem.energy(x[0], v[0]), numbers[0], rtol=0, atol=5e-9)


def test_formulas_of_several_coordinates():
    sp = pytest.importorskip("sympy")
    a, b, c, d, h = sp.symbols("a b c d h")
    energy = c**2 / 2 + d**2 / 4 + a**2 * b
    found = analysis.modified_formula(energy, (a, b), (c, d), "kick-drift", order=1, step=h)
    assert sp.expand(found - energy + h / 2 * (2 * a * b * c + a**2 * d / 2)) == 0


def test_what_has_none_is_refused():
    sp = pytest.importorskip("sympy")
    q, p = sp.symbols("q p")
    with pytest.raises(ArgumentError, match="is not T\\(p\\) \\+ V\\(q\\)"):
        analysis.modified_formula(q**2 * p**2, q, p, "leapfrog")
    with pytest.raises(ArgumentError, match="other than kicks and drifts"):
        analysis.modified_hamiltonian(PENDULUM, "gauss-4", 0.1, 0.1, 0.1)
    for order in (5, -1, 1.5, "2"):
        with pytest.raises(ArgumentError, match="order="):
            analysis.modified_hamiltonian(PENDULUM, "leapfrog", 0.1, 0.1, 0.1, order=order)
    with pytest.raises(ArgumentError, match="have shapes"):
        analysis.modified_hamiltonian(PENDULUM, "leapfrog", 0.1, [0.1, 0.2], 0.1)
    with pytest.raises(ArgumentError, match="but states of 'kepler'"):
        analysis.modified_hamiltonian(kd.systems.kepler(), "leapfrog", 0.1, [0.1] * 3, [0.1] * 3)
    with pytest.raises(MethodMismatchError, match="has no modified Hamiltonian"):
        analysis.modified_hamiltonian(lambda x, v: -x - v, "kick-drift", 0.1, [0.1], [0.1], compile=False)
    with pytest.raises(KickdriftError, match="has no energy"):
        analysis.modified_hamiltonian(lambda x: -x, "leapfrog", 0.1, [0.1], [0.1], compile=False)
    with pytest.raises(ArgumentError, match="yield no slope"):
        analysis.modified_order(PENDULUM, "leapfrog", (0.0, 1.0), [0.1])
