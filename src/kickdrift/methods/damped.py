"""Words of kicks, drifts and exact damping for m x'' = F(t, x) - c v.

With the same c / m for all numbers, each is conformally symplectic: it multiplies areas in phase space by exactly
exp(-h c / m), as the motion does.

The words of order 4 and 6 are those of Blanes and Moan for undamped motion, with drifts over which v decays. Their order
holds because such a drift, like a plain one, is linear in v: [K, [K, [K, D]]] vanishes, as the Nystroem conditions assume.

Real words of order above 2 have negative shares, over which damping makes v grow until the rest of the step undoes it: by
exp(0.70 h c / m) with order 4, and by exp(0.37 h c / m) with order 6. On forced pendulums with c / m from 3 to 30 both are
ahead of order 2 at equal cost up to h c / m = 8 at least.
"""

from kickdrift.core.kinds import Kind
from kickdrift.methods import blanes_moan
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import D, K, Method
from kickdrift.methods.words import word

_C = Letter.DAMP
_NYSTROEM = {method.name: method.word for method in blanes_moan.METHODS}


def _damped(order: int, name: str, table: str) -> Method:
    return Method(
        name=f"blanes-moan-conformal-{order}",
        order=order,
        word=tuple((Letter.DAMPED_DRIFT if letter is D else letter, weight) for letter, weight in _NYSTROEM[name]),
        symmetric=True,
        kind=Kind.DAMPED,
        source=f"{blanes_moan.BLANES_MOAN}, {table}, with damped drifts",
    )


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
    _damped(4, "blanes-moan-srkn6b", "SRKN_6^b"),
    _damped(6, "blanes-moan-srkn11b", "SRKN_11^b"),
)
