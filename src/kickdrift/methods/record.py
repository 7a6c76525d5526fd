"""What a method is: a word over flows, with exact weights."""

from dataclasses import dataclass
from decimal import Decimal
from enum import Enum
from fractions import Fraction

from kickdrift.core.errors import ArgumentError

Weight = Fraction | Decimal | str | int


class Kind(Enum):
    """What a method needs of the acceleration to have its order. The value is the sentence for people."""

    GENERAL = "any acceleration a(t, x, v)"
    SEPARABLE = "accelerations a(t, x) that do not depend on the velocity"
    NYSTROM = "accelerations a(t, x) that do not depend on the velocity, with x' = v"


class Letter(Enum):
    """The flows that words are spelled with, by the name of the flow in the engine."""

    KICK = "kick"
    DRIFT = "drift"
    EXPLICIT_EULER = "explicit-euler"
    IMPLICIT_EULER = "implicit-euler"
    IMPLICIT_MIDPOINT = "implicit-midpoint"

    @property
    def self_adjoint(self) -> bool:
        """Whether the flow over -h undoes the flow over h."""
        return self in (Letter.KICK, Letter.DRIFT, Letter.IMPLICIT_MIDPOINT)


K, D = Letter.KICK, Letter.DRIFT


@dataclass(frozen=True)
class Method:
    """A one-step method as data; refuses to exist if its word is wrong.

    Attributes
    ----------
    name : str
        Kebab-case: author, kind, order.
    order : int
        Order of the global error, on the problems of `kind`.
    word : tuple of (Letter, Fraction)
        The flows of one step, first to last, each with its share of the step.
    symmetric : bool
        Whether a step over -h undoes a step over h.
    kind : Kind
        The accelerations for which the order holds.
    source : str
        Where the coefficients are from.
    aliases : tuple of str
        Other names.
    """

    name: str
    order: int
    word: tuple[tuple[Letter, Fraction], ...]
    symmetric: bool
    kind: Kind
    source: str
    aliases: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.word:
            raise ArgumentError(f"word of {self.name!r} is empty; a method has at least one flow.")
        if self.order < 1:
            raise ArgumentError(f"order={self.order!r} of {self.name!r} must be at least 1.")
        for letter in {letter for letter, _ in self.word}:
            total = sum(weight for other, weight in self.word if other is letter)
            if total != 1:
                raise ArgumentError(
                    f"word of {self.name!r}: the weights of {letter.value!r} add up to {float(total)!r}, not to 1;"
                    " give exact fractions, or derive one weight from the others."
                )
        letters = {letter for letter, _ in self.word}
        if letters not in ({K, D}, *({single} for single in Letter if single not in (K, D))):
            spelled = ", ".join(sorted(letter.value for letter in letters))
            raise ArgumentError(
                f"word of {self.name!r} has the flows {spelled}; a step needs kicks and drifts, or one whole-step flow."
            )
        palindrome = self.word == self.word[::-1] and all(letter.self_adjoint for letter in letters)
        if self.symmetric != palindrome:
            raise ArgumentError(
                f"symmetric={self.symmetric} of {self.name!r}: its word is {'' if palindrome else 'not '}a palindrome."
            )

    @property
    def explicit(self) -> bool:
        """Whether a step needs no solver."""
        return not {letter for letter, _ in self.word} & {Letter.IMPLICIT_EULER, Letter.IMPLICIT_MIDPOINT}

    @property
    def spelling(self) -> str:
        """The word for people, such as ``K/2 D K/2``."""
        return " ".join(_spell(letter, weight) for letter, weight in self.word)


def _spell(letter: Letter, weight: Fraction) -> str:
    name = {K: "K", D: "D"}.get(letter, letter.value)
    if weight == 1:
        return name
    if weight.numerator == 1 and weight.denominator < 100:
        return f"{name}/{weight.denominator}"
    return f"{name}({float(weight):.6g})"


def word(*letters: tuple[Letter, Weight]) -> tuple[tuple[Letter, Fraction], ...]:
    """Spell a word with exact weights, given as fractions, decimals or their strings."""
    return tuple((letter, Fraction(weight)) for letter, weight in letters)


def alternating(first: Letter, weights: list[Fraction]) -> tuple[tuple[Letter, Fraction], ...]:
    """Spell a word of kicks and drifts in turns."""
    other = D if first is K else K
    return tuple((first if i % 2 == 0 else other, weight) for i, weight in enumerate(weights))
