"""The modified Hamiltonian that a word of kicks and drifts conserves, as a formula."""

from fractions import Fraction
from typing import Any

from kickdrift import methods
from kickdrift.analysis.bch import brackets
from kickdrift.core.errors import ArgumentError, missing_extra


def modified_formula(
    hamiltonian: Any, q: Any, p: Any, method: str | methods.Method, *, order: int = 4, step: Any = None
) -> Any:
    """Return the modified Hamiltonian of a method as a formula: a polynomial in the step.

    Parameters
    ----------
    hamiltonian : sympy expression
        H = T(p) + V(q).
    q, p : symbol or sequence of symbols
    method : str or Method
        A word of kicks and drifts.
    order : int
        The last power of the step, from 0 to 4.
    step : symbol or number, optional
        The step; by default the symbol h.

    Returns
    -------
    sympy expression

    Raises
    ------
    ArgumentError
        For a Hamiltonian that is not T(p) + V(q), and for whatever `modified_hamiltonian` refuses.
    MissingExtraError
        Without the package sympy.

    Examples
    --------
    >>> import sympy as sp, kickdrift as kd
    >>> q, p = sp.symbols("q p")
    >>> kd.analysis.modified_formula((p**2 + q**2) / 2, q, p, "kick-drift", order=1)
    -h*p*q/2 + p**2/2 + q**2/2
    """
    try:
        import sympy
    except ImportError:
        raise missing_extra("kd.analysis.modified_formula", "sympy", "sympy") from None
    try:
        energy, (q, p) = sympy.sympify(hamiltonian), sympy.sympify((q, p))
    except sympy.SympifyError as error:
        raise ArgumentError(
            f"hamiltonian={hamiltonian!r}, q={q!r} and p={p!r} must be a formula and its symbols: {error}"
        ) from None
    h = sympy.Symbol("h") if step is None else step
    positions, momenta = ([part] if isinstance(part, sympy.Expr) else list(part) for part in (q, p))
    velocity, slope = ([energy.diff(symbol) for symbol in half] for half in (momenta, positions))
    if any(sympy.simplify(part.diff(symbol)) != 0 for part in velocity for symbol in positions):
        raise ArgumentError(f"hamiltonian={hamiltonian} is not T(p) + V(q), whose flows are drifts and kicks.")
    along = {"D": (positions, velocity), "K": (momenta, [-part for part in slope])}

    def derivative(word: str) -> Any:
        value = energy
        for letter in reversed(word):
            value = sum(rate * value.diff(symbol) for symbol, rate in zip(*along[letter], strict=True))
        return value

    series = brackets(methods.get(method), order)
    terms = (_number(sympy, coefficient) * h ** len(word) * derivative(word) for word, coefficient in series.items())
    return sympy.expand(energy + sum(terms))


def _number(sympy: Any, coefficient: Fraction) -> Any:
    """Return a fraction that people read, or the float of a coefficient that was printed in digits."""
    near = coefficient.limit_denominator(1_000_000)
    if abs(near - coefficient) < Fraction(1, 10**15):
        return sympy.Rational(near.numerator, near.denominator)
    return sympy.Float(float(coefficient))
