"""Words for Langevin dynamics, in the letters of the trade: B a kick, A a drift, O friction with noise.

The orders are weak orders, of averages over the noise. The palindromes have order 2. BAOA is BAOAB begun half a kick
later: it has the positions of BAOAB's distribution, and order 1 as one counts from a given start.
"""

from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import D, K, Method
from kickdrift.methods.tableau import Tableau
from kickdrift.methods.words import word

_O = Letter.THERMOSTAT
_LEIMKUHLER_MATTHEWS = "Leimkuhler, Matthews, Appl. Math. Res. Express 2013, 34 (2013)"

METHODS = (
    Method(
        name="baoab",
        order=2,
        word=word((K, "1/2"), (D, "1/2"), (_O, 1), (D, "1/2"), (K, "1/2")),
        symmetric=True,
        kind=Kind.LANGEVIN,
        source=_LEIMKUHLER_MATTHEWS,
    ),
    Method(
        name="aboba",
        order=2,
        word=word((D, "1/2"), (K, "1/2"), (_O, 1), (K, "1/2"), (D, "1/2")),
        symmetric=True,
        kind=Kind.LANGEVIN,
        source=_LEIMKUHLER_MATTHEWS,
    ),
    Method(
        name="obabo",
        order=2,
        word=word((_O, "1/2"), (K, "1/2"), (D, 1), (K, "1/2"), (_O, "1/2")),
        symmetric=True,
        kind=Kind.LANGEVIN,
        source="Bussi, Parrinello, Phys. Rev. E 75, 056707 (2007)",
    ),
    Method(
        name="baoa",
        order=1,
        word=word((K, 1), (D, "1/2"), (_O, 1), (D, "1/2")),
        symmetric=False,
        kind=Kind.LANGEVIN,
        source=(
            "Zhang, Liu, Yan, Tuckerman, Liu, J. Phys. Chem. A 123, 6056 (2019); Kieninger, Keller, J. Chem. Theory"
            " Comput. 18, 5792 (2022)"
        ),
        aliases=("langevin-middle",),
    ),
    Method(
        name="drift-implicit-euler-maruyama",
        order=1,
        word=word((Letter.NOISE, 1), (Letter.IMPLICIT_RUNGE_KUTTA, 1)),
        symmetric=False,
        kind=Kind.LANGEVIN,
        source="Kloeden, Platen, Numerical Solution of Stochastic Differential Equations (1992), section 12.2",
        tableau=lambda: Tableau(a=[[1]], b=[1]),
    ),
)
