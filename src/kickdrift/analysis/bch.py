"""The Baker-Campbell-Hausdorff series of a word of kicks and drifts, up to its fifth degree.

A step is the flow over h of a modified Hamiltonian H + h H_2 + h^2 H_3 + ..., with the brackets of the kinetic part, whose flow
are drifts D, and of the potential, whose flow are kicks K. With derivatives along the two flows, D f and K f, brackets are
[D, f] = D f and [K, f] = K f; all of them are repeated derivatives of H itself, the last of them along the drift:
[K, [D, [D, K]]] = K D D H, since D V = D H and [K, D] = -[D, K]. Hairer, Lubich, Wanner, Geometric Numerical Integration,
2nd ed. (2006), sections III.4, III.5 and IX.4.
"""

from collections.abc import Iterator
from fractions import Fraction

from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError
from kickdrift.methods import Letter, Method

MOST = 5
_Series = dict[str, Fraction]  # of words of letters that do not commute


def brackets(method: Method, order: int = MOST - 1) -> dict[str, Fraction]:
    """Return the coefficients of repeated derivatives of H, by their letters, the first of which is taken last.

    Those of d letters belong to h^d. All brackets of at most five letters are linear combinations of these, which are
    independent: D; DD, KD; DDD, KDD, KKD; DDDD, DKDD, KDDD, KKDD, DKKD, KKKD.

    Raises
    ------
    ArgumentError
        For a method that is not a word of kicks and drifts, or an order, the last power of the step, that is not from 0 to
        4.
    """
    if not is_whole(order, 0, MOST - 1):
        raise ArgumentError(f"order={order!r} must be a whole number from 0 to {MOST - 1}.")
    degree = order + 1
    if not {letter.plain for letter in method.letters} <= {Letter.KICK, Letter.DRIFT}:
        raise ArgumentError(
            f"method={method.name!r} has no modified Hamiltonian here: its word {method.spelling} contains flows other"
            " than kicks and drifts; use a method such as 'velocity-verlet'."
        )
    product: _Series = {"": Fraction(1)}
    for letter, weight in method.word:
        product = _times(product, _exponential("K" if letter.plain is Letter.KICK else "D", weight, degree), degree)
    found: dict[str, Fraction] = {}
    for word, coefficient in _logarithm(product, degree).items():
        # Dynkin, Specht and Wever: a Lie polynomial is the sum of its words as nested brackets, each over its length.
        derivative, sign = _derivative(word)
        if derivative and coefficient:
            found[derivative] = found.get(derivative, Fraction(0)) + sign * coefficient / len(word)
    return {word: found[word] for word in sorted(found, key=lambda word: (len(word), word)) if abs(found[word]) > 1e-16}


def _derivative(word: str) -> tuple[str, int]:
    """Return the derivatives of H that a word stands for as a nested bracket, and their sign; empty where there are none."""
    if len(word) < 2 or word[-1] == word[-2]:
        return "", 0
    inner, sign = word[:-1], 1
    if word[-1] == "D":
        inner, sign = word[:-2] + "D", -1
    # [D, [K, [D, K]]] = [K, [D, [D, K]]], by the identity of Jacobi.
    return inner.removesuffix("DKD") + "KDD" if inner.endswith("DKD") else inner, sign


def _exponential(letter: str, weight: Fraction, degree: int) -> _Series:
    series, term = {}, Fraction(1)
    for power in range(degree + 1):
        series[letter * power] = term
        term *= weight / (power + 1)
    return series


def _logarithm(series: _Series, degree: int) -> _Series:
    rest = {word: value for word, value in series.items() if word}
    power, total = {"": Fraction(1)}, dict[str, Fraction]()
    for k in range(1, degree + 1):
        power = _times(power, rest, degree)
        for word, value in power.items():
            total[word] = total.get(word, Fraction(0)) + (-1) ** (k + 1) * value / k
    return total


def _times(one: _Series, other: _Series, degree: int) -> _Series:
    product: _Series = {}
    for word, value in _pairs(one, other, degree):
        product[word] = product.get(word, Fraction(0)) + value
    return product


def _pairs(one: _Series, other: _Series, degree: int) -> Iterator[tuple[str, Fraction]]:
    for left, a in one.items():
        for right, b in other.items():
            if len(left) + len(right) <= degree:
                yield left + right, a * b
