"""The symmetric compositions of Yoshida, with as few Verlet steps as the order allows."""

from collections.abc import Sequence
from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.record import D, K, Method, Weight, Word
from kickdrift.methods.words import composition, word

YOSHIDA = "Yoshida, Phys. Lett. A 150, 262 (1990)"


def verlet_steps(half: Sequence[Weight]) -> Word:
    """Spell a symmetric composition of position-Verlet steps by its first half; the step in the middle is the rest."""
    outer = [Fraction(weight) for weight in half]
    return composition(word((D, "1/2"), (K, 1), (D, "1/2")), [*outer, 1 - 2 * sum(outer), *reversed(outer)])


METHODS = (
    Method(
        name="yoshida-6",
        order=6,
        word=verlet_steps(
            [
                "0.7845136104775572638194976338663498757768",
                "0.2355732133593581336847931829785346016865",
                "-1.177679984178871006946415680964315734639",
            ]
        ),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{YOSHIDA}, table 1, A",
        aliases=("yoshida-6a",),
    ),
    # The root of the order conditions at 60 digits; the table in the paper is off by up to 2e-13.
    Method(
        name="yoshida-8",
        order=8,
        word=verlet_steps(
            [
                "0.9148442462297915667487934898475096045181",
                "0.2536933365662113541461460206899420760977",
                "-1.444852236860605157694730657537390354956",
                "-0.1582406353680501752040667767597542477554",
                "1.938139137622525986579186487443641760954",
                "-1.960610232975310807607633376399663640792",
                "0.1027998493917964406981151316012258629110",
            ]
        ),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{YOSHIDA}, table 2, D",
        aliases=("yoshida-8d",),
    ),
)
