"""Splittings of the dynamics in two parts, made to serve three."""

from fractions import Fraction

from kickdrift.methods.letter import Letter
from kickdrift.methods.record import Word
from kickdrift.methods.words import composition


def in_three(two_parts: Word, outer: Letter, middle: Letter, inner: Letter) -> Word:
    """Spell a word of three letters that has the order of a given one of two letters in turns.

    With ``a`` for the first-order step outer-middle-inner and ``a*`` for its adjoint, inner-middle-outer, the steps

        a(c_1) a*(c_2) a(c_3) ... a*(c_2s)

    have a given order under conditions on the c alone. With two letters this is the word of the weights c_1,
    c_1 + c_2, c_2 + c_3, ..., c_2s, neighbours merged, under the same conditions (McLachlan, SIAM J. Sci. Comput. 16,
    151 (1995)): the c follow from the weights. Shares of `outer` and `inner` are merged, so these must be flows, for
    which a share of c and then one of d is a share of c + d: exact rotations are, Boris' are not.
    """
    shares: list[Fraction] = []
    for _, weight in two_parts[:-1]:
        shares.append(weight - (shares[-1] if shares else 0))
    there, back = (outer, middle, inner), (inner, middle, outer)
    steps = [(letter, share) for i, share in enumerate(shares) for letter in (there if i % 2 == 0 else back)]
    return composition(tuple(steps), [1])
