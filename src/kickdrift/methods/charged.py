"""Words of kicks by E, drifts, and turns about B for charges in electric and magnetic fields.

Each preserves the volume of phase space, as all three letters do.
"""

from kickdrift.core.kinds import Kind
from kickdrift.methods import blanes_moan
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import D, K, Method, Word
from kickdrift.methods.three_parts import in_three
from kickdrift.methods.words import word

_R = Letter.ROTATE
_TWO_PARTS = {method.name: method.word for method in blanes_moan.METHODS}
_MCLACHLAN = "as a composition of adjoint steps: McLachlan, SIAM J. Sci. Comput. 16, 151 (1995)"
_HE = "He, Sun, Liu, Qin, J. Comput. Phys. 281, 135 (2015)"


def _around(turn: Letter) -> Word:
    return word((D, "1/2"), (K, "1/2"), (turn, 1), (K, "1/2"), (D, "1/2"))


METHODS = (
    Method(
        name="boris",
        order=2,
        word=_around(Letter.BORIS_ROTATE),
        symmetric=True,
        kind=Kind.CHARGED,
        source=f"Boris, Proc. 4th Conf. Numerical Simulation of Plasmas, 3 (1970); {_HE}",
        aliases=("boris-2",),
    ),
    Method(name="he-sun-liu-qin-2", order=2, word=_around(_R), symmetric=True, kind=Kind.CHARGED, source=_HE),
    # An eighth of the error of Suzuki's five steps of "he-sun-liu-qin-2" at equal cost, in fields that vary in space
    # and time.
    Method(
        name="blanes-moan-gyration-4",
        order=4,
        word=in_three(_TWO_PARTS["blanes-moan-s6"], D, K, _R),
        symmetric=True,
        kind=Kind.CHARGED,
        source=f"{blanes_moan.BLANES_MOAN}, S_6, {_MCLACHLAN}; volume: {_HE}",
    ),
    Method(
        name="blanes-moan-gyration-6",
        order=6,
        word=in_three(_TWO_PARTS["blanes-moan-s10"], D, K, _R),
        symmetric=True,
        kind=Kind.CHARGED,
        source=f"{blanes_moan.BLANES_MOAN}, S_10, {_MCLACHLAN}; volume: {_HE}",
    ),
)
