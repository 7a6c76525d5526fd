"""Words of kicks, drifts and exact damping for m x'' = F(t, x) - c v.

With the same c / m for all numbers, each is conformally symplectic: it multiplies areas in phase space by exactly
exp(-h c / m), as the motion does.

Real words of order above 2 have negative shares, over which damping makes v grow until the rest of the step undoes it:
by exp(0.042 h c / m) with order 4, in this arrangement of the letters, and by exp(0.73 h c / m) with order 6. On a
forced pendulum order 4 is ahead of order 2 at equal cost up to h c / m = 6, and order 6 up to 4.
"""

from kickdrift.core.kinds import Kind
from kickdrift.methods import blanes_moan
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import D, K, Method
from kickdrift.methods.three_parts import in_three
from kickdrift.methods.words import word

_C = Letter.DAMP
_TWO_PARTS = {method.name: method.word for method in blanes_moan.METHODS}
_MCLACHLAN = "as a composition of adjoint steps: McLachlan, SIAM J. Sci. Comput. 16, 151 (1995)"

METHODS = (
    # Of the six palindromes of this length the one with the least error on a forced pendulum, h c / m = 0.015 and 0.15.
    Method(
        name="conformal-verlet",
        order=2,
        word=word((K, "1/2"), (_C, "1/2"), (D, 1), (_C, "1/2"), (K, "1/2")),
        symmetric=True,
        kind=Kind.DAMPED,
        source=(
            "McLachlan, Perlmutter, J. Geom. Phys. 39, 276 (2001); Bhatt, Floyd, Moore, J. Sci. Comput. 66, 1234 (2016)"
        ),
    ),
    Method(
        name="blanes-moan-conformal-4",
        order=4,
        word=in_three(_TWO_PARTS["blanes-moan-s6"], _C, K, D),
        symmetric=True,
        kind=Kind.DAMPED,
        source=f"{blanes_moan.BLANES_MOAN}, S_6, {_MCLACHLAN}",
    ),
    Method(
        name="blanes-moan-conformal-6",
        order=6,
        word=in_three(_TWO_PARTS["blanes-moan-s10"], _C, K, D),
        symmetric=True,
        kind=Kind.DAMPED,
        source=f"{blanes_moan.BLANES_MOAN}, S_10, {_MCLACHLAN}",
    ),
)
