"""The methods of McLachlan and Atela with the smallest errors for their orders and stages.

Those of orders 4 and 5 are Nystroem methods, and their first row belongs to the kicks: with the rows exchanged both
fall to order 3 on nonlinear forces, which no harmonic oscillator shows.
"""

from decimal import Decimal, localcontext
from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.record import K, Method
from kickdrift.methods.words import rows

MCLACHLAN_ATELA = "McLachlan, Atela, Nonlinearity 5, 541 (1992), table 2"

with localcontext() as _context:
    _context.prec = 60
    _half_of_root = Fraction(Decimal("0.5").sqrt())

    # The third-order conditions for weights that read the same backwards with kicks and drifts exchanged, solved by
    # radicals: a2 = 1/(4 a1) - a1/2, a3 = 1 - a1 - a2, with a1 from a quartic and its resolvent root w.
    _third = 1 / Decimal(3)
    _z = -((2 * _third**3 - _third**2 / Decimal(3).sqrt()) ** _third)
    _w = -2 * _third + _third**2 / _z + _z
    _y = (1 + _w * _w) / 4
    _a1 = (_third**2 / _y - _w / 2 + _y.sqrt()).sqrt() - _third / _y.sqrt()
    _a2 = 1 / (4 * _a1) - _a1 / 2

METHODS = (
    Method(
        name="mclachlan-atela-2",
        order=2,
        word=rows(K, [1 - _half_of_root], [_half_of_root]),
        symmetric=False,
        kind=Kind.SEPARABLE,
        source=MCLACHLAN_ATELA,
    ),
    Method(
        name="mclachlan-atela-3",
        order=3,
        word=rows(K, [1 - Fraction(_a1) - Fraction(_a2), _a2], [_a1, _a2]),
        symmetric=False,
        kind=Kind.SEPARABLE,
        source=MCLACHLAN_ATELA,
    ),
    Method(
        name="mclachlan-atela-4",
        order=4,
        word=rows(
            K,
            ["0.1344961992774310892", "-0.2248198030794208058", "0.7563200005156682911"],
            ["0.5153528374311229364", "-0.085782019412973646", "0.4415830236164665242"],
        ),
        symmetric=False,
        kind=Kind.NEWTONIAN,
        source=MCLACHLAN_ATELA,
    ),
    Method(
        name="mclachlan-atela-5",
        order=5,
        word=rows(
            K,
            [
                "0.1193900292875672758",
                "0.6989273703824752308",
                "-0.1713123582716007754",
                "0.4012695022513534480",
                "0.0107050818482359840",
            ],
            [
                "0.339839625839110000",
                "-0.088601336903027329",
                "0.5858564768259621188",
                "-0.603039356536491888",
                "0.3235807965546976394",
            ],
        ),
        symmetric=False,
        kind=Kind.NEWTONIAN,
        source=MCLACHLAN_ATELA,
    ),
)
