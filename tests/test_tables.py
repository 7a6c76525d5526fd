"""Every explicit word of kicks and drifts has the order that its table claims, and neither more nor less.

The integrator here is written anew, in extended precision, from the reading of a word alone. The engine has no part in
it, and is then compared with it.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from mpmath import MPContext  # type: ignore[import-untyped]

import kickdrift as kd
from kickdrift.methods import Kind, Letter, Method, catalogue, get

mp = MPContext()
mp.dps = 45
mpf = mp.mpf
Number = Any  # an mpf; mpmath has no types

K, D, GRADIENT_K = Letter.KICK, Letter.DRIFT, Letter.GRADIENT_KICK
Vector = Sequence[Number]

EXPLICIT = {name: method for name, method in catalogue().items() if method.letters <= {K, D, GRADIENT_K}}
NYSTROEM = {name: m for name, m in EXPLICIT.items() if m.kind is Kind.NEWTONIAN and GRADIENT_K not in m.letters}
SEPARABLE = {name: method for name, method in EXPLICIT.items() if method.kind.includes(Kind.SEPARABLE)}


@dataclass(frozen=True)
class Problem:
    """p' = force(t, q), q' = velocity(p), from q and p at time 0 to time 1."""

    force: Callable[[Number, Vector], Vector]
    jacobian: Callable[[Vector], Sequence[Vector]]
    q: tuple[str, ...]
    p: tuple[str, ...]
    velocity: Callable[[Vector], Vector] = lambda p: p

    @property
    def start(self) -> tuple[list[Number], list[Number]]:
        return [mpf(q) for q in self.q], [mpf(p) for p in self.p]


PROBLEMS = {
    "henon-heiles": Problem(
        force=lambda t, q: [-q[0] - 2 * q[0] * q[1], -q[1] - q[0] ** 2 + q[1] ** 2],
        jacobian=lambda q: [[-1 - 2 * q[1], -2 * q[0]], [-2 * q[0], -1 + 2 * q[1]]],
        q=("0.3", "0.2"),
        p=("0.1", "0.35"),
    ),
    "forced": Problem(
        force=lambda t, q: [-q[0] - q[0] ** 3 + mp.cos(2 * t)],
        jacobian=lambda q: [[-1 - 3 * q[0] ** 2]],
        q=("0.7",),
        p=("0.2",),
    ),
    "relativistic": Problem(
        force=lambda t, q: [-q[0] - q[0] ** 3],
        jacobian=lambda q: [[-1 - 3 * q[0] ** 2]],
        velocity=lambda p: [x / mp.sqrt(1 + x * x) for x in p],
        q=("0.9",),
        p=("0.4",),
    ),
}


def real(weight: Fraction | int) -> Number:
    return mpf(weight.numerator) / weight.denominator


@cache
def solution(problem: str) -> list[Number]:
    """The end by Taylor series, with no table in it; the smallest error looked at is 1e-20."""
    of = PROBLEMS[problem]
    q, p = of.start
    rates = lambda t, y: [*of.velocity(y[len(q) :]), *of.force(t, y[: len(q)])]  # noqa: E731
    series = mp.odefun(rates, 0, [*q, *p], tol=mpf(10) ** -30)
    return list(series(1))


def kicked(problem: Problem, t: Number, s: Number, q: Vector, c: Number) -> Vector:
    """F + c s^2 grad |F|^2, of which a plain kick has c = 0."""
    force = problem.force(t, q)
    if not c:
        return force
    gradient = [2 * mp.fdot(row, force) for row in zip(*problem.jacobian(q), strict=True)]
    return [f + c * s * s * g for f, g in zip(force, gradient, strict=True)]


def error(method: Method, problem: str, steps: int, clock_of_drifts: bool = True) -> Number:
    end = run(method, problem, steps, clock_of_drifts)
    return mp.norm([a - b for a, b in zip(end, solution(problem), strict=True)])


def run(method: Method, problem: str, steps: int, clock_of_drifts: bool = True) -> list[Number]:
    """Run the word as it reads."""
    of = PROBLEMS[problem]
    (q, p), t = of.start, mpf(0)
    c = real(method.parameters[0]) if method.parameters else 0
    word = [(letter, real(weight) / steps) for letter, weight in method.word]
    for letter, s in word * steps:
        if letter is D:
            q = [x + s * v for x, v in zip(q, of.velocity(p), strict=True)]
        else:
            force = kicked(of, t, s, q, c if letter is GRADIENT_K else 0)
            p = [x + s * f for x, f in zip(p, force, strict=True)]
        if (letter is D) is clock_of_drifts:
            t += s
    return [*q, *p]


def order(method: Method, problem: str, clock_of_drifts: bool = True) -> float:
    """The order seen in halving a step; finer steps for higher orders, where the next term of the error is larger."""
    kicks = sum(letter is not D for letter, _ in method.word)
    steps = round(32 * max(method.order, 2) / kicks)
    coarse, fine = (error(method, problem, n, clock_of_drifts) for n in (steps, 2 * steps))
    return float(mp.log(coarse / fine, 2))


def exchanged(method: Method) -> Method:
    """The same weights with kicks and drifts exchanged."""
    return replace(method, word=tuple((D if letter is K else K, weight) for letter, weight in method.word))


CASES = [(name, problem) for name in EXPLICIT for problem in PROBLEMS if problem != "relativistic" or name in SEPARABLE]


@pytest.mark.parametrize(("name", "problem"), CASES)
def test_order_is_the_one_claimed(name: str, problem: str) -> None:
    assert order(EXPLICIT[name], problem) == pytest.approx(EXPLICIT[name].order, abs=0.1)


@pytest.mark.parametrize("name", [name for name, method in EXPLICIT.items() if method.order > 1])
def test_a_clock_that_moves_with_the_kicks_costs_every_order_but_one(name: str) -> None:
    assert order(EXPLICIT[name], "forced", clock_of_drifts=False) == pytest.approx(1, abs=0.1)


# Up to order 4 the conditions for T(p) + V(q) are those for Nystroem methods and one more, of order 4, which a
# symmetric word fulfils anyway: such a word keeps order 4, but not its small error.
OTHERWISE = {name: 4 if method.symmetric else 3 for name, method in NYSTROEM.items()}


@pytest.mark.parametrize("name", NYSTROEM)
def test_nystroem_words_lose_order_where_kicks_and_drifts_are_exchanged(name: str) -> None:
    for problem in ("henon-heiles", "forced"):
        assert order(exchanged(NYSTROEM[name]), problem) == pytest.approx(OTHERWISE[name], abs=0.1)


@pytest.mark.parametrize("name", NYSTROEM)
def test_nystroem_words_lose_order_where_the_velocity_is_not_linear_in_the_momentum(name: str) -> None:
    assert order(NYSTROEM[name], "relativistic") == pytest.approx(OTHERWISE[name], abs=0.1)


def test_a_nystroem_word_that_keeps_its_order_when_exchanged_still_shows_it() -> None:
    srkn6b = get("blanes-moan-srkn6b")
    assert error(exchanged(srkn6b), "forced", 10) > 5 * error(srkn6b, "forced", 10)


@pytest.mark.parametrize(("factor", "expected"), [(1, 4), (0, 2), (-1, 2)])
def test_chin_needs_the_gradient_of_the_force_and_its_sign(factor: int, expected: int) -> None:
    chin = get("chin-4a")
    assert chin.parameters == (Fraction(3, 64),)
    changed = replace(chin, parameters=(factor * chin.parameters[0],))
    assert order(changed, "henon-heiles") == pytest.approx(expected, abs=0.1)


# The order conditions themselves, without a problem: the product of the exponentials of a word is exp(K + D) up to the
# order, as a power series in letters that do not commute. Where x' = v, [K, [K, [K, D]]] = 0 besides, which spells
# KKKD = 3 KKDK - 3 KDKK + DKKK and takes every series to one without KKKD.

Series = dict[str, int]
ONE = 10**60  # coefficients are whole numbers of this part of one: mpmath takes five times as long


def append(word: str, letter: str, newtonian: bool) -> dict[str, int]:
    if not (newtonian and letter == "D" and word.endswith("KKK")):
        return {word + letter: 1}
    total: Counter[str] = Counter()
    for kept, factor, tail in (("KK", 3, "K"), ("K", -3, "KK"), ("", 1, "KKK")):
        for head, count in append(word[:-3] + kept, "D", newtonian).items():
            total[head + tail] += factor * count
    return dict(total)


def times_exponential(series: Series, weights: dict[str, Fraction | int], newtonian: bool, longest: int) -> Series:
    total, term, parts = dict(series), series, {letter: round(weight * ONE) for letter, weight in weights.items()}
    for power in range(1, longest + 1):
        longer: Series = {}
        for word, value in term.items():
            for letter, part in parts.items() if len(word) < longest else ():
                for grown, count in append(word, letter, newtonian).items():
                    longer[grown] = longer.get(grown, 0) + value * part * count // (power * ONE)
        term = longer
        for word, value in term.items():
            total[word] = total.get(word, 0) + value
    return total


def defects(method: Method) -> list[float]:
    """The largest violation of an order condition, for every order up to the first that is not fulfilled."""
    newtonian, longest = method.kind is Kind.NEWTONIAN, method.order + 1
    series: Series = {"": ONE}
    for letter, weight in method.word:
        series = times_exponential(series, {"K" if letter is K else "D": weight}, newtonian, longest)
    flow = times_exponential({"": ONE}, {"K": 1, "D": 1}, newtonian, longest)
    return [
        max(abs(series.get(word, 0) - flow.get(word, 0)) for word in {*series, *flow} if len(word) == length) / ONE
        for length in range(1, longest + 1)
    ]


# What the digits in print allow; 40 digits where there is a closed form or a root of the order conditions.
PRECISION = {
    "mclachlan-atela-4": 1e-18,
    "mclachlan-atela-5": 1e-18,
    "calvo-sanz-4": 1e-18,
    "omelyan-pefrl-4": 1e-16,
    "omelyan-vefrl-4": 1e-16,
    "blanes-moan-s6": 1e-15,
    "blanes-moan-s10": 1e-15,
    "blanes-moan-srkn6b": 1e-15,
    "blanes-moan-srkn11b": 1e-15,
    "blanes-moan-srkn14a": 1e-15,
    "kahan-li-6": 1e-25,
    "kahan-li-8": 1e-25,
    "teloy-6a": 1e-34,
    "teloy-6b": 1e-34,
    "teloy-8a": 1e-34,
    "teloy-8c": 1e-34,
    "sofroniou-spaletta-10": 1e-31,
}


@pytest.mark.parametrize("name", [name for name, method in EXPLICIT.items() if GRADIENT_K not in method.letters])
def test_order_conditions_hold_to_all_digits_and_the_next_ones_do_not(name: str) -> None:
    *fulfilled, violated = defects(EXPLICIT[name])
    assert max(fulfilled) < PRECISION.get(name, 1e-38)
    assert violated > 1e-10


@pytest.mark.parametrize("name", ["yoshida-6", "yoshida-8", "suzuki-umeno-8", "kahan-li-8", "sofroniou-spaletta-10"])
def test_twelve_digits_are_not_enough(name: str) -> None:
    steps = [weight for letter, weight in get(name).word if letter is K]
    cut = [Fraction(round(weight * 10**12), 10**12) for weight in steps]
    assert abs(float(sum(weight**3 for weight in steps))) < 1e-25
    assert abs(float(sum(weight**3 for weight in cut))) > 1e-14


def test_the_minima_that_no_order_condition_fixes_have_their_closed_forms() -> None:
    def weights(name: str) -> list[Number]:
        return [real(weight) for _, weight in get(name).word]

    root = mp.cbrt(2 * mp.sqrt(326) + 36)
    assert abs(weights("mclachlan-s2-2")[0] - (mpf(1) / 2 - root / 12 + 1 / (6 * root))) < 1e-40
    assert abs(weights("mclachlan-atela-2")[1] - mp.sqrt(2) / 2) < 1e-40


@pytest.mark.parametrize("name", EXPLICIT)
def test_kicks_and_drifts_add_up_to_one_exactly(name: str) -> None:
    for drift in (True, False):
        assert sum(weight for letter, weight in EXPLICIT[name].word if (letter is D) is drift) == 1


def test_aliases_of_the_literature() -> None:
    for alias, name in {
        "pefrl": "omelyan-pefrl-4",
        "vefrl": "omelyan-vefrl-4",
        "yoshida-4": "forest-ruth-4",
        "candy-rozmus-4": "forest-ruth-4",
        "yoshida-6a": "yoshida-6",
        "yoshida-8d": "yoshida-8",
        "mclachlan-ss15-8": "suzuki-umeno-8",
    }.items():
        assert get(alias).name == name


@pytest.mark.parametrize(("name", "problem"), [(name, problem) for name, problem in CASES if name != "chin-4a"])
def test_the_engine_does_what_the_word_says(name: str, problem: str) -> None:
    of = PROBLEMS[problem]
    q, p = (np.array([float(number) for number in part]) for part in of.start)
    system = kd.Separable(
        kinetic_gradient=lambda p: p / np.sqrt(1 + p * p) if problem == "relativistic" else p,
        potential_gradient=lambda t, q: -np.array([float(f) for f in of.force(mpf(t), [mpf(x) for x in q])]),
    )
    if problem != "relativistic":
        system = lambda t, x: np.array([float(f) for f in of.force(mpf(t), [mpf(q) for q in x])])  # noqa: E731
    end = kd.solve(system, (0.0, 1.0), q, p, step=0.2, method=name, compile=False, save_every=5)
    exact = np.array([float(number) for number in run(EXPLICIT[name], problem, 5)])
    assert np.abs(np.concatenate([end.x[-1], end.v[-1]]) - exact).max() < 3e-15
