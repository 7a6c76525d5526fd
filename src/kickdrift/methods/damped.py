"""Words of kicks, drifts and exact damping for m x'' = F(t, x) - c v.

With the same c / m for all numbers, each multiplies areas in phase space by exactly exp(-h c / m): conformally symplectic.

Real words of order above 2 have negative shares, over which damping makes v grow, until the rest of the step undoes it.
The letters are arranged for the least of that: exp(0.042 h c / m) with order 4.
"""

from kickdrift.core.kinds import Kind
from kickdrift.methods import blanes_moan
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import D, K, Method, word
from kickdrift.methods.three_parts import in_three

_C = Letter.DAMP
_TWO_PARTS = {method.name: method.word for method in blanes_moan.METHODS}
_MCLACHLAN = "as a composition of adjoint steps: McLachlan, SIAM J. Sci. Comput. 16, 151 (1995)"

METHODS = (
    # Of the six palindromes the one with the least error on a forced pendulum, from h c / m = 0.02 to 8.
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
