"""The tables, and what a method refuses to be."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, UnknownNameError
from kickdrift.methods import Kind, Letter, Method, Tableau, alternating, word

K, D = Letter.KICK, Letter.DRIFT


def method(letters, symmetric=False, order=1, name="mine"):
    return Method(name=name, order=order, word=letters, symmetric=symmetric, kind=Kind.NEWTONIAN, source="a test")


@pytest.mark.parametrize(
    ("alias", "name"),
    [
        ("semi-implicit-euler", "kick-drift"),
        ("symplectic-euler", "kick-drift"),
        ("euler-cromer", "kick-drift"),
        ("leapfrog", "velocity-verlet"),
        ("stormer-verlet", "velocity-verlet"),
        ("yoshida-4", "forest-ruth-4"),
    ],
)
def test_aliases_resolve(alias, name):
    assert kd.methods.get(alias) is kd.methods.catalogue()[name]


def test_names_and_aliases_are_unique_and_kebab_case():
    names = [n for m in kd.methods.catalogue().values() for n in (m.name, *m.aliases)]
    assert len(names) == len(set(names))
    assert all(n == n.lower() and " " not in n and "_" not in n for n in names)


@pytest.mark.parametrize("record", kd.methods.catalogue().values(), ids=lambda m: m.name)
def test_every_table_is_exact_and_cited(record):
    for share in {letter.share for letter, _ in record.word}:
        assert sum(weight for letter, weight in record.word if letter.share == share) == 1
    assert record.source
    assert record.order % 2 == 0 or not record.symmetric  # a symmetric method has an even order


def test_forest_ruth_weights_to_thirty_digits():
    # 1 / (2 - 2^(1/3)): Forest and Ruth, Physica D 43, 105 (1990); digits by mpmath.
    import mpmath

    with mpmath.workdps(50):
        outer = 1 / (2 - mpmath.cbrt(2))
        weight = kd.methods.get("forest-ruth-4").word[1][1]
        assert abs(mpmath.mpf(weight.numerator) / weight.denominator - outer) < mpmath.mpf(10) ** -40


def test_unknown_name_offers_the_nearest():
    with pytest.raises(UnknownNameError, match="'leapfrog'"):
        kd.methods.get("leapfrg")


@pytest.mark.parametrize(
    ("letters", "symmetric", "order", "reason"),
    [
        ((), False, 1, "empty"),
        (word((K, "1/2"), (D, 1)), False, 1, "add up to 0.5"),
        (word((K, 1), (D, "0.99999999999999999")), False, 1, "not to 1"),
        (word((K, 1), (D, 1)), True, 1, "not a palindrome"),
        (word((K, "1/2"), (D, 1), (K, "1/2")), False, 2, "is a palindrome"),
        (word((K, 1)), False, 1, "kicks and drifts"),
        (word((K, 1), (Letter.IMPLICIT_RUNGE_KUTTA, 1)), False, 1, "kicks and drifts"),
        (word((K, 1), (D, 1)), False, 0, "at least 1"),
    ],
)
def test_a_wrong_method_cannot_exist(letters, symmetric, order, reason):
    with pytest.raises(ArgumentError, match=reason):
        method(letters, symmetric, order)


@given(st.lists(st.fractions(min_value=-2, max_value=2, max_denominator=1000), min_size=1, max_size=6))
def test_any_weights_that_add_up_make_a_method(kicks):
    kicks = [*kicks, 1 - sum(kicks)]
    drifts = [Fraction(1, len(kicks))] * len(kicks)
    made = method(alternating(K, [w for pair in zip(kicks, drifts, strict=True) for w in pair]), symmetric=False)
    assert made.explicit
    assert made.spelling.startswith("K")


def test_a_method_of_ones_own_runs():
    mine = method(word((D, "1/4"), (K, "1/2"), (D, "1/2"), (K, "1/2"), (D, "1/4")), symmetric=True, order=2)
    problem = kd.systems.harmonic_oscillator()
    solution = kd.solve(problem, (0.0, 1.0), step=0.01, method=mine)
    assert abs(solution.x[-1] - problem.exact(solution.t)[0][-1]) < 1e-5
    assert solution.about.method == "mine"


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"word": word((K, 1), (D, 1), (Letter.ROTATE, 1))}, "'rotate' needs charges"),
        ({"word": word((K, 1), (D, 1), (Letter.THERMOSTAT, 1))}, "'thermostat' needs Langevin"),
        ({"word": word((K, 1), (Letter.KEPLER, 1))}, "'kepler' needs light bodies"),
        ({"kind": Kind.CONSTRAINED}, "none of its flows is for this kind"),
        ({"kind": Kind.LANGEVIN}, "none of its flows is for this kind"),
        ({"word": word((Letter.RUNGE_KUTTA, 1))}, "a Runge-Kutta flow needs one"),
        ({"tableau": lambda: Tableau([[0]], [1])}, "a Runge-Kutta flow needs one"),
        ({"word": word((Letter.EXTRAPOLATION, 1))}, "its flows need 1"),
        ({"parameters": (1,)}, "its flows need 0"),
    ],
)
def test_a_method_whose_flows_lack_what_they_need_cannot_exist(change, reason):
    given = {"word": word((K, 1), (D, 1)), "kind": Kind.NEWTONIAN, "symmetric": False, "order": 1}
    with pytest.raises(ArgumentError, match=reason):
        Method(name="mine", source="a test", **{**given, **change})


@pytest.mark.parametrize(
    ("letter", "symmetric", "reason"),
    [
        (Letter.RUNGE_KUTTA, True, "tableau of 'mine' is implicit"),
        (Letter.IMPLICIT_RUNGE_KUTTA, False, "for its tableau this is True"),
    ],
)
def test_a_tableau_that_does_not_fit_is_refused_when_it_is_needed(letter, symmetric, reason):
    mine = Method(
        name="mine",
        order=2,
        word=word((letter, 1)),
        symmetric=symmetric,
        kind=Kind.FIRST_ORDER,
        source="a test",
        tableau=lambda: Tableau([[Fraction(1, 2)]], [1]),
    )
    with pytest.raises(ArgumentError, match=reason):
        kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, step=0.1, method=mine, compile=False)


def test_half_kicks_that_see_the_velocity_are_not_merged():
    letters = word((K, "1/2"), (K, "1/2"), (D, 1))
    halves = Method("mine", 1, letters, False, Kind.VELOCITY_DEPENDENT, "a test")
    run = kd.solve(lambda x, v: -x - 3 * v, (0.0, 1.0), 1.0, 0.0, step=0.1, method=halves, compile=False)
    x, v = 1.0, 0.0
    for _ in range(10):
        v += 0.05 * (-x - 3 * v)
        v += 0.05 * (-x - 3 * v)
        x += 0.1 * v
    assert run.x[-1] == pytest.approx(x, rel=1e-14)
