"""The Radau IIA methods: collocation with the end of the step as a node, for stiff problems.

They are L-stable: what decays faster than a step can follow is gone after it. They conserve no energy.
"""

from decimal import Decimal, localcontext
from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.collocation import collocation
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import Method
from kickdrift.methods.tableau import Tableau
from kickdrift.methods.words import word

with localcontext() as _context:
    _context.prec = 60
    _SIX = Fraction(Decimal(6).sqrt() / 10)

_MIDDLE = Fraction(2, 5)

# The roots of P_3(2 c - 1) - P_4(2 c - 1) with Legendre's polynomials, but for 1.
_FOUR = tuple(
    Fraction(root)
    for root in (
        "0.088587959512703947395546143769456196885729331922750",
        "0.40946686444073471086492625206882989405190489528056",
        "0.78765946176084705602524188987599962334808005851097",
    )
)


_TABLES = "Hairer, Wanner, Solving Ordinary Differential Equations II, 2nd ed. (1996), tables IV.5.5 and IV.5.6"


def _of_nodes(*nodes: Fraction) -> Tableau:
    a, b = collocation(nodes)
    return Tableau(a=a, b=b)


def _method(order: int, source: str, *nodes: Fraction) -> Method:
    return Method(
        name=f"radau-{order}",
        order=order,
        word=word((Letter.STIFF_RUNGE_KUTTA, 1)),
        symmetric=False,
        kind=Kind.FIRST_ORDER,
        source=source,
        aliases=(f"radau-iia-{order}",),
        tableau=lambda: _of_nodes(*nodes),
    )


METHODS = (
    _method(3, _TABLES, Fraction(1, 3), Fraction(1)),
    _method(5, _TABLES, _MIDDLE - _SIX, _MIDDLE + _SIX, Fraction(1)),
    _method(7, "Hairer, Wanner, J. Comput. Appl. Math. 111, 93 (1999)", *_FOUR, Fraction(1)),
)
