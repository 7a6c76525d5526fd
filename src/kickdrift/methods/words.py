"""Words of letters from the numbers that are printed: alternating ones, palindromes, compositions."""

from collections.abc import Sequence
from fractions import Fraction

from kickdrift.methods.letter import Letter
from kickdrift.methods.record import D, K, Weight, Word


def word(*letters: tuple[Letter, Weight]) -> Word:
    """Spell a word with exact weights.

    Parameters
    ----------
    *letters : (Letter, weight)
        The flows of a step in their order, each with its share of the step: an int, a Fraction, a Decimal, or the string of
        one, such as ``"1/2"``; floats are not exact.

    Returns
    -------
    tuple of (Letter, Fraction)
        For the argument `word` of `Method`.

    Examples
    --------
    >>> from kickdrift.methods import Letter, word
    >>> word((Letter.KICK, "1/2"), (Letter.DRIFT, 1), (Letter.KICK, "1/2"))[0]
    (<Letter.KICK: 'kick'>, Fraction(1, 2))
    """
    return tuple((letter, Fraction(weight)) for letter, weight in letters)


def alternating(first: Letter, weights: Sequence[Weight], second: Letter | None = None) -> Word:
    """Spell a word of two alternating letters.

    Parameters
    ----------
    first : Letter
        The first letter of the word.
    weights : sequence of Fraction, Decimal, str or int
        One per letter of the word.
    second : Letter, optional
        The other letter; by default DRIFT after KICK, otherwise KICK.

    Returns
    -------
    tuple of (Letter, Fraction)
        As from `word`.

    Examples
    --------
    >>> from kickdrift.methods import Letter, alternating
    >>> [
    ...     (letter.symbol, str(share))
    ...     for letter, share in alternating(Letter.DRIFT, ["1/2", 1, "1/2"])
    ... ]
    [('D', '1/2'), ('K', '1'), ('D', '1/2')]
    """
    other = second or (D if first is K else K)
    return word(*((first if i % 2 == 0 else other, weight) for i, weight in enumerate(weights)))


def rows(first: Letter, own: Sequence[Weight], others: Sequence[Weight]) -> Word:
    """Spell a word of alternating kicks and drifts by the weights of `first` and of the other letter, each without the last.

    The two left out follow from the sums, so that time advances by exactly one step whatever the rounding of the printed
    digits.

    Parameters
    ----------
    first : Letter
        KICK or DRIFT.
    own, others : sequence of Fraction, Decimal, str or int
        Weights of the first letter and of the other one, one number fewer than the word has of each.

    Returns
    -------
    tuple of (Letter, Fraction)
        As from `word`.

    Examples
    --------
    >>> from kickdrift.methods import Letter, rows
    >>> [
    ...     (letter.symbol, str(share))
    ...     for letter, share in rows(Letter.KICK, ["1/4"], ["2/3"])
    ... ]
    [('K', '1/4'), ('D', '2/3'), ('K', '3/4'), ('D', '1/3')]
    """
    weights = [Fraction(0)] * (len(own) + len(others) + 2)
    for start, given in enumerate((own, others)):
        printed = [Fraction(weight) for weight in given]
        weights[start::2] = [*printed, 1 - sum(printed, Fraction(0))]
    return alternating(first, weights)


def palindrome(first: Letter, weights: Sequence[Weight], second: Letter | None = None) -> Word:
    """Spell a symmetric word of two alternating letters by its first half, without the last weight of each letter.

    These two weights follow from the sums of 1 for each letter, so that time advances by exactly one step whatever the
    rounding of the printed digits.

    Parameters
    ----------
    first : Letter
        The first letter of the word.
    weights : sequence of Fraction, Decimal, str or int
        The first n weights of a word of 2 n + 3 letters.
    second : Letter, optional
        As for `alternating`.

    Returns
    -------
    tuple of (Letter, Fraction)
        As from `word`.

    Examples
    --------
    >>> from kickdrift.methods import Letter, palindrome
    >>> [(letter.symbol, str(share)) for letter, share in palindrome(Letter.KICK, ["1/6"])]
    [('K', '1/6'), ('D', '1/2'), ('K', '2/3'), ('D', '1/2'), ('K', '1/6')]
    """
    given = [Fraction(weight) for weight in weights]
    inner, middle = Fraction(1, 2) - sum(given[-2::-2], Fraction(0)), 1 - 2 * sum(given[-1::-2], Fraction(0))
    half = [*given, inner]
    return alternating(first, [*half, middle, *reversed(half)], second)


def composition(base: Word, weights: Sequence[Weight]) -> Word:
    """Spell a composition of steps: a step of `base` for each weight, neighbours of the same letter merged.

    Parameters
    ----------
    base : tuple of (Letter, Fraction)
        A word.
    weights : sequence of Fraction, Decimal, str or int
        The share of each step of `base`; they add up to 1.

    Returns
    -------
    tuple of (Letter, Fraction)
        As from `word`.

    Examples
    --------
    >>> from kickdrift.methods import Letter, alternating, composition
    >>> leapfrog = alternating(Letter.KICK, ["1/2", 1, "1/2"])
    >>> [
    ...     (letter.symbol, str(share))
    ...     for letter, share in composition(leapfrog, ["1/3", "2/3"])
    ... ]
    [('K', '1/6'), ('D', '1/3'), ('K', '1/2'), ('D', '2/3'), ('K', '1/3')]
    """
    spelled: list[tuple[Letter, Fraction]] = []
    for share in [Fraction(weight) for weight in weights]:
        for letter, weight in base:
            if spelled and spelled[-1][0] is letter:
                spelled[-1] = letter, spelled[-1][1] + share * weight
            else:
                spelled.append((letter, share * weight))
    return tuple(spelled)
