"""The record of a method: a word over flows, with exact weights."""

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.core.html import facts, path
from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import WHOLES, Letter
from kickdrift.methods.oscillator import order_on_oscillator
from kickdrift.methods.tableau import Tableau

_LONGEST_SPELLING = 9  # letters

Weight = Fraction | Decimal | str | int
Word = tuple[tuple[Letter, Fraction], ...]

K, D = Letter.KICK, Letter.DRIFT
# Flows of damping and of a magnetic field, which do nothing where there is none: a word has no higher order than without them.
_IDLE = (Letter.DAMP, Letter.ROTATE, Letter.BORIS_ROTATE)
ADJOINT_K, ADJOINT_D = Letter.ADJOINT_KICK, Letter.ADJOINT_DRIFT


def _is_share(letter: Any, weight: Any) -> bool:
    return isinstance(letter, Letter) and isinstance(weight, Fraction | int) and not isinstance(weight, bool)


@dataclass(frozen=True)
class Method:
    """A one-step method as data, validated on creation.

    Attributes
    ----------
    name : str
        Kebab-case: author, kind, order.
    order : int
        Order of the global error, on the problems of `kind`; for Langevin dynamics that of averages, the weak order; for
        ``shake`` that of positions, while its velocities have order 1.
    word : tuple of (Letter, Fraction)
        The flows of one step, from first to last, each with its fraction of the step, as `kickdrift.methods.word` and the
        like return it. `Letter` lists which flows make up a step.
    symmetric : bool
        Whether a step of -h inverts a step of h.
    kind : Kind
        The widest kind of problem that it is designed for, on which its order holds.
    source : str
        Source of the coefficients.
    aliases : tuple of str
        Other names.
    tableau : callable, optional
        Returns the `Tableau` of a Runge-Kutta method, whose word is a single letter such as ``Letter.RUNGE_KUTTA``.
    parameters : tuple of int or Fraction
        Numbers that its letters need, such as the number of substeps; see `Letter`.
    counterpart : str
        Name of the method that replaces it for non-separable Hamiltonians.
    generalised_order : tuple of int
        For problems A + e B with a small e: the powers of h in the errors of order e, e^2, ..., such as (8, 6, 4) for e h^8
        + e^2 h^6 + e^3 h^4.
    corrector : tuple of (Letter, Fraction)
        Another word of the same letters, whose weights sum to zero: applied once, before the first step, and inverted on
        every state that is kept.

    Raises
    ------
    ArgumentError
        For fields that contradict each other: shares that do not add up to 1, a wrong symmetry, an order that the word does
        not have on the harmonic oscillator, or letters that do not exist for the kind of problem.

    Examples
    --------
    >>> from kickdrift.methods import Kind, Letter, Method, word
    >>> halves = word((Letter.DRIFT, "1/2"), (Letter.KICK, 1), (Letter.DRIFT, "1/2"))
    >>> mine = Method(
    ...     name="mine-2",
    ...     order=2,
    ...     symmetric=True,
    ...     kind=Kind.SEPARABLE,
    ...     source="an example",
    ...     word=halves,
    ... )
    >>> mine.spelling, mine.explicit
    ('D/2 K D/2', True)
    """

    name: str
    order: int
    word: Word
    symmetric: bool
    kind: Kind
    source: str
    aliases: tuple[str, ...] = ()
    tableau: Callable[[], Tableau] | None = None
    parameters: tuple[Fraction | int, ...] = ()
    counterpart: str = ""
    generalised_order: tuple[int, ...] = ()
    corrector: Word = ()

    def __post_init__(self) -> None:
        self._check_types()
        if not self.word:
            raise ArgumentError(f"word of {self.name!r} is empty; a method needs at least one flow.")
        if self.order < 1:
            raise ArgumentError(f"order={self.order!r} of {self.name!r} must be at least 1.")
        self._check_shares()
        self._check_order()
        self._check_corrector()
        self._check_needs()
        if self.tableau is None and self.symmetric != self._palindrome:
            is_one = "a palindrome" if self._palindrome else "not a palindrome"
            raise ArgumentError(f"symmetric={self.symmetric} of {self.name!r}: its word is {is_one}.")

    def _check_types(self) -> None:
        wanted = {"name": str, "order": int, "word": tuple, "symmetric": bool, "kind": Kind, "source": str, "aliases": tuple,
                  "parameters": tuple, "counterpart": str, "generalised_order": tuple, "corrector": tuple}  # fmt: skip
        for name, kind in wanted.items():
            value: Any = getattr(self, name)
            if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
                raise ArgumentError(f"{name}={value!r} of a method is not of type {kind.__name__}; give one.")
        if self.tableau is not None and not callable(self.tableau):
            raise ArgumentError(f"tableau={self.tableau!r} of {self.name!r} must be a function that returns a Tableau.")
        for name in ("word", "corrector"):
            for member in getattr(self, name):
                if not (isinstance(member, tuple) and len(member) == 2 and _is_share(*member)):
                    raise ArgumentError(
                        f"{name} of {self.name!r} has {member!r}; give pairs of a Letter and its share of the step, a Fraction."
                    )
        for number in (*self.parameters, *self.generalised_order):
            if not isinstance(number, int | Fraction):
                raise ArgumentError(
                    f"parameters and generalised_order of {self.name!r} contain {number!r}; give whole numbers."
                )

    def _check_shares(self) -> None:
        totals: dict[str, Fraction] = {}
        for letter, weight in self.word:
            totals[letter.share] = totals.get(letter.share, Fraction(0)) + weight
        for share, total in totals.items():
            if total != 1:
                raise ArgumentError(
                    f"word of {self.name!r}: the weights of {share!r} add up to {float(total)!r}, not to 1; give exact"
                    " fractions, or compute one weight from the others."
                )
        if frozenset(totals) not in WHOLES:
            raise ArgumentError(
                f"word of {self.name!r} has the flows {', '.join(sorted(totals))}; a step needs kicks and drifts, or"
                " another complete set of flows."
            )

    def _check_order(self) -> None:
        if self.letters <= {K, D, *_IDLE, Letter.DAMPED_DRIFT}:
            moves = [(letter is not K, float(weight)) for letter, weight in self.word if letter not in _IDLE]
            if (order := order_on_oscillator(moves, self.order)) < self.order:
                raise ArgumentError(
                    f"order={self.order!r} of {self.name!r}: its word has only order {order} on the harmonic"
                    " oscillator; give that order, or other weights."
                )

    def _check_corrector(self) -> None:
        for share in {letter.share for letter, _ in self.corrector}:
            total = sum((weight for letter, weight in self.corrector if letter.share == share), Fraction(0))
            if total != 0:
                raise ArgumentError(
                    f"corrector of {self.name!r}: the weights of {share!r} add up to {float(total)!r}, not to 0; a"
                    " corrector changes the state and does not advance it."
                )
        used = {letter for letter, _ in self.corrector}
        if not used <= self.letters or any(letter.noisy or letter.adjoint is None for letter in used):
            raise ArgumentError(
                f"corrector of {self.name!r} has letters that are not in its word, or that cannot be inverted; use"
                " others."
            )

    def _repr_html_(self) -> str:
        """Return the HTML that notebooks show."""
        rows = {
            "order": f"{self.order} {self.generalised_order or ''}".rstrip(),
            "for": self.kind.value,
            "word": self.spelling,
            "symmetric": "yes" if self.symmetric else "no",
            "source": self.source,
        }
        return facts(self.name, rows.items(), drawing=self._staircase())

    def _staircase(self) -> str:
        """Return an SVG of the word: drifts lead to the right by their share of the step, kicks upwards, negative ones back."""
        shares = {letter.share for letter in self.letters}
        if self.tableau is not None or not shares <= {"kick", "drift"}:
            return ""
        corners = [(0.0, 0.0)]
        for letter, weight in self.word:
            drift, kick = corners[-1]
            is_drift = letter.share == "drift"
            corners.append((drift + weight * is_drift, kick + weight * (not is_drift)))
        return path([(float(drift), float(kick)) for drift, kick in corners], "drifts lead to the right, kicks upwards")

    def __hash__(self) -> int:
        """Return the same for equal methods; a word of fractions takes long."""
        return hash((self.name, self.order))

    @property
    def _palindrome(self) -> bool:
        """Whether the word reads the same backwards with each letter's adjoint.

        A kick and its adjoint are the same flow where the acceleration does not depend on the velocity, and so are
        drifts for separable problems.
        """
        moving = [(letter, weight) for letter, weight in self.word if not letter.projection]
        same = Kind.SEPARABLE.includes(self.kind) or any(
            letter.share not in ("kick", "drift") for letter in self.letters
        )
        backwards = [(letter if same else letter.adjoint, weight) for letter, weight in reversed(moving)]
        return moving == backwards and all(letter.adjoint is not None for letter, _ in moving)

    def _check_needs(self) -> None:
        special = {letter: letter.kind for letter in self.letters if letter.kind is not Kind.FIRST_ORDER}
        for letter, kind in special.items():
            if not kind.includes(self.kind):
                raise ArgumentError(
                    f"kind of {self.name!r} is {self.kind.value}, but its flow {letter.value!r} needs {kind.value}."
                )
        if not Kind.FIRST_ORDER.includes(self.kind) and not special:
            raise ArgumentError(f"kind of {self.name!r} is {self.kind.value}, but none of its flows is for this kind.")
        if (self.tableau is not None) != any(letter.has_tableau for letter in self.letters):
            raise ArgumentError(f"tableau of {self.name!r}: a Runge-Kutta flow needs one, and no other flow has one.")
        wanted = sum(letter.parameters for letter in self.letters)
        if len(self.parameters) != wanted:
            raise ArgumentError(f"parameters={self.parameters!r} of {self.name!r}: its flows need {wanted}.")

    @property
    def coefficients(self) -> NDArray[np.float64]:
        """The coefficients that the flows need: the numbers of its tableau, or its parameters.

        Raises
        ------
        ArgumentError
            For a tableau that does not fit the letter, or is not as symmetric as the method says.
        """
        if self.tableau is None:
            return np.array([float(parameter) for parameter in self.parameters])
        tableau = self.tableau()
        if self.explicit and not tableau.explicit:
            raise ArgumentError(f"tableau of {self.name!r} is implicit; its letter is IMPLICIT_RUNGE_KUTTA.")
        if Letter.STIFF_RUNGE_KUTTA in self.letters and not tableau.stiffly_accurate:
            raise ArgumentError(
                f"tableau of {self.name!r} is not stiffly accurate, which needs b to be the last row of a nonsingular"
                " a, for x and v alike; its letter is IMPLICIT_RUNGE_KUTTA."
            )
        if tableau.symmetric != self.symmetric:
            raise ArgumentError(
                f"symmetric={self.symmetric} of {self.name!r}: for its tableau this is {tableau.symmetric}."
            )
        return tableau.numbers

    @property
    def explicit(self) -> bool:
        """Whether a step needs no solver for the accelerations on any problem of its kind."""
        return not any(letter.implicit for letter, _ in self.word)

    @cached_property
    def letters(self) -> frozenset[Letter]:
        """The letters of the word."""
        return frozenset(letter for letter, _ in self.word)

    @cached_property
    def spelling(self) -> str:
        """The word as text, such as ``K/2 D K/2``; the middle of a long one is left out."""
        spelled = [_spell(letter.symbol, weight) for letter, weight in self.word]
        if len(spelled) > _LONGEST_SPELLING:
            spelled[3:-3] = [f"... ({len(spelled)} letters) ..."]
        return " ".join(spelled)


def _spell(symbol: str, weight: Fraction) -> str:
    if weight == 1:
        return symbol
    if weight.numerator == 1 and weight.denominator < 100:
        return f"{symbol}/{weight.denominator}"
    return f"{symbol}({float(weight):.6g})"
